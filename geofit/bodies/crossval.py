"""Leave one hole out: what a body predicts along holes it has not seen, next to a linear RBF and indicator kriging."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.active import farthest_apart
from geofit.bodies.data import BodyData
from geofit.bodies.fit import fit_field
from geofit.data.errors import FitError
from geofit.data.messages import message
from geofit.prediction.kriging import krige_left_out

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["CrossValidation", "HoleScore", "MethodScore", "leave_one_hole_out"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Centres next to a place that the linear RBF of many samples is made of; fewer samples count all at once.
NEIGHBOURS = 100
WHOLE = 2_000


@dataclass(frozen=True)
class HoleScore:
    """One hole left out: metres of the wrong side, metres logged, and its contacts.

    ``contact_errors`` are distances along the hole from each logged contact to the nearest one predicted, metres;
    ``missed`` counts the contacts of a hole on which none is predicted.
    """

    hole: str
    misclassified: float
    logged: float
    contact_errors: tuple[float, ...]
    missed: int


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
    def missed(self) -> int:
        """Contacts of holes on which none is predicted."""
        return sum(hole.missed for hole in self.holes)


@dataclass(frozen=True)
class CrossValidation:
    """Scores of "body", "linear RBF" and "indicator kriging" on the same holes; holes that had to stay, and why."""

    methods: Mapping[str, MethodScore]
    skipped: Mapping[str, str]


def leave_one_hole_out(body: BodyFit, holes: int = 30) -> CrossValidation:
    """Fit a body again without each of its holes, and compare with two usual methods on the same folds.

    The linear RBF interpolates signed distances to the nearest contact at all samples, and 0 at contacts. Indicator
    kriging estimates the share of inside samples (Journel, "Nonparametric estimation of spatial distributions", Math.
    Geol. 15, 1983) from the nearest samples of other holes with the variogram of all samples; one half is the surface.

    Parameters
    ----------
    body : BodyFit
        A body whose data name their holes.
    holes : int
        Holes left out at most: of those that meet the body or come within reach of it, some spread over it.

    Raises
    ------
    FitError
        If fewer than three holes have samples.
    """
    data = body.data
    names = _chosen(body, holes)
    scores: dict[str, list[HoleScore]] = {"body": [], "linear RBF": [], "indicator kriging": []}
    skipped = {}
    kriged = _kriged(data, names)
    for name in names:
        rest = data.without(name)
        try:
            fitted = fit_field(rest, body.settings)
        except FitError as error:
            skipped[name] = str(error)
            continue
        line = _Line.of(data, name)
        scores["body"].append(line.score(fitted.field.value(line.xyz - fitted.field.frame.origin)))
        scores["linear RBF"].append(line.score(_linear_rbf(rest, line.xyz)))
        scores["indicator kriging"].append(line.score(kriged[name]))
    return CrossValidation({name: MethodScore(tuple(found)) for name, found in scores.items()}, skipped)


def _chosen(body: BodyFit, most: int) -> tuple[str, ...]:
    """Return holes that meet the body or come within its reach, at most so many, spread over it."""
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
    return tuple(found[k] for k in np.sort(farthest_apart(middles - body.origin, min(most, len(found)))).tolist())


@dataclass(frozen=True, eq=False)
class _Line:
    """Samples of one hole in their order along it, ``at`` (n,) metres, and its contacts in the same measure."""

    name: str
    xyz: Floats
    inside: Bools
    at: Floats
    length: Floats
    contacts: Floats

    @classmethod
    def of(cls, data: BodyData, name: str) -> _Line:
        within, without = data.inside_hole == name, data.outside_hole == name
        xyz = np.concatenate([data.inside[within], data.outside[without]])
        inside = np.arange(len(xyz)) < within.sum()
        length = np.concatenate([data.inside_length[within], data.outside_length[without]])
        along, middle = _main_direction(xyz)
        at = (xyz - middle) @ along
        order = np.argsort(at, kind="stable")
        at = at[order]
        # Samples without a length: half the way to each neighbour.
        gaps = np.gradient(at) if len(at) > 1 else np.zeros(len(at))
        length = np.where(np.isfinite(length[order]), length[order], np.abs(gaps))
        contacts = (data.contacts[data.hole == name] - middle) @ along
        return cls(name, xyz[order], inside[order], at, length, contacts)

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


def _main_direction(xyz: Floats) -> tuple[Floats, Floats]:
    middle = xyz.mean(axis=0)
    return np.asarray(np.linalg.svd(xyz - middle, full_matrices=False)[2][0]), middle


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
