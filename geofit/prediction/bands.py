"""The standard deviation of a surface, at any place, on a grid, and as an upper and a lower surface."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import NearestNDInterpolator
from scipy.special import ndtri

from geofit.data.columns import measurable_places
from geofit.data.errors import FitError, SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.data.numbers import is_finite, shown
from geofit.data.prediction import PredictionResult, Uncertainty
from geofit.data.threads import one_thread
from geofit.fitting.calibration import Calibration, uncalibrated
from geofit.fitting.conflicts import trust_of
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.model import Model
from geofit.fitting.net import Net
from geofit.fitting.posterior import Posterior, posterior, posterior_of_core
from geofit.geometry.clip import inside
from geofit.geometry.hull import within_hull
from geofit.geometry.projection import searchable
from geofit.splines.refined import abscissae, from_abscissae, outer_of

__all__ = ["Grid", "PredictionError", "band", "band_directions", "grid_over", "prediction_sd", "uncertainty_on"]

Floats = NDArray[np.float64]
#: What a standard deviation is of: the surface, or the contact that a new hole finds there.
Of = Literal["surface", "contact"]

#: Nodes along the longer side of the grid.
NODES = 100


@dataclass(frozen=True, eq=False)
class PredictionError:
    """Mean square error of a surface about the rock.

    The surface meets points that the field takes for noisy, and departs from the field by t to do so. Given the data,
    its expected square error is the field's posterior variance plus t^2, times the square of the local factor. In a
    core with a field of its own, the field is that one.
    """

    model: Model
    posterior: Posterior
    calibration: Calibration

    def variance(self, plane: Floats) -> Floats:
        """Return the (n,) mean square errors at (n, 2) places in units, before calibration, m^2."""
        net = self.model.net
        height, variance = self.field(plane)
        departure = net.space.matrix(plane) @ net.coefficients - height
        if departure.ndim == 2:
            departure = (departure * _normals(net, plane)).sum(axis=1)
        return np.asarray(variance + departure**2)

    def field(self, plane: Floats) -> tuple[Floats, Floats]:
        """Return heights (n,) or coordinates (n, 3) of the field at (n, 2) places in units, and its variances, m^2."""
        height, variance = self.posterior.height(plane), self.posterior.variance(plane)
        relief = self.model.net.relief
        if relief is not None:
            share = relief.share(plane)
            some = share > 0
            own, places, part = posterior_of_core(relief), relief.places(plane[some]), share[some]
            height[some] += part * (own.height(places) - height[some])
            variance[some] += part * (own.variance(places) - variance[some])
        return height, variance

    def sd(self, plane: Floats) -> Floats:
        """Return the (n,) standard deviations at (n, 2) places in units, metres."""
        return np.asarray(self.calibration.at(plane) * np.sqrt(self.variance(plane)))

    @property
    def contact_noise(self) -> float:
        """Noise of a new hole's contact, metres (1 sigma): that of the points measured nearest to the rock."""
        given = self.posterior
        trust = trust_of(self.model.problem.points.labels["kind"][given.kept])
        return given.noise / math.sqrt(float(np.median(given.weight[trust == trust.min()])))


@dataclass(frozen=True, eq=False)
class Grid:
    """Nodes over a surface: ``x`` (nx,) and ``y`` (ny,); ``plane`` (k, 2) in units where ``within`` (ny, nx)."""

    x: Floats
    y: Floats
    within: NDArray[np.bool_]
    plane: Floats

    def at_nodes(self, values: Floats) -> Floats:
        """Return (k,) values at the nodes of the surface as (ny, nx), nan elsewhere."""
        full = np.full(self.within.shape, np.nan)
        full[self.within] = values
        return full

    def places(self, model: Model) -> Floats:
        """Return the map coordinates (k, 3) of the surface at the nodes on it."""
        net, frame = model.net, model.problem.parametrization.frame
        local = net.space.matrix(self.plane) @ net.coefficients
        if local.ndim == 1:
            local = np.column_stack([self.plane * net.unit, local])
        return frame.turn_back(local) + frame.origin


def grid_over(surface: HorizonFit) -> Grid:
    """Lay a grid over the study area; on a best plane, or in the parameters of a fold, over the hull of the points."""
    model = _model(surface)
    parametrization, unit = model.problem.parametrization, model.net.unit
    u0, u1, v0, v1 = parametrization.area
    if parametrization.frame.kind == "map":
        local = np.array([[u0, v0, 0], [u1, v0, 0], [u1, v1, 0], [u0, v1, 0]])
        corners = (parametrization.frame.turn_back(local) + parametrization.frame.origin)[:, :2]
        if surface.outline is not None:
            corners = surface.outline
    else:
        corners = np.array([[u0, v0], [u1, v1]])
    low, high = corners.min(axis=0), corners.max(axis=0)
    step = float((high - low).max()) / (NODES - 1)
    x, y = (np.linspace(low[k], high[k], max(round((high[k] - low[k]) / step) + 1, 2)) for k in (0, 1))
    nodes = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    plane = parametrization.frame.plan(nodes) if parametrization.frame.kind == "map" else nodes
    edge = 1e-9 * max(u1 - u0, v1 - v0)
    within = (plane >= (u0 - edge, v0 - edge)).all(axis=1) & (plane <= (u1 + edge, v1 + edge)).all(axis=1)
    plane = np.clip(plane, (u0, v0), (u1, v1))
    if parametrization.frame.kind != "map":
        within &= within_hull(parametrization.plane, plane)
    grid = Grid(x, y, within.reshape(len(y), len(x)), plane[within] / unit)
    if surface.outline is None:
        return grid
    places = nodes[within] if parametrization.frame.kind == "map" else grid.places(model)[:, :2]
    # The outline itself counts as inside.
    middle = (surface.outline.min(axis=0) + surface.outline.max(axis=0)) / 2
    kept = inside(surface.outline, middle + (places - middle) * (1 - 1e-9))
    return Grid(x, y, grid.at_nodes(kept.astype(float)) == 1, grid.plane[kept])


def uncertainty_on(grid: Grid, error_model: PredictionError) -> Uncertainty:
    """Return the standard deviation on the nodes of a grid."""
    factors = error_model.calibration.at(grid.plane)
    sd = factors * np.sqrt(error_model.variance(grid.plane))
    return Uncertainty(
        grid.x, grid.y, grid.at_nodes(sd), float(np.median(factors)), float(sd.mean()), float(sd.max()),
        grid.at_nodes(factors), error_model.model.problem.parametrization.frame.kind, error_model.contact_noise,
    )  # fmt: skip


@arguments_checked
def prediction_sd(surface: HorizonFit, uncertainty: Uncertainty, xyz: ArrayLike, of: Of = "surface") -> Floats:
    """Return the prediction standard deviation of a surface at any place.

    Parameters
    ----------
    surface : HorizonFit
        A fitted surface.
    uncertainty : Uncertainty
        ``examine(surface).uncertainty``.
    xyz : (n, 3) array_like
        Map coordinates on the surface, metres; (n, 2) is enough for a height field over the map. Beside a folded
        surface the nearest place on it counts.
    of : {"surface", "contact"}
        Of the surface itself, or of the contact that a new hole finds there: it has the points' noise besides.

    Returns
    -------
    (n,) array
        Standard deviations, metres.

    Raises
    ------
    ArgumentError
        If ``uncertainty`` is none, as after an examination that could estimate nothing.
    FitError
        If nothing is known about how the surface was fitted.

    Notes
    -----
    The posterior of the field is evaluated at each place and multiplied by the calibration factor of the nearest node
    of the grid.
    """
    model = _model(surface)
    if np.ndim(xyz) > 0 and np.shape(xyz)[-1] == 2:
        xyz = np.insert(np.atleast_2d(np.asarray(xyz)), 2, 0.0, axis=1)
        if surface.frame != "map":
            raise FitError(
                message(
                    "prediction.plane-needs-elevations",
                    "A surface over its best plane, or a folded one, needs (n, 3) coordinates; (n, 2) were given.",
                )
            )
    places = _parameters(surface, model, measurable_places(xyz))
    with one_thread():
        return _sd(model, uncertainty, places, of)


def band_directions(surface: HorizonFit, xyz: Floats) -> Floats:
    """Return the unit vectors, (n, 3), along which the standard deviation is measured at (n, 3) places on a surface.

    Upwards, across its best plane, or along the normals of a folded surface; to its upper side.
    """
    model = _model(surface)
    axes = model.problem.parametrization.frame.axes
    if not model.problem.parametrization.parametric:
        across = axes[2] if axes[2, 2] >= 0 else -axes[2]
        return np.tile(across, (len(xyz), 1))
    normals = _normals(model.net, _parameters(surface, model, xyz)) * searchable(surface.patches).upwards
    return np.asarray(normals @ axes)


@arguments_checked
def band(
    surface: HorizonFit, found: PredictionResult | Uncertainty, share: float = 0.9, of: Of = "contact"
) -> tuple[HorizonFit, HorizonFit]:
    """Return the upper and the lower surface between which a new hole finds the rock with the given probability.

    Parameters
    ----------
    surface : HorizonFit
        A fitted surface.
    found : PredictionResult or Uncertainty
        What :func:`geofit.prediction.examine.examine` found.
    share : float
        Probability, above 0 and below 1.
    of : {"contact", "surface"}
        Whether the band holds the contacts of new holes, noise included, or the surface about which they scatter.

    Returns
    -------
    upper, lower : HorizonFit
        The same net, each control point moved by plus or minus z * sd at its Greville abscissa: Schoenberg's
        variation-diminishing spline, which never swings below zero. Patches meet as those of the surface do. Control
        points of a folded surface move along its normals; where the band is wider than a hinge is round, it crosses
        itself.

    Raises
    ------
    SettingsError
        If ``share`` is not a probability.
    FitError
        If nothing is known about how the surface was fitted.

    Notes
    -----
    The deviation is taken as normal, with the calibrated standard deviation of :func:`prediction_sd`. Control points
    at Greville abscissae: Farin, Curves and Surfaces for CAGD, 5th ed., sec. 8.3.
    """
    if not is_finite(share) or not 0 < share < 1:
        raise SettingsError(
            message(
                "prediction.share-out-of-range",
                "share is {share}; a probability above 0 and below 1 is needed, for instance 0.9.",
                share=shown(share),
            )
        )
    uncertainty = found.uncertainty if isinstance(found, PredictionResult) else found
    if uncertainty is None:
        raise FitError(
            message(
                "prediction.standard-deviation-unknown-here",
                "No standard deviation is known of '{name}'; see the notes of its examination.",
                name=surface.name,
            )
        )
    model = _model(surface)
    space, factor = model.net.space, float(ndtri((1 + share) / 2))
    with one_thread():
        offset = from_abscissae(space, lambda plane: factor * _sd(model, uncertainty, plane, of))
    if model.net.coefficients.ndim == 2:
        up = searchable(surface.patches).upwards
        offset = offset[:, None] * _normals(model.net, abscissae(outer_of(space))) * up
    sides = []
    for sign, word in ((1, "upper"), (-1, "lower")):
        moved = model.with_net(replace(model.net, coefficients=model.net.coefficients + sign * offset))
        sides.append(
            surface.with_(
                patches=moved.patches(),
                name=f"{surface.name} {word} {100 * share:g}%",
                core=np.zeros(len(surface.points), bool),
                accuracy=None,
                model=None,
            )
        )
    return sides[0], sides[1]


def _parameters(surface: HorizonFit, model: Model, xyz: Floats) -> Floats:
    """Return the places, (n, 2) in units, of (n, 3) map coordinates on a surface."""
    if model.problem.parametrization.parametric:
        foot = surface.project(xyz)
        plane = np.column_stack([foot.u, foot.v])
    else:
        plane = model.problem.parametrization.frame.to_local(xyz)[:, :2]
    return plane / model.net.unit


def _normals(net: Net, plane: Floats) -> Floats:
    """Return the unit normals of a folded surface at (n, 2) places in units, (n, 3) along the frame's axes."""
    ways = (outer_of(net.space).gradient_rows(plane, np.tile(way, (len(plane), 1))) for way in np.eye(2))
    along, across = ((values[..., None] * net.coefficients[index]).sum(axis=1) for index, values in ways)
    normal = np.cross(along, across)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)[:, None]
    return np.asarray(normal)


def _sd(model: Model, uncertainty: Uncertainty, plane: Floats, of: Of) -> Floats:
    """Return the standard deviation at places in units, with the factors of a grid."""
    frame = model.problem.parametrization.frame
    x, y = np.meshgrid(uncertainty.x, uncertainty.y)
    known = np.isfinite(uncertainty.factors)
    nodes = np.column_stack([x[known], y[known]])
    metres = plane * model.net.unit
    if uncertainty.frame == "map":
        metres = (frame.turn_back(np.column_stack([metres, np.zeros(len(metres))])) + frame.origin)[:, :2]
    factor = NearestNDInterpolator(nodes - nodes[0], uncertainty.factors[known])(metres - nodes[0])
    sd = factor * PredictionError(model, posterior(model), uncalibrated()).sd(plane)
    return np.asarray(np.hypot(sd, uncertainty.noise) if of == "contact" else sd)


def _model(surface: HorizonFit) -> Model:
    if surface.model is None:
        raise FitError(
            message(
                "prediction.surface-not-fitted",
                "'{name}' was not fitted here, so its uncertainty between the points is unknown. Fit it first.",
                name=surface.name,
            )
        )
    return surface.model
