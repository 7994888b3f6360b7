"""Manual edits: local, exact where it must be, and with closed, tangent seams."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from refusals import refused
from truth import paper_arrangement

from geofit import FitSettings, PointSet, fit_horizon
from geofit.data.errors import ExactnessError, FitError
from geofit.fitting.edit import acted_on, support
from geofit.fitting.horizon_fit import HorizonFit


@cache
def fitted(seed: int = 3, **settings: str) -> HorizonFit:
    """A surface of nine patches: the core is the inner part of the dense sections."""
    truth = paper_arrangement(seed)
    x0, x1, y0, y1 = truth.core
    dx, dy = (x1 - x0) / 5, (y1 - y0) / 5
    core = ((x0 + dx, y0 + dy), (x1 - dx, y0 + dy), (x1 - dx, y1 - dy), (x0 + dx, y1 - dy))
    return fit_horizon(truth.points, FitSettings(core=core, **settings), boundary=truth.boundary)


def patch_of(surface: HorizonFit, name: str):
    return next(patch for patch in surface.patches if patch.name == name)


def lattice(surface: HorizonFit, count: int = 300) -> np.ndarray:
    low, high = surface.points.xyz[:, :2].min(axis=0), surface.points.xyz[:, :2].max(axis=0)
    return np.stack(np.meshgrid(*(np.linspace(a, b, count) for a, b in zip(low, high, strict=True))), axis=-1)


def free_control_point(surface: HorizonFit, name: str) -> tuple[int, int]:
    """A control point of a patch that acts on no exact point, nearest to the patch's corner (0, 0)."""
    rows, columns, _ = patch_of(surface, name).control.shape
    for i, j in sorted(np.ndindex(rows, columns), key=sum):
        try:
            surface.adjust(name, i, j, 0.0)
        except ExactnessError:
            continue
        return i, j
    raise AssertionError("no free control point")


def worst_of_the_periphery(surface: HorizonFit) -> int:
    """The point farthest from the surface of those that do not lie beside points of the core."""
    plan = surface.points.xyz[:, :2]
    away = np.linalg.norm(plan[:, None] - plan[surface.core][None], axis=2).min(axis=1) > 100
    return int(np.argmax(np.where(away, np.abs(surface.accuracy.residuals), 0)))


def assert_seams_hold(surface: HorizonFit) -> None:
    assert max(seam.gap for seam in surface.accuracy.seams) <= 1e-9
    assert max(seam.angle for seam in surface.accuracy.seams) <= 1e-6


@pytest.mark.parametrize("name", ["north", "west", "south-east"])
def test_a_control_point_moves_by_dz_and_nothing_outside_its_support(name):
    surface = fitted()
    rows, columns, _ = patch_of(surface, name).control.shape
    i, j = (rows - 1) // 2, (columns - 1) // 2
    moved = surface.adjust(name, i, j, 2.5)
    change = patch_of(moved, name).control - patch_of(surface, name).control
    assert change[i, j] == pytest.approx([0, 0, 2.5], abs=1e-9)
    xy = lattice(surface)
    before, after = (s.elevation(xy[..., 0], xy[..., 1]) for s in (surface, moved))
    u0, u1, v0, v1 = support(surface, name, i, j)
    local = surface.model.problem.parametrization.frame.plan(xy.reshape(-1, 2)).reshape(xy.shape)
    u, v = local[..., 0], local[..., 1]
    outside = (u < u0) | (u > u1) | (v < v0) | (v > v1)
    assert 0 < (~outside).mean() < 0.5
    assert np.nanmax(np.abs(after - before)[outside]) == 0.0
    assert np.nanmax(np.abs(after - before)[~outside]) > 0.5
    assert_seams_hold(moved)


@pytest.mark.parametrize("at", [(0, 0), (0, 4), (5, 3)])
def test_a_control_point_acts_on_the_points_whose_elevation_it_changes_and_no_other(at):
    # Without a study area the outermost points stand on the surface's own edge.
    x, y = (axis.ravel() for axis in np.meshgrid(np.linspace(0, 90, 7), np.linspace(0, 60, 5)))
    points = PointSet(np.column_stack([x, y, np.sin(x / 20) + 0.02 * y]))
    surface = fit_horizon(points, FitSettings(core="none"))
    (patch,) = surface.patches
    acting, held = acted_on(surface, patch.name, *at)
    moved = surface.adjust(patch.name, *at, 1.0)
    assert np.array_equal(acting, np.abs(moved.elevation(x, y) - surface.elevation(x, y)) > 1e-12)
    assert acting.any()
    assert not acting.all()
    assert not held.any()


def test_exact_points_that_a_control_point_acts_on_hold_it():
    surface = fitted()
    rows, columns, _ = patch_of(surface, "core").control.shape
    row = rows // 2
    column = next(j for j in range(3, columns) if acted_on(surface, "core", row, j)[1].any())
    acting, held = acted_on(surface, "core", row, column)
    assert np.array_equal(held, acting & surface.core)
    with refused(ExactnessError, "fitting.control-point-moves-exact-points", count=held.sum()):
        surface.adjust("core", row, column, 1.0)


def test_a_control_point_beside_a_seam_moves_both_patches_and_the_seam_stays_tangent():
    surface = fitted()
    name = "south-east"
    columns = patch_of(surface, name).control.shape[1]
    moved = surface.adjust(name, 0, columns // 2, 1.0)
    assert not np.array_equal(patch_of(moved, "south").control, patch_of(surface, "south").control)
    assert patch_of(moved, name).control[0, columns // 2, 2] - patch_of(surface, name).control[
        0, columns // 2, 2
    ] == pytest.approx(1.0)
    assert_seams_hold(moved)


def test_exact_points_are_never_lost():
    surface = fitted()
    control = patch_of(surface, "core").control[..., :2] + surface.origin[:2]
    for exact in surface.points.xyz[surface.core][::60, :2]:
        i, j = np.unravel_index(np.linalg.norm(control - exact, axis=2).argmin(), control.shape[:2])
        with refused(ExactnessError, "fitting.control-point-moves-exact-points"):
            surface.adjust("core", int(i), int(j), 0.5)


def test_the_surface_is_pulled_through_a_peripheral_point_and_the_core_stays_exact():
    surface = fitted()
    distance = np.abs(surface.accuracy.residuals)
    worst = worst_of_the_periphery(surface)
    assert distance[worst] > 1e-3
    pulled = surface.move_to(worst)
    assert abs(pulled.accuracy.residuals[worst]) < 1e-9
    assert np.abs(pulled.accuracy.residuals[surface.core]).max() <= 1e-6
    assert_seams_hold(pulled)
    half = surface.move_to(worst, share=0.5)
    assert abs(half.accuracy.residuals[worst]) == pytest.approx(distance[worst] / 2, rel=0.01)
    assert pulled.diagnostics["by_hand"] == 1
    assert pulled.accuracy.notes[-1].code == "fitting.moved-towards-note"


def test_the_surface_is_pulled_to_a_place_in_the_map_even_in_the_core():
    surface = fitted()
    x, y = surface.points.xyz[surface.core].mean(axis=0)[:2] + np.array([7.0, 11.0])
    z = float(surface.elevation(x, y)) + 0.05
    pulled = surface.move_to((x, y, z))
    assert float(pulled.elevation(x, y)) == pytest.approx(z, abs=1e-9)
    assert np.abs(pulled.accuracy.residuals[surface.core]).max() <= 1e-6
    assert_seams_hold(pulled)


def test_what_cannot_be_pulled_says_why():
    surface = fitted()
    exact = surface.points.xyz[surface.core][0] + np.array([0.0, 0.0, 3.0])
    with refused(ExactnessError, "fitting.target-near-exact-points"):
        surface.move_to(exact)
    with refused(FitError, "fitting.point-off-surface"):
        surface.move_to((0.0, 0.0, 0.0))
    with refused(FitError, "fitting.point-unknown"):
        surface.move_to(10**6)
    with refused(FitError, "fitting.value-not-finite", name="share"):
        surface.move_to(0, share=float("nan"))
    with refused(FitError, "fitting.target-not-finite"):
        surface.move_to((1.0, 2.0))
    with refused(FitError, "fitting.patch-unknown", patch="nowhere"):
        surface.adjust("nowhere", 0, 0, 1.0)
    with refused(FitError, "fitting.control-point-unknown"):
        surface.adjust("north", 10**4, 0, 1.0)
    with refused(FitError, "fitting.no-common-control-net"):
        surface.with_(model=None).adjust("north", 0, 0, 1.0)


def test_a_weight_draws_the_surface_to_its_control_point():
    surface = fitted()
    name = "north"
    rows, columns, _ = patch_of(surface, name).control.shape
    i, j = rows // 2, columns - 4
    moved = surface.adjust(name, i, j, 10.0)
    heavy = moved.weigh(name, i, j, 5.0)
    x, y, z = patch_of(moved, name).control[i, j] + surface.origin
    light_gap, heavy_gap = abs(moved.elevation(x, y) - z), abs(heavy.elevation(x, y) - z)
    assert heavy_gap < 0.6 * light_gap
    assert_seams_hold(heavy)
    with refused(FitError, "fitting.weights-act"):
        heavy.move_to((x, y, z))
    neutral = heavy.weigh(name, i, j, 1.0)
    assert neutral.elevation(x, y) == pytest.approx(moved.elevation(x, y), abs=1e-9)
    assert float(neutral.move_to((x, y, z)).elevation(x, y)) == pytest.approx(z, abs=1e-9)


def test_weights_that_would_open_a_seam_are_refused():
    surface = fitted()
    columns = patch_of(surface, "south-east").control.shape[1]
    with refused(FitError, "fitting.control-point-on-seam"):
        surface.weigh("south-east", 0, columns // 2, 2.0)
    with refused(FitError, "fitting.weight-out-of-range"):
        surface.weigh("south-east", 5, 5, 0.0)


def test_a_core_that_is_straight_across_its_sections_keeps_to_them():
    surface = fitted(across="linear")
    middle = surface.points.xyz[surface.core].mean(axis=0)
    with refused(FitError, "fitting.core-ruled"):
        surface.move_to(middle)


def test_undoing_a_change_by_its_opposite_gives_the_surface_back():
    surface = fitted()
    i, j = free_control_point(surface, "north")
    back = surface.adjust("north", i, j, 4.0).adjust("north", i, j, -4.0)
    assert back.diagnostics["by_hand"] == 2
    for before, after in zip(surface.patches, back.patches, strict=True):
        np.testing.assert_allclose(after.control, before.control, atol=1e-9)


def test_a_changed_surface_is_stitched_and_its_file_reads_back(tmp_path):
    surface = fitted()
    worst = worst_of_the_periphery(surface)
    rows, columns, _ = patch_of(surface, "north").control.shape
    changed = surface.move_to(worst).weigh("north", rows // 2, columns - 4, 3.0)
    assert changed.write_step(tmp_path / "changed.step").passed
