"""Folds and steep surfaces end at the study area, as height fields over the map do."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from refusals import with_code
from truth import EASTING, NORTHING, folded

from geofit.cad.read_back import self_intersects
from geofit.cad.sewing import shell
from geofit.cad.step import read_step, write_step
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.site import Site
from geofit.data.verdict import verdict_of
from geofit.fitting.edit import adjust
from geofit.fitting.judge import judge
from geofit.fitting.pipeline import fit_horizon
from geofit.prediction.examine import examine
from geofit.site.fit_site import fit_site
from geofit.streaming.fit import fit_cloud


def steep(lean=0.2, n=150):
    """A fault along the easting, wavy across it and leaning to the north; upright for a lean of 0."""
    along, z = np.random.default_rng(2).uniform(0, [[400], [200]], (2, n))
    return PointSet(np.column_stack([along, lean * z + 5 * np.sin(along / 60), z]) + np.array((EASTING, NORTHING, 500)))


def rectangle(points, share):
    """A study area that contains all points, or those of a share of their longer extent."""
    low, high = points.xyz[:, :2].min(axis=0) - 20, points.xyz[:, :2].max(axis=0) + 20
    along = int(np.argmax(high - low))
    high[along] = low[along] + 20 + share * (high - low - 40)[along] + 20 * (share == 1)
    return np.array([low, [high[0], low[1]], high, [low[0], high[1]]])


def tight(points):
    """A study area narrower than a fold across its limbs: the fold leaves it and enters it again."""
    (x0, y0), (x1, y1) = points.xyz[:, :2].min(axis=0), points.xyz[:, :2].max(axis=0)
    x = x0 + (x1 - x0) * np.array([0.3, 0.7])
    return np.array([[x[0], y0 - 5], [x[1], y0 - 5], [x[1], y1 + 5], [x[0], y1 + 5]])


def size_by_sums(surface, outline, n=500):
    """Area of what lies in an outline: small pieces of the patches counted by where their middles are."""
    total, area = 0.0, shapely.Polygon(outline)
    shapely.prepare(area)
    share = (np.arange(n) + 0.5) / n
    for patch in surface.patches:
        u0, u1, v0, v1 = patch.domain
        u, v = u0 + share[:, None] * (u1 - u0), v0 + share[None] * (v1 - v0)
        x, y, _ = np.moveaxis(patch.evaluate(u, v) + surface.origin, -1, 0)
        piece = np.linalg.norm(np.cross(patch.evaluate(u, v, 1, 0), patch.evaluate(u, v, 0, 1)), axis=-1)
        total += float(piece[shapely.contains_xy(area, x, y)].sum()) * (u1 - u0) * (v1 - v0) / n**2
    return total


def size(mesh):
    a, b, c = np.moveaxis(mesh.points[mesh.triangles], 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2


def size_of_faces(shape):
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, found, 1e-6)
    return found.Mass()


@pytest.mark.parametrize(
    ("points", "frame", "area"),
    [
        (folded(), "sections", rectangle(folded(), 0.5)),
        (folded(azimuth=0.6), "sections", tight(folded(azimuth=0.6))),
        (steep(), "best-plane", rectangle(steep(), 0.5)),
        (steep(0), "best-plane", rectangle(steep(0), 0.5)),
    ],
    ids=["fold", "fold, turned", "steep", "upright"],
)
def test_the_surface_and_its_file_end_at_the_area(points, frame, area, tmp_path):
    surface = fit_horizon(points, FitSettings(frame=frame), area)
    assert surface.frame == frame
    mesh, wanted = surface.triangulate(0.01), size_by_sums(surface, area)
    assert size(mesh) == pytest.approx(wanted, rel=2e-3)
    assert wanted < 0.9 * size_by_sums(surface, rectangle(points, 1))
    assert shapely.dwithin(shapely.Polygon(area), shapely.points(mesh.xyz[:, :2]), 1e-6).all()

    back = write_step({"F": surface}, tmp_path / "f.step")["F"]
    assert [check.name for check in back.checks if check.passed is False] == []
    assert back.sigma == pytest.approx(surface.accuracy.sigma, abs=1e-9)
    assert size_of_faces(shell(surface)) == pytest.approx(wanted, rel=1e-3)
    read = read_step(tmp_path / "f.step")["F"]
    assert size(read.triangulate(0.01)) == pytest.approx(wanted, rel=2e-3)
    judged = judge(read, points).accuracy
    assert judged.sigma == pytest.approx(surface.accuracy.sigma, abs=1e-9)
    assert [check.name for check in judged.checks if check.passed is False] == []


def test_a_fold_that_leaves_the_area_and_enters_it_again_is_several_shells(tmp_path):
    points = folded()
    surface = fit_horizon(points, FitSettings(frame="sections"), tight(points))
    sewn = surface.to_cadquery()
    assert len(sewn.Shells()) == 3
    assert sewn.isValid()
    assert not self_intersects(sewn.wrapped)
    back = write_step({"F": surface}, tmp_path / "f.step")["F"]
    assert back.faces >= 3
    assert [check.name for check in back.checks if check.passed is False] == []
    read = read_step(tmp_path / "f.step")["F"]
    assert [patch.name for patch in read.patches] == [patch.name for patch in surface.patches]
    assert size(read.triangulate(0.01)) == pytest.approx(size(surface.triangulate(0.01)), rel=1e-6)


def test_points_outside_are_a_warning_and_the_area_check_asks_for_no_cover():
    points = folded()
    site = Site("S", {"F": points}, boundary=rectangle(points, 0.5))
    accuracy = fit_site(site).surfaces["F"].accuracy
    note = with_code(accuracy.notes, "fitting.points-beyond-study-area")
    assert note.severity == "warning"
    outside = (points.xyz[:, :2] > site.boundary.max(axis=0)).any(axis=1)
    assert note.params["count"] == outside.sum() > 0
    assert "area" not in {check.name for check in accuracy.checks}


@pytest.mark.parametrize("points", [folded(), steep()], ids=["fold", "steep"])
def test_a_surface_within_the_area_is_the_same_as_without(points):
    free, ended = fit_horizon(points), fit_horizon(points, boundary=rectangle(points, 1.0))
    assert np.array_equal(free.patches[0].control, ended.patches[0].control)
    assert verdict_of(ended.accuracy).word == "PASS"
    assert np.array_equal(free.triangulate().points, ended.triangulate().points)


@pytest.mark.parametrize("points", [folded(), steep()], ids=["fold", "steep"])
def test_bands_and_suggested_holes_end_at_the_area(points):
    area = rectangle(points, 0.5)
    found = examine(fit_horizon(points, boundary=area))
    holes = np.array([(hole.x, hole.y) for hole in found.suggestions])
    assert len(holes)
    assert shapely.dwithin(shapely.Polygon(area), shapely.points(holes), 1e-6).all()
    whole = examine(fit_horizon(points)).uncertainty.sd
    ended = found.uncertainty.sd
    assert 0.3 * np.isfinite(whole).sum() < np.isfinite(ended).sum() < 0.7 * np.isfinite(whole).sum()


@pytest.mark.parametrize("points", [folded(), steep()], ids=["fold", "steep"])
def test_an_area_with_hardly_a_point_does_not_end_the_surface(points):
    aside = rectangle(points, 1.0) + (points.xyz[:, 0].max() - points.xyz[:, 0].min() + 30.0) * np.array([1, 0])
    surface = fit_horizon(points, boundary=aside)
    assert surface.outline is None
    note = with_code(surface.accuracy.notes, "fitting.study-area-not-applied")
    assert (note.severity, note.params["count"]) == ("warning", len(points))


def test_a_cloud_over_its_best_plane_ends_at_the_area():
    points = steep(n=3000)
    area = rectangle(points, 0.5)
    surface = fit_cloud(points.xyz, FitSettings(), area).surface
    assert surface.frame == "best-plane"
    assert size(surface.triangulate(0.01)) == pytest.approx(size_by_sums(surface, area), rel=2e-3)
    assert fit_cloud(points.xyz, FitSettings(), area + np.array([1000, 0])).surface.outline is None


def test_a_manual_edit_keeps_the_end():
    points = steep()
    area = rectangle(points, 0.5)
    surface = fit_horizon(points, FitSettings(core="none"), area)
    moved = adjust(surface, surface.patches[0].name, 3, 3, 0.05)
    assert np.array_equal(moved.outline, area)
