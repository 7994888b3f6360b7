"""Leave one hole out: what a body predicts along holes it has not seen, next to a linear RBF and indicator kriging."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.data import BodyData
from geofit.bodies.fit import fit_field
from geofit.bodies.posterior import BodyPosterior
from geofit.data.errors import FitError
from geofit.data.messages import message
from geofit.data.prediction import LeftOutBody, Scheme
from geofit.prediction.kriging import krige_left_out
from geofit.streaming.executors import Where

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["CrossValidation", "HoleScore", "MethodScore", "leave_one_hole_out", "left_out_body"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Centres next to a place that the linear RBF of many samples is made of; fewer samples count all at once.
NEIGHBOURS = 100
WHOLE = 2_000
#: Holes left out by default; fewer where each fit without one takes long, because the body has many conditions.
USUAL, FEW, LARGE = 30, 8, 1_500
#: The 90 % band leaves out so much on each side.
BAND = 0.05
#: Samples whose second direction is larger than this share of the first fill a plane: they are of a section.
FLAT = 0.2


@dataclass(frozen=True)
class HoleScore:
    """One hole left out: metres of the wrong side, metres logged, and its contacts.

    ``contact_errors`` are distances along the hole from each logged contact to the nearest one predicted, metres (on a
    section: at right angles to the surface); ``missed`` counts the contacts of a hole on which none is predicted.
    ``contacts`` counts those at which the chance of lying inside was evaluated, ``covered`` those of them at which it
    is from 5 to 95 %. ``beyond`` counts those beyond the reach of all other data, where the body is closed by its
    settings: no chance is known there.
    """

    hole: str
    misclassified: float
    logged: float
    contact_errors: tuple[float, ...]
    missed: int
    contacts: int = 0
    covered: int = 0
    beyond: int = 0


@dataclass(frozen=True)
class MethodScore:
    """All holes left out, by one method."""

    holes: tuple[HoleScore, ...]

    @property
    def misclassified(self) -> float:
        """Metres of the wrong side."""
        return sum(hole.misclassified for hole in self.holes)

    @property
    def logged(self) -> float:
        """Metres logged."""
        return sum(hole.logged for hole in self.holes)

    @property
    def contact_error(self) -> float:
        """Median distance along the holes from a logged contact to the nearest one predicted, metres; nan if none."""
        errors = [error for hole in self.holes for error in hole.contact_errors]
        return float(np.median(errors)) if errors else float("nan")

    @property
    def contact_rms(self) -> float:
        """Root mean square of the same distances, metres; nan if there is none."""
        errors = [error for hole in self.holes for error in hole.contact_errors]
        return float(np.sqrt(np.mean(np.square(errors)))) if errors else float("nan")

    @property
    def inside(self) -> float:
        """Share of the contacts that the 90 % band contains; nan if none was evaluated."""
        contacts = sum(hole.contacts for hole in self.holes)
        return sum(hole.covered for hole in self.holes) / contacts if contacts else float("nan")

    @property
    def beyond(self) -> int:
        """Contacts beyond the reach of all other data."""
        return sum(hole.beyond for hole in self.holes)

    @property
    def missed(self) -> int:
        """Contacts of holes on which none is predicted."""
        return sum(hole.missed for hole in self.holes)


@dataclass(frozen=True)
class CrossValidation:
    """Scores of "body", "linear RBF" and "indicator kriging" on the same holes; holes that had to stay, and why."""

    methods: Mapping[str, MethodScore]
    skipped: Mapping[str, str]
    scheme: Scheme = "hole"

    @property
    def left_out(self) -> LeftOutBody:
        """What the verdict on the body takes from this."""
        score = self.methods["body"]
        return LeftOutBody(
            self.scheme, len(score.holes), score.contact_rms, score.missed, score.misclassified, score.logged,
            score.inside, score.beyond,
        )  # fmt: skip


def leave_one_hole_out(
    body: BodyFit,
    holes: int | None = None,
    *,
    compared: bool = True,
    scheduler: str = "local",
    workers: int | None = 1,
    folder: Path | None = None,
) -> CrossValidation:
    """Fit a body again without each of its holes, and compare with two usual methods on the same folds.

    The linear RBF interpolates signed distances to the nearest contact at all samples, and 0 at contacts. Indicator
    kriging estimates the share of inside samples (Journel, "Nonparametric estimation of spatial distributions", Math.
    Geol. 15, 1983) from the nearest samples of other holes with the variogram of all samples; one half is the surface.

    Parameters
    ----------
    body : BodyFit
        A body whose data name their holes.
    holes : int
        Holes left out at most: of those that meet the body or come within reach of it, a selection at equal steps in
        their order along the longest direction, so that they are spaced as all holes are; by default 30, and 8 of a
        body with more than 1500 conditions. Sections take the place of holes where outlines are given.
    compared : bool
        Whether the two usual methods are scored, too.
    scheduler, workers : str, int
        Where the fits without a hole are made, see :func:`geofit.streaming.executors.run_tasks`; by default here. The
        scores are the same to the last bit.
    folder : Path, optional
        Where the scores of holes are kept: a run that was stopped goes on with the others.

    Raises
    ------
    FitError
        If fewer than three holes have samples.
    SchedulerError
        If the scheduler is lost.
    """
    data = body.data
    if holes is None:
        holes = USUAL if body.fitted.conditions <= LARGE else FEW
    names = _chosen(body, holes)
    scores: dict[str, list[HoleScore]] = {"body": []}
    if compared:
        scores |= {"linear RBF": [], "indicator kriging": []}
    skipped: dict[str, str] = {}
    kriged = _kriged(data, names) if compared else {}
    # A new one: what the body has computed so far need not travel.
    bare = replace(body, accuracy=None)
    where = Where(scheduler, workers, folder)
    found = dict(where.run(_without_hole, [(bare, name, compared) for name in names]))
    for k, name in enumerate(names):
        score = found[k]
        if isinstance(score, str):
            skipped[name] = score
            continue
        scores["body"].append(score[0])
        if compared:
            scores["linear RBF"].append(score[1])
            scores["indicator kriging"].append(_Line.of(data, name).score(kriged[name]))
    flat = all(_Line.of(data, name).flat for name in names)
    methods = {name: MethodScore(tuple(each)) for name, each in scores.items()}
    return CrossValidation(methods, skipped, "section" if flat and names else "hole")


def _with_band(line: _Line, body: BodyFit) -> HoleScore:
    """Score a body fitted without a hole or a section along it, and its band at the contacts."""
    score = line.score(body.value(line.xyz))
    if not len(line.places):
        return score
    if line.flat:
        score = replace(score, contact_errors=tuple(np.abs(body.distance(line.places)).tolist()), missed=0)
    posterior = BodyPosterior(body)
    known = line.places[posterior.open_ground(line.places)]
    chance = posterior.probability(known)
    covered = int(((chance >= BAND) & (chance <= 1 - BAND)).sum())
    return replace(score, contacts=len(known), covered=covered, beyond=len(line.places) - len(known))


def _without_hole(task: tuple[BodyFit, str, bool]) -> tuple[HoleScore, ...] | str:
    """Return the scores of a body and, where asked, of a linear RBF without one hole, or why no body can be fitted."""
    body, name, compared = task
    rest, line = body.data.without(name), _Line.of(body.data, name)
    try:
        fitted = fit_field(rest, body.settings)
    except FitError as error:
        return str(error)
    own = _with_band(line, replace(body, data=rest, fitted=fitted))
    return (own, line.score(_linear_rbf(rest, line.xyz))) if compared else (own,)


def _chosen(body: BodyFit, most: int) -> tuple[str, ...]:
    """Return holes that meet the body or come within its reach: all, or a selection at equal steps in their order.

    The order is that along their longest direction. Holes farthest apart would be those that the others predict worst.
    """
    from scipy.spatial import cKDTree

    data = body.data
    names = np.concatenate([data.inside_hole, data.outside_hole])
    xyz = np.concatenate([data.inside, data.outside])
    if len(set(names.tolist()) - {""}) < 3:
        raise FitError(
            message(
                "bodies.folds-need-three-holes",
                "Leaving out one hole at a time needs three holes or more with samples, and their names in "
                "inside_hole and outside_hole.",
            )
        )
    own = np.concatenate([data.contacts, data.inside]) - body.origin
    near = cKDTree(own).query(xyz - body.origin)[0] <= body.region.reach
    found = sorted(set(names[near].tolist()) - {""})
    middles = np.array([xyz[(names == name) & near].mean(axis=0) for name in found])
    order = np.argsort((middles - middles.mean(axis=0)) @ _directions(middles)[0][0], kind="stable")
    count = min(most, len(found))
    some = order[((np.arange(count) + 0.5) * len(found) / count).astype(int)]
    return tuple(found[k] for k in np.sort(some).tolist())


@dataclass(frozen=True, eq=False)
class _Line:
    """Samples of one hole in their order along it, ``at`` (n,) metres, and its contacts in the same measure."""

    name: str
    xyz: Floats
    inside: Bools
    at: Floats
    length: Floats
    contacts: Floats
    places: Floats
    flat: bool

    @classmethod
    def of(cls, data: BodyData, name: str) -> _Line:
        within, without = data.inside_hole == name, data.outside_hole == name
        xyz = np.concatenate([data.inside[within], data.outside[without]])
        inside = np.arange(len(xyz)) < within.sum()
        length = data_length = np.concatenate([data.inside_length[within], data.outside_length[without]])
        (along, _, _), (_, across, _), middle = _directions(xyz)
        at = (xyz - middle) @ along
        order = np.argsort(at, kind="stable")
        at = at[order]
        # Samples without a length: half the way to each neighbour.
        gaps = np.gradient(at) if len(at) > 1 else np.zeros(len(at))
        length = np.where(np.isfinite(length[order]), length[order], np.abs(gaps))
        places = data.contacts[data.hole == name]
        flat = across > FLAT
        # Nothing is logged along a section: its samples fill a plane.
        length = np.zeros(len(length)) if flat and not np.isfinite(data_length).any() else length
        return cls(name, xyz[order], inside[order], at, length, (places - middle) @ along, places, flat)

    def score(self, value: Floats) -> HoleScore:
        """Compare values (n,), negative inside, with the log."""
        wrong = (value < 0) != self.inside
        change = np.flatnonzero((value[1:] < 0) != (value[:-1] < 0))
        share = value[change] / (value[change] - value[change + 1])
        crossings = self.at[change] + share * (self.at[change + 1] - self.at[change])
        errors: tuple[float, ...] = ()
        if len(crossings):
            errors = tuple(np.abs(self.contacts[:, None] - crossings).min(axis=1).tolist())
        missed = 0 if len(crossings) else len(self.contacts)
        return HoleScore(self.name, float(self.length[wrong].sum()), float(self.length.sum()), errors, missed)


def _directions(xyz: Floats) -> tuple[Floats, tuple[float, float, float], Floats]:
    """Return the main directions (3, 3) of places, their sizes as shares of the largest, and the middle (3,)."""
    middle = xyz.mean(axis=0)
    sizes, axes = np.linalg.svd(np.concatenate([xyz - middle, np.zeros((3, 3))]), full_matrices=False)[1:]
    first, second, third = (sizes / max(float(sizes[0]), 1e-300)).tolist()
    return np.asarray(axes), (first, second, third), middle


def _linear_rbf(data: BodyData, places: Floats) -> Floats:
    """Return the linear radial basis function through signed distances to the nearest contact, at (n, 3) places."""
    from scipy.interpolate import RBFInterpolator
    from scipy.spatial import cKDTree

    origin = data.contacts[0]
    samples = np.concatenate([data.inside, data.outside])
    side = np.where(np.arange(len(samples)) < len(data.inside), -1.0, 1.0)
    far = cKDTree(data.contacts - origin).query(samples - origin)[0]
    centres = np.concatenate([data.contacts, samples])
    values = np.concatenate([np.zeros(len(data.contacts)), side * far])
    _, first = np.unique(np.round(centres - origin, 6), axis=0, return_index=True)
    few = None if len(first) <= WHOLE else NEIGHBOURS
    function = RBFInterpolator(centres[first] - origin, values[first], kernel="linear", neighbors=few)
    return np.asarray(function(places - origin))


def _kriged(data: BodyData, names: tuple[str, ...]) -> dict[str, Floats]:
    """Return one half minus the kriged share of inside samples along each hole, from the other holes' samples."""
    lines = {name: _Line.of(data, name) for name in names}
    samples = np.concatenate([data.inside, data.outside])
    hole = np.concatenate([data.inside_hole, data.outside_hole])
    inside = (np.arange(len(samples)) < len(data.inside)).astype(float)
    _, first = np.unique(np.round(samples - samples[0], 6), axis=0, return_index=True)
    rest = first[~np.isin(hole[first], names)]
    parts = [(line.xyz, line.inside.astype(float)) for line in lines.values()]
    ends = np.cumsum([0, *(len(xyz) for xyz, _ in parts)])
    places = np.concatenate([*(xyz for xyz, _ in parts), samples[rest]]) - samples[0]
    values = np.concatenate([*(share for _, share in parts), inside[rest]])
    groups = [np.arange(a, b) for a, b in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True)]
    estimate = krige_left_out(places, values, groups)
    return {name: 0.5 - estimate[group] for name, group in zip(names, groups, strict=True)}


def left_out_body(body: BodyFit, workers: int | None = 1) -> LeftOutBody | None:
    """Return what the verdict takes from leaving holes out; None where the data are of too few holes for that.

    ``workers`` are the processes for a body with more than 1500 conditions, as in :func:`leave_one_hole_out`; the holes
    of a smaller one take less time than a process takes to start.
    """
    workers = workers if body.fitted.conditions > LARGE else 1
    try:
        return leave_one_hole_out(body, compared=False, workers=workers).left_out
    except FitError:
        return None
