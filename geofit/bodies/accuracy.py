"""The verdict on a body: sigma of its contacts against epsilon, and whether it agrees with every logged metre."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.between import between_samples
from geofit.data.accuracy import Accuracy, Check, Conflict, Exceedance, Group
from geofit.data.messages import Message, message

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["BodyAccuracy", "across_two_sections", "crossed_pairs", "examine_body"]

Floats = NDArray[np.float64]
WORST = 20
#: Shares of the contacts on cavities and of the surface far from all data above which a body is not what was measured:
#: of planted bodies that fit their data neither has any, of one real open cloud 17 % are far; turned inside out, a body
#: has all its contacts on cavities or a third of its surface far.
BURIED, FAR = 0.5, 0.25
#: With fewer contacts P10 to P90 is too narrow: it contained the volume of a third of the planted ellipsoids, not 80 %.
FEW = 9
#: Share of the extent of a body in a direction, beyond all data there, above which its volume is an assumption; nodes
#: of the raster on which the section through the data is measured, along each side.
BEYOND, RASTER = 0.5, 120
#: The same across data that fill two parallel sections: nothing between them shows how a body narrows to its ends. It
#: is two sections if a gap makes up this part of the data's extent in one of so many directions, and this part of their
#: size at least; looked for among so many data.
BEYOND_TWO, GAP, APART, DIRECTIONS, SOME = 0.2, 0.8, 0.01, 180, 5_000
#: Sides of the box, and how a sentence calls them.
SIDE_WORDS = {
    "west": message("bodies.side-west", "west"),
    "east": message("bodies.side-east", "east"),
    "south": message("bodies.side-south", "south"),
    "north": message("bodies.side-north", "north"),
    "bottom": message("bodies.side-bottom", "bottom"),
    "top": message("bodies.side-top", "top"),
}


@dataclass(frozen=True, eq=False)
class BodyAccuracy(Accuracy):
    """The check of one body: the figures of a horizon, and those that only a body has.

    ``residuals`` (n,) are the signed orthogonal distances of all contacts given, metres, positive outside.
    ``wrong_side`` counts samples on the wrong side; ``missed_length`` is logged inside but outside the body,
    ``excess_length`` the reverse, metres, ``logged_length`` all that is logged with a length. ``extra_crossings``
    counts changes of side between neighbouring samples of a hole that are of one side. ``unsupported`` counts parts of
    the body without a contact or inside sample, ``far_share`` is the share of its surface farther than
    ``far_distance`` metres from all data; ``open_sides`` are the sides of the box at which it is cut.
    """

    wrong_side: int = 0
    missed_length: float = 0.0
    excess_length: float = 0.0
    logged_length: float = 0.0
    extra_crossings: int = 0
    unsupported: int = 0
    far_share: float = 0.0
    far_distance: float = 0.0
    open_sides: tuple[str, ...] = ()

    @property
    def warnings(self) -> tuple[Message, ...]:
        """The notes that limit what the body may be used for."""
        return tuple(note for note in self.notes if note.severity == "warning")


def examine_body(body: BodyFit) -> BodyAccuracy:
    """Return the accuracy of a body."""
    data, settings = body.data, body.settings
    residuals = body.distance(data.contacts)
    residuals.setflags(write=False)
    n = len(residuals)
    sigma = float(np.sqrt((residuals**2).sum() / max(n - 1, 1)))
    wrong_in, wrong_out = body.value(data.inside) >= 0, body.value(data.outside) <= 0
    missed_between, excess_between = (crossed_pairs(body, inside=inside)[1] for inside in (True, False))
    missed = float(missed_between.sum() + np.nansum(data.inside_length[wrong_in]))
    excess = float(excess_between.sum() + np.nansum(data.outside_length[wrong_out]))
    # Into the other side and back.
    crossings = 2 * (len(missed_between) + len(excess_between))
    buried = body.fitted.buried
    logged = float(np.nansum(data.inside_length) + np.nansum(data.outside_length))
    wrong = int(wrong_in.sum() + wrong_out.sum())
    places = np.concatenate([data.inside[wrong_in], data.outside[wrong_out]])[:WORST]
    far = body.region.reach
    far_share = _far_share(body, far)
    unsupported, cut = body.fitted.unsupported, body.field.cut
    checks = (
        Check(
            "sides",
            wrong == 0,
            float(wrong),
            0.0,
            "1",
            message(
                "bodies.samples-wrong-side",
                "{wrong} of {count} samples lie on the wrong side of the surface",
                wrong=wrong,
                count=len(data.inside) + len(data.outside),
            ),
            tuple((float(x), float(y), float(z)) for x, y, z in places),
        ),
        Check(
            "logged lengths",
            missed + excess <= 0.0 if logged else None,
            missed + excess,
            0.0,
            "m",
            message(
                "bodies.logs-violated-by-length",
                "{missed:.2f} m are logged inside but lie outside the body, {excess:.2f} m the reverse, of "
                "{logged:.1f} m",
                missed=missed,
                excess=excess,
                logged=logged,
            ),
        ),
        Check(
            "crossings",
            crossings == 0,
            float(crossings),
            0.0,
            "1",
            message(
                "bodies.crossings-between-samples",
                "{count} places where a hole crosses the surface between two samples of one side",
                count=crossings,
            ),
        ),
        Check(
            "components",
            unsupported == 0,
            float(unsupported),
            0.0,
            "1",
            message(
                "bodies.parts-without-data",
                "{count} parts of the body contain no contact and no inside sample",
                count=unsupported,
            ),
        ),
        Check(
            "closed",
            not cut,
            float(len(cut)),
            0.0,
            "1",
            message("bodies.closed-in-box", "The body is closed in its box")
            if not cut
            else message(
                "bodies.cut-at-box",
                "The body is cut at the box: {sides}",
                sides=tuple(SIDE_WORDS[side] for side in cut),
            ),
        ),
        Check(
            "orientation",
            buried <= BURIED,
            buried,
            BURIED,
            "1",
            message("bodies.right-side-out", "The contacts lie on the outer surface of the body")
            if buried <= BURIED
            else message(
                "bodies.inside-out",
                "{share:.0%} of the contacts lie on cavities, so the body surrounds its data. The normals seem to "
                "point inwards, or inside and outside are exchanged: turn them round",
                share=buried,
            ),
        ),
        Check("far from data", far_share <= FAR, far_share, FAR, "1", _far(far_share, far)),
    )
    conflicts = tuple(Conflict(-1, -1, 0.0, issue.text) for issue in body.issues if not issue.used)
    order = np.argsort(-np.abs(residuals), kind="stable")
    return BodyAccuracy(
        n=n,
        sigma=sigma,
        epsilon=settings.epsilon,
        passed=sigma < settings.epsilon,
        max_abs=float(np.abs(residuals).max(initial=0.0)),
        mean=float(residuals.mean()) if n else 0.0,
        residuals=residuals,
        patch=np.full(n, body.name, dtype=np.str_),
        by_patch=_groups(residuals, np.full(n, body.name, dtype=np.str_)),
        by_kind={},
        by_hole=_groups(residuals, data.hole),
        by_section={},
        over={"epsilon": Exceedance(settings.epsilon, int((np.abs(residuals) > settings.epsilon).sum()))},
        worst=tuple(order[:WORST].tolist()),
        checks=checks,
        conflicts=conflicts,
        notes=_notes(body),
        wrong_side=wrong,
        missed_length=missed,
        excess_length=excess,
        logged_length=logged,
        extra_crossings=crossings,
        unsupported=unsupported,
        far_share=far_share,
        far_distance=far,
        open_sides=cut,
    )


def crossed_pairs(body: BodyFit, *, inside: bool) -> tuple[Floats, Floats, NDArray[np.intp]]:
    """Return where the surface crosses between neighbouring samples of one hole and side.

    Returns
    -------
    tuple
        A place (k, 3) on the wrong side between the samples of each such pair, map coordinates, the length (k,) of the
        hole on that side there, metres, and the first sample (k,) of each pair.
    """
    places, share, first = between_samples(body.data, inside=inside)
    value = body.value(places)
    wrong = np.flatnonzero(value >= 0 if inside else value <= 0)
    pairs, at, of = np.unique(first[wrong], return_index=True, return_inverse=True)
    length = np.zeros(len(pairs))
    np.add.at(length, of, share[wrong])
    return places[wrong[at]], length, pairs


def _far_share(body: BodyFit, distance: float) -> float:
    from scipy.spatial import cKDTree

    # Crossed edges of a raster: as many a square metre whatever the surface's direction, within a third.
    places = body.fitted.survey.places
    if not len(places):
        return 0.0
    data = np.concatenate([body.data.contacts, body.data.inside, body.data.outside]) - body.origin
    return float((np.asarray(cKDTree(data).query(places)[0]) > distance).mean())


def _far(share: float, distance: float) -> Message:
    if share <= FAR:
        return message(
            "bodies.surface-far-from-data",
            "{share:.1%} of the surface is farther than {distance:.1f} m from all data",
            share=share,
            distance=distance,
        )
    return message(
        "bodies.surface-unbounded-by-data",
        "{share:.1%} of the surface is farther than {distance:.1f} m from all data, which do not bound the body. Check "
        "that normals point outwards and that inside and outside are not exchanged, or give data around the body",
        share=share,
        distance=distance,
    )


def _groups(residuals: Floats, names: NDArray[np.str_]) -> Mapping[str, Group]:
    groups = {}
    for name in np.unique(names[names != ""]).tolist():
        d = residuals[names == name]
        sigma = float(np.sqrt((d**2).sum() / max(len(d) - 1, 1)))
        groups[name] = Group(len(d), sigma, float(np.abs(d).max()), float(d.mean()))
    return groups


def _notes(body: BodyFit) -> tuple[Message, ...]:
    fitted, region = body.fitted, body.region
    samples = len(fitted.prepared.inside) + len(fitted.prepared.outside)
    notes: list[Message] = [
        message(
            "bodies.samples-active",
            "{active} of {samples} samples are active; the field satisfies {conditions} conditions",
            active=fitted.active,
            samples=samples + len(region.closing),
            conditions=fitted.conditions,
        )
    ]
    if len(region.closing):
        notes.append(
            message(
                "bodies.ground-beyond-reach",
                "Ground farther than {reach:.1f} m from contacts and inside samples counts as outside ({count} places)",
                reach=region.reach,
                count=len(region.closing),
            )
        )
    if (met := len(body.data.contacts)) < FEW:
        notes.append(
            message(
                "bodies.too-few-contacts-for-band",
                "Contacts: {count}. With fewer than {needed}, P10 to P90 is too narrow: it holds the volume far less "
                "often than the stated 80 %. Drill more holes through the body before you rely on its volume.",
                count=met,
                needed=FEW,
            ).with_severity("warning")
        )
    notes += _beyond(body)
    notes += [issue.text for issue in body.issues]
    return tuple(notes)


def _beyond(body: BodyFit) -> list[Message]:
    """Return a warning where most of the extent in a direction lies beyond all data, as across a fence of holes."""
    surface = body.fitted.survey.places
    if not len(surface):
        return []
    data = np.concatenate([body.data.contacts, body.data.inside, body.data.outside]) - body.origin
    middle = data.mean(axis=0)
    main = np.linalg.svd(data - middle, full_matrices=False)[2]
    limits = np.full(len(main), BEYOND)
    if (between := across_two_sections(data - middle)) is not None:
        main, limits = np.vstack([main, between]), np.append(limits, BEYOND_TWO)
    known, reached = ((xyz - middle) @ main.T for xyz in (data, surface))
    low, high = reached.min(axis=0), reached.max(axis=0)
    covered = np.maximum(np.minimum(high, known.max(axis=0)) - np.maximum(low, known.min(axis=0)), 0.0)
    share = 1.0 - covered / (high - low)
    k = int(np.argmax(share / limits))
    if share[k] <= limits[k]:
        return []
    axis = main[k]
    # Two directions at right angles to it span the section.
    across = np.linalg.svd(axis[None])[2][1:]
    first, last = (end((surface - middle) @ across.T, axis=0) for end in (np.min, np.max))
    steps = (np.arange(RASTER) + 0.5) / RASTER
    u, v = np.meshgrid(*(first + steps[:, None] * (last - first)).T)
    # Between two sections that are not joined there is none in the middle.
    places = middle + np.column_stack([u.ravel(), v.ravel()]) @ across
    ends = np.clip([known[:, k].min(), 0.0, known[:, k].max()], low[k], high[k])
    section = max(float((body.field.value(places + end * axis) < 0).mean()) for end in ends)
    # An axis has no sign: it is stated downwards, a level one from north over east to south.
    level = abs(axis[2]) < 0.01
    way = -axis if (axis[0] < 0 if level else axis[2] > 0) else axis
    return [
        message(
            "bodies.extent-beyond-data",
            "Along azimuth {azimuth}° and dip {dip}° the body extends over {extent:.1f} m, but the data cover "
            "only {covered:.1f} m of it. No data bound the rest (reach: {reach:.1f} m), so the volume and P10 to P90 "
            "are assumptions. The section of the body at the data has up to {area:whole} m²: each metre of extent "
            "adds about {area:whole} m³. Give data on both sides, or limit the body by its reach or its box.",
            azimuth=round(float(np.degrees(np.arctan2(way[0], way[1])))) % 360,
            dip=round(float(np.degrees(np.arcsin(np.clip(-way[2], 0.0, 1.0))))),
            extent=float((high - low)[k]),
            covered=float(covered[k]),
            reach=body.region.reach,
            area=section * float(np.prod(last - first)),
        ).with_severity("warning")
    ]


def across_two_sections(data: Floats) -> Floats | None:
    """Return the unit direction (3,) across the two parallel sections, vertical or level, that data fill; else None.

    Parameters
    ----------
    data : (n, 3) array
        Places about any origin, metres.
    """
    if len(data) > SOME:
        data = np.random.default_rng(0).choice(data, SOME, replace=False)
    size = float(np.ptp(data, axis=0).max())
    turns = np.arange(DIRECTIONS) * np.pi / DIRECTIONS
    for way in (*np.column_stack([np.cos(turns), np.sin(turns), np.zeros(DIRECTIONS)]), np.array([0.0, 0.0, 1.0])):
        along = data @ way
        order = np.argsort(along, kind="stable")
        gaps = np.diff(along[order])
        # One section does not count, nor does the width of its holes.
        if len(gaps) and gaps.max() > max(GAP * np.ptp(along), APART * size):
            first, second = np.split(data[order], [int(np.argmax(gaps)) + 1])
            sides, axes = np.linalg.svd(np.concatenate([first - first.mean(axis=0), second - second.mean(axis=0)]))[1:]
            return np.asarray(axes[2] if sides[1] > APART * sides[0] else way)
    return None
