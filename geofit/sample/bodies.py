"""Rock bodies of the sample site whose every point is known: an ore lens, a karst void, an intrusion with an apophysis.

Each lies in ground of its own below the right or left bank. They are given in the site's axes (s downstream, t towards
the left bank, z up) as functions that are negative inside; see :mod:`geofit.sample.truth`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.messages import message
from geofit.sample.truth import to_map, to_site

__all__ = ["BODIES", "BodyTruth", "body_truth"]

Floats = NDArray[np.float64]

#: Names of the bodies, which are their codes in the log.
BODIES = ("ORE", "VOID", "GABBRO")
#: Cells across the box of a body in which its volume is counted.
CELLS = 160


@dataclass(frozen=True, eq=False)
class BodyTruth:
    """A body of the sample site.

    ``centre`` (3,) and ``half`` (3,) bound it in site axes (s, t, z), metres; ``field`` takes (n, 3) places about that
    centre along these axes and is negative inside.
    """

    name: str
    centre: Floats
    half: Floats
    field: Callable[[Floats], Floats]

    def value(self, xyz: Floats) -> Floats:
        """Return values (n,), negative inside, at (n, 3) places in map coordinates."""
        s, t = to_site(xyz[:, 0], xyz[:, 1])
        return self.field(np.column_stack([s, t, xyz[:, 2]]) - self.centre)

    def to_map(self, local: Floats) -> Floats:
        """Return map coordinates (n, 3) of (n, 3) places about the centre along the site's axes."""
        s, t, z = (local + self.centre).T
        return np.column_stack([*to_map(s, t), z])

    @cached_property
    def volume(self) -> float:
        """Volume in m3, from the cells of a raster; part of a cell counts by its distance from the surface."""
        axes = [(np.arange(CELLS) + 0.5) / CELLS * 2 - 1] * 2
        plane = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
        cell = 2 * self.half / CELLS
        total = 0.0
        for w in axes[0]:
            local = np.column_stack([plane, np.full(len(plane), w)]) * self.half
            step = 1e-3 * np.eye(3)
            value = self.field(local)
            near = np.abs(value) < 4 * cell.max()
            change = np.zeros(len(local))
            for axis in range(3):
                change[near] += np.abs(self.field(local[near] + step[axis]) - value[near]) / 1e-3 * cell[axis]
            total += float(np.clip(0.5 - value / np.maximum(change, 1e-9), 0.0, 1.0).sum())
        return total * float(cell.prod())


def _turned(local: Floats, azimuth: float, dip: float) -> Floats:
    """Return (n, 3) coordinates along strike, down dip and across a plane that dips by ``dip`` towards ``azimuth``.

    The azimuth is measured from s towards t, degrees.
    """
    a, d = np.radians([azimuth, dip])
    down = np.array([np.cos(a) * np.cos(d), np.sin(a) * np.cos(d), -np.sin(d)])
    strike = np.array([-np.sin(a), np.cos(a), 0.0])
    return np.asarray(local @ np.array([strike, down, np.cross(strike, down)]).T)


def _ellipsoid(x: Floats, axes: tuple[float, float, float]) -> Floats:
    """Return about the distance from an ellipsoid."""
    scaled = np.linalg.norm(x / axes, axis=1)
    return np.asarray((scaled - 1.0) * min(axes))


def _ore(local: Floats) -> Floats:
    """Return a lens of 190 x 130 x 34 m that dips by 32 degrees, warped along strike and down dip."""
    x = _turned(local, 60.0, 32.0)
    x[:, 2] -= 7.0 * np.sin(x[:, 0] / 45.0) + 5.0 * np.cos(x[:, 1] / 38.0) - 5.0
    return _ellipsoid(x, (95.0, 65.0, 17.0))


def _void(local: Floats) -> Floats:
    """Return a karst void: a chamber with a passage that rises from it."""
    chamber = _ellipsoid(local, (26.0, 17.0, 12.0))
    first, second = np.array([10.0, 4.0, 2.0]), np.array([44.0, 16.0, 20.0])
    along = second - first
    share = np.clip((local - first) @ along / (along @ along), 0.0, 1.0)
    passage = np.linalg.norm(local - first - share[:, None] * along, axis=1) - (9.0 - 2.0 * share)
    return _joined(chamber, passage, 4.0)


def _gabbro(local: Floats) -> Floats:
    """Return a stock with an apophysis that leaves it sideways and climbs."""
    stock = _ellipsoid(local - np.array([-30.0, 0.0, -10.0]), (62.0, 52.0, 78.0))
    share = np.linspace(0.0, 1.0, 40)
    line = np.column_stack([10.0 + 100.0 * share, 24.0 * np.sin(2.2 * share), 8.0 + 42.0 * share**1.5])
    gaps = np.linalg.norm(local[:, None] - line, axis=2) - (24.0 - 8.0 * share)
    return _joined(stock, gaps.min(axis=1), 10.0)


def _joined(first: Floats, second: Floats, width: float) -> Floats:
    """Return the union of two bodies, its edge rounded within ``width`` metres."""
    share = np.clip(0.5 + 0.5 * (second - first) / width, 0.0, 1.0)
    return np.asarray(second * (1 - share) + first * share - width * share * (1 - share))


_TRUTHS = {
    "ORE": BodyTruth("ORE", np.array([620.0, -300.0, 1480.0]), np.array([90.0, 70.0, 45.0]), _ore),
    "VOID": BodyTruth("VOID", np.array([1330.0, 330.0, 1560.0]), np.array([54.0, 26.0, 30.0]), _void),
    "GABBRO": BodyTruth("GABBRO", np.array([1560.0, -330.0, 1400.0]), np.array([132.0, 58.0, 92.0]), _gabbro),
}


def body_truth(name: str) -> BodyTruth:
    """Return the truth of one body of the sample site.

    Parameters
    ----------
    name : str
        One of :data:`BODIES`.

    Returns
    -------
    BodyTruth
        ``value(xyz)`` is negative at (n, 3) places inside, ``volume`` is in m3.

    Raises
    ------
    SettingsError
        If the site has no such body.

    Examples
    --------
    >>> truth = body_truth("ORE")
    >>> bool(truth.value(truth.to_map(np.zeros((1, 3))))[0] < 0)
    True
    """
    if name not in _TRUTHS:
        raise SettingsError(
            message(
                "sample.body-unknown",
                "The sample site has no body {name!r}; choose one of {names}.",
                name=name,
                names=", ".join(BODIES),
            )
        )
    return _TRUTHS[name]
