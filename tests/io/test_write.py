"""write_surface and read_surface: the ending chooses the format, keywords mean the same in each."""

from __future__ import annotations

import inspect

import numpy as np
import pytest
from surfaces import ORIGIN, height_field, horizon, nine

import geofit
from geofit.data.errors import InputError, MissingDependencyError, SettingsError
from geofit.io.export.write import FORMATS, format_of


@pytest.fixture(scope="module")
def upper():
    return horizon(nine()[1], name="T2-T1")


@pytest.fixture(scope="module")
def lower():
    return horizon([height_field(z=lambda x, y: 0.2 * x - 60)], name="W")


@pytest.mark.parametrize(("ending", "name"), [(end, name) for name, one in FORMATS.items() for end in one.endings])
def test_an_ending_stands_for_the_first_format_that_has_it(ending, name):
    first = next(known for known, one in FORMATS.items() if ending in one.endings)
    assert format_of(f"a{ending.upper()}") == first
    assert (first == name) == (name != "dxf-mesh")


@pytest.mark.parametrize("name", FORMATS)
def test_one_surface_or_several_in_every_format(name, upper, lower, tmp_path):
    path = tmp_path / "new" / f"a{FORMATS[name].endings[0]}"
    options = {"format": name, "tolerance": 2.0, "cell": 100.0, "interval": 20.0, "crs": "EPSG:32648"}
    try:
        (one, *origin) = geofit.write_surface(upper, path, **options)
    except MissingDependencyError as error:
        pytest.skip(str(error))
    assert one == path
    assert one.stat().st_size > 100
    assert not origin or origin[0].name == path.name + ".origin.txt"
    both = geofit.write_surface({"up": upper, "low": lower}, path, **options)
    assert all(file.is_file() for file in both)


@pytest.mark.usefixtures("read_here")
def test_the_unit_is_that_of_the_file_not_of_the_surface(upper, tmp_path):
    sizes = {}
    for unit in ("m", "mm"):
        (file,) = geofit.write_surface(upper, tmp_path / f"{unit}.step", unit=unit)
        back = geofit.read_surface(file)
        assert back.name == "T2-T1"
        assert np.abs(back.bounds[0] - upper.bounds[0]).max() < 1e-6
        sizes[unit] = file.read_text("utf-8").count("MILLI")
    assert sizes["mm"] > sizes["m"]
    with pytest.raises(SettingsError, match="metres"):
        geofit.write_surface(upper, tmp_path / "a.obj", unit="mm")


@pytest.mark.usefixtures("read_here")
def test_a_surface_is_found_by_its_name(upper, lower, tmp_path):
    geofit.write_surface({"up": upper, "low": lower}, tmp_path / "two.step")
    assert geofit.read_surface(tmp_path / "two.step", "low").name == "low"
    assert list(geofit.io.read_surfaces(tmp_path / "two.step")) == ["up", "low"]
    with pytest.raises(InputError, match=r"several surfaces.*up, low"):
        geofit.read_surface(tmp_path / "two.step")
    with pytest.raises(InputError, match=r"no surface 'mid'.*up, low"):
        geofit.read_surface(tmp_path / "two.step", "mid")


def test_what_is_read_is_judged_like_a_fit(tmp_path):
    rng = np.random.default_rng(0)
    xyz = np.column_stack([rng.uniform(0, 500, (60, 2)), np.zeros(60)]) + ORIGIN
    xyz[:, 2] += 0.1 * (xyz[:, 0] - ORIGIN[0])
    fit = geofit.fit_horizon(geofit.PointSet(xyz), name="plane")
    geofit.write_surface(fit, tmp_path / "plane.step")
    within = (np.abs(xyz[:, :2] - fit.bounds[0][:2] - 250) < 200).all(axis=1)  # the foot points leave no edge
    moved = geofit.PointSet(xyz[within] + np.array([0, 0, 0.3]))
    n = len(moved)
    judged = geofit.judge(geofit.read_surface(tmp_path / "plane.step"), moved, geofit.FitSettings(epsilon=0.2))
    assert judged.name == "plane"
    assert not judged.accuracy.passed
    across = 0.3 / np.hypot(1, 0.1)  # orthogonal to the plane
    assert judged.accuracy.sigma == pytest.approx(across * np.sqrt(n / (n - 1)), abs=1e-6)


def test_an_unknown_ending_names_the_known_ones(upper, tmp_path):
    with pytest.raises(InputError, match=r"ending '\.dwg'.*\.landxml"):
        geofit.write_surface(upper, tmp_path / "a.dwg")


def test_options_are_keywords():
    parameters = inspect.signature(geofit.write_surface).parameters.values()
    assert [one.name for one in parameters if one.kind is not one.KEYWORD_ONLY] == ["surfaces", "path"]


@pytest.mark.parametrize("ending", [".dxf", ".step", ".vtm", ".obj"])
def test_a_file_in_place_of_a_folder_is_the_fault_and_no_default(ending, tmp_path):
    (tmp_path / "file").write_text("")
    surface = geofit.fit_horizon(geofit.PointSet([[0, 0, 1.0], [9, 0, 2.0], [0, 9, 3.0], [9, 9, 4.0]]), name="a")
    with pytest.raises(InputError) as caught:
        geofit.write_surface(surface, tmp_path / "file" / f"a{ending}", crs="")
    assert caught.value.code == "data.folder-not-made"


def test_a_default_that_is_given_is_not_blamed_for_another_error(upper, tmp_path, monkeypatch):
    def broken(*_, **__):
        raise RuntimeError("of a library")

    monkeypatch.setattr("geofit.io.export.dxf.write_contours_dxf", broken)
    with pytest.raises(RuntimeError, match="of a library"):
        geofit.write_surface(upper, tmp_path / "a.dxf", format="", crs="", interval=20.0)
