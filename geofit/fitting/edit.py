"""Manual edits: one control point moved or weighed, the surface moved to one point (paper, sec. 3.3).

The patches are parts of one tensor-product surface, so a coefficient of the whole net is moved, never a row of one
patch: neighbours move with it, and seams stay as closed and as smooth as they were. Nothing outside the support of
the control points that move is touched, and no change takes the surface off a point that it must meet exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array, diags_array, vstack

from geofit.data.columns import LARGEST
from geofit.data.errors import ExactnessError, FitError
from geofit.data.given import arguments_checked
from geofit.data.messages import Message, message
from geofit.data.numbers import is_finite, shown
from geofit.fitting.assemble import NetPart, divide
from geofit.fitting.edit_words import core_ruled, move_note, moved_aside, require_finite, require_three
from geofit.fitting.model import Model
from geofit.fitting.skin import minimum_norm_correction
from geofit.geometry.projection import project
from geofit.splines.patch import Patch
from geofit.splines.refined import neighbours

if TYPE_CHECKING:
    from geofit.fitting.horizon_fit import HorizonFit


__all__ = ["acted_on", "adjust", "movable", "move_to", "support", "weigh"]

Floats = NDArray[np.float64]

#: Rows of control points along a seam that hold its tangent plane.
TANGENT_ROWS = 2
#: Rows of control points around those that act at a place that may move too where exact points are close.
BEYOND = 2


@arguments_checked
def adjust(
    surface: HorizonFit, patch: str, i: int, j: int, dz: float, aside: Sequence[float] = (0.0, 0.0, 0.0)
) -> HorizonFit:
    """Move one control point, and the check with it.

    Parameters
    ----------
    surface : HorizonFit
        A fit.
    patch : str
        Name of the patch.
    i, j : int
        Row (in u) and column (in v) of the control point in the patch.
    dz : float
        How far it moves along the frame's height, metres: upwards over the map and on a folded surface, along the
        normal of the best plane on a steep one.
    aside : (3,) sequence of float
        A further move in map coordinates, metres; the surface is then a height field no longer.

    Returns
    -------
    HorizonFit
        The changed surface with its own check; ``diagnostics["by_hand"]`` counts the changes.

    Raises
    ------
    FitError
        If there is no such control point, or the surface is not a fit of this session.
    ExactnessError
        If the control point acts on points that the surface must meet exactly.

    Notes
    -----
    Li, Miao, Liu, Wang (2011), sec. 3.3. Only the control point's own knot spans change.
    """
    model = _model(surface)
    require_finite(dz, "dz")
    require_three(aside, "aside")
    index, share = movable(surface, patch, i, j)
    by = model.problem.parametrization.frame.axes @ np.asarray(aside, float)
    by[2] += dz
    return _changed(surface, model.moved(index, by / share), move_note(patch, i, j, dz, aside))


@arguments_checked
def move_to(surface: HorizonFit, point: int | ArrayLike, share: float = 1.0) -> HorizonFit:
    """Pull the surface to a point, by the smallest change of the control points that act there.

    Parameters
    ----------
    surface : HorizonFit
        A fit.
    point : int or (3,) array_like
        Index of one of its points, or a place in map coordinates, metres.
    share : float
        Share of the distance to take away: 1 lets the surface pass through the point.

    Returns
    -------
    HorizonFit
        The changed surface with its own check; exact points stay exact.

    Raises
    ------
    FitError
        If there is no such point, it lies outside the surface, or weights other than 1 act there.
    ExactnessError
        If the points that are met exactly leave no freedom at this place.

    Notes
    -----
    The minimum-norm change of the control points that act at the point, subject to the exact points (Li, Miao, Liu,
    Wang, 2011, sec. 3.3).
    """
    model = _model(surface)
    require_finite(share, "share")
    place, value, name = _target(surface, model, point)
    net, given = model.net, model.problem
    row = net.space.matrix(place / net.unit)
    misfit = share * (value - row @ net.coefficients)
    exact = np.flatnonzero(surface.core)
    if isinstance(point, (int, np.integer)):
        exact = exact[exact != point]
    fixed = csr_array(net.space.matrix(given.parametrization.plane[exact] / net.unit))
    acting = np.zeros(net.space.size, bool)
    acting[row.indices] = True
    _require_movable(model, acting)
    # Beside weights, and where the core is linear across its sections, other control points may not move.
    tied = net.lines is not None or model.aside is not None or any(True for _ in _weighed(model))
    change = _moved_beside(csr_array(row), misfit, fixed, acting)
    wider = 0
    while change is None:
        if tied or wider == BEYOND:
            raise ExactnessError(
                message(
                    "fitting.target-near-exact-points",
                    "The surface cannot be moved to {name}: the exactly interpolated points around it "
                    "({count}) leave no freedom. Exclude the one that is wrong, or fit with core='none'.",
                    name=name,
                    count=int(((fixed * acting.astype(float)).power(2).sum(axis=1) > 0).sum()),
                )
            )
        # Where exact points lie close together, the control points next to those that act have to move too.
        acting, wider = neighbours(net.space, acting), wider + 1
        change = _moved_beside(csr_array(row), misfit, fixed, acting)
    return _changed(
        surface,
        model.with_net(replace(net, coefficients=net.coefficients + change)),
        message(
            "fitting.moved-towards-note",
            "manual edit: moved by {share:.0%} of the distance to {name}",
            share=share,
            name=name,
        ),
    )


def _require_movable(model: Model, acting: NDArray[np.bool_]) -> None:
    """Refuse to move control points of a core that is linear across its sections, or next to weighted ones."""
    if model.net.lines is not None and model.net.frozen[acting].any():
        raise core_ruled()
    if model.aside is not None and model.aside[acting].any():
        raise moved_aside()
    if any(_touches(part, weights, acting, model) for part, weights in _weighed(model)):
        raise FitError(
            message(
                "fitting.weights-act",
                "Control points with weights other than 1 act here. Set their weights to 1 first.",
            )
        )


def _moved_beside(row: csr_array, misfit: Floats, fixed: csr_array, acting: NDArray[np.bool_]) -> Floats | None:
    """Return the least change of the acting control points that takes a misfit away at ``row`` and none at ``fixed``.

    None where there is no freedom for it.
    """
    # Points that the acting control points hardly reach must stay all the same: their rows count alike.
    reached = np.sqrt(np.asarray((fixed * acting.astype(float)).power(2).sum(axis=1)).ravel())
    near = csr_array(diags_array(1 / reached[reached > 0]) @ fixed[reached > 0])
    system = csr_array(vstack([row, near])) if near.shape[0] else row
    wanted = np.concatenate([misfit, np.zeros((near.shape[0], *misfit.shape[1:]))])
    try:
        return minimum_norm_correction(system, wanted, acting)
    except ExactnessError:
        return None


@arguments_checked
def weigh(surface: HorizonFit, patch: str, i: int, j: int, weight: float) -> HorizonFit:
    """Change the weight of a control point of the periphery: above 1 draws the surface towards it.

    Parameters
    ----------
    surface : HorizonFit
        A fit.
    patch : str
        Name of the patch.
    i, j : int
        Row (in u) and column (in v) of the control point in the patch.
    weight : float
        The weight, 0.01 to 100.

    Returns
    -------
    HorizonFit
        The changed surface with its own check.

    Raises
    ------
    FitError
        If there is no such control point, the weight is out of its range, the control point fixes the tangent plane of
        a seam, or the surface is not a fit of this session.
    ExactnessError
        If the control point acts on points that the surface must meet exactly.

    Notes
    -----
    Li, Miao, Liu, Wang (2011), eq. 1.
    """
    model = _model(surface)
    if not is_finite(weight) or not 0.01 <= weight <= 100:
        raise FitError(
            message(
                "fitting.weight-out-of-range",
                "The weight is {weight}; between 0.01 and 100 is needed (1 is neutral).",
                weight=shown(weight),
            )
        )
    part = _part(model, patch)
    index, _ = _coefficient(model, part, i, j)
    whole = model.net.space.knots_u, model.net.space.knots_v
    for k, count, knots, ends in zip((i, j), part.shape, (part.knots_u, part.knots_v), whole, strict=True):
        if (k < TANGENT_ROWS and knots[0] != ends[0]) or (k >= count - TANGENT_ROWS and knots[-1] != ends[-1]):
            text = message(
                "fitting.control-point-on-seam",
                "Control point ({i}, {j}) of patch '{patch}' defines the tangent plane of a seam; its "
                "weight stays 1. Choose one at least {rows} rows away from the seam.",
                i=i,
                j=j,
                patch=patch,
                rows=TANGENT_ROWS,
            )
            raise FitError(text)
    _refuse_exact(surface, model, index, patch, i, j)
    weights = dict(model.weights)
    changed = np.array(weights.get(patch, np.ones(part.shape)))
    changed[i, j] = weight
    weights[patch] = changed
    return _changed(
        surface,
        replace(model, weights=weights),
        message(
            "fitting.control-point-weighted-note",
            "manual edit: control point ({i}, {j}) of patch '{patch}' has weight {weight:g}",
            i=i,
            j=j,
            patch=patch,
            weight=weight,
        ),
    )


def support(surface: HorizonFit, patch: str, i: int, j: int) -> tuple[float, float, float, float]:
    """Return the rectangle (u0, u1, v0, v1) of the frame, metres, outside of which :func:`adjust` moves nothing."""
    model = _model(surface)
    return _support(model, _coefficient(model, _part(model, patch), i, j)[0])


def movable(surface: HorizonFit, patch: str, i: int, j: int) -> tuple[int, float]:
    """Return the coefficient of the net that :func:`adjust` changes, and by which share the control point follows it.

    Raises
    ------
    FitError, ExactnessError
        As :func:`adjust`: why the control point cannot move.
    """
    model = _model(surface)
    index, share = _coefficient(model, _part(model, patch), i, j)
    _refuse_exact(surface, model, index, patch, i, j)
    if model.net.lines is not None and model.net.frozen[index]:
        raise core_ruled()
    return index, share


def acted_on(surface: HorizonFit, patch: str, i: int, j: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which points a control point acts on, (n,), and which of these are met exactly and so forbid its move.

    Raises
    ------
    FitError
        If there is no such control point, or the surface was read from a file.
    """
    model = _model(surface)
    acting = _acting(model, _coefficient(model, _part(model, patch), i, j)[0])
    return acting, acting & _exact(model)


def _model(surface: HorizonFit) -> Model:
    model: Model | None = getattr(surface, "model", None)
    if model is None:
        text = message(
            "fitting.no-common-control-net",
            "'{name}' was read from a file: its patches have no common control net. Fit it again, then adjust.",
            name=surface.name,
        )
        raise FitError(text)
    return model


def _refuse_exact(surface: HorizonFit, model: Model, index: int, patch: str, i: int, j: int) -> None:
    """Refuse a control point that acts on points that are met exactly."""
    held = _acting(model, index) & _exact(model)
    if held.any():
        raise ExactnessError(
            message(
                "fitting.control-point-moves-exact-points",
                "Control point ({i}, {j}) of patch '{patch}' acts on points that are met exactly "
                "({count}: {names}). Choose one that lies farther from them, or exclude them first.",
                i=i,
                j=j,
                patch=patch,
                count=held.sum(),
                names=_names(surface, held),
            )
        )


def _part(model: Model, patch: str) -> NetPart:
    given, net = model.problem, model.net
    parts = divide(net.space, net.core, given.parametrization.frame, given.split.core is not None).parts
    for part in parts:
        if part.name == patch:
            return part
    raise FitError(
        message(
            "fitting.patch-unknown",
            "There is no patch '{patch}'. The patches are: {names}.",
            patch=patch,
            names=", ".join(part.name for part in parts),
        )
    )


def _coefficient(model: Model, part: NetPart, i: int, j: int) -> tuple[int, float]:
    """Return the coefficient of the whole net that moves a patch's control point most, and by which share."""
    rows, columns = part.shape
    whole = all(isinstance(k, (int, np.integer)) for k in (i, j))
    if not (whole and 0 <= i < rows and 0 <= j < columns):
        raise FitError(
            message(
                "fitting.control-point-unknown",
                "Patch '{name}' has control points (0, 0) to ({rows}, {columns}); ({i}, {j}) was given.",
                name=part.name,
                rows=rows - 1,
                columns=columns - 1,
                i=shown(i),
                j=shown(j),
            )
        )
    given, net = model.problem, model.net
    division = divide(net.space, net.core, given.parametrization.frame, given.split.core is not None)
    return division.acting_most(part, int(i), int(j))


def _support(model: Model, index: int) -> tuple[float, float, float, float]:
    unit = model.net.unit
    u0, u1, v0, v1 = model.net.space.support(index)
    return u0 * unit, u1 * unit, v0 * unit, v1 * unit


def _acting(model: Model, index: int) -> NDArray[np.bool_]:
    """Return which points a coefficient acts on, (n,)."""
    plane, net = model.problem.parametrization.plane, model.net
    u0, u1, v0, v1 = _support(model, index)
    # Inside it acts; on its edge it does at the surface's own edge only.
    acting = (plane[:, 0] >= u0) & (plane[:, 0] <= u1) & (plane[:, 1] >= v0) & (plane[:, 1] <= v1)
    near = np.flatnonzero(acting)
    acting[near] = net.space.matrix(plane[near] / net.unit)[:, [index]].toarray().ravel() != 0
    return acting


def _exact(model: Model) -> NDArray[np.bool_]:
    return model.problem.split.inside & model.problem.kept


def _weighed(model: Model) -> list[tuple[NetPart, Floats]]:
    return [(_part(model, name), weights) for name, weights in model.weights.items()]


def _touches(part: NetPart, weights: Floats, acting: NDArray[np.bool_], model: Model) -> bool:
    """Tell whether a weight other than 1 belongs to one of the coefficients."""
    return any(acting[_coefficient(model, part, int(i), int(j))[0]] for i, j in np.argwhere(weights != 1))


def _names(surface: HorizonFit, which: NDArray[np.bool_]) -> tuple[Message | str, ...]:
    """Name the first of some points."""
    first = [surface.points.describe(int(i)) for i in np.flatnonzero(which)[:2]]
    return tuple([*first, "..."] if which.sum() > 2 else first)


def _target(surface: HorizonFit, model: Model, point: int | ArrayLike) -> tuple[Floats, Floats, Message]:
    """Return the place (1, 2) on the parametrization, the value (1,) or (1, 3) wanted there, and what to call it."""
    parametrization = model.problem.parametrization
    if isinstance(point, (int, np.integer)) and not isinstance(point, bool):
        if not 0 <= point < len(surface.points):
            raise FitError(
                message(
                    "fitting.point-unknown",
                    "'{name}' has points 0 to {last}; {point} was given.",
                    name=surface.name,
                    last=len(surface.points) - 1,
                    point=point,
                )
            )
        only = np.array([point])
        return parametrization.plane[only], parametrization.values[only], surface.points.describe(int(point))
    try:
        xyz = np.asarray(point, float)
    except (TypeError, ValueError, OverflowError):
        xyz = np.empty(0)
    if xyz.shape != (3,) or not (np.abs(xyz) <= LARGEST).all():
        raise FitError(
            message(
                "fitting.target-not-finite",
                "The point is {point}; three map coordinates (easting, northing, elevation) up to {most:.0e} m are "
                "needed.",
                point=shown(point),
                most=LARGEST,
            )
        )
    x, y, z = xyz
    name = message("fitting.place-coordinates", "({x:.2f}, {y:.2f}, {z:.2f})", x=x, y=y, z=z)
    if parametrization.parametric:
        foot = project(_plain(surface.patches), xyz[None] - surface.origin)
        return np.column_stack([foot.u, foot.v]), xyz[None] - surface.origin, name
    local = parametrization.frame.to_local(xyz[None])
    u0, u1, v0, v1 = parametrization.area
    if not (u0 <= local[0, 0] <= u1 and v0 <= local[0, 1] <= v1):
        text = message(
            "fitting.point-off-surface",
            "The point {point} is not above or below the surface '{name}'. Choose a place above or below it.",
            point=name,
            name=surface.name,
        )
        raise FitError(text)
    return local[:, :2], local[:, 2], name


def _plain(patches: tuple[Patch, ...]) -> tuple[Patch, ...]:
    return tuple(replace(patch, weights=None) for patch in patches)


def _changed(fit: HorizonFit, model: Model, note: Message) -> HorizonFit:
    result = fit.refitted(model)
    before, after = fit.accuracy, result.accuracy
    assert before is not None
    assert after is not None
    figures = {**result.diagnostics, "by_hand": fit.diagnostics.get("by_hand", 0) + 1}
    return result.with_(diagnostics=figures, accuracy=replace(after, notes=(*before.notes, note)))
