from __future__ import annotations

import numpy as np
import pytest
from truth import folded, paper_arrangement

from geofit import FitSettings, fit_horizon
from geofit.data.messages import message
from geofit.fitting.density import split_auto
from geofit.fitting.split import split_all, split_none, split_rectangle

AREA = (0.0, 2000.0, 0.0, 2000.0)
DRAWN = message("fitting.core-polygon-drawn", "the core's polygon as drawn")


def uniform(n, area=AREA, seed=0):
    return np.random.default_rng(seed).uniform((area[0], area[2]), (area[1], area[3]), (n, 2))


def box(plane):
    (u0, v0), (u1, v1) = plane.min(axis=0), plane.max(axis=0)
    return (u0, u1, v0, v1)


def within(plane, core, edge=1e-6):
    u, v = plane.T
    return (u >= core[0] - edge) & (u <= core[1] + edge) & (v >= core[2] - edge) & (v <= core[3] + edge)


@pytest.mark.parametrize("seed", range(10))
def test_the_papers_arrangement_is_found(seed):
    truth = paper_arrangement(seed)
    plane = truth.points.xyz[:, :2] - (truth.area[0], truth.area[2])
    split = split_auto(plane, AREA)
    # The sections' own points, and no peripheral one; from one edge of the area to the other.
    np.testing.assert_array_equal(split.inside, truth.points.section != "")
    np.testing.assert_allclose(split.core, (700, 1300, 0, 2000), atol=1e-6)
    assert split.reason.code == "fitting.dense-points-fill-core"
    assert (split.reason.params["count"], split.reason.params["others"]) == (440, 157)


@pytest.mark.parametrize("size", [(500, 900), (400, 400), (900, 300)])
@pytest.mark.parametrize("seed", range(3))
def test_a_core_inside_on_all_four_sides_is_found(size, seed):
    core = (700.0, 700.0 + size[0], 600.0, 600.0 + size[1])
    dense = uniform(400, core, seed)
    sparse = uniform(150, AREA, 50 + seed)
    sparse = sparse[~within(sparse, core, 40.0)]
    plane = np.concatenate([dense, sparse])
    split = split_auto(plane, AREA)
    assert split.core is not None, split.reason
    np.testing.assert_allclose(split.core, core, atol=0.12 * min(size))
    assert split.inside[:400].mean() > 0.9
    assert split.inside[400:].mean() < 0.1


@pytest.mark.parametrize("n", [40, 100, 600, 3000])
@pytest.mark.parametrize("seed", range(5))
def test_a_uniform_cloud_has_no_core(n, seed):
    split = split_auto(uniform(n, seed=seed), AREA)
    assert split.core is None
    assert not split.inside.any()
    assert split.reason.code == "fitting.no-dense-core"


def bent(n, seed):
    """Evenly scattered places on two legs of an area, whose other corner is empty."""
    plane = uniform(6 * n, seed=seed)
    return plane[(plane < 500).any(axis=1)][:n]


@pytest.mark.parametrize("n", [120, 250, 600])
@pytest.mark.parametrize("seed", range(8))
def test_an_empty_corner_makes_no_core_of_the_rest(n, seed):
    split = split_auto(bent(n, seed), AREA)
    assert split.core is None, split.reason


@pytest.mark.parametrize("seed", range(4))
def test_a_core_in_a_bent_area_is_found(seed):
    core = (100.0, 400.0, 900.0, 1400.0)
    plane = np.concatenate([uniform(300, core, seed), bent(150, 50 + seed)])
    split = split_auto(plane, AREA)
    assert split.core is not None, split.reason
    np.testing.assert_allclose(split.core, core, atol=120)


def test_a_regular_grid_has_no_core():
    grid = np.stack(np.meshgrid(np.arange(20.0), np.arange(30.0)), axis=-1).reshape(-1, 2)
    assert split_auto(grid, box(grid)).core is None


def with_a_line(angle):
    along, a = np.linspace(-800, 800, 260), np.radians(angle)
    line = 1000 + np.column_stack([along * np.cos(a), along * np.sin(a)])
    return np.concatenate([line, uniform(150)])


@pytest.mark.parametrize("angle", [0, 90])
def test_one_dense_line_makes_no_core_and_the_reason_says_so(angle):
    split = split_auto(with_a_line(angle), AREA)
    assert split.core is None
    assert split.reason.code == "fitting.dense-points-on-line"


@pytest.mark.parametrize("angle", [10, 20, 35, 45, 80])
def test_one_dense_line_across_the_axes_makes_no_core_either(angle):
    assert split_auto(with_a_line(angle), AREA).core is None


@pytest.mark.parametrize("n", [0, 1, 3, 39])
def test_few_points_have_no_core(n):
    split = split_auto(uniform(n), AREA)
    assert split.core is None
    assert split.reason.code == "fitting.too-few-points-for-core"
    assert len(split.inside) == n


def test_more_points_than_can_be_interpolated_are_approximated_and_told():
    dense = uniform(6000, (700, 1300, 700, 1300))
    split = split_auto(np.concatenate([dense, uniform(400)]), AREA)
    assert split.core is None
    assert split.reason.code == "fitting.dense-points-too-many"
    assert split.reason.severity == "warning"


def test_points_all_at_few_places_do_not_crash():
    plane = np.repeat(uniform(4), 15, axis=0)
    split = split_auto(plane, AREA)
    assert len(split.inside) == 60


@pytest.mark.parametrize("seed", range(60))
def test_any_cloud_gives_a_split_that_tells_the_truth(seed):
    rng = np.random.default_rng(seed)
    parts = []
    for _ in range(rng.integers(1, 5)):
        centre, size = rng.uniform(0, 2000, 2), 10.0 ** rng.uniform(-1, 3.3, 2)
        parts.append(centre + rng.uniform(-0.5, 0.5, (rng.integers(1, 200), 2)) * size)
    plane = np.concatenate(parts)
    if seed % 3 == 0:
        plane = np.unique(np.round(plane, -1), axis=0)
    area = box(plane)
    split = split_auto(plane, area)
    assert split.reason
    if split.core is None:
        assert not split.inside.any()
        return
    core = split.core
    np.testing.assert_array_equal(split.inside, within(plane, core))
    assert split.inside.any()
    assert not split.inside.all()
    assert area[0] <= core[0] < core[1] <= area[1]
    assert area[2] <= core[2] < core[3] <= area[3]


def test_a_drawn_rectangle_is_taken_as_it_is():
    plane = uniform(400)
    core = (600.0, 1200.0, 500.0, 1500.0)
    split = split_rectangle(plane, core, AREA, DRAWN)
    assert split.core == core
    np.testing.assert_array_equal(split.inside, within(plane, core))
    assert split.reason.code == "fitting.points-inside-outside"
    assert split.reason.params["reason"] == DRAWN
    assert split.reason.params["within"] == split.inside.sum()


def test_a_drawn_side_next_to_the_areas_edge_moves_there():
    truth = paper_arrangement(0)
    plane = truth.points.xyz[:, :2] - (truth.area[0], truth.area[2])
    split = split_rectangle(plane, (690.0, 1310.0, 1.0, 1999.0), AREA, DRAWN)
    assert split.core == (690.0, 1310.0, 0.0, 2000.0)
    assert split.inside.sum() == 440


def test_a_drawn_rectangle_without_points_or_with_all_of_them_degenerates():
    plane = uniform(50, (0, 500, 0, 500))
    empty = split_rectangle(plane, (1500.0, 1900.0, 1500.0, 1900.0), AREA, DRAWN)
    assert empty.core is None
    assert empty.reason.code == "fitting.no-point-inside"
    full = split_rectangle(plane, (0.0, 600.0, 0.0, 600.0), AREA, DRAWN)
    assert full.core == AREA
    assert full.inside.all()


def test_all_and_none_are_what_they_say():
    plane = uniform(20)
    assert split_all(plane, AREA, "x").inside.all()
    assert split_all(plane, AREA, "x").core == AREA
    assert split_none(plane, "x").core is None
    assert not split_none(plane, "x").inside.any()


def test_a_box_drawn_in_to_one_section_is_no_core():
    # Of the dense cluster two points lie beside its one section; the box's edge comes in past them.
    rng = np.random.default_rng(0)
    section = np.column_stack([np.sort(rng.uniform(0, 360, 22)), np.full(22, 400.0)])
    beside = np.array([[30.0, 460.0], [330.0, 481.0]])
    split = split_auto(np.concatenate([section, beside, uniform(25, seed=1)]), AREA)
    assert split.core is None
    assert "one section makes no core" in str(split.reason)


def test_sections_of_unequal_distances_make_one_core():
    """Three sections near to each other are the densest part, but a line; the others belong to the core too."""
    rng = np.random.default_rng(3)
    lines = [700, 760, 900, 1010, 1130, 1150, 1170, 1300]
    sections = np.concatenate(
        [np.column_stack([np.full(40, x), np.sort(rng.uniform(0, 2000, 40))]) for x in map(float, lines)]
    )
    side = np.where(rng.uniform(size=120) < 0.5, 0.0, 1360.0)
    plane = np.concatenate([sections, np.column_stack([side + rng.uniform(0, 640, 120), rng.uniform(0, 2000, 120)])])
    drawn = np.arange(len(plane)) < len(sections)
    assert split_auto(plane, AREA).reason.code == "fitting.dense-points-on-line"
    split = split_auto(plane, AREA, drawn)
    assert split.core is not None
    np.testing.assert_array_equal(split.inside, drawn)


@pytest.mark.parametrize("extra", [{}, {"max_control_points": 16}])
def test_a_fold_without_a_core_is_met_where_it_can_be_and_says_so(extra):
    """With sixteen control points no surface passes through the curves: then all points are approximated, as asked."""
    surface = fit_horizon(folded(seed=2), FitSettings(core="none", **extra))
    reason = surface.partition.reason
    if extra:
        assert not surface.core.any()
        reason = reason.params["reason"]
    else:
        assert surface.core.all()
    assert reason.code == "fitting.fold-always-met"
    assert surface.partition.reason.severity == "warning"
