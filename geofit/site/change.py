"""How a horizon moved from one state of a site to the next: a map of the difference, and its figures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.messages import Message, message
from geofit.data.numbers import is_finite, shown
from geofit.data.site import Ground
from geofit.fitting.horizon_fit import HorizonFit
from geofit.sampling.grids import thickness_grid

__all__ = ["HorizonChange", "MovedArea", "horizon_change"]

Floats = NDArray[np.float64]

#: Moved areas that are listed, the largest first.
MOST_AREAS = 12


@dataclass(frozen=True)
class MovedArea:
    """A connected area over which a horizon moved by more than epsilon.

    ``area`` in m2; ``x``, ``y`` where it moved most, and ``most`` by how much there (m, positive upwards); ``mean``
    over the area.
    """

    area: float
    x: float
    y: float
    most: float
    mean: float


@dataclass(frozen=True, eq=False)
class HorizonChange:
    """The later surface minus the earlier one, metres, positive where the horizon is now higher.

    Parameters
    ----------
    name : str
        Name of the horizon.
    epsilon : float
        What counts as moved, metres.
    difference : Ground
        Grid of the difference; nan where either surface is absent.
    mean, rms, most, least : float
        Of the difference over the common area; ``most`` and ``least`` are the extremes. nan without a common area.
    place : (x, y)
        Where the larger of the two extremes is, map coordinates.
    area, moved : float
        The common area, and how much of it moved by more than ``epsilon``, m2.
    only_before, only_after : float
        Area that only one of the surfaces covers, m2.
    areas : tuple of MovedArea
        The connected areas that moved, the largest first, at most 12.
    """

    name: str
    epsilon: float
    difference: Ground
    mean: float
    rms: float
    most: float
    least: float
    place: tuple[float, float]
    area: float
    moved: float
    only_before: float
    only_after: float
    areas: tuple[MovedArea, ...]

    @property
    def largest(self) -> float:
        """The extreme of larger size, metres, with its sign."""
        return self.most if abs(self.most) >= abs(self.least) else self.least

    @property
    def share(self) -> float:
        """Share of the common area that moved by more than epsilon."""
        return self.moved / self.area if self.area else float("nan")

    @property
    def text(self) -> Message:
        """The figures as a sentence."""
        if not self.area:
            return message("site.states-share-no-area", "{name}: the two states share no area", name=self.name)
        return message(
            "site.surface-moved",
            "{name} moved by {mean:+.2f} m on average and {largest:+.2f} m at most; {share:.0%} of its area moved by "
            "more than {epsilon:g} m",
            name=self.name,
            mean=self.mean,
            largest=self.largest,
            share=self.share,
            epsilon=self.epsilon,
        )


def horizon_change(
    before: HorizonFit, after: HorizonFit, epsilon: float | None = None, cell: float | None = None
) -> HorizonChange:
    """Compare two states of a horizon.

    Parameters
    ----------
    before, after : HorizonFit
        The earlier and the later surface, in the same coordinates. Where one lies over a place more than once (an
        overturned fold), its highest elevation counts.
    epsilon : float, optional
        What counts as moved, metres; by default the control error of ``after``.
    cell : float, optional
        Size of the grid's cells, metres; by default about 200 along the longer side.

    Returns
    -------
    HorizonChange

    Raises
    ------
    SettingsError
        If ``epsilon`` is not above 0, or the cell leaves no grid.

    Notes
    -----
    Means and areas are sums by the trapezoidal rule over cells whose four nodes are known. Areas that touch along an
    edge are one.

    Examples
    --------
    >>> import geofit
    >>> xyz = [[x, y, 0.1 * x] for x in range(0, 100, 10) for y in range(0, 100, 10)]
    >>> old = geofit.fit_horizon(geofit.PointSet(xyz))
    >>> new = geofit.fit_horizon(geofit.PointSet([[x, y, z + 2.0] for x, y, z in xyz]))
    >>> round(horizon_change(old, new, epsilon=0.5).mean, 3)
    2.0
    """
    from scipy import ndimage

    limit = after.settings.epsilon if epsilon is None else epsilon
    if not is_finite(limit) or limit <= 0:
        raise SettingsError(
            message("site.epsilon-not-positive", "epsilon is {value}; give metres above 0.", value=shown(limit))
        )
    grid = thickness_grid(after.surface, before.surface, cell)
    d, weight = grid.z, _node_areas(np.isfinite(grid.z), grid)
    only_after, only_before = _only(before, after, grid)
    known = weight > 0
    if not known.any():
        nan = float("nan")
        return HorizonChange(
            after.name, limit, grid, nan, nan, nan, nan, (nan, nan), 0.0, 0.0, only_before, only_after, ()
        )
    size = np.abs(np.where(known, d, 0.0))
    moved = size > limit
    labels, count = ndimage.label(moved)
    areas = [_area(d, np.where(labels == k, weight, 0.0), grid) for k in _largest(labels, weight, count)]
    values, share = d[known], weight[known] / weight.sum()
    j, i = np.unravel_index(int(np.argmax(size)), d.shape)
    return HorizonChange(
        after.name, limit, grid, float(share @ values), float(np.sqrt(share @ values**2)), float(values.max()),
        float(values.min()), (float(grid.x[i]), float(grid.y[j])), float(weight.sum()), float(weight[moved].sum()),
        only_before, only_after, tuple(areas),
    )  # fmt: skip


def _node_areas(known: NDArray[np.bool_], grid: Ground) -> Floats:
    """Return the area that each node represents, m2: a quarter of each cell around it whose nodes are known."""
    whole = known[1:, 1:] & known[1:, :-1] & known[:-1, 1:] & known[:-1, :-1]
    cells = np.zeros(known.shape)
    for rows in (slice(1, None), slice(None, -1)):
        for columns in (slice(1, None), slice(None, -1)):
            cells[rows, columns] += whole
    return np.asarray(cells / 4 * (grid.x[1] - grid.x[0]) * (grid.y[1] - grid.y[0]))


def _largest(labels: NDArray[np.signedinteger], weight: Floats, count: int) -> list[int]:
    areas = np.bincount(labels.ravel(), weight.ravel(), minlength=count + 1)[1:]
    return [int(k) + 1 for k in np.argsort(-areas, kind="stable")[:MOST_AREAS]]


def _area(d: Floats, weight: Floats, grid: Ground) -> MovedArea:
    j, i = np.unravel_index(int(np.argmax(np.where(weight > 0, np.abs(d), -1.0))), d.shape)
    mean = float((weight * np.where(weight > 0, d, 0.0)).sum() / weight.sum())
    return MovedArea(float(weight.sum()), float(grid.x[i]), float(grid.y[j]), float(d[j, i]), mean)


def _only(before: HorizonFit, after: HorizonFit, grid: Ground) -> tuple[float, float]:
    """Return the areas that only the later and only the earlier surface covers, m2: by a grid around both."""
    boxes = np.array([surface.bounds for surface in (before, after)])
    step = float(grid.x[1] - grid.x[0])
    low, high = boxes[:, 0, :2].min(axis=0), boxes[:, 1, :2].max(axis=0)
    x, y = (np.arange(low[k] + step / 2, high[k], step) for k in (0, 1))
    if not len(x) or not len(y):
        return 0.0, 0.0
    here, there = (np.isfinite(surface.elevation(x, y[:, None])) for surface in (after, before))
    return step**2 * int((here & ~there).sum()), step**2 * int((there & ~here).sum())
