"""Variances, left-out errors, bands and next holes against dense algebra and brute force."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from refusals import refused
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import splu
from truth import EASTING, NORTHING, Truth, hills, paper_arrangement

from geofit import FitSettings, PointSet, fit_horizon
from geofit.data.errors import FitError, SettingsError
from geofit.fitting.calibration import uncalibrated
from geofit.fitting.deletion import LinearFit, linear_fit
from geofit.fitting.field import precision_band
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.posterior import Posterior, posterior
from geofit.prediction.bands import PredictionError, band, grid_over, prediction_sd, uncertainty_on
from geofit.prediction.drilling import greedy_holes, suggest_holes
from geofit.prediction.examine import examine
from geofit.splines import bspline
from geofit.splines.blocks import BlockFactor
from geofit.splines.matern import MaternPrecision
from geofit.splines.refined import finest
from geofit.splines.tensor import RIDGES, TensorSpace


def dense(band: np.ndarray) -> np.ndarray:
    full = np.zeros((band.shape[1],) * 2)
    for k, row in enumerate(band):
        j = np.arange(band.shape[1] - k)
        full[j + k, j] = full[j, j + k] = row[: len(j)]
    return full


@cache
def system() -> tuple[TensorSpace, np.ndarray, np.ndarray]:
    """A space of 13 x 9 control points, 60 places, and a band of data and energy."""
    breaks = np.linspace(0, 1, 11), np.linspace(0, 1, 7)
    space = TensorSpace(*(bspline.clamped_knots(along, 3) for along in breaks))
    plane = np.random.default_rng(4).uniform(size=(60, 2))
    data, _ = space.normal_equations(plane, np.zeros(60), np.linspace(0.5, 2, 60))
    return space, plane, data + 1e-5 * MaternPrecision(space, 3).band(2.0)


def test_block_factor_agrees_with_dense_algebra():
    space, plane, system_band = system()
    factor, inverse = BlockFactor(system_band), np.linalg.inv(dense(system_band))
    matrix = space.matrix(plane)
    rows = matrix.toarray()
    expected = rows @ inverse @ rows.T
    assert np.allclose(factor.gram(matrix), expected, rtol=1e-7, atol=1e-9 * expected.max())
    assert np.allclose(factor.inverse().quadratic(*space.rows(plane)), np.diag(expected), rtol=1e-7)
    assert np.allclose(dense(system_band) @ factor.solve(rows.T), rows.T, atol=1e-7)


def test_a_band_that_holds_nothing_is_refused():
    space, plane, _ = system()
    data, _ = space.normal_equations(plane[:5], np.zeros(5), np.ones(5))
    with refused(FitError, "splines.control-points-unconstrained"):
        BlockFactor(data)


@cache
def small_truth() -> Truth:
    return paper_arrangement(3, section_points=12, periphery=60)


@cache
def small_surface(**settings: str | float) -> HorizonFit:
    truth = small_truth()
    return fit_horizon(truth.points, FitSettings(**settings), boundary=truth.boundary)


def linear(surface: HorizonFit) -> LinearFit:
    return linear_fit(surface.model, posterior(surface.model))


def field_without(given: Posterior, keep: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Heights of field and plane at all points, and their covariance over noise^2, from some of the points alone."""
    a = given.matrix(given.plane)
    f = np.column_stack([np.ones(len(given.value)), given.plane])
    band = precision_band(given.space, given.model)
    below = diags_array(list(band), offsets=[-k for k in range(len(band))], shape=(a.shape[1], a.shape[1]))
    energy = below + below.T - diags_array(band[0])
    some, w = a[keep], given.weight[keep]
    k = some.T @ diags_array(w) @ some + energy
    # The ridge of the factor that the fit is solved with: K of all points has it.
    k = k + RIDGES[0] * diags_array((a.T @ diags_array(given.weight) @ a + energy).diagonal())
    solved = splu(csc_array(k)).solve(a.T.toarray())
    # Covariance of the field a priori conditioned on the points; the plane's slope is held to none, trend included.
    among = a @ solved
    v = np.diag(w) - w[:, None] * among[np.ix_(keep, keep)] * w
    prior = np.diag([0.0, given.model.hold, given.model.hold])
    moment = f[keep].T @ v @ f[keep] + prior
    b = np.linalg.solve(moment, f[keep].T @ v @ given.value[keep] - prior @ given.trend)
    height = among[:, keep] @ (w * (given.value[keep] - f[keep] @ b)) + f @ b
    rest = f - among[:, keep] @ (w[:, None] * f[keep])
    return height, among + rest @ np.linalg.solve(moment, rest.T)


def brute_force(surface: HorizonFit, fit: LinearFit, group: np.ndarray) -> np.ndarray:
    """Errors of the same three steps, solved anew from the points that are left."""
    given, net = fit.posterior, surface.model.net
    keep = np.setdiff1d(np.arange(len(given.value)), group)
    height, _ = field_without(given, keep)
    rows = net.space.matrix(given.plane)
    for step in fit.corrections:
        mine = np.intersect1d(step.points, keep)
        wanted = given.value[mine] - height[mine]
        if step.slack:
            wanted = np.sign(wanted) * np.maximum(np.abs(wanted) - step.slack, 0)
        # The kernel's own inverse tells its nugget.
        place = {p: i for i, p in enumerate(step.points)}
        index = [place[p] for p in mine]
        among = np.linalg.inv(step.inverse)[np.ix_(index, index)]
        multiplier = np.linalg.solve(among, wanted)
        free = (~net.frozen if step.slack else finest(net.space)).astype(float)
        height = height + rows @ (free * (rows[mine].T @ multiplier))
    return given.value[group] - height[group]


@pytest.mark.parametrize(
    ("settings", "digits"),
    [
        ({"smoothing": 0.01}, 1e-8),
        ({}, 1e-7),
        # The noise is a millimetre, the errors are metres: I - H of the group, their squared ratio, cancels six digits
        # of a system of condition 3e7. The brute force is the better side: solved in 80 bits it changes by 8e-6.
        ({"core": "none"}, 2e-4),
        ({"core": "all"}, 2e-4),
        ({"interior_tolerance": 0.01}, 1e-7),
    ],
)
def test_leaving_out_is_the_same_as_solving_anew(settings, digits):
    surface = small_surface(**settings)
    fit = linear(surface)
    section = surface.points.section
    groups = [np.array([3]), np.flatnonzero(section == "S05"), np.array([20, 150, 170])]
    predicted = fit.without(groups)
    for group in groups:
        expected = brute_force(surface, fit, group)
        assert predicted.error[group] == pytest.approx(expected, rel=digits, abs=digits)
    untouched = np.setdiff1d(np.arange(len(section)), np.concatenate(groups))
    assert np.isnan(predicted.error[untouched]).all()


def test_variance_at_points_left_out():
    surface = small_surface()
    fit = linear(surface)
    given = fit.posterior
    group = np.array([5, 6, 140])
    keep = np.setdiff1d(np.arange(len(given.value)), group)
    variance = given.noise**2 * np.diag(field_without(given, keep)[1])[group]
    assert fit.without([group]).variance[group] == pytest.approx(variance, rel=1e-5)


def test_the_covariance_holds_the_plane_s_own_doubt():
    given = posterior(small_surface().model)
    every = np.arange(len(given.value))
    height, covariance = field_without(given, every)
    assert given.gram(given.plane) == pytest.approx(covariance, rel=1e-5, abs=1e-7 * covariance.max())
    assert given.variance(given.plane) == pytest.approx(given.noise**2 * np.diag(covariance), rel=1e-5)
    assert given.value - given.residual == pytest.approx(height, abs=1e-5)
    some = given.plane[:5]
    expected = given.noise**2 * covariance[:, :5]
    assert given.covariance_with(given.plane, some) == pytest.approx(expected, rel=1e-5, abs=1e-7 * expected.max())


def test_points_that_were_let_go_pull_at_nothing_when_others_are_left_out():
    rng = np.random.default_rng(5)
    plan = rng.uniform(0, 1000, (80, 2))
    plan[-1] = plan[-2] + (1.0, 0.5)
    height = 30 * np.sin(plan[:, 0] / 150) + 20 * np.cos(plan[:, 1] / 120) + rng.normal(0, 2.0, 80)
    height[-1] = height[-2] + 60
    surface = fit_horizon(PointSet(np.column_stack([plan, height])))
    fit = linear(surface)
    left = np.abs(surface.elevation(*plan.T) - height)
    before = np.abs(fit.posterior.residual)
    tolerance = surface.settings.interior_tolerance
    (pull,) = fit.corrections
    assert sorted(left[-2:] > tolerance) == [False, True]
    assert set(pull.points) == set(np.flatnonzero((before > tolerance) & (left < 1.1 * tolerance)))
    assert len({78, 79} & set(pull.points)) == 1


def is_near_core(surface: HorizonFit, point: np.ndarray) -> bool:
    """Whether a point lies within two spacings of the core's points from the core."""
    corners = np.array(surface.partition.corners)
    low, high = corners.min(axis=0), corners.max(axis=0)
    aside = 2 * np.sqrt(np.prod(high - low) / surface.core.sum())
    (plan,) = surface.points.xyz[point, :2]
    return bool(((plan > low - aside) & (plan < high + aside)).all())


def test_holes_left_out_are_close_to_new_fits_without_them():
    """Of 20 holes: each new fit chooses its own knots, pulls and field; a few holes decide on its direction."""
    surface, truth = small_surface(), small_truth()
    predicted = linear(surface).without([np.array([k]) for k in range(len(truth.points))])
    holes = np.unique(truth.points.hole[truth.points.hole != ""])[:60:3]
    moved, near = {}, {}
    for hole in holes:
        left = truth.points.hole == hole
        refit = fit_horizon(truth.points[~left], boundary=truth.boundary)
        x, y, z = truth.points.xyz[left].T
        apart = predicted.error[left] - (z - refit.elevation(x, y))
        moved[hole] = abs(apart / np.sqrt(predicted.variance[left])).item()
        if is_near_core(surface, left):
            near[hole] = abs(z - refit.elevation(x, y)).item() - abs(predicted.error[left]).item()
            del moved[hole]
    # Next to the core its own points say more than the field of all points, by which holes are left out.
    assert near
    assert np.mean(list(near.values())) < 0
    size = np.array(list(moved.values()))
    assert moved["B004"] < 0.25
    assert size.max() < 0.4
    assert np.median(size) < 0.05
    assert np.sqrt(np.mean(size**2)) < 0.15


def test_standard_deviation_grows_away_from_the_points():
    surface = small_surface()
    spread = PredictionError(surface.model, posterior(surface.model), uncalibrated())
    grid = grid_over(surface)
    uncertainty = uncertainty_on(grid, spread)
    assert uncertainty.sd.shape == (len(uncertainty.y), len(uncertainty.x))
    assert np.isfinite(uncertainty.sd).all()
    x, y = np.meshgrid(uncertainty.x, uncertainty.y)
    nodes = np.column_stack([x.ravel(), y.ravel()])
    distance = np.linalg.norm(nodes[:, None] - surface.points.xyz[None, :, :2], axis=2).min(axis=1)
    far, close = distance > np.quantile(distance, 0.9), distance < np.quantile(distance, 0.1)
    assert np.median(uncertainty.sd.ravel()[far]) > 5 * np.median(uncertainty.sd.ravel()[close])
    at = prediction_sd(surface, uncertainty, nodes[::500])
    assert at == pytest.approx(uncertainty.sd.ravel()[::500], rel=1e-6)


def test_band_lies_z_times_sd_above_and_below_and_keeps_its_seams():
    surface = small_surface()
    spread = PredictionError(surface.model, posterior(surface.model), uncalibrated())
    uncertainty = uncertainty_on(grid_over(surface), spread)
    upper, lower = band(surface, uncertainty, 0.9)
    x, y = small_truth().places(400).T
    sd = prediction_sd(surface, uncertainty, np.column_stack([x, y]), of="contact")
    alone = prediction_sd(surface, uncertainty, np.column_stack([x, y]))
    assert sd == pytest.approx(np.hypot(alone, posterior(surface.model).noise), rel=1e-9)
    middle = surface.elevation(x, y)
    assert (upper.elevation(x, y) > middle).all()
    assert upper.elevation(x, y) - middle == pytest.approx(middle - lower.elevation(x, y), abs=1e-6)
    ratio = (upper.elevation(x, y) - middle) / (1.6449 * sd)
    assert 0.9 < np.median(ratio) < 1.3
    from geofit.geometry.seams import seams

    assert all(seam.gap < 1e-9 and seam.angle < 0.1 for seam in seams(upper.patches))
    with refused(SettingsError, "prediction.share-out-of-range"):
        band(surface, uncertainty, 1.0)
    with refused(FitError, "prediction.surface-not-fitted"):
        band(surface.with_(model=None), uncertainty)


def test_greedy_holes_against_trying_every_place():
    rng = np.random.default_rng(8)
    root = rng.normal(size=(25, 6)) * np.geomspace(1, 0.1, 6)
    covariance, rest, noise = root @ root.T + 0.01 * np.eye(25), rng.uniform(0, 0.1, 25), 0.04
    plan = greedy_holes(covariance, rest, noise, 3)
    chosen: list[int] = []
    for step in range(3):
        means = []
        for candidate in range(25):
            holes = [*chosen, candidate]
            among = covariance[np.ix_(holes, holes)] + noise * np.eye(len(holes))
            gain = covariance[:, holes] @ np.linalg.solve(among, covariance[holes])
            means.append(np.sqrt(np.diag(covariance - gain) + rest).mean())
        means = np.array(means)
        means[chosen] = np.inf
        assert plan.chosen[step] == np.argmin(means)
        assert plan.mean_after[step] == pytest.approx(means.min(), rel=1e-9)
        chosen.append(int(np.argmin(means)))


def test_a_suggested_hole_lowers_the_deviation_as_promised():
    """The promise for the first hole, against a posterior with that hole among the points."""
    surface = small_surface(core="none", max_iterations=0)
    model = surface.model
    given = posterior(model)
    spread, grid = PredictionError(model, given, uncalibrated()), grid_over(surface)
    holes = suggest_holes(grid, spread, 4)
    before = np.sqrt(spread.variance(grid.plane)).mean()
    assert before > holes[0].mean_after > holes[1].mean_after > holes[3].mean_after
    node = grid.plane[np.argmin(np.linalg.norm(grid.places(model)[:, :2] - (holes[0].x, holes[0].y), axis=1))]
    # The variance given one more point of the field's own noise; the covariance itself is tested above.
    with_it = given.covariance_with(grid.plane, node[None])[:, 0]
    own = given.variance(node[None])[0] + given.noise**2
    lowered = given.variance(grid.plane) - with_it**2 / own
    departure = spread.variance(grid.plane) - given.variance(grid.plane)
    assert holes[0].mean_after == pytest.approx(np.sqrt(lowered + departure).mean(), rel=1e-6)
    apart = np.array([[h.x, h.y] for h in holes])
    assert np.linalg.norm(apart[:, None] - apart[None], axis=2)[np.triu_indices(4, 1)].min() > 100


def test_points_without_a_model_or_a_height_have_no_posterior():
    xyz = np.random.default_rng(1).uniform(size=(30, 3)) * (100, 100, 1)
    surface = fit_horizon(PointSet(xyz))
    with pytest.raises(FitError):
        grid_over(surface.with_(model=None))


def test_the_posterior_of_a_core_that_lost_points_has_the_unit_of_its_fit():
    """On a circle no two neighbours agree: half of a core of all points is let go, the others are still its core."""
    rng = np.random.default_rng(76)
    t = rng.uniform(0, 2 * np.pi, 190)
    plan = 4000 * np.column_stack([np.cos(t), np.sin(t)]) + (EASTING, NORTHING)
    points = PointSet(np.column_stack([plan, 300 + rng.normal(0, 80, 190)]))
    surface = fit_horizon(points, FitSettings(core="all"))
    assert 0 < surface.core.sum() < len(points) - 10
    model = surface.model
    given = posterior(model)
    assert np.allclose(given.plane * model.net.unit, model.problem.parametrization.plane, rtol=0, atol=1e-9)
    found = examine(surface)
    assert not [note for note in found.notes if note.code == "prediction.error-not-found"]
    assert found.uncertainty is not None


@pytest.mark.parametrize("stated", [True, False])
def test_a_new_hole_scatters_as_holes_do_and_not_as_picks(stated):
    rng, height = np.random.default_rng(11), hills(11)
    xy = rng.uniform((EASTING, NORTHING), (EASTING + 2000, NORTHING + 2000), (450, 2))
    sd = np.repeat([0.05, 4.0], [150, 300])
    xyz = np.column_stack([xy, height(*xy.T) + sd * rng.normal(size=450)])
    kind = np.repeat(["borehole", "geophysics"], [150, 300])
    surface = fit_horizon(PointSet(xyz, kind=kind, accuracy=sd if stated else np.nan), FitSettings(core="none"))
    uncertainty = examine(surface).uncertainty
    assert uncertainty.noise < 1.0
    new = rng.uniform((EASTING + 100, NORTHING + 100), (EASTING + 1900, NORTHING + 1900), (1000, 2))
    found = height(*new.T) + 0.05 * rng.normal(size=1000)
    held = 1.645 * prediction_sd(surface, uncertainty, new, of="contact")
    assert 0.82 <= (np.abs(found - surface.elevation(*new.T)) <= held).mean() <= 0.97
