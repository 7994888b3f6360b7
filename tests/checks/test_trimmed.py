"""What lies beyond the loops of a file's faces is not part of the surface: no check asks it, none misses what is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from surfaces import ORIGIN, area, bored, fold, height_field, horizon, lifted, split

from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.judge import judge
from geofit.io.surface_files import read_surfaces
from geofit.surfaces.trimmed import TrimmedSurface

#: Rings in the parameters of a patch of 1,000 by 700 m: all of it nearly, its west, a hole in the east.
ALL = np.array([[10, 10], [990, 10], [990, 690], [10, 690]], float)
WEST = np.array([[10, 10], [560, 10], [600, 350], [560, 690], [10, 690]], float)
EAST = np.array([[620, 180], [940, 180], [940, 520], [620, 520]], float)


def trimmed(patch, *loops):
    return HorizonFit(TrimmedSurface((patch,), ORIGIN, trim_loops=(loops,)))


def gentle():
    return height_field(50, 36, z=lambda x, y: 8 * np.sin(x / 150) * np.cos(y / 170))


def points_on(patch, within, n=400):
    """Points on a sound patch, nowhere nearer to its rim than the rings."""
    u, v = np.random.default_rng(1).uniform(within.min(axis=0), within.max(axis=0), (n, 2)).T
    return PointSet(patch.evaluate(u, v) + ORIGIN)


def spike(control):
    control[39, 17, 2] += 30.0


def overlap(control):
    control[39, 17, :2] += 2.5 * (control[42, 17, :2] - control[39, 17, :2])


def run_away(control):
    control[37:41, 14:20, 2] += 400.0


FAULTS = {
    spike: {"oscillation"},
    overlap: {"normals", "patches"},
    run_away: {"elevation range"},
}


def failing(surface, points):
    found = judge(surface, points, FitSettings(epsilon=1.0), "T1").accuracy
    return {one.name for one in found.checks if one.passed is False}


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("loops", [(WEST,), (ALL, EAST)], ids=["beside the face", "in a hole"])
def test_a_fault_beyond_the_loops_is_none(fault, loops):
    patch = gentle()
    control = patch.control.copy()
    fault(control)
    broken = replace(patch, control=control)
    # Points that a fault would push away from the surface lie where it is whole.
    points = points_on(patch, np.array([[20, 20], [540, 680]]))
    assert failing(trimmed(patch, ALL), points) == set()
    assert failing(trimmed(broken, *loops), points) == set()


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_within_the_loops_is_found(fault):
    patch = gentle()
    control = patch.control.copy()
    fault(control)
    broken = replace(patch, control=control)
    points = points_on(patch, ALL)
    off = np.abs(trimmed(broken, ALL).distance(points.xyz)) < 1e-9
    points = points[off]
    assert failing(trimmed(broken, ALL), points) >= FAULTS[fault]


def test_a_surface_that_leaves_the_trend_beyond_its_loops():
    patch = gentle()
    x, z = patch.control[..., 0], patch.control[..., 2]
    broken = lifted(patch, z + np.maximum(x - 620, 0) ** 2 / 1500)
    points = points_on(patch, np.array([[20, 20], [540, 680]]))
    assert failing(trimmed(broken, WEST), points) == set()
    assert "trend" in failing(trimmed(broken, ALL), points)


def test_a_crossing_beyond_the_loops():
    patch = fold()
    z = patch.control[..., 2]
    crossed = lifted(patch, np.where(z > 100, 200 - z, z))
    low = np.array([[0, 5], [0.3, 5], [0.3, 295], [0, 295]])
    points = PointSet(np.empty((0, 3)))
    assert "self-intersection" not in failing(trimmed(crossed, low), points)
    whole = np.array([[0, 5], [1, 5], [1, 295], [0, 295]])
    assert "self-intersection" in failing(trimmed(crossed, whole), points)


def test_a_collapsed_edge_beyond_the_loops():
    patch = gentle()
    control = patch.control.copy()
    control[-1] = control[-1, 0]
    broken = replace(patch, control=control)
    points = points_on(patch, np.array([[20, 20], [540, 680]]))
    assert failing(trimmed(broken, WEST), points) == set()
    touching = WEST + np.where(WEST > [500, 0], [440, 0], [0, 0])
    touching[1:4, 0] = 1000.0
    assert "patches" in failing(trimmed(broken, touching), points)


def test_a_plane_of_one_span_is_asked_inside_a_small_loop():
    """The only places of its span, ends and middle, lie outside: the loop is asked all the same."""
    plane = height_field(2, 2, degree=1, z=lambda x, y: 0.5 * x)
    small = np.array([[600, 100], [700, 100], [700, 200], [600, 200]], float)
    points = PointSet(np.column_stack([[10.0, 20, 30, 15, 5], [10.0, 60, 20, 90, 45], [0, 1, 2, 0, 1]]) + ORIGIN)
    found = judge(trimmed(plane, small), points, FitSettings(), "T1").accuracy
    (elevations,) = [one for one in found.checks if one.name == "elevation range"]
    assert elevations.value == pytest.approx(350 - 2, abs=10)


def overlapping():
    """Two faces that meet at x = 500, each on a patch of its own that reaches on, 30 m too high, over the other."""
    whole = gentle()
    x, z = whole.control[..., 0], whole.control[..., 2]
    left = lifted(whole, z + 30 * np.clip((x - 620) / 100, 0, 1), "left")
    right = lifted(whole, z + 30 * np.clip((380 - x) / 100, 0, 1), "right")
    halves = [np.array([[a, 10], [b, 10], [b, 690], [a, 690]], float) for a, b in ((10, 500), (500, 990))]
    bare = horizon([left, right], outline=ALL)
    faces = TrimmedSurface(bare.patches, ORIGIN, outline=bare.outline, trim_loops=((halves[0],), (halves[1],)))
    surface = HorizonFit(faces, bare.points)
    return whole, surface


def test_two_faces_whose_patches_overlap_are_one_sheet():
    whole, surface = overlapping()
    plan = np.random.default_rng(2).uniform([11, 11], [989, 689], (400, 2))
    height = surface.elevation(*(plan + ORIGIN[:2]).T)
    assert np.abs(height - ORIGIN[2] - whole.evaluate(*plan.T)[:, 2]).max() < 1e-9
    assert np.isnan(surface.elevation(ORIGIN[0] + 5, ORIGIN[1] + 5))
    found = judge(surface, points_on(whole, ALL), FitSettings(), "T1").accuracy
    (area,) = [one for one in found.checks if one.name == "area"]
    assert area.passed
    assert area.value < 1e-6


@pytest.mark.parametrize("cuts", [([], []), ([500.0], [350.0])], ids=["one patch", "four patches"])
def test_triangles_end_at_the_holes(cuts, tmp_path):
    truth, rim = bored(tmp_path / "a.brep", split(height_field(21, 17), *cuts))
    (surface,) = read_surfaces(tmp_path / "a.brep").values()
    assert isinstance(surface, TrimmedSurface)
    mesh = surface.triangulate(0.1)
    assert area(mesh.points[mesh.triangles]) == pytest.approx(truth, rel=1e-4)
    assert np.abs(surface.distance(mesh.xyz)).max() < 1e-9
    t = mesh.triangles
    ends = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1)
    ends, count = np.unique(ends, axis=0, return_counts=True)
    assert count.max() == 2
    # Free edges are the rim alone: seams that the holes cut are still closed.
    free = mesh.points[ends[count == 1], :2]
    assert np.linalg.norm(free[:, 1] - free[:, 0], axis=1).sum() == pytest.approx(rim, rel=1e-4)
    # Places on the triangles are on the face, not over a hole.
    middles = mesh.points[t].mean(axis=1)
    assert np.hypot(*(middles[:, :2] - [500, 350]).T).min() > 119.9
