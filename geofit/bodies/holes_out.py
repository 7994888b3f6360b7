"""What holes meet that are left out of a body: how far inside the others put each sample, and its logged side."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.clusters import sections_of
from geofit.bodies.posterior import BodyPosterior, scored
from geofit.bodies.reliability import Reliability, SidesMet, reliability_by
from geofit.data.errors import FitError

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit
    from geofit.bodies.data import BodyData

__all__ = ["reliability_of"]

Floats = NDArray[np.float64]
Strings = NDArray[np.str_]

#: Holes left out and samples of them, at most; fits of a body in parts, each without its share of the holes.
HOLES, SAMPLES, FOLDS = 80, 4000, 3
#: Fewest holes that are judged by.
FEWEST = 5


def reliability_of(body: BodyFit) -> Reliability:
    """Return how reliable the chance of lying inside a body is, by its holes.

    It is the field's own where data have no holes, are outlines, or include normals, which are of no hole.
    """
    data = body.data
    if (
        len(data.holes) < FEWEST
        or (data.hole == "").any()
        or np.isfinite(body.fitted.prepared.normals).all(axis=1).any()
        or sections_of(data, data.contacts) is not None
    ):
        return Reliability()
    found = _refitted(body) if body.fitted.system is None else _downdated(body)
    return Reliability() if found is None else reliability_by(found, body.region.spacing)


def _downdated(body: BodyFit) -> SidesMet | None:
    """Leave holes out of the fit's own system, one at a time, by blocks of its inverse (Dubrule, Math. Geol. 15, 1983).

    Active samples of the other holes keep their values.
    """
    from scipy.spatial import cKDTree

    posterior, data = BodyPosterior(body, Reliability()), body.data
    system, reach = posterior.system, body.region.reach
    weights = system.solve(body.field.interpolant.value(system.points))
    inverse = system.solve(np.eye(len(system.points)))
    places, names = _places(data) - body.origin, _names(data)
    # Places between samples are of their hole, too; those that close the body are far from all data.
    far, near = cKDTree(places).query(body.field.frame.to_map(system.points) - body.origin)
    hole = np.where(far <= reach / 8, names[near], "")
    contact = np.arange(len(places)) < len(data.contacts) + len(data.inside)
    samples = np.arange(len(data.contacts), len(places))
    judged = _spread(data)
    step = -(-int(np.isin(names[samples], judged).sum()) // SAMPLES)
    found: list[tuple[Floats, NDArray[np.bool_], Floats]] = []
    for name in judged.tolist():
        other = names != name
        own = samples[names[samples] == name][:: max(step, 1)]
        own = own[cKDTree(places[contact & other]).query(places[own])[0] <= reach]
        if not len(own):
            continue
        fitted = body.field.frame.to_fit(places[own] + body.origin)
        rows = system.rows(fitted)
        out = np.flatnonzero(hole == name)
        left, variance = weights, system.variance(fitted)
        if len(out):
            block = inverse[np.ix_(out, out)]
            left = weights - inverse[:, out] @ np.linalg.solve(block, weights[out])
            lost = system.solve_rows(rows)[out]
            variance = variance + (lost * np.linalg.solve(block, lost)).sum(axis=0)
        score = scored(rows @ left, posterior.scale * np.sqrt(np.maximum(variance, 0.0)))
        found.append((score, contact[own], np.asarray(cKDTree(places[other]).query(places[own])[0])))
    return _joined(found, int(np.isin(data.hole, judged).sum()) + len(judged))


def _refitted(body: BodyFit) -> SidesMet | None:
    """Leave shares of the holes out of a body in parts, which has no system of its own, and fit it again."""
    data = body.data
    holes = np.random.default_rng(body.settings.seed).permutation(np.array(data.holes))
    step = max(1, -(-(len(data.inside) + len(data.outside)) // SAMPLES))
    found: list[tuple[Floats, NDArray[np.bool_], Floats]] = []
    for k in range(FOLDS):
        out = holes[k::FOLDS]
        kept = (~np.isin(each, out) for each in (data.hole, data.inside_hole, data.outside_hole))
        rest = data.select(*kept)
        try:
            fitted = body.fitted.refit(rest, body.settings)
        except FitError:
            continue
        posterior = BodyPosterior(replace(body, data=rest, fitted=fitted, accuracy=None), Reliability())
        xyz = np.concatenate([data.inside, data.outside])
        inside = np.arange(len(xyz)) < len(data.inside)
        own = np.flatnonzero(np.isin(np.concatenate([data.inside_hole, data.outside_hole]), out))[::step]
        own = own[posterior.open_ground(xyz[own])]
        if len(own):
            score = scored(posterior.body.value(xyz[own]), posterior.deviation(xyz[own]))
            found.append((score, inside[own], posterior.away(xyz[own])))
    return _joined(found, len(data.contacts) + len(data.holes))


def _joined(found: list[tuple[Floats, NDArray[np.bool_], Floats]], stretches: int) -> SidesMet | None:
    if not found:
        return None
    score, inside, away = (np.concatenate(each) for each in zip(*found, strict=True))
    return SidesMet(score, inside, away, stretches)


def _spread(data: BodyData) -> Strings:
    """Return the names of holes with samples, or every second, third ... one of many."""
    names = np.unique(np.concatenate([data.inside_hole, data.outside_hole]))
    names = names[names != ""]
    return np.asarray(names[:: max(1, -(-len(names) // HOLES))], np.str_)


def _places(data: BodyData) -> Floats:
    return np.concatenate([data.contacts, data.inside, data.outside])


def _names(data: BodyData) -> Strings:
    return np.concatenate([data.hole, data.inside_hole, data.outside_hole])
