"""Bodies whose truth is known, and the holes that find them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.data import BodyData

Floats = NDArray[np.float64]
Truth = Callable[[Floats], Floats]

ORIGIN = np.array([500_000.0, 3_100_000.0, 800.0])
SIZE = 100.0


def ellipsoid(axes: tuple[float, float, float], centre: tuple[float, float, float] = (0, 0, 0)) -> tuple[Truth, float]:
    a, c = np.array(axes), np.array(centre)

    def truth(x: Floats) -> Floats:
        return np.linalg.norm((x - c) / a, axis=1) - 1.0

    return truth, float(4 / 3 * np.pi * a.prod())


def torus(radius: float, tube: float) -> tuple[Truth, float]:
    def truth(x: Floats) -> Floats:
        return np.hypot(np.hypot(x[:, 0], x[:, 1]) - radius, x[:, 2]) - tube

    return truth, 2 * np.pi**2 * radius * tube**2


def pair() -> tuple[Truth, float]:
    (first, v), (second, w) = (
        ellipsoid((0.35, 0.3, 0.3), (-0.5, 0, 0.1)),
        ellipsoid((0.3, 0.35, 0.25), (0.5, 0.1, -0.1)),
    )
    return (lambda x: np.minimum(first(x), second(x))), v + w


def plate(dip: float, thickness: float) -> Truth:
    """Return a square plate of sides 1.2 that dips towards east by so many degrees."""
    turn = np.radians(dip)
    along, across = np.array([np.cos(turn), 0, -np.sin(turn)]), np.array([np.sin(turn), 0, np.cos(turn)])

    def truth(x: Floats) -> Floats:
        return np.max([np.abs(x @ along) - 0.6, np.abs(x[:, 1]) - 0.6, np.abs(x @ across) - thickness / 2], axis=0)

    return truth


def drilled(truth: Truth, seed: int, *, rows: int = 7, step: float = 0.04, named: bool = False) -> BodyData:
    """Return contacts and samples of rows x rows slightly deviated holes through the box [-1, 1]^3, in map metres."""
    rng = np.random.default_rng(seed)
    grid = (np.arange(rows) + 0.5) / rows * 2 - 1
    collars = np.array([(x, y) for x in grid for y in grid]) + rng.uniform(-0.3, 0.3, (rows * rows, 2)) / rows
    parts: dict[str, list[Floats]] = {"contacts": [], "inside": [], "outside": []}
    names: dict[str, list[str]] = {"contacts": [], "inside": [], "outside": []}
    for k, collar in enumerate(collars):
        way = np.append(rng.normal(0, 0.1, 2), -1.0)
        way /= np.linalg.norm(way)
        depth = np.linspace(0, 2 / -way[2], 4001)
        line = np.append(collar, 1.0) + depth[:, None] * way
        value = truth(line)
        for i in np.flatnonzero(np.sign(value[1:]) != np.sign(value[:-1])):
            share = value[i] / (value[i] - value[i + 1])
            parts["contacts"].append(line[i] + share * (line[i + 1] - line[i]))
            names["contacts"].append(f"B{k}")
        samples = np.append(collar, 1.0) + np.arange(step / 2, depth[-1], step)[:, None] * way
        side = truth(samples) < 0
        for name, own in (("inside", samples[side]), ("outside", samples[~side])):
            parts[name] += list(own)
            names[name] += [f"B{k}"] * len(own)
    contacts, inside, outside = (np.array(parts[k]).reshape(-1, 3) * SIZE + ORIGIN for k in parts)
    if not named:
        return BodyData(contacts, inside, outside)
    length = step * SIZE
    return BodyData(
        contacts, inside, outside, None, names["contacts"], names["inside"], names["outside"], length, length
    )
