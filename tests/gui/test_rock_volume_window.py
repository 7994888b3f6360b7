"""What the window of a rock volume shows and asks: stale results, limits, raw files, edges, theme; and that it goes."""

from __future__ import annotations

import gc
import gzip
import json
import weakref
import zipfile

import numpy as np
import pytest
from chambers import chambers
from PySide6.QtCore import QCoreApplication, QEvent, Qt, QTimer
from PySide6.QtWidgets import QApplication, QDialogButtonBox, QFileDialog, QLabel, QMessageBox, QWidget

from geofit.data.languages import EN
from geofit.gui.dialogs.rock_volume import RockVolumeDialog
from geofit.gui.help import Help
from geofit.gui.language import apply_language
from geofit.gui.panels.marks import icon
from geofit.gui.theme import apply_theme
from geofit.pores.representative import representative_volume
from geofit.pores.volume import RockVolume
from geofit.project.pore_files import pore_files
from geofit.report.pores_chapter import settling_sentence


def read(qtbot, rock_volume, path):
    before = rock_volume.volume
    rock_volume.read(path)
    qtbot.waitUntil(lambda: not rock_volume.running and rock_volume.volume is not before, timeout=30_000)


def find(qtbot, rock_volume, low=0, high=0, edge=2):
    """State pore values and edge, and click; wait until pores or words are there."""
    for box, value in ((rock_volume.low, low), (rock_volume.high, high), (rock_volume.edge, edge)):
        box.setValue(value)
    qtbot.mouseClick(rock_volume.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: not rock_volume.running and bool(rock_volume.message.text()), timeout=120_000)


def found(qtbot, rock_volume, path):
    read(qtbot, rock_volume, labels(path))
    find(qtbot, rock_volume)
    assert rock_volume.view is not None


def labels(path):
    np.save(path, chambers())
    return path


def figures(rock_volume):
    table = rock_volume.table.model()
    return {table.index(r, 0).data(): table.index(r, 1).data() for r in range(table.rowCount())}


def test_another_file_leaves_nothing_of_the_first_on_show(qtbot, rock_volume, tmp_path, here):
    found(qtbot, rock_volume, tmp_path / "rock.npy")
    assert figures(rock_volume)
    assert rock_volume.key.text()
    read(qtbot, rock_volume, labels(tmp_path / "second.npy"))
    assert "second.npy" in rock_volume.windowTitle()
    assert rock_volume.scene.shown == ()
    assert figures(rock_volume) == {}
    assert rock_volume.key.text() == ""
    find(qtbot, rock_volume, 7, 7)
    assert rock_volume.scene.shown == ()
    assert figures(rock_volume) == {}


def test_results_of_other_values_are_marked_until_the_values_are_theirs_again(qtbot, rock_volume, tmp_path, here):
    found(qtbot, rock_volume, tmp_path / "rock.npy")
    said = rock_volume.message.text()
    assert said
    assert not rock_volume.old.isVisible()
    for box, other in ((rock_volume.high, 1), (rock_volume.edge, 3)):
        before = box.value()
        box.setValue(other)
        assert rock_volume.old.isVisible()
        assert "Find pores" in rock_volume.old.text
        assert rock_volume.message.text() == ""
        box.setValue(before)
        assert not rock_volume.old.isVisible()
        assert rock_volume.message.text() == said
    find(qtbot, rock_volume, edge=3)
    assert not rock_volume.old.isVisible()
    assert rock_volume.message.text() == said


def test_a_folder_of_slices_is_opened_and_a_slice_alone_says_that_it_is_one(qtbot, rock_volume, tmp_path, monkeypatch):
    image = pytest.importorskip("PIL.Image", reason="Pillow reads TIFF")
    for k, values in enumerate(chambers()):
        image.fromarray(values).save(tmp_path / f"slice_{k:03d}.tif")
    read(qtbot, rock_volume, tmp_path / "slice_000.tif")
    assert rock_volume.volume.values.shape == (1, *chambers().shape[1:])
    assert "one slice" in rock_volume.message.text()
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(tmp_path))
    before = rock_volume.volume
    qtbot.mouseClick(rock_volume.folder_button, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: not rock_volume.running and rock_volume.volume is not before, timeout=30_000)
    np.testing.assert_array_equal(rock_volume.volume.values, chambers())
    assert "one slice" not in rock_volume.message.text()


def test_a_volume_that_is_refused_is_named_while_the_former_stays_on_show(qtbot, rock_volume, tmp_path):
    read(qtbot, rock_volume, labels(tmp_path / "rock.npy"))
    values = chambers().astype(np.float32)
    values[0] = np.nan
    np.save(tmp_path / "holes.npy", values)
    rock_volume.read(tmp_path / "holes.npy")
    qtbot.waitUntil(lambda: not rock_volume.running, timeout=30_000)
    assert rock_volume.message.text().startswith("holes.npy: ")
    assert "NaN" in rock_volume.message.text()
    assert rock_volume.volume.name == "rock.npy"


@pytest.mark.parametrize("largest", [1e-6, 0.01, 1.0, 255.0, 40_000.0])
def test_limits_of_fractions_are_as_fine_as_the_values(qtbot, rock_volume, tmp_path, largest):
    values = np.random.default_rng(5).beta(2, 2, (12, 13, 14)) * largest
    np.save(tmp_path / "grey.npy", values.astype(np.float32))
    read(qtbot, rock_volume, tmp_path / "grey.npy")
    volume = rock_volume.volume
    assert rock_volume.high.value() == pytest.approx(volume.threshold, abs=1e-3 * largest)
    assert volume.values.min() >= rock_volume.low.value() > volume.values.min() - 1e-3 * largest
    share = 100 * (volume.values <= volume.threshold).mean()
    assert float(rock_volume.porosity.text().split()[0]) == pytest.approx(share, abs=0.2)
    assert largest / 1000 <= rock_volume.high.singleStep() <= largest / 10


@pytest.mark.parametrize("value", [2**38, -7, 0.25])
def test_limits_of_one_value_everywhere_step_by_one(qtbot, rock_volume, tmp_path, value):
    np.save(tmp_path / "one.npy", np.full((4, 5, 6), value))
    read(qtbot, rock_volume, tmp_path / "one.npy")
    qtbot.keyClick(rock_volume.low, Qt.Key.Key_Up)
    assert rock_volume.low.value() <= value
    rock_volume.low.setValue(value)
    rock_volume.high.setValue(value)
    assert rock_volume.porosity.text() == "100.00 %"


@pytest.mark.parametrize("kind", [np.uint8, np.int16, np.uint16])
def test_limits_of_whole_numbers_are_whole_and_from_the_smallest(qtbot, rock_volume, tmp_path, kind):
    values = np.random.default_rng(5).integers(0, 200, (12, 13, 14)).astype(kind)
    if kind is np.int16:
        values -= 100
    np.save(tmp_path / "grey.npy", values)
    read(qtbot, rock_volume, tmp_path / "grey.npy")
    assert rock_volume.low.text() == str(values.min())
    assert rock_volume.high.text() == str(int(np.floor(rock_volume.volume.threshold)))
    assert rock_volume.porosity.text() == f"{100 * (values <= rock_volume.volume.threshold).mean():.2f} %"


def test_up_begins_at_the_values_of_the_volume(qtbot, rock_volume, tmp_path):
    np.save(tmp_path / "labels.npy", chambers() + np.uint8(3))
    read(qtbot, rock_volume, tmp_path / "labels.npy")
    assert rock_volume.low.text() == rock_volume.high.text() == "not stated"
    qtbot.keyClick(rock_volume.low, Qt.Key.Key_Up)
    assert rock_volume.low.text() == "3"
    qtbot.keyClick(rock_volume.low, Qt.Key.Key_Up)
    assert rock_volume.low.text() == "4"
    qtbot.keyClick(rock_volume.high, Qt.Key.Key_Up)
    assert rock_volume.high.text() == "4", "no range ends below its start"


def test_the_upper_limit_is_not_called_as_a_depth_is(qtbot):
    apply_language("zh_CN")
    try:
        rock_volume = RockVolumeDialog()
        qtbot.addWidget(rock_volume)
        assert "终点深度" not in {label.text() for label in rock_volume.findChildren(QLabel)}
        rock_volume.close()
    finally:
        apply_language("en")


@pytest.mark.parametrize("file", ["odd.raw", "odd.raw.gz"])
def test_shape_and_type_of_a_raw_file_are_asked_for(qtbot, rock_volume, tmp_path, file):
    values = np.arange(4 * 5 * 7, dtype=">u2").reshape(4, 5, 7)
    content = values.tobytes()
    (tmp_path / file).write_bytes(gzip.compress(content) if file.endswith("gz") else content)
    rock_volume.read(tmp_path / file)
    qtbot.waitUntil(lambda: rock_volume.raw is not None and not rock_volume.running, timeout=30_000)
    form = rock_volume.raw
    assert form.isVisible()
    assert "280 bytes" in form.message.text()
    assert "dtype" not in form.message.text()
    accept = form.buttons.button(QDialogButtonBox.StandardButton.Open)
    assert not accept.isEnabled()
    for box, count in zip(form.counts, (4, 5, 8), strict=True):
        box.setValue(count)
    form.kind.setCurrentIndex(form.kind.findData("u2"))
    form.big_endian.setChecked(True)
    qtbot.mouseClick(accept, Qt.MouseButton.LeftButton)
    # Wrong counts: the reader's error, and the same form once more.
    qtbot.waitUntil(lambda: rock_volume.raw not in (None, form) and not rock_volume.running, timeout=30_000)
    again = rock_volume.raw
    assert "need 320" in again.message.text()
    assert [box.value() for box in again.counts] == [4, 5, 8]
    assert again.stated == ((4, 5, 8), ">u2")
    again.counts[2].setValue(7)
    again.accept()
    qtbot.waitUntil(lambda: not rock_volume.running and rock_volume.volume is not None, timeout=30_000)
    np.testing.assert_array_equal(rock_volume.volume.values, values)
    assert rock_volume.raw is None
    assert file in rock_volume.windowTitle()


def test_pores_of_a_raw_file_whose_shape_was_stated_are_found(qtbot, rock_volume, tmp_path, here):
    (tmp_path / "odd.raw").write_bytes(chambers().tobytes())
    rock_volume.read(tmp_path / "odd.raw", chambers().shape, "u1")
    qtbot.waitUntil(lambda: not rock_volume.running and rock_volume.volume is not None, timeout=30_000)
    find(qtbot, rock_volume)
    assert figures(rock_volume)["pores, throats"] == "2, 1"


def test_a_raw_file_is_left_alone_where_its_shape_is_not_stated(qtbot, rock_volume, tmp_path):
    (tmp_path / "odd.raw").write_bytes(bytes(280))
    rock_volume.read(tmp_path / "odd.raw")
    qtbot.waitUntil(lambda: rock_volume.raw is not None and not rock_volume.running, timeout=30_000)
    rock_volume.raw.reject()
    assert rock_volume.raw is None
    assert "odd.raw" in rock_volume.message.text()
    assert "dtype" not in rock_volume.message.text()
    assert rock_volume.volume is None


@pytest.mark.parametrize("file", ["core.raw", "core.raw.gz", "core_6.raw", "core.zip"])
def test_the_shape_that_a_raw_file_was_read_with_is_shown_and_can_be_changed(qtbot, rock_volume, tmp_path, file):
    """As many voxels fit a cube and 4 x 6 x 9: a size says nothing about the shape."""
    values = np.arange(216, dtype=np.uint8).reshape(4, 6, 9)
    path = tmp_path / file
    if file.endswith("zip"):
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("core.raw", values.tobytes())
    else:
        path.write_bytes(gzip.compress(values.tobytes()) if file.endswith("gz") else values.tobytes())
    assert not rock_volume.shape_button.isVisible()
    read(qtbot, rock_volume, path)
    assert rock_volume.volume.values.shape == (6, 6, 6)
    assert rock_volume.assumed.isVisible()
    assert "read as 6 × 6 × 6 voxels, 8 bits, unsigned." in rock_volume.assumed.text()
    qtbot.mouseClick(rock_volume.shape_button, Qt.MouseButton.LeftButton)
    form = rock_volume.raw
    assert form.isVisible()
    assert form.stated == ((6, 6, 6), "u1")
    for box, count in zip(form.counts, values.shape, strict=True):
        box.setValue(count)
    before = rock_volume.volume
    form.accept()
    qtbot.waitUntil(lambda: not rock_volume.running and rock_volume.volume is not before, timeout=30_000)
    np.testing.assert_array_equal(rock_volume.volume.values, values)
    # What a person stated is not called assumed, and can still be changed.
    assert not rock_volume.assumed.isVisible()
    assert rock_volume.shape_button.isVisible()
    read(qtbot, rock_volume, labels(tmp_path / "rock.npy"))
    assert not rock_volume.shape_button.isVisible()


@pytest.mark.parametrize(("file", "content"), [("a.raw", b""), ("a.mha", None)])
def test_no_shape_is_asked_for_that_would_not_help(qtbot, rock_volume, tmp_path, file, content):
    path = tmp_path / file
    if content is None:
        path = anisotropic(path)
        content = path.read_bytes()[:-7]
    path.write_bytes(content)
    rock_volume.read(path)
    qtbot.waitUntil(lambda: not rock_volume.running and bool(rock_volume.message.text()), timeout=30_000)
    assert rock_volume.raw is None
    assert "dtype" not in rock_volume.message.text()


def test_values_that_no_voxel_has_are_named_as_they_were_stated(qtbot, rock_volume, tmp_path, here):
    read(qtbot, rock_volume, labels(tmp_path / "rock.npy"))
    find(qtbot, rock_volume, 4, 6)
    text = rock_volume.message.text()
    assert "from 4 to 6" in text
    assert "from 0 to 1" in text
    assert "True" not in text


def test_a_window_that_is_closed_goes_with_its_volume(qtbot, tmp_path):
    window = QWidget()
    qtbot.addWidget(window)
    gone = []

    def work():
        dialog = QApplication.activeModalWidget()
        dialog.read(labels(tmp_path / "rock.npy"))
        qtbot.waitUntil(lambda: not dialog.running and dialog.volume is not None, timeout=30_000)
        gone.append(weakref.ref(dialog.volume))
        dialog.reject()

    QTimer.singleShot(200, work)
    Help(window, lambda: "view").rock_volume()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    gc.collect()
    assert window.findChildren(RockVolumeDialog) == []
    assert gone[0]() is None


def test_the_scene_follows_the_theme(qtbot, qapp, rock_volume, tmp_path, here):
    found(qtbot, rock_volume, tmp_path / "rock.npy")
    try:
        for theme, dark in (("dark", True), ("light", False), ("dark", True)):
            apply_theme(qapp, theme)
            qtbot.wait(20)
            assert rock_volume.scene.dark == dark
            assert (max(rock_volume.scene.canvas.renderer.GetBackground()) < 0.3) == dark
    finally:
        apply_theme(qapp, "light")


@pytest.mark.parametrize("size", [(1180, 760), (1180, 1000)])
def test_all_that_is_drawn_is_in_the_picture(qtbot, rock_volume, tmp_path, here, size):
    rock_volume.resize(*size)
    # An eighth of a ball at each corner: most of each ball that is drawn is outside the sample.
    from_corner = np.minimum(np.arange(21), np.arange(21)[::-1])
    squares = sum(axis.astype(float) ** 2 for axis in np.meshgrid(*[from_corner] * 3))
    np.save(tmp_path / "pore.npy", (squares > 81).astype(np.uint8))
    read(qtbot, rock_volume, tmp_path / "pore.npy")
    find(qtbot, rock_volume)
    canvas = rock_volume.scene.canvas
    for actor in rock_volume.scene.actors.values():
        places = canvas.projector().screen(actor.mapper.dataset.points)[:, :2]
        assert (places >= 0).all()
        assert (places <= [canvas.width(), canvas.height()]).all()


def anisotropic(path, spacing="0.001 0.001 0.002", values=None):
    values = chambers() if values is None else values
    sizes = " ".join(map(str, values.shape[::-1]))
    header = f"NDims = 3\nDimSize = {sizes}\nElementType = MET_UCHAR\nElementSpacing = {spacing}\n"
    path.write_bytes((header + "ElementDataFile = LOCAL\n").encode() + values.tobytes())
    return path


def test_edges_that_the_file_states_are_shown_and_not_asked_for(qtbot, rock_volume, tmp_path):
    read(qtbot, rock_volume, anisotropic(tmp_path / "a.mha"))
    assert rock_volume.edges.isVisible()
    assert "2.000 × 1.000 × 1.000 µm" in rock_volume.edges.text()
    assert "pore" in rock_volume.message.text()
    assert "edge" not in rock_volume.message.text()
    rock_volume.edge.setValue(4.0)
    assert "4.000 × 2.000 × 2.000 µm" in rock_volume.edges.text()
    grey = np.random.default_rng(1).integers(0, 200, (5, 6, 7)).astype(np.uint8)
    read(qtbot, rock_volume, anisotropic(tmp_path / "b.mha", "0.001 0.001 0.001", grey))
    assert not rock_volume.edges.isVisible()
    assert "Otsu" in rock_volume.message.text()
    assert "edge" not in rock_volume.message.text()


def test_edges_that_are_no_lengths_are_asked_for(qtbot, rock_volume, tmp_path, here):
    read(qtbot, rock_volume, anisotropic(tmp_path / "a.mha", "0 0 -1"))
    assert "edge" in rock_volume.message.text()
    assert not rock_volume.edges.isVisible()
    find(qtbot, rock_volume)


@pytest.mark.parametrize(("millimetres", "text"), [("0.0000043", "0.004300 µm"), ("0.0652", "65.200 µm")])
def test_an_edge_that_the_file_states_is_not_rounded_away(qtbot, rock_volume, tmp_path, millimetres, text):
    read(qtbot, rock_volume, anisotropic(tmp_path / "a.mha", " ".join([millimetres] * 3)))
    assert rock_volume.edge.text() == text


def test_files_and_report_are_written_of_the_pores_that_are_shown(qtbot, rock_volume, tmp_path, here, monkeypatch):
    out = tmp_path / "out"
    out.mkdir()
    assert not rock_volume.export.isEnabled()
    found(qtbot, rock_volume, tmp_path / "rock.npy")
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(out))
    for button, report in ((rock_volume.export, False), (rock_volume.report, True)):
        before = set(out.iterdir())
        assert button.isEnabled()
        qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
        qtbot.waitUntil(lambda: not rock_volume.running and bool(rock_volume.message.text()), timeout=120_000)
        written = set(out.iterdir()) - before
        assert written == set(pore_files(out, "rock", chambers().shape, report=report))
        assert str(out) in rock_volume.message.text()
    figures = json.loads((out / "rock.json").read_text("utf-8"))
    assert figures["porosity"] == pytest.approx((chambers() == 0).mean())
    assert figures["voxel"] == pytest.approx([2e-6] * 3)
    # What is there already is replaced only if that is wanted.
    (out / "rock.json").write_text("mine", "utf-8")
    monkeypatch.setattr(QMessageBox, "exec", lambda _: QMessageBox.StandardButton.No)
    qtbot.mouseClick(rock_volume.export, Qt.MouseButton.LeftButton)
    assert not rock_volume.running
    assert (out / "rock.json").read_text("utf-8") == "mine"
    # Of pores that are out of date there are none.
    rock_volume.edge.setValue(3)
    assert not rock_volume.export.isEnabled()
    assert not rock_volume.report.isEnabled()


def test_the_representative_volume_is_that_of_the_report(qtbot, rock_volume, tmp_path, here):
    tabs, place = rock_volume.tabs, rock_volume.tabs.indexOf(rock_volume.settling)
    assert not tabs.isTabVisible(place)
    found(qtbot, rock_volume, tmp_path / "rock.npy")
    volume = RockVolume(chambers(), pore=0, voxel=2e-6)
    settling = representative_volume(volume)
    assert tabs.isTabVisible(place)
    np.testing.assert_array_equal(rock_volume.view.settling.mean, settling.mean)
    assert rock_volume.settling.words.text() == settling_sentence(settling, volume.porosity, EN)
    tabs.setCurrentIndex(place)
    qtbot.waitUntil(lambda: bool(rock_volume.settling.canvas.figure.axes))
    # However many lines the words take.
    assert rock_volume.settling.canvas.geometry().bottom() < rock_volume.settling.height()
    read(qtbot, rock_volume, labels(tmp_path / "second.npy"))
    assert not tabs.isTabVisible(place)


def test_a_large_volume_has_files_and_no_report(qtbot, rock_volume, tmp_path, here, monkeypatch):
    monkeypatch.setattr("geofit.project.pore_view.LARGE", 1000)
    found(qtbot, rock_volume, tmp_path / "rock.npy")
    assert not rock_volume.report.isEnabled()
    assert "too large" in rock_volume.report.toolTip()
    assert not rock_volume.tabs.isTabVisible(rock_volume.tabs.indexOf(rock_volume.settling))
    rock_volume.write(tmp_path / "out")
    qtbot.waitUntil(lambda: not rock_volume.running and bool(rock_volume.message.text()), timeout=120_000)
    assert set((tmp_path / "out").iterdir()) == set(pore_files(tmp_path / "out", "rock", chambers().shape))


def test_a_warning_has_the_mark_of_warnings(qtbot, rock_volume, tmp_path, monkeypatch):
    image = pytest.importorskip("PIL.Image", reason="Pillow reads TIFF")
    marks = []
    monkeypatch.setattr(
        "geofit.gui.dialogs.task_dialog.icon", lambda name: marks.append(name) or icon(name), raising=True
    )
    image.fromarray(chambers()[0]).save(tmp_path / "slice_000.tif")
    read(qtbot, rock_volume, tmp_path / "slice_000.tif")
    assert marks[-1] == "warning"
