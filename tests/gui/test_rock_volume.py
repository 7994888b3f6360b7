"""A rock volume from the file to its pores in space: slices, threshold, progress, stop, colours, figures."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest
from chambers import chambers
from PySide6.QtCore import Qt

from geofit.data.errors import Cancelled, InputError
from geofit.gui.view3d.pore_scene import CONNECTED
from geofit.project.pore_view import pore_view, read_grey

VOXEL = (2e-6,) * 3


def read(qtbot, rock_volume, path):
    rock_volume.read(path)
    qtbot.waitUntil(lambda: not rock_volume.running and rock_volume.volume is not None, timeout=30_000)


def test_labels_are_never_guessed_and_the_voxel_is_asked_for(qtbot, rock_volume, tmp_path):
    np.save(tmp_path / "rock.npy", chambers())
    assert not rock_volume.go.isEnabled()
    read(qtbot, rock_volume, tmp_path / "rock.npy")
    assert not rock_volume.go.isEnabled()
    rock_volume.edge.setValue(2.0)
    assert not rock_volume.go.isEnabled()
    rock_volume.low.setValue(0)
    rock_volume.high.setValue(0)
    assert rock_volume.go.isEnabled()
    assert rock_volume.porosity.text() == f"{100 * (chambers() == 0).mean():.2f} %"
    rock_volume.high.setValue(-1)
    assert not rock_volume.go.isEnabled()
    assert rock_volume.porosity.text() == "–", "of no range"


def test_slices_go_through_all_axes_and_the_histogram_counts_all_voxels(qtbot, rock_volume, tmp_path):
    values = np.arange(5 * 6 * 7, dtype=np.uint16).reshape(5, 6, 7)
    np.save(tmp_path / "grey.npy", values)
    read(qtbot, rock_volume, tmp_path / "grey.npy")
    slices = rock_volume.slices
    for axis in range(3):
        slices.axis.setCurrentIndex(axis)
        assert slices.slider.maximum() == values.shape[axis] - 1
        for place in (0, values.shape[axis] - 1):
            slices.slider.setValue(place)
            np.testing.assert_array_equal(slices.slice(), values.take(place, axis=axis))
    assert rock_volume.volume.counts.sum() == values.size
    assert rock_volume.volume.threshold == pytest.approx(104.5, abs=1)
    assert rock_volume.high.value() == np.floor(rock_volume.volume.threshold), "the same voxels, in whole numbers"
    assert rock_volume.porosity.text() == "50.00 %"


def test_the_picture_shows_each_voxel_in_its_grey_and_pores_in_colour(qtbot, rock_volume, tmp_path):
    values = np.arange(4 * 5 * 6, dtype=np.uint8).reshape(4, 5, 6)
    np.save(tmp_path / "grey.npy", values)
    read(qtbot, rock_volume, tmp_path / "grey.npy")
    rock_volume.low.setValue(0)
    rock_volume.high.setValue(70)
    slices = rock_volume.slices
    slices.slider.setValue(2)
    image = slices.picture.image
    assert (image.width(), image.height()) == (6, 5)
    for row, column in np.ndindex(5, 6):
        colour = image.pixelColor(column, row)
        blue = colour.blue() > colour.red()
        assert blue == (values[2, row, column] <= 70)
        if not blue:
            assert colour.red() == pytest.approx(255 * (values[2, row, column] + 0.5) / 120, abs=1)
    place = slices.picture.place()
    assert place.width() * 5 == pytest.approx(place.height() * 6, abs=6)
    assert slices.picture.rect().contains(place)


def test_a_slice_of_a_large_volume_follows_the_slider(qtbot, rock_volume, tmp_path):
    values = np.random.default_rng(3).integers(0, 255, (400, 400, 400), np.uint8)
    np.save(tmp_path / "large.npy", values)
    began = time.process_time()
    counted = np.unique_counts(values).counts
    whole = time.process_time() - began
    began = time.process_time()
    read(qtbot, rock_volume, tmp_path / "large.npy")
    reading = time.process_time() - began
    qtbot.wait(50)
    took = []
    for axis in range(3):
        rock_volume.slices.axis.setCurrentIndex(axis)
        for place in range(50, 350, 30):
            began = time.process_time()
            rock_volume.slices.slider.setValue(place)
            rock_volume.slices.picture.repaint()
            took.append(time.process_time() - began)
    began = time.process_time()
    rock_volume.high.setValue(99)
    rock_volume.slices.canvas.draw()
    changing = time.process_time() - began
    np.testing.assert_array_equal(rock_volume.volume.counts, counted)
    # Compared with numpy's count of the same voxels, since processors differ: it took 3 s where the limits were 3, 0.05
    # and 0.25 s.
    assert reading < whole
    assert np.median(took) < whole / 60
    # Nothing is kept of the slices before: the last ones are as quick as the first.
    assert np.median(took[-10:]) < whole / 60
    assert changing < whole / 12
    assert rock_volume.porosity.text() == f"{100 * (values <= 99).mean():.2f} %"


@pytest.mark.parametrize("kind", [np.uint8, np.int16, np.uint16, np.float32])
def test_the_share_between_two_values_is_that_of_the_voxels(tmp_path, kind):
    values = (np.random.default_rng(2).random((6, 7, 8)) * 250 - (100 if kind is np.int16 else 0)).astype(kind)
    np.save(tmp_path / "a.npy", values)
    volume = read_grey(tmp_path / "a.npy")
    for low, high in ((0, 100), (-1e12, 17.5), (40.5, 40.6), (30, 20), (values.min(), values.max()), (-50, 1e12)):
        assert volume.share(low, high) == pytest.approx(((values >= low) & (values <= high)).mean())


def test_a_file_that_is_no_volume_is_an_error_in_words(qtbot, rock_volume, tmp_path):
    np.save(tmp_path / "flat.npy", np.ones((4, 4)))
    rock_volume.read(tmp_path / "flat.npy")
    qtbot.waitUntil(lambda: bool(rock_volume.message.text()), timeout=30_000)
    assert "three" in rock_volume.message.text()
    assert rock_volume.volume is None


def found(qtbot, rock_volume, path):
    np.save(path, chambers())
    read(qtbot, rock_volume, path)
    rock_volume.edge.setValue(2.0)
    rock_volume.low.setValue(0)
    rock_volume.high.setValue(0)
    qtbot.mouseClick(rock_volume.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: not rock_volume.running and rock_volume.view is not None, timeout=120_000)


def test_network_and_surface_are_drawn_and_the_figures_are_those_of_the_library(qtbot, rock_volume, tmp_path, here):
    found(qtbot, rock_volume, tmp_path / "rock.npy")
    truth = pore_view(chambers(), 0, 0, VOXEL)
    assert rock_volume.scene.shown == ("pores", "throats", "surface")
    table = rock_volume.table.model()
    rows = {table.index(r, 0).data(): table.index(r, 1).data() for r in range(table.rowCount())}
    assert rows["pores, throats"] == "2, 1"
    assert rows["pores without a path to a face, left out"] == "1"
    assert rows["permeability along axis 2, mD"] == f"{truth.permeability.millidarcy[2]:.4g}"
    assert rows["permeability along axis 0, mD"] == "0"
    assert "axis 0" in rock_volume.message.text()
    rock_volume.surface.setChecked(False)
    assert rock_volume.scene.shown == ("pores", "throats")
    rock_volume.network.setChecked(False)
    assert rock_volume.scene.shown == ()


def test_colours_are_those_of_radius_and_connection(qtbot, rock_volume, tmp_path, here):
    found(qtbot, rock_volume, tmp_path / "rock.npy")
    radius = rock_volume.view.network.pores.radius
    np.testing.assert_array_equal(rock_volume.scene.values(), radius)
    assert f"{radius.max() * 2:.2f}" in rock_volume.key.text()
    rock_volume.colour.setCurrentIndex(1)
    np.testing.assert_array_equal(rock_volume.scene.values(), [1, 1])
    mesh = rock_volume.scene.actors["pores"].mapper.dataset
    one = tuple(int(CONNECTED[1][i : i + 2], 16) for i in (1, 3, 5))
    assert {tuple(colour) for colour in mesh["colour"].tolist()} == {one}
    assert CONNECTED[3] in rock_volume.key.text()


def test_stop_leaves_what_was_there(qtbot, rock_volume, tmp_path, monkeypatch, here):
    np.save(tmp_path / "rock.npy", chambers())
    read(qtbot, rock_volume, tmp_path / "rock.npy")
    gate = threading.Event()

    def slow(*_, progress):
        gate.wait(20)
        if progress("network", 0.5) is False:
            raise Cancelled("stopped")

    monkeypatch.setattr("geofit.gui.dialogs.rock_volume.pore_view", slow)
    rock_volume.edge.setValue(2.0)
    rock_volume.low.setValue(0)
    rock_volume.high.setValue(0)
    qtbot.mouseClick(rock_volume.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(rock_volume.stop.isVisible, timeout=5_000)
    assert not rock_volume.low.isEnabled()
    qtbot.mouseClick(rock_volume.stop, Qt.MouseButton.LeftButton)
    gate.set()
    qtbot.waitUntil(lambda: not rock_volume.running, timeout=20_000)
    assert rock_volume.view is None
    assert "Stopped" in rock_volume.message.text()


@pytest.mark.parametrize("stage", ["distance", "basins", "merging", "throats", "surface", "triangles", "permeability"])
def test_every_stage_can_be_stopped(stage):
    seen = []

    def listen(name, fraction):
        seen.append(fraction)
        return name != stage

    with pytest.raises(Cancelled):
        pore_view(chambers(), 0, 0, VOXEL, progress=listen)
    assert seen == sorted(seen)


def test_the_surface_knows_the_pore_at_each_vertex():
    view = pore_view(chambers(), 0, 0, VOXEL)
    centre = view.network.pores.centre[view.vertex_pore] + 0.5
    assert len(np.unique(view.vertex_pore)) == 2
    low, high = view.vertices[:, 2] < 6, view.vertices[:, 2] > 14
    assert (centre[low, 2] < 10).all()
    assert (centre[high, 2] > 10).all()
    assert view.axes.tolist() == [1, 1]


def test_a_stated_voxel_is_taken_from_the_header(tmp_path):
    header = "NDims = 3\nDimSize = 6 5 4\nElementType = MET_UCHAR\nElementSpacing = 0.001 0.001 0.002\n"
    values = np.arange(120, dtype=np.uint8)
    (tmp_path / "a.mha").write_bytes((header + "ElementDataFile = LOCAL\n").encode() + values.tobytes())
    volume = read_grey(tmp_path / "a.mha")
    assert volume.voxel == pytest.approx((2e-6, 1e-6, 1e-6))
    assert volume.values.shape == (4, 5, 6)


def test_a_large_volume_is_worked_through_in_slabs_without_a_surface(qtbot, rock_volume, tmp_path, monkeypatch, here):
    monkeypatch.setattr("geofit.project.pore_view.LARGE", 1000)
    monkeypatch.setattr("geofit.pores.slabs.VOXELS", 2000)
    monkeypatch.setattr("geofit.gui.view3d.pore_scene.MANY", 1)
    found(qtbot, rock_volume, tmp_path / "rock.npy")
    monkeypatch.undo()
    whole = pore_view(chambers(), 0, 0, VOXEL)
    view = rock_volume.view
    assert rock_volume.scene.shown == ("pores", "throats")
    np.testing.assert_array_equal(view.network.pores.centre, whole.network.pores.centre)
    np.testing.assert_array_equal(view.network.throats.conductance, whole.network.throats.conductance)
    assert (view.porosity, view.connected) == pytest.approx((whole.porosity, whole.connected))
    assert view.permeability.square_metres == whole.permeability.square_metres
    assert view.axes.tolist() == whole.axes.tolist()
    assert not rock_volume.surface.isEnabled()


@pytest.mark.parametrize("stage", ["distance", "basins", "merging", "throats", "permeability"])
def test_every_stage_of_a_large_volume_can_be_stopped(stage, tmp_path, monkeypatch):
    monkeypatch.setattr("geofit.project.pore_view.LARGE", 1000)
    np.save(tmp_path / "rock.npy", chambers())
    seen = []

    def listen(name, fraction):
        seen.append(fraction)
        return name != stage

    with pytest.raises(Cancelled):
        pore_view(tmp_path / "rock.npy", 0, 0, VOXEL, progress=listen)
    assert seen == sorted(seen)


def test_a_file_that_went_between_opening_and_finding_is_an_error_in_words(tmp_path):
    with pytest.raises(InputError, match="the file or folder does not exist"):
        pore_view(tmp_path / "gone.npy", 0, 0, VOXEL)
