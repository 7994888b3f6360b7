"""What is known of a body: contacts on its surface, places inside and outside, normals; checked and merged."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.bodies.settings import BodySettings
from geofit.data.columns import column, places, refuse_far
from geofit.data.errors import FitError, PointsError
from geofit.data.given import arguments_checked, keywords_known
from geofit.data.messages import Message, Untranslated, message, plural_message

__all__ = ["BodyData", "BodyIssue", "Prepared", "prepare"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Strings = NDArray[np.str_]
EMPTY = np.zeros((0, 3))

#: Contacts this share of epsilon apart are readings of one place, if that is this share of the way to other places. Of
#: thousands of places drawn at random hardly two are as near.
READING = 0.5
NEARER = 5e-3
#: The neighbour of a contact, itself counted, that is taken for another place: of one place there are fewer readings.
OTHERS = 7


@dataclass(frozen=True)
class BodyIssue:
    """Something in the data of a body that a person should look at.

    ``used`` is whether the fit uses the data all the same; ``place`` is in map coordinates.
    """

    kind: Literal["coincident", "contradiction", "normal", "interval", "gap", "file"]
    text: Message
    place: tuple[float, float, float] | None = None
    used: bool = True


@keywords_known
@dataclass(frozen=True, eq=False)
class BodyData:
    """What is known of a body, in metres and map coordinates.

    Parameters
    ----------
    contacts : (n, 3) array_like
        Places on the surface of the body.
    inside, outside : (m, 3), (k, 3) array_like
        Places known to lie in the body and off it, such as samples along logged intervals.
    normals : (n, 3) array_like or None
        Outward normals at the contacts, of any length; a row of NaN where none is known.
    hole, inside_hole, outside_hole : str or array_like of str
        Borehole (or section) of each contact and sample; empty where there is none.
    inside_length, outside_length : float or array_like
        Length in metres of the interval that each sample represents; nan where it represents none.
    issues : tuple of BodyIssue
        What was found when the data were made.

    Raises
    ------
    PointsError
        If an array has the wrong shape, or a coordinate is not finite.

    Examples
    --------
    >>> data = BodyData(contacts=[[0, 0, 1], [0, 0, -1]], inside=[[0, 0, 0]])
    >>> len(data.contacts), len(data.outside), bool(np.isnan(data.normals).all())
    (2, 0, True)
    """

    contacts: Floats = field(default_factory=lambda: EMPTY)
    inside: Floats = field(default_factory=lambda: EMPTY)
    outside: Floats = field(default_factory=lambda: EMPTY)
    normals: Floats = None  # type: ignore[assignment]
    hole: Strings = ""  # type: ignore[assignment]
    inside_hole: Strings = ""  # type: ignore[assignment]
    outside_hole: Strings = ""  # type: ignore[assignment]
    inside_length: Floats = np.nan  # type: ignore[assignment]
    outside_length: Floats = np.nan  # type: ignore[assignment]
    issues: tuple[BodyIssue, ...] = ()

    def __init__(
        self,
        contacts: ArrayLike = (),
        inside: ArrayLike = (),
        outside: ArrayLike = (),
        normals: ArrayLike | None = None,
        hole: ArrayLike = "",
        inside_hole: ArrayLike = "",
        outside_hole: ArrayLike = "",
        inside_length: ArrayLike = np.nan,
        outside_length: ArrayLike = np.nan,
        issues: tuple[BodyIssue, ...] = (),
    ) -> None:
        for name, given in (("contacts", contacts), ("inside", inside), ("outside", outside)):
            self._set(name, _finite_places(name, given))
        n = len(self.contacts)
        known = np.full((n, 3), np.nan) if normals is None else _copied(normals)
        if known.size == 0:
            known = known.reshape(0, 3)
        if known.shape != (n, 3):
            raise PointsError(
                message(
                    "bodies.normals-wrong-shape",
                    "normals has shape {shape}; {n} contacts need shape ({n}, 3), NaN where no normal is known.",
                    shape=known.shape,
                    n=n,
                )
            )
        self._set("normals", known)
        for name, values, count in (
            ("hole", hole, n),
            ("inside_hole", inside_hole, len(self.inside)),
            ("outside_hole", outside_hole, len(self.outside)),
        ):
            self._set(name, column(name, values, count, np.str_))
        self._set("inside_length", column("inside_length", inside_length, len(self.inside), np.float64))
        self._set("outside_length", column("outside_length", outside_length, len(self.outside), np.float64))
        object.__setattr__(self, "issues", tuple(issues))

    def _set(self, name: str, array: NDArray[Any]) -> None:
        array.setflags(write=False)
        object.__setattr__(self, name, array)

    @property
    def holes(self) -> tuple[str, ...]:
        """Names of the holes, sorted."""
        names = set(self.hole.tolist()) | set(self.inside_hole.tolist()) | set(self.outside_hole.tolist())
        return tuple(sorted(names - {""}))

    @arguments_checked
    def select(self, contacts: ArrayLike, inside: ArrayLike, outside: ArrayLike) -> BodyData:
        """Return a part of the data: what is true in an array of each kind."""
        masks = {"contacts": contacts, "inside": inside, "outside": outside}
        contacts, inside, outside = (
            column(name, mask, len(getattr(self, name)), np.bool_) for name, mask in masks.items()
        )
        return BodyData(
            self.contacts[contacts], self.inside[inside], self.outside[outside], self.normals[contacts],
            self.hole[contacts], self.inside_hole[inside], self.outside_hole[outside],
            self.inside_length[inside], self.outside_length[outside], self.issues,
        )  # fmt: skip

    @arguments_checked
    def without(self, hole: str) -> BodyData:
        """Return the data without those of one hole."""
        return self.select(self.hole != hole, self.inside_hole != hole, self.outside_hole != hole)


@arguments_checked
def _copied(normals: ArrayLike) -> Floats:
    return np.array(normals, float)


def _finite_places(name: str, given: ArrayLike) -> Floats:
    xyz = places(name, given)
    bad = np.flatnonzero(~np.isfinite(xyz).all(axis=1))
    if bad.size:
        raise PointsError(
            message(
                "bodies.values-not-finite",
                "{count} of {total} {name} are not finite, the first at index {index}. Remove or complete them.",
                count=bad.size,
                total=len(xyz),
                name=Untranslated(name),
                index=bad[0],
            )
        )
    refuse_far(xyz)
    return xyz


@dataclass(frozen=True, eq=False)
class Prepared:
    """Data that a fit can use.

    ``contacts`` (n, 3) differ from each other, ``normals`` (n, 3) have length one or are NaN; ``member`` (N,) is the
    row in ``contacts`` of each contact given. ``inside`` and ``outside`` contradict nothing; ``inside_used`` and
    ``outside_used`` are masks over what was given.
    """

    contacts: Floats
    normals: Floats
    member: Ints
    inside: Floats
    outside: Floats
    inside_used: NDArray[np.bool_]
    outside_used: NDArray[np.bool_]
    issues: tuple[BodyIssue, ...]


def prepare(data: BodyData, settings: BodySettings) -> Prepared:
    """Merge contacts of one place, list what contradicts itself, and make sure that a body can be fitted.

    Contacts are of one place within ``settings.coincidence_distance``, and within half of epsilon where others are
    200 times as far away: a field that is zero at two readings of one place cannot rise from one to the other, and
    turns all around them. Those of one hole, of opposite normals, or with a sample between them bound a thin part of
    the body and stay.

    Raises
    ------
    FitError
        If the data cannot bound a body: nothing inside, nothing that bounds it, one hole only.
    """
    distance = settings.coincidence_distance
    issues = list(data.issues)
    readings = _readings(data, settings.epsilon * READING)
    contacts, member = _merge(data.contacts, distance, readings)
    count = np.bincount(member, minlength=len(contacts))
    apart = np.zeros(len(contacts))
    np.maximum.at(apart, member, np.linalg.norm(data.contacts - contacts[member], axis=1))
    for k in np.flatnonzero(count > 1).tolist():
        text = message(
            "bodies.contacts-coincident",
            "{count} contacts coincide within {distance:.2g} m: they count as one",
            count=int(count[k]),
            distance=max(float(apart[k]), distance),
        )
        issues.append(BodyIssue("coincident", text, _place(contacts[k])))
    normals = _normals(data, contacts, member, issues)
    inside_used, outside_used = _sides(data, contacts, distance, issues)
    inside, _ = _merge(data.inside[inside_used], distance)
    outside, _ = _merge(data.outside[outside_used], distance)
    for name, given, kept in (
        ("inside", int(inside_used.sum()), len(inside)),
        ("outside", int(outside_used.sum()), len(outside)),
    ):
        if given > kept:
            text = message(
                "bodies.samples-repeated",
                "{count} {side} samples repeat another one: they count once",
                count=given - kept,
                side=name,
            )
            issues.append(BodyIssue("coincident", text))
    found = Prepared(contacts, normals, member, inside, outside, inside_used, outside_used, tuple(issues))
    _require_body(data, found, distance)
    return found


def _readings(data: BodyData, most: float) -> Ints:
    """Return the pairs (k, 2) of contacts that are readings of one place, at most so many metres apart."""
    from scipy.spatial import cKDTree

    xyz, hole = data.contacts, data.hole
    if len(xyz) < 2:
        return np.zeros((0, 2), np.int64)
    tree = cKDTree(xyz - xyz[0])
    # Other places: a place has few readings, so one of several neighbours is of another place.
    other = np.asarray(tree.query(xyz - xyz[0], k=min(OTHERS, len(xyz)))[0])[:, -1]
    pairs = tree.query_pairs(min(most, NEARER * float(other.max())), output_type="ndarray").astype(np.int64)
    first, second = pairs.T
    apart = np.linalg.norm(xyz[first] - xyz[second], axis=1)
    own = apart <= NEARER * np.minimum(other[first], other[second])
    own &= (hole[first] != hole[second]) | (hole[first] == "")
    own &= ~((data.normals[first] * data.normals[second]).sum(axis=1) < 0)
    samples = np.concatenate([data.inside, data.outside]) - xyz[0]
    if len(samples):
        own &= np.asarray(cKDTree(samples).query((xyz[first] + xyz[second]) / 2 - xyz[0])[0]) > apart / 2
    return np.asarray(pairs[own], np.int64)


def _merge(xyz: Floats, distance: float, pairs: Ints | None = None) -> tuple[Floats, Ints]:
    """Return the places that differ, the first of each group, and the row there of every place given.

    Places of one group are nearer to each other than the distance, or are among the pairs (k, 2).
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    if len(xyz) < 2:
        return xyz, np.zeros(len(xyz), np.int64)
    near = cKDTree(xyz - xyz[0]).query_pairs(distance, output_type="ndarray")
    if pairs is not None:
        near = np.concatenate([near, pairs])
    graph = coo_array((np.ones(len(near)), (near[:, 0], near[:, 1])), shape=(len(xyz), len(xyz)))
    _, label = connected_components(graph, directed=False)
    _, first, member = np.unique(label, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return xyz[first[order]], rank[member]


def _normals(data: BodyData, contacts: Floats, member: Ints, issues: list[BodyIssue]) -> Floats:
    """Return the mean normal of each merged contact, unit or NaN; opposite ones are listed and left out."""
    length = np.linalg.norm(data.normals, axis=1)
    for i in np.flatnonzero(length == 0).tolist():
        issues.append(
            BodyIssue(
                "normal",
                message("bodies.normal-zero", "The normal of contact {index} is zero: it is not used", index=i),
                _place(data.contacts[i]),
                used=False,
            )
        )
    known = np.isfinite(length) & (length > 0)
    unit = np.zeros_like(data.normals)
    unit[known] = data.normals[known] / length[known, None]
    total = np.zeros_like(contacts)
    np.add.at(total, member, unit)
    count = np.bincount(member[known], minlength=len(contacts))
    size = np.linalg.norm(total, axis=1)
    # Mean of unit vectors below cos(60 degrees): they do not mean the same side.
    opposite = (count > 1) & (size < 0.5 * count)
    for k in np.flatnonzero(opposite).tolist():
        text = message(
            "bodies.coincident-normals-opposite",
            "{count} coincident contacts have opposite normals: none of these normals is used",
            count=int(count[k]),
        )
        issues.append(BodyIssue("normal", text, _place(contacts[k]), used=False))
    use = (count > 0) & ~opposite
    result = np.full_like(contacts, np.nan)
    result[use] = total[use] / size[use, None]
    return result


def _sides(
    data: BodyData, contacts: Floats, distance: float, issues: list[BodyIssue]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which samples can be used; those that contradict each other or lie on a contact are listed."""
    from scipy.spatial import cKDTree

    origin = np.concatenate([contacts, data.inside, data.outside, np.zeros((1, 3))])[0]
    used = []
    for name, samples in (("inside", data.inside), ("outside", data.outside)):
        mask = np.ones(len(samples), bool)
        if len(contacts) and len(samples):
            mask = np.asarray(cKDTree(contacts - origin).query(samples - origin)[0]) > distance
        for i in np.flatnonzero(~mask).tolist():
            text = message(
                "bodies.sample-on-contact",
                "{side} sample {index} lies on a contact: its side is not used",
                side=name,
                index=i,
            )
            issues.append(BodyIssue("coincident", text, _place(samples[i]), used=False))
        used.append(mask)
    if len(data.inside) and len(data.outside):
        far, near = map(np.asarray, cKDTree(data.outside - origin).query(data.inside - origin))
        for i in np.flatnonzero(far <= distance).tolist():
            holes = data.inside_hole[i], data.outside_hole[near[i]]
            text = message(
                "bodies.samples-contradict",
                "Inside sample {inside} (hole '{first}') and outside sample {outside} (hole "
                "'{second}') coincide: the intervals contradict each other, and neither side is used",
                inside=i,
                outside=int(near[i]),
                first=holes[0],
                second=holes[1],
            )
            issues.append(BodyIssue("contradiction", text, _place(data.inside[i]), used=False))
        clash = np.asarray(cKDTree(data.inside - origin).query(data.outside - origin)[0]) <= distance
        used[0] &= far > distance
        used[1] &= ~clash
    return used[0], used[1]


def _require_body(data: BodyData, found: Prepared, coincidence_distance: float) -> None:
    if len(found.contacts) == 1 < len(data.contacts):
        raise FitError(
            message(
                "bodies.contacts-all-coincide",
                "All {count} contacts lie within the coincidence distance of {distance:g} m of each other, so they "
                "count as one. Give coordinates in metres, or a smaller coincidence_distance.",
                count=len(data.contacts),
                distance=coincidence_distance,
            )
        )
    oriented = np.isfinite(found.normals).all(axis=1).any()
    given = {"contacts": len(found.contacts), "inside": len(found.inside), "outside": len(found.outside)}
    _require_agreement(data, found, oriented=bool(oriented))
    if not len(found.inside) and not oriented:
        raise FitError(
            message(
                "bodies.no-data-inside",
                "Nothing lies inside the body (contacts: {contacts}, inside samples: {inside}, outside samples: "
                "{outside}, no normals). Give intervals in the body, inside samples, or contacts with normals.",
                **given,
            )
        )
    if not len(found.contacts) and not len(found.outside):
        raise FitError(
            message(
                "bodies.no-data-outside",
                "Nothing bounds the body: all {inside} samples are inside. Give contacts, or intervals outside it.",
                **given,
            )
        )
    if not len(found.contacts):
        raise FitError(
            message(
                "bodies.no-contact",
                "The data have {inside} samples inside and {outside} outside, but no contact. Give places on the "
                "surface, such as the ends of the intervals in the body.",
                **given,
            )
        )
    if len(data.holes) == 1 and (data.hole == data.holes[0]).all():
        raise FitError(
            message(
                "bodies.contacts-of-one-hole",
                "All contacts come from one hole, '{hole}': they do not show how wide the body is. Give at least two "
                "holes, or outlines or points elsewhere.",
                hole=data.holes[0],
            )
        )
    everything = np.concatenate([found.contacts, found.inside, found.outside])
    extent = np.linalg.svd(everything - everything.mean(axis=0), compute_uv=False)
    if len(everything) < 2 or extent[1] < 1e-3 * extent[0]:
        raise FitError(
            message(
                "bodies.data-on-one-line",
                "All {count} data lie on one line, like those of one hole: they do not show how wide the body is. "
                "Give at least two holes.",
                count=len(everything),
            )
        )


def _require_agreement(data: BodyData, found: Prepared, *, oriented: bool) -> None:
    """Refuse samples that contradict each other so that none of a side that the body needs is left."""
    count = sum(issue.kind == "contradiction" for issue in found.issues)
    lost_inside = len(data.inside) and not found.inside_used.any() and not oriented
    lost_outside = len(data.outside) and not found.outside_used.any() and not len(found.contacts)
    if count and (lost_inside or lost_outside):
        raise FitError(
            plural_message(
                "bodies.samples-all-contradict",
                "{count} inside sample lies where an outside sample lies, so neither can be used, and the data do not "
                "show which side is the body. Correct the intervals or samples.",
                "{count} inside samples lie where outside samples lie, so neither can be used, and the data do not "
                "show which side is the body. Correct the intervals or samples.",
                count=count,
            )
        )


def _place(xyz: Floats) -> tuple[float, float, float]:
    return (float(xyz[0]), float(xyz[1]), float(xyz[2]))
