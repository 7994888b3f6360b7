"""The figures that a fit must reach (METHOD, sections 4 to 7), on known truths and on the sample site."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from truth import paper_arrangement, rms, thin_plate

import geofit
from geofit import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.sample import horizon_truth
from geofit.sample.truth import HORIZONS

SITE = Path(__file__).parents[2] / "sample_data" / "site.toml"
SEEDS = range(12)


@cache
def sample_site() -> geofit.Site:
    return geofit.io.read_site(SITE)


@cache
def sample_surface(name: str) -> HorizonFit:
    site = sample_site()
    return geofit.fit_horizon(site.horizons[name], site.settings[name], boundary=site.boundary, name=name)


@cache
def seeded_surface(seed: int, **settings: str) -> HorizonFit:
    truth = paper_arrangement(seed)
    return geofit.fit_horizon(truth.points, FitSettings(**settings), boundary=truth.boundary)


def failed(surface: HorizonFit) -> list[str]:
    return [check.text for check in surface.accuracy.checks if check.passed is False]


def test_error_off_the_data_is_below_the_thin_plate_s():
    """Core <= 1.2 x and whole <= 0.9 x the exact thin-plate spline's error, medians; worst 1.4 x and 1.1 x."""
    ratios = []
    for seed in SEEDS:
        truth, surface = paper_arrangement(seed), seeded_surface(seed)
        spline = thin_plate(truth.points)
        row = []
        for core in (True, False):
            x, y = truth.places(10_000, core=core).T
            height = truth.height(x, y)
            row.append(rms(surface.elevation(x, y) - height) / rms(spline(x, y) - height))
        ratios.append(row)
    core, whole = np.array(ratios).T
    assert np.median(core) <= 0.8  # 0.66 measured; 1.2 is asked for
    assert core.max() <= 1.0
    assert np.median(whole) <= 0.9
    assert whole.max() <= 1.1


@pytest.mark.parametrize("seed", SEEDS)
def test_every_check_of_the_paper_s_arrangement_holds(seed):
    surface = seeded_surface(seed)
    accuracy = surface.accuracy
    assert [patch.name for patch in surface.patches] == ["core", "west", "east"]
    assert accuracy.passed
    # Two holes of site 5 are 3 m apart, and differ by 0.14 m.
    assert len(failed(surface)) <= 2 * (seed == 5)
    assert np.abs(accuracy.residuals[surface.core]).max() < 1e-9
    assert accuracy.sigma <= 0.17
    assert surface.control_points <= 15 * accuracy.n


@pytest.mark.parametrize("core", [True, False])
def test_sample_horizons_off_the_data(core):
    """Core <= 1.2 x and whole <= 0.9 x the thin plate's error, medians; worst 1.4 x and 1.1 x."""
    ratios = []
    for name in ("T3-T2", "T2-T1", "W"):
        truth, surface, points = horizon_truth(name), sample_surface(name), sample_site().horizons[name]
        spline = thin_plate(points)
        x, y, height = truth.places(10_000, core=core).T
        error = surface.elevation(x, y) - height
        assert not np.isnan(error).any()
        ratios.append(rms(error) / rms(spline(x, y) - height))
    # Measured: core 0.35 to 0.67, whole 0.71 to 0.93.
    assert np.median(ratios) <= (1.2 if core else 0.9)
    assert max(ratios) <= (1.4 if core else 1.1)


def test_the_597_point_horizon():
    surface = sample_surface("T2-T1")
    assert surface.accuracy.n == 597
    assert surface.settings.epsilon == 0.5
    assert surface.accuracy.sigma <= 0.17
    assert surface.control_points <= 15 * 597
    assert surface.core.sum() > 400


@pytest.mark.parametrize("name", HORIZONS)
def test_sample_horizon_passes_every_check(name):
    surface = sample_surface(name)
    assert surface.accuracy.passed
    assert failed(surface) == []


@pytest.mark.parametrize("name", HORIZONS)
def test_step_file_read_back(name, tmp_path):
    """Core within 1e-6 m, seams closed and tangent, one valid shell, measured in the file at map coordinates."""
    surface = sample_surface(name)
    back = surface.write_step(tmp_path / "horizon.step")
    assert surface.origin[1] > 3.0e6
    assert back.passed, [check.text for check in back.checks if check.passed is False]
    assert back.core_max_abs <= 1e-6
    assert all(seam.gap <= 1e-6 and seam.angle <= 0.1 for seam in back.seams)
    assert len(back.seams) == len(surface.accuracy.seams)
    assert back.brep_valid
    assert back.free_edges == back.outline_edges
    assert not back.self_intersects
    assert back.sigma == pytest.approx(surface.accuracy.sigma, abs=1e-6)


def test_the_fault_is_fitted_over_its_best_plane():
    surface = sample_surface("F1")
    assert surface.diagnostics["frame"] == "best-plane"
    distance = surface.distance(horizon_truth("F1").places(5_000))
    # Places beyond the outermost points count too; the surface ends there.
    assert np.percentile(np.abs(distance), 95) < 0.3


def test_the_overturned_fold_is_lofted_through_its_sections():
    surface = sample_surface("M1")
    assert surface.diagnostics["frame"] == "sections"
    assert surface.core.all()
    assert np.abs(surface.accuracy.residuals).max() < 1e-9
    distance = surface.distance(horizon_truth("M1").places(5_000))
    assert np.percentile(np.abs(distance), 90) < 0.5


def test_fold_stands_over_one_place_more_than_once():
    surface = sample_surface("M1")
    patch = surface.patches[0]
    u0, u1, v0, v1 = patch.domain
    u, v = np.meshgrid(np.linspace(u0, u1, 30), np.linspace(v0, v1, 60), indexing="ij")
    upward = patch.normal(u, v)[..., 2]
    assert (upward > 0.1).any()
    assert (upward < -0.1).any()


@pytest.mark.parametrize("settings", [{"seam": "position"}, {"across": "linear"}, {"core": "none"}, {"core": "all"}])
def test_other_ways_of_fitting_keep_their_promises(settings):
    surface = seeded_surface(0, **settings)
    accuracy = surface.accuracy
    assert accuracy.passed
    assert failed(surface) == []
    if settings.get("core") == "none":
        assert not surface.core.any()
        assert [patch.name for patch in surface.patches] == ["periphery"]
    else:
        assert np.abs(accuracy.residuals[surface.core]).max() < 1e-9
    if settings.get("core") == "all":
        assert surface.core.all()
    if settings.get("across") == "linear":
        core = surface.patches[0]
        assert core.degree == (1, 3)
    if settings.get("seam") == "position":
        assert max(seam.angle for seam in accuracy.seams) > 0.1
        assert max(seam.gap for seam in accuracy.seams) < 1e-9


def test_a_core_drawn_by_hand_has_patches_on_all_sides():
    truth = paper_arrangement(1)
    x0, x1, y0, y1 = truth.core
    corners = ((x0 + 60, y0 + 400), (x1 - 60, y0 + 400), (x1 - 60, y1 - 400), (x0 + 60, y1 - 400))
    surface = geofit.fit_horizon(truth.points, FitSettings(core=corners), boundary=truth.boundary)
    names = {patch.name for patch in surface.patches}
    assert names == {
        "core", "west", "east", "south", "north", "south-west", "south-east", "north-west", "north-east",
    }  # fmt: skip
    assert failed(surface) == []
    x, y = truth.points.xyz[:, :2].T
    drawn = (x >= x0 + 60 - 1e-6) & (x <= x1 - 60 + 1e-6) & (y >= y0 + 400) & (y <= y1 - 400)
    assert (surface.core == drawn).all()
