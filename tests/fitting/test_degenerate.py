"""fit_horizon end to end on inputs that hold little, too much, or strange things."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused, with_code
from truth import EASTING, NORTHING, hills, paper_arrangement, rms

from geofit import FitSettings, PointSet, fit_horizon
from geofit.data.errors import FitError, PointsError
from geofit.fitting.parametrize import parametrize

ALL, NONE = FitSettings(core="all"), FitSettings(core="none")
CORES = pytest.mark.parametrize("settings", [FitSettings(), ALL, NONE], ids=["auto", "all", "none"])


def plan(n, seed=0, size=1000.0):
    return np.random.default_rng(seed).uniform(0, size, (n, 2)) + np.array((EASTING, NORTHING))


def cloud(n, seed=0, size=1000.0, noise=0.0):
    xy = plan(n, seed, size)
    z = hills(3, shortest=600.0)(*xy.T) + np.random.default_rng(seed + 1).normal(0, noise, n)
    return np.column_stack([xy, z])


def sections(lines, n=20, length=1000.0):
    xyz, names = [], []
    for i, x in enumerate(lines):
        y = NORTHING + np.linspace(0, length, n)
        x = np.full(n, EASTING + x)
        xyz.append(np.column_stack([x, y, hills(3, shortest=600.0)(x, y)]))
        names += [f"S{i}"] * n
    return PointSet(np.concatenate(xyz), section=names, kind="section")


def calm(surface, beyond=0.5, known=()):
    """Nothing folded, open, or far out of the data's range; the checks that fail are ``known``."""
    accuracy = surface.accuracy
    assert np.isfinite(accuracy.residuals).all()
    for patch in surface.patches:
        assert np.isfinite(patch.control).all()
        z = patch.control[..., 2] + surface.origin[2]
        data = surface.points.xyz[:, 2]
        margin = beyond * np.ptp(data) + 5.0
        assert z.min() > data.min() - margin
        assert z.max() < data.max() + margin
    failed = [c.name for c in accuracy.checks if c.passed is False and c.name != "interior tolerance"]
    assert failed == list(known)


@pytest.mark.parametrize("n", [0, 1, 2])
def test_too_few_points_say_how_many_are_needed(n):
    with refused(PointsError, "fitting.too-few-points") as caught:
        fit_horizon(PointSet(cloud(n)))
    assert caught.value.message.params["given"].params["count"] == n


def test_points_all_at_one_place_are_refused():
    with refused(PointsError, "fitting.points-at-one-location", count=4):
        fit_horizon(PointSet(np.tile([[EASTING, NORTHING, 5.0]], (4, 1))))


@pytest.mark.parametrize("n", [3, 4, 5, 7, 10, 15, 16, 20, 41])
@CORES
def test_few_points_take_a_lower_degree(n, settings):
    surface = fit_horizon(PointSet(cloud(n)), settings)
    assert surface.patches[0].degree == ((3, 3) if n >= 16 else (2, 2) if n >= 6 else (1, 1))
    assert surface.accuracy.passed
    calm(surface, beyond=1.0)
    if settings.core == "all":
        assert surface.accuracy.max_abs < 1e-6
        assert surface.patches[0].name == "core"


@pytest.mark.parametrize("n", [3, 4, 7, 20, 41])
@CORES
def test_a_plane_is_met_exactly(n, settings):
    xy = plan(n)
    z = 700 + 0.2 * (xy[:, 0] - EASTING) - 0.1 * (xy[:, 1] - NORTHING)
    surface = fit_horizon(PointSet(np.column_stack([xy, z])), settings)
    assert surface.accuracy.max_abs < 1e-5
    x0, x1 = np.quantile(xy[:, 0], [0.2, 0.8])
    at = np.linspace(x0, x1, 9)
    y = np.full(9, xy[:, 1].mean())
    np.testing.assert_allclose(surface.elevation(at, y), 700 + 0.2 * (at - EASTING) - 0.1 * (y - NORTHING), atol=1e-4)


@pytest.mark.parametrize("n", [3, 7, 20, 41])
@CORES
def test_equal_elevations_give_a_level_surface(n, settings):
    xyz = cloud(n)
    xyz[:, 2] = 432.1
    surface = fit_horizon(PointSet(xyz), settings)
    assert surface.accuracy.max_abs < 1e-9
    for patch in surface.patches:
        np.testing.assert_allclose(patch.control[..., 2] + surface.origin[2], 432.1, atol=1e-8)


def collinear(n, direction):
    t = np.linspace(0, 500, n)
    return PointSet(
        np.column_stack([EASTING + direction[0] * t, NORTHING + direction[1] * t, 500 + 10 * np.sin(t / 120)])
    )


@pytest.mark.parametrize("n", [3, 4, 7, 15, 20, 25, 30, 41, 60])
@pytest.mark.parametrize("direction", [(1.0, 0.3), (0.0, 1.0), (1.0, 0.0)])
@pytest.mark.parametrize("settings", [FitSettings(), NONE], ids=["auto", "none"])
def test_collinear_points_make_a_strip(n, direction, settings):
    surface = fit_horizon(collinear(n, direction), settings)
    assert surface.accuracy.passed
    calm(surface, beyond=1.0, known=["strip"])


@pytest.mark.parametrize("n", [3, 7, 20, 41])
def test_collinear_points_are_interpolated(n):
    surface = fit_horizon(collinear(n, (1.0, 0.3)), ALL)
    assert surface.accuracy.max_abs < 1e-6


def test_an_interpolated_strip_is_level_across():
    for direction in ((1.0, 0.3), (1.0, 0.0)):
        calm(fit_horizon(collinear(20, direction), ALL), beyond=1.0, known=["strip"])


@pytest.mark.parametrize("n", [4, 20, 60])
def test_duplicates_change_nothing_and_are_listed(n):
    xyz = cloud(n)
    once, twice = fit_horizon(PointSet(xyz)), fit_horizon(PointSet(np.concatenate([xyz, xyz])))
    assert len(twice.accuracy.conflicts) == n
    for a, b in zip(once.patches, twice.patches, strict=True):
        np.testing.assert_array_equal(a.control, b.control)
    assert twice.accuracy.n == 2 * n


@CORES
def test_contradicting_duplicates_are_settled_before_the_fit(settings):
    xyz = cloud(50)
    wrong = xyz[:10] + np.array([0, 0, 5.0])
    points = PointSet(np.concatenate([xyz, wrong]), accuracy=[0.1] * 50 + [1.0] * 10)
    surface = fit_horizon(points, settings)
    assert sorted(c.dropped for c in surface.accuracy.conflicts) == list(range(50, 60))
    assert np.abs(surface.accuracy.residuals[:50]).max() < 0.1
    assert np.abs(surface.accuracy.residuals[50:]).min() > 4
    calm(surface)


def vertical(n=60, roughness=1.0):
    rng = np.random.default_rng(0)
    s, w = rng.uniform(0, 600, n), rng.normal(0, roughness, n)
    return PointSet(
        np.column_stack([EASTING + 0.8 * s - 0.6 * w, NORTHING + 0.6 * s + 0.8 * w, rng.uniform(0, 400, n)])
    )


def test_a_vertical_plane_is_fitted_over_itself():
    assert parametrize(vertical(), FitSettings(), None).frame.kind == "best-plane"


def test_a_vertical_plane_is_fitted_over_itself_when_asked():
    surface = fit_horizon(vertical(roughness=0.02), FitSettings(frame="best-plane"))
    assert surface.accuracy.max_abs < 0.1
    assert [c.name for c in surface.accuracy.checks if c.passed is False] == []


def test_points_of_a_vertical_plane_over_the_map_end_in_figures_or_a_geofit_error():
    try:
        surface = fit_horizon(vertical(8), FitSettings(frame="map", max_iterations=2))
    except FitError:
        return
    assert np.isfinite(surface.accuracy.sigma)


def test_points_above_each_other_have_a_surface():
    z = np.arange(5) * 10.0
    surface = fit_horizon(PointSet(np.column_stack([np.full(5, EASTING), np.full(5, NORTHING), z])))
    assert surface.diagnostics["frame"] == "best-plane"
    assert surface.accuracy.max_abs < 1e-6


@pytest.mark.parametrize("across", ["cubic", "linear"])
@pytest.mark.parametrize("lines", [[0], [0, 200], [0, 100, 200, 300, 400]])
@CORES
def test_one_two_and_five_sections(lines, settings, across):
    surface = fit_horizon(sections(lines), FitSettings(core=settings.core, across=across))
    assert surface.accuracy.passed
    calm(surface, beyond=1.0, known=["strip"] if len(lines) == 1 else [])
    if settings.core == "all":
        assert surface.accuracy.max_abs < 1e-6


def with_a_cluster(away):
    far = cloud(60, seed=1, size=50.0) + np.array([away, away, 20])
    return PointSet(np.concatenate([cloud(60), far]))


@pytest.mark.parametrize("away", [2e3, 5e3, 1e4, 5e4])
def test_a_cluster_far_away_is_met_or_told(away):
    points = with_a_cluster(away)
    surface = fit_horizon(points)
    assert np.isfinite(surface.accuracy.residuals).all()
    checks = {c.name: c for c in surface.accuracy.checks}
    assert np.abs(surface.accuracy.residuals[surface.core]).max(initial=0) < 1e-6
    low, high = points.xyz[:, 2].min(), points.xyz[:, 2].max()
    z = np.concatenate([(patch.control[..., 2] + surface.origin[2]).ravel() for patch in surface.patches])
    if z.min() < low - 2 * (high - low) or z.max() > high + 2 * (high - low):
        assert checks["elevation range"].passed is False
    if surface.accuracy.max_abs > 0.1 and checks["interior tolerance"].passed is not False:
        assert any(note.code == "fitting.points-beyond-tolerance-as-noise" for note in surface.model.net.notes)


def test_a_small_core_in_a_wide_area_has_no_gaps():
    surface = fit_horizon(with_a_cluster(5e3))
    assert len(surface.accuracy.seams) == 4
    assert max(seam.gap for seam in surface.accuracy.seams) < 1e-6


@CORES
def test_coordinates_of_32_million_keep_their_digits(settings):
    here, there = PointSet(cloud(60)), PointSet(cloud(60) + np.array([3.2e7 - EASTING, 0, 0]))
    one, two = fit_horizon(here, settings), fit_horizon(there, settings)
    # 3.2e7 m carries 4e-9 m; the smoothness that exact points seem to have follows from such digits.
    np.testing.assert_allclose(two.accuracy.residuals, one.accuracy.residuals, atol=5e-6)
    calm(two)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
@CORES
def test_tiny_and_huge_sites(scale, settings):
    xyz = cloud(60)
    centre = xyz.mean(axis=0)
    points = PointSet((xyz - centre) * scale + centre)
    surface = fit_horizon(points, FitSettings(core=settings.core, coincidence_distance=0.01 * min(scale, 1)))
    assert surface.accuracy.max_abs < 0.1
    assert np.isfinite(surface.patches[0].control).all()


@pytest.fixture(scope="module")
def truth():
    return paper_arrangement(5)


@pytest.mark.parametrize("seam", ["tangent", "position"])
@pytest.mark.parametrize("across", ["cubic", "linear"])
def test_every_seam_and_way_across_keeps_its_promises(truth, seam, across):
    surface = fit_horizon(truth.points, FitSettings(seam=seam, across=across), truth.boundary)
    checks = {c.name: c for c in surface.accuracy.checks}
    assert checks["core"].passed
    assert checks["seam gap"].value < 1e-9
    if seam == "tangent":
        assert checks["seam angle"].value < 1e-3
    assert surface.accuracy.passed
    assert checks["normals"].passed
    assert checks["elevation range"].passed


def test_core_all_interpolates_every_point(truth):
    surface = fit_horizon(truth.points, ALL, truth.boundary)
    assert [p.name for p in surface.patches] == ["core"]
    assert surface.core.all()
    assert surface.accuracy.max_abs < 1e-6
    assert surface.partition.core == 597


def test_core_none_approximates_every_point(truth):
    surface = fit_horizon(truth.points, NONE, truth.boundary)
    assert [p.name for p in surface.patches] == ["periphery"]
    assert not surface.core.any()
    assert surface.accuracy.passed


def test_a_drawn_core_has_a_periphery_on_all_sides(truth):
    x, y = EASTING, NORTHING
    polygon = ((x + 800, y + 500), (x + 1200, y + 500), (x + 1200, y + 1500), (x + 800, y + 1500))
    surface = fit_horizon(truth.points, FitSettings(core=polygon), truth.boundary)
    assert len(surface.patches) == 9
    east, north = truth.points.xyz[:, 0] - x, truth.points.xyz[:, 1] - y
    inside = (east >= 800) & (east <= 1200) & (north >= 500) & (north <= 1500)
    np.testing.assert_array_equal(surface.core, inside)
    assert np.abs(surface.accuracy.residuals[inside]).max() < 1e-6
    np.testing.assert_allclose(sorted(surface.partition.corners), sorted(polygon), atol=1e-6)
    checks = {c.name: c for c in surface.accuracy.checks}
    assert checks["seam gap"].value < 1e-9
    assert checks["seam angle"].value < 1e-3


def test_a_drawn_core_outside_the_area_or_over_a_fault_is_a_fit_error(truth):
    away = tuple((x + 9e4, y) for x, y in truth.boundary)
    with refused(FitError, "fitting.core-polygon-outside"):
        fit_horizon(truth.points, FitSettings(core=away), truth.boundary)
    with refused(FitError, "fitting.core-polygon-in-other-frame"):
        fit_horizon(truth.points, FitSettings(core=away, frame="best-plane"))


def test_a_boundary_smaller_than_the_data_keeps_all_points(truth):
    x, y = EASTING, NORTHING
    small = np.array([[x + 600, y + 500], [x + 1400, y + 500], [x + 1400, y + 900], [x + 600, y + 900]])
    surface = fit_horizon(truth.points, None, small)
    assert surface.accuracy.n == 597
    assert surface.accuracy.passed
    assert with_code(surface.accuracy.notes, "fitting.points-beyond-study-area").severity == "warning"
    assert np.isfinite(surface.elevation(x + 1000, y + 700))


def test_a_turned_site_fits_as_well_as_one_along_the_axes(truth):
    a = np.radians(30)
    turn = np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])
    centre = truth.points.xyz[:, :2].mean(axis=0)
    xyz = truth.points.xyz.copy()
    xyz[:, :2] = (xyz[:, :2] - centre) @ turn + centre
    here = fit_horizon(truth.points, None, truth.boundary)
    there = fit_horizon(truth.points.with_(xyz=xyz), None, (truth.boundary - centre) @ turn + centre)
    assert there.partition.core == here.partition.core == 440
    at = truth.places(2000)
    turned = (at - centre) @ turn + centre
    # The edges of the areas differ in the last digit: stay 1 m inside.
    inner = (np.abs(at - at.mean(axis=0)) < 995).all(axis=1)
    np.testing.assert_allclose(there.elevation(*turned[inner].T), here.elevation(*at[inner].T), atol=0.2)


@pytest.mark.parametrize(
    "boundary",
    [[[0, 0], [1, 1]], [[0, 0, 0]] * 3, [[0, 0], [1, np.nan], [2, 2]], [0, 1, 2]],
    ids=["two corners", "3d", "nan", "flat list"],
)
def test_a_boundary_that_is_none_is_refused(boundary):
    with refused(PointsError, "fitting.boundary-wrong-shape"):
        fit_horizon(PointSet(cloud(10)), None, boundary)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_nan_and_infinities_never_reach_the_fit(bad):
    xyz = cloud(10)
    xyz[3, 2] = bad
    with refused(PointsError, "data.points-not-finite", count=1, total=10, index=3):
        fit_horizon(PointSet(xyz))


@pytest.mark.parametrize("settings", [FitSettings(), NONE, ALL], ids=["auto", "none", "all"])
def test_the_same_input_gives_the_same_control_points(truth, settings):
    one, two = (fit_horizon(truth.points, settings, truth.boundary) for _ in range(2))
    for a, b in zip(one.patches, two.patches, strict=True):
        assert a.name == b.name
        np.testing.assert_array_equal(a.control, b.control)
        np.testing.assert_array_equal(a.knots_u, b.knots_u)
    np.testing.assert_array_equal(one.accuracy.residuals, two.accuracy.residuals)


@pytest.mark.parametrize(
    "settings",
    [
        pytest.param(FitSettings(), id="auto"),
        pytest.param(NONE, id="none"),
    ],
)
def test_the_order_of_the_points_does_not_matter(truth, settings):
    order = np.random.default_rng(0).permutation(597)
    one = fit_horizon(truth.points, settings, truth.boundary)
    two = fit_horizon(truth.points[order], settings, truth.boundary)
    at = truth.places(3000)
    np.testing.assert_allclose(two.elevation(*at.T), one.elevation(*at.T), atol=1e-6)


@CORES
def test_a_translated_site_has_the_same_residuals(truth, settings):
    # Whole metres and powers of two: the sums are exact, so only the fit's own arithmetic shows.
    xyz = np.round(truth.points.xyz * 1024) / 1024
    one = fit_horizon(truth.points.with_(xyz=xyz), settings)
    two = fit_horizon(truth.points.with_(xyz=xyz + np.array([1e5, 1e6, 0])), settings)
    np.testing.assert_allclose(two.accuracy.residuals, one.accuracy.residuals, atol=1e-7)


def test_a_smoothing_that_is_given_is_not_chased(truth):
    stiff = fit_horizon(truth.points, FitSettings(core="none", smoothing=1.0, epsilon=50.0), truth.boundary)
    assert stiff.diagnostics["smoothing"] == pytest.approx(1.0)
    assert stiff.diagnostics["rounds"] == 0
    assert stiff.accuracy.sigma > 0.1


@pytest.mark.parametrize("most", [300, 1000, 2000])
def test_the_cap_of_control_points_holds(truth, most):
    surface = fit_horizon(truth.points, FitSettings(core="none", max_control_points=most), truth.boundary)
    assert surface.control_points <= most


def test_the_cap_holds_for_a_core_too_or_is_told(truth):
    surface = fit_horizon(truth.points, FitSettings(max_control_points=2500), truth.boundary)
    assert surface.control_points <= 2500
    assert rms(surface.accuracy.residuals) < 0.5
    with refused(FitError, "fitting.core-not-interpolable"):
        fit_horizon(truth.points, FitSettings(core="all", max_control_points=400), truth.boundary)
