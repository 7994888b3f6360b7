"""What moving a control point would do, fast enough to follow a hand (paper, sec. 3.3).

Only the knot spans that the control point acts on are evaluated: they are cut out of the surface once, their control
points are linear in the move, and only the points that may have their foot there are measured again. The figures are
those of :func:`geofit.fitting.edit.adjust`, to rounding; the other checks wait for it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.checks.check import sigma
from geofit.data.errors import FitError
from geofit.data.messages import message
from geofit.fitting.assemble import divide, flattened, patches_of
from geofit.fitting.edit import movable, support
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.model import Model
from geofit.geometry.projection import Projection, project
from geofit.splines.patch import Patch

__all__ = ["MoveEffect", "MovePreview", "preview_move"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Knot spans around those that change, in which a foot point may slide without leaving what is evaluated.
MARGIN = 2
#: No move aside.
STILL = (0.0, 0.0, 0.0)
#: Metres within which two distances are one.
ONE = 1e-9


@dataclass(frozen=True, eq=False)
class MoveEffect:
    """The deviations after a move of ``dz`` metres along the height, and of ``aside`` in map coordinates.

    ``residuals`` (n,) signed orthogonal distances, metres, of which ``changed`` differ from before; ``sigma`` (eq. 3)
    and ``max_abs`` in metres; ``beyond`` points lie farther than the control error.
    """

    dz: float
    residuals: Floats
    sigma: float
    max_abs: float
    beyond: int
    changed: int
    aside: Sequence[float] = STILL


@dataclass(frozen=True, eq=False)
class MovePreview:
    """A control point that can move; made by :func:`preview_move`.

    Parameters
    ----------
    surface : HorizonFit
        The checked fit.
    patch, i, j
        Name of the patch, row and column of the control point.
    index, share
        The coefficient of the whole net that is changed, and how far the control point follows it.
    place : (3,) array
        Where the control point is, map coordinates, metres.
    way : (3,) array
        Unit vector along which it moves: upwards over the map, across the best plane on a steep surface.
    support : (u0, u1, v0, v1)
        Rectangle of the parameters, metres, outside of which nothing changes.
    """

    surface: HorizonFit
    patch: str
    i: int
    j: int
    index: int
    share: float
    place: Floats
    way: Floats
    support: tuple[float, float, float, float]

    def effect(self, dz: float, aside: Sequence[float] = STILL) -> MoveEffect:
        """Return the deviations with the control point moved by ``dz`` metres, and aside in map coordinates."""
        accuracy = self.surface.accuracy
        assert accuracy is not None
        residuals = accuracy.residuals.copy()
        if any(aside):
            rows = self._within_reach(float(np.linalg.norm(aside)))
            residuals[rows] = self._project(self._whole(dz, aside), rows).distance
        else:
            rows = self._near[0]
            if len(rows):
                residuals[rows] = self._distances(dz, *self._near)
        size = np.abs(residuals)
        return MoveEffect(
            dz=dz,
            residuals=residuals,
            sigma=sigma(residuals),
            max_abs=float(size.max(initial=0.0)),
            beyond=int((size > accuracy.epsilon).sum()),
            changed=int((np.abs(residuals[rows] - accuracy.residuals[rows]) > ONE).sum()),
            aside=aside,
        )

    def vector(self, dz: float, aside: Sequence[float] = STILL) -> Floats:
        """Return the move (3,) in map coordinates."""
        return np.asarray(dz * self.way + np.asarray(aside, float))

    def shares(self, xyz: ArrayLike) -> Floats:
        """Return by how many metres the surface at (n, 3) map coordinates moves for a move of one metre, (n,)."""
        return self._basis(self.parameters(xyz))

    def parameters(self, xyz: ArrayLike) -> Floats:
        """Return the parameters (n, 2) of places on the surface, (n, 3) map coordinates, metres."""
        parametrization, xyz = self._model.problem.parametrization, np.asarray(xyz, float).reshape(-1, 3)
        if not parametrization.parametric and self._model.aside is None:
            return parametrization.frame.to_local(xyz)[:, :2]
        found = project(self.surface.patches, xyz - self.surface.origin)
        return np.column_stack([found.u, found.v])

    def control_shares(self) -> tuple[Floats, ...]:
        """Return by how many metres each patch's control points (nu, nv) move for a move of one metre."""
        net, given = self._model.net, self._model.problem
        whole = divide(net.space, net.core, given.parametrization.frame, given.split.core is not None)
        unit = np.zeros(net.space.size)
        unit[self.index] = 1 / self.share
        parts = {part.name: whole.coefficients(part, unit).reshape(part.shape) for part in whole.parts}
        return tuple(
            parts[one.name] if parts[one.name].shape == one.control.shape[:2] else np.zeros(one.control.shape[:2])
            for one in self.surface.patches
        )

    def rim(self, dz: float, aside: Sequence[float] = STILL, steps: int = 24) -> Floats:
        """Return the border of what moves, a closed line (4 * steps + 1, 3) in map coordinates, metres."""
        u0, u1, v0, v1 = self._within(self.support)
        along = np.linspace(0.0, 1.0, steps + 1)[:-1]
        u = np.concatenate([u0 + (u1 - u0) * along, np.full(steps, u1), u1 - (u1 - u0) * along, np.full(steps, u0)])
        v = np.concatenate([np.full(steps, v0), v0 + (v1 - v0) * along, np.full(steps, v1), v1 - (v1 - v0) * along])
        plane = np.column_stack([np.append(u, u0), np.append(v, v0)])
        return self._places(plane) + self._basis(plane)[:, None] * self.vector(dz, aside)

    @property
    def _model(self) -> Model:
        assert self.surface.model is not None
        return self.surface.model

    def _places(self, plane: Floats) -> Floats:
        """Return the places (n, 3) on the unmoved surface at (n, 2) parameters, map coordinates."""
        net, frame = self._model.net, self._model.problem.parametrization.frame
        value = net.space.matrix(plane / net.unit) @ net.coefficients
        if self._model.aside is not None:
            plane = plane + net.space.matrix(plane / net.unit) @ self._model.aside
        local = value if value.ndim == 2 else np.column_stack([plane, value])
        return np.asarray(frame.turn_back(local) + self.surface.origin)

    def _within(self, area: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
        """Return the part of a rectangle that the surface has."""
        space, unit = self._model.net.space, self._model.net.unit
        (a, b), (c, d) = (unit * knots[[0, -1]] for knots in (space.knots_u, space.knots_v))
        u0, u1, v0, v1 = area
        return max(u0, float(a)), min(u1, float(b)), max(v0, float(c)), min(v1, float(d))

    def _basis(self, plane: Floats) -> Floats:
        """Return the moving B-spline at (n, 2) parameters, counted for a move of one metre of the control point."""
        net = self._model.net
        u0, u1, v0, v1 = self._within(self.support)
        inside = (plane[:, 0] >= u0) & (plane[:, 0] <= u1) & (plane[:, 1] >= v0) & (plane[:, 1] <= v1)
        share = np.zeros(len(plane))
        rows = net.space.matrix(plane[inside] / net.unit)
        share[inside] = rows[:, [self.index]].toarray().ravel() / self.share
        return share

    @cached_property
    def _region(self) -> tuple[Patch, Floats] | None:
        """What is evaluated of a height field: a patch with the knot spans that move, and how its control points move.

        None where the surface is none, or where the net alone is not the surface: patches have weights, or the core is
        linear across its sections.
        """
        model, net = self._model, self._model.net
        if model.weights or net.lines is not None or model.problem.parametrization.parametric:
            return None
        if model.aside is not None:
            return None
        support, frame, border = net.space.support(self.index), model.problem.parametrization.frame, []
        space, before = flattened(net.space, net.coefficients)
        _, after = flattened(net.space, self._moved(1.0).control())
        for knots, low, high in ((space.knots_u, *support[:2]), (space.knots_v, *support[2:])):
            breaks = np.unique(knots)
            first, last = np.searchsorted(breaks, (low, high)).tolist()
            border += [float(breaks[max(first - MARGIN, 0)]), float(breaks[min(last + MARGIN, len(breaks) - 1)])]
        area = (border[0], border[1], border[2], border[3])
        still, other = (patches_of(space, c, area, frame, net.unit)[0] for c in (before, after))
        return still, other.control - still.control

    @cached_property
    def _near(self) -> tuple[Ints, Bools, Floats]:
        """Which points may have their foot in the region, (k,); which have it there now; and how far its border is.

        Feet across the border are at least that far away, metres, because no surface is nearer than its plan.
        """
        d = self._before
        if self._region is None:
            return np.arange(len(d)), np.ones(len(d), bool), np.full(len(d), np.inf)
        patch = self._region[0]
        u0, u1, v0, v1 = patch.domain
        low, high = np.array([u0, v0]), np.array([u1, v1])
        place = self._model.problem.parametrization.frame.to_local(self.surface.points.xyz)[:, :2]
        beside = np.linalg.norm(np.maximum(np.maximum(low - place, place - high), 0.0), axis=1)
        rows = np.flatnonzero(beside <= np.abs(d) + ONE)
        knots = self._model.net.space.knots_u, self._model.net.space.knots_v
        ends = np.array([k[[0, -1]] for k in knots]) * self._model.net.unit
        sides = (place[rows] - low, low > ends[:, 0]), (high - place[rows], high < ends[:, 1])
        room = np.min([np.where(goes_on, apart, np.inf).min(axis=1) for apart, goes_on in sides], axis=0)
        here = np.abs(self._project((patch,), rows).distance) <= np.abs(d[rows]) + ONE
        return rows, here, np.maximum(room, 0.0)

    def _within_reach(self, aside: float) -> Ints:
        """Return which points may have their foot on what moves when it is moved aside by so many metres, (k,)."""
        if self._region is None:
            return np.arange(len(self._before))
        u0, u1, v0, v1 = self._region[0].domain
        place = self._model.problem.parametrization.frame.to_local(self.surface.points.xyz)[:, :2]
        off = np.maximum(np.maximum([u0, v0] - place, place - [u1, v1]), 0.0)
        return np.flatnonzero(np.linalg.norm(off, axis=1) <= np.abs(self._before) + aside + ONE)

    def _distances(self, dz: float, rows: Ints, here: Bools, room: Floats) -> Floats:
        """Return the signed distances of the points of :meth:`_near` after a move."""
        if self._region is None:
            return self._project(self._whole(dz), rows).distance
        patch, change = self._region
        distance = self._project((replace(patch, control=patch.control + dz * change),), rows).distance
        # Elsewhere the surface is as it was: a foot there stays, unless what moves came nearer.
        stay = ~here & (np.abs(self._before[rows]) <= np.abs(distance))
        distance = np.where(stay, self._before[rows], distance)
        away = here & (np.abs(distance) > room)
        if away.any():
            distance[away] = self._project(self._whole(dz), rows[away]).distance
        return np.asarray(distance)

    @property
    def _before(self) -> Floats:
        assert self.surface.accuracy is not None
        return self.surface.accuracy.residuals

    def _moved(self, dz: float, aside: Sequence[float] = STILL) -> Model:
        by = self._model.problem.parametrization.frame.axes @ np.asarray(aside, float)
        by[2] += dz
        return self._model.moved(self.index, by / self.share)

    def _whole(self, dz: float, aside: Sequence[float] = STILL) -> tuple[Patch, ...]:
        """Return all patches after a move."""
        return self._moved(dz, aside).patches()

    def _project(self, patches: tuple[Patch, ...], rows: Ints) -> Projection:
        if not len(rows):
            return Projection.unknown(0)
        return project(patches, self.surface.points.xyz[rows] - self.surface.origin)


def preview_move(surface: HorizonFit, patch: str, i: int, j: int) -> MovePreview:
    """Get ready to follow a control point while it moves.

    Parameters
    ----------
    surface : HorizonFit
        A checked fit.
    patch : str
        Name of the patch.
    i, j : int
        Row (in u) and column (in v) of the control point in the patch.

    Returns
    -------
    MovePreview
        Its ``effect(dz)`` has the figures that :func:`geofit.fitting.edit.adjust` would have.

    Raises
    ------
    FitError
        If there is no such control point, or the surface is not a checked fit of this session.
    ExactnessError
        If the control point acts on points that the surface must meet exactly.

    Notes
    -----
    Li, Miao, Liu, Wang (2011), sec. 3.3.
    """
    index, share = movable(surface, patch, i, j)
    assert surface.model is not None
    if surface.accuracy is None:
        text = message("fitting.fit-not-checked", "'{name}' has not been checked. Check it first.", name=surface.name)
        raise FitError(text)
    control = next(one for one in surface.patches if one.name == patch).control
    return MovePreview(
        surface=surface,
        patch=patch,
        i=i,
        j=j,
        index=index,
        share=share,
        place=np.asarray(control[i, j] + surface.origin),
        way=np.asarray(surface.model.problem.parametrization.frame.axes[2]),
        support=support(surface, patch, i, j),
    )
