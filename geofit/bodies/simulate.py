"""The spread of a body's volume: fields that honour the same data, each as likely as the fitted one.

Conditional simulation (Chilès & Delfiner, *Geostatistics*, 2nd ed. 2012, ch. 7): the part of the field that the data
leave open is drawn at knots near the surface from its covariance and carried to a raster by kriging.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.active import farthest_apart
from geofit.bodies.posterior import BodyPosterior
from geofit.bodies.rbf import Saddle, rows_of
from geofit.streaming.executors import HERE, Where

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["BodyVolumes", "Draws", "changes", "draws", "simulate", "volumes_of"]

Floats = NDArray[np.float64]

#: Cells of the raster along the longest side, knots at which the field is drawn, samples that a draw must honour.
CELLS = 40
KNOTS = 500
GUARDS = 150
#: Places farther from the surface than this many standard deviations keep their side.
FAR = 3.5
CORRECTIONS = 12
#: Nodes of the raster, those nearest to the surface, that a draw may reach.
REACHED = 15_000


@dataclass(frozen=True, eq=False)
class BodyVolumes:
    """Volumes of a body in m3.

    ``p10``, ``p50`` and ``p90``: 10, 50 and 90 % of the realizations are smaller. ``best`` is the volume of the fitted
    body and ``error`` its numerical error (:attr:`geofit.BodyFit.size`), ``mean`` and ``sd`` are over the realizations,
    ``values`` (n,) are their volumes. Their spread contains the numerical error as one more standard deviation.

    With fewer than 9 contacts P10 to P90 is too narrow: it contained a third of the volumes of planted ellipsoids
    drilled by 3 x 3 to 5 x 5 holes. The notes of the body's accuracy then include a warning.
    """

    p10: float
    p50: float
    p90: float
    best: float
    mean: float
    sd: float
    values: Floats
    error: float = 0.0


@dataclass(frozen=True, eq=False)
class Draws:
    """Conditional simulations of a body on the cells of a raster that they may reach.

    ``places`` (n, 3) are the middles of the cells in map coordinates; ``changes`` (n, realizations) is what each
    simulation adds to the volume in each cell, m3.
    """

    places: Floats
    changes: Floats


def simulate(body: BodyFit, where: Where = HERE) -> BodyVolumes:
    """Return the volumes of ``settings.realizations`` conditional simulations of a body."""
    size = body.size
    return volumes_of(size.volume, draws(body, where).changes.sum(axis=0), size.volume_error)


def draws(body: BodyFit, where: Where = HERE) -> Draws:
    """Return ``settings.realizations`` conditional simulations of a body, kriged ``where`` it is said."""
    posterior = BodyPosterior(body)
    rng = np.random.default_rng(body.settings.seed)
    nodes, counts, spacing = _nodes(body)
    whole = body.field.value(nodes - body.origin)
    # The nearest ones only: no draw reaches the others, and each variance costs the square of the data.
    nearest = np.argsort(np.abs(whole), kind="stable")[:REACHED]
    deviation = posterior.spread * posterior.deviation(nodes[nearest])
    width = np.maximum(np.linalg.norm(body.field.gradient(nodes[nearest] - body.origin), axis=1) * spacing, 1e-300)
    # Also the cells that the surface crosses, however well it is known.
    open_, crossed = np.abs(whole[nearest]) < FAR * deviation, np.abs(whole[nearest]) < width / 2
    near = nearest[open_ | crossed]
    value, width, deviation = whole[near], width[open_ | crossed], deviation[open_ | crossed]
    fitted = body.field.frame.to_fit(nodes[near])
    knots = _first_knots(fitted, np.maximum(np.abs(value) - width / 2, 0.0), deviation)
    change = changes(body, posterior, fitted[knots], fitted, rng, where)
    supported = np.union1d(np.flatnonzero(whole < 0), _next_to_data(body, nodes))
    base = np.clip(0.5 - value / width, 0.0, 1.0)
    # In place: with many cells the array is the largest one of a simulation.
    for k in range(change.shape[1]):
        drawn = value + change[:, k]
        share = np.clip(0.5 - drawn / width, 0.0, 1.0)
        share[_islands(whole, near, drawn, counts, supported)] = 0.0
        change[:, k] = spacing**3 * (share - base)
    return Draws(nodes[near], change)


def _next_to_data(body: BodyFit, nodes: Floats) -> NDArray[np.int64]:
    """Return the nodes next to contacts and inside samples."""
    from scipy.spatial import cKDTree

    prepared = body.fitted.prepared
    data = np.concatenate([prepared.contacts, prepared.inside]) - body.origin
    return np.unique(np.asarray(cKDTree(nodes - body.origin).query(data, k=min(8, len(nodes)))[1]))


def _islands(
    whole: Floats, near: NDArray[np.int64], drawn: Floats, counts: NDArray[np.int64], supported: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Return which of the nodes near the surface a draw puts into a part that holds no ``supported`` node.

    Such a part is met by no data, nor is it of the fitted body: a fit closes what no data support, too.
    """
    from scipy.ndimage import label

    inside = whole < 0
    inside[near] = drawn < 0
    parts = label(inside.reshape(counts), np.ones((3, 3, 3)))[0].ravel()
    kept = np.zeros(parts.max() + 1, bool)
    kept[parts[supported]] = True
    return np.asarray(inside[near] & ~kept[parts[near]])


def volumes_of(best: float, change: Floats, error: float = 0.0) -> BodyVolumes:
    """Return the volumes of a fitted volume with its numerical error and of what each simulation (n,) adds, m3."""
    # A draw that swells gains more than one that shrinks loses, so draws are larger than the fitted body on average.
    # On planted bodies the fitted body is the one without bias: it stays the middle.
    values = np.maximum(best + change, 0.0)
    middle = float(np.median(values))
    if middle > 0:
        values *= best / middle
    values = np.maximum(_with_error(values, best, error), 0.0)
    p10, p50, p90 = np.quantile(values, [0.1, 0.5, 0.9]).tolist()
    values.setflags(write=False)
    return BodyVolumes(p10, p50, p90, best, float(values.mean()), float(values.std(ddof=1)), values, error)


def _with_error(values: Floats, best: float, error: float) -> Floats:
    """Return volumes (n,) spread about the best one so that their variance has that of its numerical error, too."""
    from scipy.special import ndtri

    sd = float(values.std(ddof=1))
    if sd > 0:
        return np.asarray(best + (values - best) * np.hypot(1.0, error / sd))
    return np.asarray(best + error * ndtri((np.arange(len(values)) + 0.5) / len(values)))


def _nodes(body: BodyFit) -> tuple[Floats, NDArray[np.int64], float]:
    """Return raster nodes (n, 3) around the body in map coordinates, their counts along the axes, their distance."""
    lower, upper = body.extent
    margin = body.region.reach / 2
    lower, upper = np.maximum(lower - margin, body.field.lower), np.minimum(upper + margin, body.field.upper)
    spacing = float((upper - lower).max()) / CELLS
    counts = np.maximum(((upper - lower) / spacing).astype(int), 1)
    axes = [lower[a] + (np.arange(counts[a]) + 0.5) * (upper - lower)[a] / counts[a] for a in range(3)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    volume = float(((upper - lower) / counts).prod())
    return nodes + body.origin, counts, volume ** (1 / 3)


def _first_knots(fitted: Floats, value: Floats, deviation: Floats) -> NDArray[np.int64]:
    """Return the nodes at which the field is drawn: spread over those whose side is open."""
    doubt = np.flatnonzero(np.abs(value) < 2.5 * deviation)
    return np.asarray(doubt[farthest_apart(fitted[doubt], min(KNOTS, len(doubt)))] if len(doubt) else doubt)


def changes(
    body: BodyFit,
    posterior: BodyPosterior,
    knots: Floats,
    places: Floats,
    rng: np.random.Generator,
    where: Where = HERE,
) -> Floats:
    """Return what each realization adds to the field, (n, realizations), at (n, 3) fitted places."""
    if not len(knots):
        return np.zeros((len(places), body.settings.realizations))
    guards, side, held = _guards(body, posterior)
    every = np.concatenate([knots, guards])
    covariance = (posterior.spread * posterior.scale) ** 2 * posterior.system.covariance(every)
    root, vectors = np.linalg.eigh(covariance)
    factor = vectors * np.sqrt(np.maximum(root, 0.0))
    drawn = factor @ rng.standard_normal((len(every), body.settings.realizations))
    _honour(drawn, covariance, len(knots), side, held)
    # Kriging from knots and guards; the data themselves add nothing.
    system = posterior.system
    points = np.concatenate([system.points, every])
    keep = _distinct(points, len(system.points))
    whole = Saddle(points[keep], system.oriented, system.reach)
    right = np.zeros((len(whole.points) + 3 * len(system.oriented), drawn.shape[1]))
    right[len(system.points) : len(whole.points)] = drawn[keep[len(system.points) :] - len(system.points)]
    weights = whole.solve(right)
    blocks = np.array_split(places, max(1, len(places) // 2000))
    tasks = [(block, whole.points, whole.oriented, whole.reach, weights) for block in blocks]
    found = dict(where.run(_kriged, tasks))
    return np.concatenate([found[k] for k in range(len(blocks))])


def _kriged(task: tuple[Floats, Floats, Floats, float, Floats]) -> Floats:
    """Return the values of realizations (m, realizations) at some places, from the weights of what holds them."""
    places, points, oriented, reach, weights = task
    return np.asarray(rows_of(places, points, oriented, reach) @ weights)


def _guards(body: BodyFit, posterior: BodyPosterior) -> tuple[Floats, Floats, Floats]:
    """Return the samples most likely to change side in a draw: fitted places, sides, and the field's values there."""
    prepared, region = body.fitted.prepared, body.region
    xyz = np.concatenate([prepared.inside, prepared.outside, region.closing])
    side = np.concatenate([-np.ones(len(prepared.inside)), np.ones(len(xyz) - len(prepared.inside))])
    if len(xyz) > 20_000:
        some = np.arange(0, len(xyz), -(-len(xyz) // 20_000))
        xyz, side = xyz[some], side[some]
    value = body.value(xyz)
    # Only samples that the surface could reach at all need their variance looked at.
    order = np.argsort(np.abs(value), kind="stable")[:3000]
    xyz, side, value = xyz[order], side[order], value[order]
    deviation = posterior.deviation(xyz)
    doubt = np.flatnonzero((np.abs(value) < FAR * deviation) & (deviation > 1e-9))
    fitted = body.field.frame.to_fit(xyz[doubt])
    chosen = doubt[farthest_apart(fitted, min(GUARDS, len(doubt)))] if len(doubt) else doubt
    return body.field.frame.to_fit(xyz[chosen]), side[chosen], value[chosen]


def _honour(drawn: Floats, covariance: Floats, first: int, side: Floats, held: Floats) -> None:
    """Move draws (in place) by the least change that keeps the guards, those from ``first`` on, on their sides."""
    own = np.arange(first, len(drawn))
    for k in range(drawn.shape[1]):
        for _ in range(CORRECTIONS):
            missed = side * (held + drawn[own, k])
            bad = own[missed < 0]
            if not len(bad):
                break
            block = covariance[np.ix_(bad, bad)]
            lift = np.linalg.solve(block + 1e-9 * np.trace(block) / len(bad) * np.eye(len(bad)),
                                   -(held + drawn[own, k])[missed < 0])  # fmt: skip
            drawn[:, k] += covariance[:, bad] @ lift


def _distinct(points: Floats, first: int) -> NDArray[np.int64]:
    """Return the indices of points that lie off all those before them; the ``first`` ones all stay."""
    from scipy.spatial import cKDTree

    pairs = cKDTree(points).query_pairs(1e-6, output_type="ndarray")
    later = np.unique(pairs.max(axis=1)) if len(pairs) else np.zeros(0, np.int64)
    return np.setdiff1d(np.arange(len(points)), later[later >= first])
