"""The mistakes of a first script: every function of the front door says what it was given and what it needs."""

from __future__ import annotations

import numpy as np
import pytest

import geofit
from geofit.data.errors import ArgumentError, SettingsError

XYZ = np.random.default_rng(0).uniform((500000, 3100000, 900), (500100, 3100100, 905), (40, 3))


@pytest.fixture(scope="module")
def fit():
    return geofit.fit_horizon(geofit.PointSet(XYZ), name="T1")


@pytest.fixture(scope="module")
def read(fit, tmp_path_factory):
    """The same surface, read from a file: patches alone."""
    path = tmp_path_factory.mktemp("read") / "T1.igs"
    geofit.write_surface(fit, path)
    return geofit.read_surface(path)


@pytest.mark.parametrize("points", [XYZ, XYZ.tolist(), None, "points.csv"])
def test_points_are_a_point_set(points):
    with pytest.raises(ArgumentError, match=r"points is of type \w+; a PointSet is needed: PointSet\(xyz\)") as told:
        geofit.fit_horizon(points)
    assert isinstance(told.value, TypeError)


def test_settings_are_settings():
    with pytest.raises(ArgumentError, match="settings is of type dict; settings are needed"):
        geofit.fit_horizon(geofit.PointSet(XYZ), {"epsilon": 0.2})


def test_a_surface_that_was_read_is_no_fit(read):
    name = read.patches[0].name
    for call in (
        lambda: geofit.examine(read),
        lambda: geofit.separate_horizons({"a": read}, ["a"]),
        lambda: geofit.write_report(read, "nowhere"),
        lambda: geofit.write_report([read], "nowhere"),
    ):
        with pytest.raises(ArgumentError, match=r"is of type PatchSurface; a fit is needed: fit_horizon\(points\)"):
            call()
    for edit in (
        lambda: geofit.adjust(read, name, 1, 1, 0.1),
        lambda: geofit.weigh(read, name, 1, 1, 2.0),
        lambda: geofit.move_to(read, XYZ[0]),
    ):
        with pytest.raises(geofit.errors.FitError, match="was read from a file"):
            edit()


@pytest.mark.parametrize("surface", [None, XYZ, "a.step"])
def test_only_surfaces_are_written_and_judged(surface, tmp_path):
    with pytest.raises(ArgumentError, match=r"a surface is needed, or several by name: \{'T1': surface\}"):
        geofit.write_surface(surface, tmp_path / "a.step")
    with pytest.raises(ArgumentError, match="surfaces\\['a'\\] is of type"):
        geofit.write_surface({"a": surface}, tmp_path / "a.step")
    with pytest.raises(ArgumentError, match="surface is of type"):
        geofit.judge(surface, geofit.PointSet(XYZ))
    assert not list(tmp_path.iterdir())


def test_a_list_of_surfaces_has_no_names(fit, tmp_path):
    with pytest.raises(ArgumentError, match=r"surfaces is of type list; .*by name"):
        geofit.write_surface([fit, fit], tmp_path / "a.step")


@pytest.mark.parametrize("site", ["site.toml", {"T1": XYZ}, None])
def test_a_site_is_a_site(site):
    with pytest.raises(ArgumentError, match=r"a site is needed: read_site\(path\)"):
        geofit.fit_site(site)


def test_no_horizons_are_apart():
    assert geofit.separate_horizons({}, []).surfaces == {}


def test_a_form_of_report_that_is_unknown_is_refused(fit, tmp_path):
    with pytest.raises(SettingsError, match="A report as 'docx' is unknown; choose html, pdf, json") as told:
        geofit.write_report(fit, tmp_path / "report", forms=["docx"])
    assert told.value.code == "project.report-form-unknown"
    assert not (tmp_path / "report").exists()


def test_no_film_without_frames(tmp_path):
    with pytest.raises(SettingsError, match="no frames"):
        geofit.write_film([], tmp_path / "a.gif")


def test_without_uncertainty_there_is_no_standard_deviation(fit):
    with pytest.raises(ArgumentError, match=r"uncertainty is of type None; .*examine\(surface\)"):
        geofit.prediction_sd(fit, None, XYZ)


def test_a_volume_without_rock_has_no_contacts():
    volume = geofit.RockVolume(np.zeros((5, 5, 5), np.uint8), pore=0, voxel=1.0)
    with pytest.raises(geofit.GeofitError) as told:
        geofit.pore_surface(volume)
    assert told.value.code == "pores.no-rock"
    assert geofit.pore_surface(volume, construction="blend").triangulate(0.5).volume > 0
