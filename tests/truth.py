"""Synthetic truths: horizons whose every elevation is known, sampled as sites are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RBFInterpolator

from geofit import PointSet

Floats = NDArray[np.float64]
Height = Callable[[Floats, Floats], Floats]

#: Where a real dam site lies on its national grid, metres.
EASTING, NORTHING = 5.0e5, 3.1e6


@dataclass(frozen=True)
class Truth:
    """A sampled horizon: its points, its true height, the study area and the core's rectangle in the map."""

    points: PointSet
    height: Height
    area: tuple[float, float, float, float]
    core: tuple[float, float, float, float]

    @property
    def boundary(self) -> Floats:
        x0, x1, y0, y1 = self.area
        return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])

    def places(self, n: int = 10_000, *, core: bool = False, seed: int = 12345) -> Floats:
        """Return (n, 2) places spread evenly over the study area or the core."""
        x0, x1, y0, y1 = self.core if core else self.area
        return np.random.default_rng(seed).uniform((x0, y0), (x1, y1), (n, 2))


def hills(seed: int, size: float = 2000.0, shortest: float = 250.0, relief: float = 25.0) -> Height:
    """Return a smooth random height: a dipping plane and waves whose power falls with the wavelength's cube."""
    rng = np.random.default_rng(seed)
    waves = 60
    length = size * (shortest / size) ** rng.uniform(0, 1, waves)
    azimuth, phase = rng.uniform(0, 2 * np.pi, (2, waves))
    amplitude = (length / size) ** 1.5 * rng.normal(0, 1, waves)
    amplitude *= relief / np.sqrt((amplitude**2).sum() / 2)
    kx, ky = 2 * np.pi / length * np.cos(azimuth), 2 * np.pi / length * np.sin(azimuth)
    dip = rng.normal(0, 0.08, 2)

    def height(x: Floats, y: Floats) -> Floats:
        x, y = np.asarray(x, float) - EASTING, np.asarray(y, float) - NORTHING
        waved = sum(a * np.sin(p * x + q * y + f) for a, p, q, f in zip(amplitude, kx, ky, phase, strict=True))
        return 1500.0 + dip[0] * x + dip[1] * y + waved

    return height


def paper_arrangement(
    seed: int, *, noise: float = 0.05, section_points: int = 40, periphery: int = 157, rotation: float = 0.0
) -> Truth:
    """Return 597 points as in the paper's fig. 3a: a core of 11 sections 60 m apart, the rest left and right.

    Points of a section keep at least 6 m between them; peripheral ones lie at random.
    """
    rng = np.random.default_rng(1000 + seed)
    height = hills(seed)
    size, x0, x1 = 2000.0, 700.0, 1300.0
    xyz, section = [], []
    for i, x in enumerate(np.linspace(x0, x1, 11)):
        gaps = rng.dirichlet(np.ones(section_points + 1)) * (size - 6.0 * (section_points - 1))
        y = np.cumsum(gaps[:-1]) + 6.0 * np.arange(section_points)
        xyz.append(np.column_stack([np.full(section_points, x), y]))
        section += [f"S{i + 1:02d}"] * section_points
    side = np.where(rng.uniform(size=periphery) < 0.5, 0.0, x1 + 60.0)
    xyz.append(np.column_stack([side + rng.uniform(0, x0 - 60.0, periphery), rng.uniform(0, size, periphery)]))
    plan = np.concatenate(xyz) + np.array([EASTING, NORTHING])
    z = height(plan[:, 0], plan[:, 1]) + rng.normal(0, noise, len(plan))
    points = PointSet(
        np.column_stack([plan, z]),
        kind=["section"] * len(section) + ["borehole"] * periphery,
        section=section + [""] * periphery,
        hole=[""] * len(section) + [f"B{i + 1:03d}" for i in range(periphery)],
        row=np.arange(len(plan)) + 2,
    )
    area = (EASTING, EASTING + size, NORTHING, NORTHING + size)
    return Truth(points, height, area, (EASTING + x0, EASTING + x1, NORTHING, NORTHING + size))


def thin_plate(points: PointSet) -> Height:
    """Return scipy's exact thin-plate spline of the deduplicated points, in scaled local coordinates."""
    xy, first = np.unique(points.xyz[:, :2], axis=0, return_index=True)
    centre, scale = xy.mean(axis=0), np.ptp(xy, axis=0).max()
    spline = RBFInterpolator((xy - centre) / scale, points.xyz[first, 2], kernel="thin_plate_spline")

    def height(x: Floats, y: Floats) -> Floats:
        x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
        plan = (np.column_stack([x.ravel(), y.ravel()]) - centre) / scale
        return spline(plan).reshape(x.shape)

    return height


def rms(error: Floats) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(error**2)))


def folded(lines=6, n=40, reverse=(), seed=None, azimuth=0.0):
    """An overturned fold on parallel sections; its truth is known everywhere."""
    xyz, names = [], []
    for i in range(lines):
        t = np.linspace(0, 1, n)
        if seed is not None:
            t = np.sort(np.concatenate([[0, 1], np.random.default_rng(seed + i).uniform(0, 1, n - 2)]))
        line = fold_at(t, np.full(n, 60.0 * i))
        xyz.append(line[::-1] if i in reverse else line)
        names += [f"S{i}"] * n
    c, s = np.cos(azimuth), np.sin(azimuth)
    xyz = np.concatenate(xyz)
    xyz[:, :2] = xyz[:, :2] @ np.array([[c, s], [-s, c]])
    return PointSet(xyz + np.array((EASTING, NORTHING, 500)), section=names, kind="section")


def fold_at(t, y):
    return np.column_stack([150 * t + 130 * np.sin(2 * np.pi * t) + 0.05 * y, y, 220 * t + 6 * np.sin(y / 70)])
