"""The patch of a core, whose knots end at its edges."""

from __future__ import annotations

import numpy as np
import pytest
from truth import paper_arrangement

import geofit
from geofit.splines.refined import RefinedSpace

ORIGIN = np.array([500_000.0, 3_100_000.0, 0.0])
SQUARE = [(500_400.0, 3_100_400.0), (500_600.0, 3_100_400.0), (500_600.0, 3_100_600.0), (500_400.0, 3_100_600.0)]


def half_in_the_square(n, seed=0):
    rng = np.random.default_rng(seed)
    plan = np.concatenate([rng.uniform(400, 600, (n // 2, 2)), rng.uniform(0, 1000, (n - n // 2, 2))])
    z = 10 * np.sin(plan[:, 0] / 150) + 5 * np.cos(plan[:, 1] / 200)
    return geofit.PointSet(np.column_stack([plan, z]) + ORIGIN)


@pytest.fixture(scope="module")
def site():
    truth = paper_arrangement(0)
    return geofit.fit_horizon(truth.points, geofit.FitSettings(), truth.boundary)


def test_neighbours_of_the_core_have_few_knots_of_their_own(site):
    patches = {patch.name: patch for patch in site.patches}
    core = patches.pop("core")
    spans = np.diff(np.unique(core.knots_v))
    for name in ("east", "west"):
        coarse = np.unique(patches[name].knots_v)
        assert len(coarse) < 0.6 * len(np.unique(core.knots_v))
        assert np.isin(coarse, core.knots_v).all()
        assert np.diff(coarse).mean() > 2 * spans.mean()
    assert core.control[..., 0].size > 0.6 * site.control_points
    assert max(seam.gap for seam in site.accuracy.seams) < 1e-9
    assert max(seam.angle for seam in site.accuracy.seams) < 1e-4


def test_no_edge_of_the_patch_is_nearer_to_the_core_s_points_than_to_the_others(site):
    plane, unit = site.model.problem.parametrization.plane, site.model.net.unit
    u0, u1, v0, v1 = np.array(site.model.net.core) * unit
    core, others = plane[site.core], plane[~site.core]
    within = (core > (u0, v0)) & (core < (u1, v1))
    assert within.all()
    facing = others[(others[:, 1] > v0) & (others[:, 1] < v1)]
    for edge, way in ((u0, -1), (u1, 1)):
        beyond = way * (facing[:, 0] - edge)
        assert 0.99 * (way * (edge - core[:, 0])).min() <= beyond[beyond > 0].min()


@pytest.mark.parametrize("place", [(600.5, 560.0), (603.0, 480.0), (608.0, 520.0), (398.0, 601.0), (500.0, 399.0)])
def test_a_point_next_to_the_core_is_met_without_moving_the_core(place):
    """In the room of its patch, or beyond its edge."""
    xyz = half_in_the_square(160).xyz.copy()
    near = xyz[:80][np.hypot(*(xyz[:80, :2] - ORIGIN[:2] - place).T).argmin()]
    xyz[-1] = (*(ORIGIN[:2] + place), near[2] + 0.6)
    surface = geofit.fit_horizon(geofit.PointSet(xyz), geofit.FitSettings(core=SQUARE))
    assert isinstance(surface.model.net.space, RefinedSpace)
    distance = np.abs(surface.distance(xyz))
    assert distance[surface.core].max() < 1e-6
    assert not surface.core[-1]
    assert distance[-1] <= surface.settings.interior_tolerance


@pytest.mark.parametrize(("n", "cap"), [(12, 120), (17, 400), (40, 400), (120, 1000)])
def test_few_control_points_suffice_for_few_points(n, cap):
    surface = geofit.fit_horizon(half_in_the_square(n), geofit.FitSettings(core=SQUARE, max_control_points=cap))
    assert surface.core.sum() >= n // 2
    assert np.abs(surface.distance(surface.points.xyz[surface.core])).max() < 1e-6
    assert surface.control_points <= cap


@pytest.mark.parametrize("cap", [16, 40, 120])
def test_too_few_control_points_for_a_core_that_was_asked_for_are_refused(cap):
    with pytest.raises(geofit.GeofitError, match="Raise max_control_points"):
        geofit.fit_horizon(half_in_the_square(120), geofit.FitSettings(core=SQUARE, max_control_points=cap))
