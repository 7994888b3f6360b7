"""A control point on the move: the figures at every step are those that the edit itself would have."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from truth import EASTING, NORTHING, folded, hills

import geofit
from geofit.data.errors import ExactnessError, FitError
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.fitting.edit import acted_on, adjust, movable, weigh
from geofit.fitting.pipeline import fit_horizon
from geofit.fitting.preview import preview_move
from geofit.io.site_file import read_site

SITE = Path(__file__).parents[2] / "sample_data" / "site.toml"
MOVES = (-40.0, -0.7, 0.0, 0.013, 2.5, 90.0)


def scattered(seed, n=300, noise=0.15):
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, 2000, (n, 2)) + np.array([EASTING, NORTHING])
    return PointSet(np.column_stack([xy, hills(seed)(*xy.T) + rng.normal(0, noise, n)]))


def movable_points(surface, count, seed=0):
    """Return control points that can move, of any patch, those near data points first."""
    rng, found = np.random.default_rng(seed), []
    near = surface.points.xyz[rng.permutation(len(surface.points))] - surface.origin
    for place in near:
        for patch in surface.patches:
            away = np.linalg.norm(patch.control - place, axis=2)
            i, j = np.unravel_index(int(away.argmin()), away.shape)
            try:
                movable(surface, patch.name, int(i), int(j))
            except (ExactnessError, FitError):
                continue
            if (patch.name, int(i), int(j)) not in found:
                found.append((patch.name, int(i), int(j)))
        if len(found) >= count:
            return found[:count]
    return found


@cache
def sample_fit(name):
    site = read_site(SITE)
    return geofit.fit_horizon(site.horizons[name], site.settings[name], boundary=site.boundary, name=name)


def agrees(surface, control, dz, aside=(0.0, 0.0, 0.0)):
    effect = preview_move(surface, *control).effect(dz, aside)
    after = adjust(surface, *control, dz, aside).accuracy
    np.testing.assert_allclose(effect.residuals, after.residuals, atol=1e-8)
    assert effect.sigma == pytest.approx(after.sigma, abs=1e-9)
    assert effect.max_abs == pytest.approx(after.max_abs, abs=1e-8)
    assert effect.beyond == after.over["epsilon"].count
    return effect.changed


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_figures_are_those_of_the_edit(seed):
    surface = fit_horizon(scattered(seed), FitSettings(core="none"))
    changed = [agrees(surface, control, dz) for control in movable_points(surface, 3, seed) for dz in MOVES]
    assert sum(n > 0 for n in changed) >= 8


@pytest.mark.parametrize("name", ["T3-T2", "F1"])
def test_they_are_with_a_core_and_on_a_steep_fault(name):
    surface = sample_fit(name)
    controls = movable_points(surface, 4)
    assert len(controls) == 4
    for control in controls:
        for dz in (-3.0, 0.4, 20.0):
            agrees(surface, control, dz)


def test_they_are_next_to_weights():
    surface = fit_horizon(scattered(5, n=120), FitSettings(core="none"))
    control = movable_points(surface, 1)[0]
    agrees(weigh(surface, *control, 3.0), control, 1.5)


def test_they_are_on_a_fold():
    surface = fit_horizon(folded(seed=1), FitSettings(frame="sections"))
    free = [(i, j) for i, j in np.ndindex(surface.patches[0].control.shape[:2]) if is_free(surface, i, j)]
    assert len(free) > 10
    for i, j in free[:: len(free) // 3]:
        agrees(surface, (surface.patches[0].name, i, j), 1.5)


def is_free(surface, i, j):
    try:
        return movable(surface, surface.patches[0].name, i, j)[1] > 0
    except ExactnessError:
        return False


def test_only_the_support_moves_and_the_way_is_the_heights():
    surface = fit_horizon(scattered(7), FitSettings(core="none"))
    control = movable_points(surface, 1)[0]
    preview = preview_move(surface, *control)
    u0, u1, v0, v1 = preview.support
    rng = np.random.default_rng(0)
    x, y = rng.uniform(-150, 150, (2, 4000)) + preview.place[:2, None]
    inside = np.isfinite(surface.elevation(x, y))
    places = np.column_stack([x, y, surface.elevation(x, y)])[inside]
    shares, plane = preview.shares(places), preview.parameters(places)
    moved = adjust(surface, *control, 2.0).elevation(*places[:, :2].T) - places[:, 2]
    np.testing.assert_allclose(2.0 * shares, moved, atol=1e-9)
    outside = (plane[:, 0] < u0) | (plane[:, 0] > u1) | (plane[:, 1] < v0) | (plane[:, 1] > v1)
    assert outside.any()
    assert not shares[outside].any()
    assert (shares[~outside] > 0).mean() > 0.95
    assert preview.way.tolist() == [0.0, 0.0, 1.0]


def test_control_points_and_the_rim_move_as_the_edited_ones():
    surface = sample_fit("T3-T2")
    for control in movable_points(surface, 4):
        preview, after = preview_move(surface, *control), adjust(surface, *control, 2.0)
        for old, new, share in zip(surface.patches, after.patches, preview.control_shares(), strict=True):
            np.testing.assert_allclose(new.control - old.control, 2.0 * share[..., None] * preview.way, atol=1e-9)
        rim = preview.rim(2.0)
        np.testing.assert_allclose(rim[0], rim[-1])
        np.testing.assert_allclose(after.distance(rim), 0.0, atol=1e-6)


def test_a_control_point_that_cannot_move_says_why():
    surface = sample_fit("T3-T2")
    i, columns = surface.patches[0].control.shape[0] // 2, surface.patches[0].control.shape[1]
    j = next(j for j in range(columns) if acted_on(surface, "core", i, j)[1].any())
    with pytest.raises(ExactnessError) as refused:
        preview_move(surface, "core", i, j)
    with pytest.raises(ExactnessError) as edited:
        adjust(surface, "core", i, j, 1.0)
    assert str(refused.value) == str(edited.value)
    with pytest.raises(FitError):
        preview_move(surface, "nowhere", 0, 0)


@pytest.mark.parametrize("seed", [4, 5])
def test_a_move_aside_has_the_figures_of_the_edit_and_moves_nothing_outside_its_support(seed):
    surface, rng = fit_horizon(scattered(seed), FitSettings(core="none")), np.random.default_rng(seed)
    for control in movable_points(surface, 3, seed):
        preview = preview_move(surface, *control)
        for size in (0.3, 8.0, 60.0):
            aside = tuple((size * rng.normal(size=3) * (1.0, 1.0, 0.1)).tolist())
            agrees(surface, control, 0.7, aside)
        after = adjust(surface, *control, 0.0, (9.0, -4.0, 0.0))
        patch, i, j = control
        place = next(one.control[i, j] for one in after.patches if one.name == patch) + after.origin
        np.testing.assert_allclose(place - preview.place, [9.0, -4.0, 0.0], atol=1e-6)
        rim = preview.rim(0.0)
        low, high = rim[:, :2].min(axis=0), rim[:, :2].max(axis=0)
        xy = rng.uniform(surface.points.xyz[:, :2].min(axis=0), surface.points.xyz[:, :2].max(axis=0), (400, 2))
        off = (xy < low - 20).any(axis=1) | (xy > high + 20).any(axis=1)
        np.testing.assert_allclose(after.elevation(*xy[off].T), surface.elevation(*xy[off].T), atol=1e-6)


@pytest.mark.parametrize("name", ["T3-T2", "F1"])
def test_a_move_aside_on_a_core_s_neighbour_and_on_a_steep_fault(name):
    surface = sample_fit(name)
    for control in movable_points(surface, 2):
        agrees(surface, control, 0.4, (2.0, 3.0, -0.5))
        agrees(surface.adjust(*control, 0.4, (2.0, 3.0, -0.5)), control, -0.2, (0.0, 1.0, 0.0))


def test_a_height_field_whose_control_point_moved_aside_is_not_pulled_to_points_there():
    surface = fit_horizon(scattered(7), FitSettings(core="none"))
    control = movable_points(surface, 1)[0]
    after = adjust(surface, *control, 0.0, (5.0, 0.0, 0.0))
    near = int(np.flatnonzero(acted_on(after, *control)[0])[0])
    with pytest.raises(FitError, match="moved sideways"):
        after.move_to(near)
    for wrong, words in (((1.0, 2.0), "has 2 values"), ((float("nan"), 0.0, 0.0), "is nan"), ("abc", "is 'a'")):
        with pytest.raises(FitError, match=words):
            adjust(surface, *control, 0.2, wrong)
    far = int(np.linalg.norm(after.points.xyz - after.points.xyz[near], axis=1).argmax())
    assert abs(after.move_to(far).accuracy.residuals[far]) < 1e-6
