"""Two surfaces closed to a body: the ground of a survey above a common base, or a horizon above another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.data.site import Ground
from geofit.implicit.field import Box, points_of
from geofit.morphing.columns import RockColumns, heights
from geofit.morphing.errors import MorphError
from geofit.surfaces.protocol import HasElevation

if TYPE_CHECKING:
    from scipy.interpolate import RectBivariateSpline

__all__ = ["BetweenSurfaces", "between"]

Floats = NDArray[np.float64]

#: Cells of the raster along the longer side of the area by default, and the most.
CELLS, MOST = 200, 4000


@arguments_checked
@dataclass(frozen=True, eq=False)
class BetweenSurfaces:
    """The body below one surface and above another, within an area; a field about ``origin``, negative inside.

    Parameters
    ----------
    name : str
        Name.
    origin : (3,) array
        Map coordinates of the local origin, metres.
    upper, lower : RectBivariateSpline
        Elevations above the origin over x and y about it.
    edge : RectBivariateSpline
        Distance in plan from the edge of the area that both surfaces reach, negative within it.
    box : pair of (3,) arrays
        Box of the body about the origin.
    ground : RectBivariateSpline or None
        Elevation of the ground as those of the surfaces: above it there is nothing. None if none was given.
    """

    name: str
    origin: Floats
    upper: RectBivariateSpline
    lower: RectBivariateSpline
    edge: RectBivariateSpline
    box: Box
    ground: RectBivariateSpline | None = None

    @property
    def field(self) -> BetweenSurfaces:
        """The field itself: it is about ``origin``."""
        return self

    @property
    def bounds(self) -> Box:
        """Box of the body about the origin."""
        return self.box

    @property
    def lipschitz(self) -> float:
        """No bound is known."""
        return float("inf")

    def value(self, xyz: Floats) -> Floats:
        """Return the field (n,) at (n, 3) places about the origin: about the distance, metres."""
        return np.asarray(self._parts(xyz)[0].max(axis=0))

    def gradient(self, xyz: Floats) -> Floats:
        """Return the gradients (n, 3) of the face that is nearest."""
        values, gradients = self._parts(xyz)
        return np.asarray(np.take_along_axis(gradients, values.argmax(axis=0)[None, :, None], axis=0)[0])

    def _parts(self, xyz: Floats) -> tuple[Floats, Floats]:
        xyz, (low, high) = points_of(xyz), self.box
        x, y = (np.clip(xyz[:, k], low[k], high[k]) for k in (0, 1))
        beyond = np.hypot(xyz[:, 0] - x, xyz[:, 1] - y)
        values, gradients = [], []
        for surface, sign in ((self.upper, 1.0), (self.lower, -1.0), (self.ground, 1.0)):
            if surface is None:
                continue
            sx, sy = surface(x, y, dx=1, grid=False), surface(x, y, dy=1, grid=False)
            length = np.sqrt(1 + sx**2 + sy**2)
            values.append(sign * (xyz[:, 2] - surface(x, y, grid=False)) / length)
            gradients.append(sign * np.stack([-sx, -sy, np.ones_like(sx)], axis=1) / length[:, None])
        values.append(self.edge(x, y, grid=False) + beyond)
        ex, ey = self.edge(x, y, dx=1, grid=False), self.edge(x, y, dy=1, grid=False)
        gradients.append(np.stack([ex, ey, np.zeros_like(ex)], axis=1))
        return np.array(values), np.array(gradients)


@arguments_checked
def between(
    upper: HasElevation | float,
    lower: HasElevation | float,
    *,
    area: ArrayLike | None = None,
    spacing: float | None = None,
    name: str = "",
    ground: Ground | HasElevation | None = None,
) -> BetweenSurfaces:
    """Return the body between two surfaces: a horizon, ground or survey above a common base.

    Parameters
    ----------
    upper, lower : surface or float
        Anything with ``elevation(x, y)`` in map coordinates, nan where it does not reach, or one elevation in metres.
        Where ``upper`` lies below ``lower`` there is no body.
    area : (2, 2) array_like, optional
        Corners ((west, south), (east, north)) in map coordinates, metres; by default the common box of the surfaces.
    spacing : float, optional
        Of the raster on which the surfaces are taken, metres; by default 1/200 of the longer side.
    name : str
        Name of the body.
    ground : Ground or surface, optional
        The ground, above which there is nothing of the body; where it is not known (nan) it ends nothing.

    Returns
    -------
    BetweenSurfaces
        A body for :func:`geofit.morph`: it ends upright at the edge of the area that both surfaces reach.

    Raises
    ------
    SettingsError
        If the area is not known, or the raster too fine.
    MorphError
        If the upper surface lies nowhere above the lower one, below the ground.

    Notes
    -----
    The field is the largest of the distances from the surfaces, to first order, and from the edge in plan:
    ``docs/morph.md``.
    """
    low, high = _area(upper, lower, area)
    size = float((high - low).max())
    h = size / CELLS if spacing is None else float(spacing)
    if not (np.isfinite(h) and h > 0) or size / h > MOST:
        raise SettingsError(
            message(
                "morphing.raster-spacing-unusable",
                "A raster of {spacing} m cannot be used for an area {size:.1f} m wide: give {least:.3g} m or more.",
                spacing=spacing,
                size=size,
                least=size / MOST,
            )
        )
    counts = np.maximum(np.ceil((high - low) / h - 1e-9).astype(int) + 1, 4)
    x, y = (np.linspace(low[k], high[k], counts[k]) for k in (0, 1))
    a, b = np.meshgrid(x, y, indexing="ij")
    levels = [heights(surface, a, b) for surface in (upper, lower)]
    top, base = RockColumns(upper, lower, ground)(a, b)
    reached = np.isfinite(top) & np.isfinite(base)
    thick = reached & (top > base)
    if not thick.any():
        if ground is not None and (reached & (levels[0] > levels[1])).any():
            raise MorphError(
                message(
                    "morphing.no-thickness-below-ground",
                    "Below the ground the upper surface lies nowhere above the lower one.",
                )
            )
        raise MorphError(message("morphing.no-thickness", "The upper surface lies nowhere above the lower one."))
    tops, bases = top[thick], base[thick]
    origin = np.array([*np.round((low + high) / 2, -1), np.round((tops.max() + bases.min()) / 2)])
    if ground is not None:
        levels.append(_known(heights(ground, a, b), levels[0]))
    return _body(x, y, levels, reached, origin, (bases.min(), tops.max()), name)


def _known(ground: Floats, upper: Floats) -> Floats:
    """Return the ground with nodes where it is not known raised above the upper surface: there it ends nothing."""
    from scipy.ndimage import distance_transform_edt

    unknown = ~np.isfinite(ground)
    if not unknown.any():
        return ground
    if unknown.all():
        return np.full(ground.shape, np.nanmax(upper) + 1.0)
    nearest = distance_transform_edt(unknown, return_distances=False, return_indices=True)
    return np.where(unknown, np.fmax(ground[tuple(nearest)], upper + 1.0), ground)


def _body(
    x: Floats, y: Floats, levels: list[Floats], reached: NDArray[np.bool_], origin: Floats,
    span: tuple[float, float], name: str,
) -> BetweenSurfaces:  # fmt: skip
    from scipy.interpolate import RectBivariateSpline
    from scipy.ndimage import distance_transform_edt

    step = (x[1] - x[0], y[1] - y[0])
    padded = np.pad(reached, 1)
    inward = distance_transform_edt(padded, sampling=step)[1:-1, 1:-1]
    outward, nearest = distance_transform_edt(~reached, sampling=step, return_indices=True)
    # The edge is at the last reached node, half a cell within the next one.
    edge = np.where(reached, -(inward - min(step)), outward)
    across, along = x - origin[0], y - origin[1]
    splines = [RectBivariateSpline(across, along, level[tuple(nearest)] - origin[2], kx=3, ky=3) for level in levels]
    low = np.array([across[0], along[0], span[0] - origin[2]])
    high = np.array([across[-1], along[-1], span[1] - origin[2]])
    rim = RectBivariateSpline(across, along, edge, kx=2, ky=2)
    return BetweenSurfaces(name, origin, splines[0], splines[1], rim, (low, high), *splines[2:])


def _area(upper: Any, lower: Any, area: ArrayLike | None) -> tuple[Floats, Floats]:
    if area is not None:
        corners = np.asarray(area, float)
        if corners.shape == (2, 2) and np.isfinite(corners).all() and (corners[0] < corners[1]).all():
            return corners[0], corners[1]
    else:
        boxes = [np.asarray(surface.bounds, float)[:, :2] for surface in (upper, lower) if hasattr(surface, "bounds")]
        if boxes:
            low, high = np.max([box[0] for box in boxes], axis=0), np.min([box[1] for box in boxes], axis=0)
            if (low < high).all():
                return low, high
    raise SettingsError(
        message(
            "morphing.area-unknown",
            "The area of the body is not known: give area=((west, south), (east, north)) in metres, or surfaces whose "
            "boxes overlap.",
        )
    )
