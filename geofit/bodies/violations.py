"""Where a body and its data disagree: contacts off the surface, samples on the wrong side, metres of the wrong code."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.accuracy import crossed_pairs
from geofit.bodies.questions import Question
from geofit.data.messages import Message, message

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["Violation", "question_rows", "violations"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Violation:
    """One place at which a body and its data disagree.

    ``kind`` is "contact" (farther from the surface than epsilon), "sample" (on the wrong side), "length" (the surface
    crosses between two samples of one side), "data" (not used, because data contradict each other) or "question" (what
    outlines leave open between two sections, at a place that is nan where the body gives none). ``distance`` is
    the signed distance of the place from the surface and ``length`` what is logged otherwise, metres, nan if unknown.
    """

    kind: Literal["contact", "sample", "length", "data", "question"]
    hole: str
    place: tuple[float, float, float]
    distance: float
    length: float
    text: Message


def violations(body: BodyFit) -> tuple[Violation, ...]:
    """Return the disagreements between a body and its data, contacts first; none if the body honours all of them."""
    data, epsilon = body.data, body.settings.epsilon
    found: list[Violation] = []
    residuals = body.distance(data.contacts) if body.accuracy is None else body.accuracy.residuals
    for i in np.flatnonzero(np.abs(residuals) > epsilon).tolist():
        text = message(
            "bodies.contact-beyond-epsilon", "contact farther from the surface than ε = {epsilon:g} m", epsilon=epsilon
        )
        found.append(
            Violation("contact", str(data.hole[i]), _place(data.contacts[i]), float(residuals[i]), np.nan, text)
        )
    sides = (
        (data.inside, data.inside_hole, data.inside_length, True),
        (data.outside, data.outside_hole, data.outside_length, False),
    )
    for xyz, hole, length, inside in sides:
        value = body.value(xyz)
        wrong = np.flatnonzero(value >= 0 if inside else value <= 0)
        distances = body.distance(xyz[wrong])
        text = (
            message("bodies.logged-inside-lies-outside", "logged inside, lies outside")
            if inside
            else message("bodies.logged-outside-lies-inside", "logged outside, lies inside")
        )
        for i, distance in zip(wrong.tolist(), distances.tolist(), strict=True):
            found.append(Violation("sample", str(hole[i]), _place(xyz[i]), distance, float(length[i]), text))
        for place, metres, i in zip(*crossed_pairs(body, inside=inside), strict=True):
            away = float(body.distance(place[None])[0])
            found.append(Violation("length", str(hole[i]), _place(place), away, float(metres), text))
    found += [
        Violation("data", "", issue.place, np.nan, np.nan, issue.text)
        for issue in body.issues
        if not issue.used and issue.place is not None
    ]
    return tuple(found)


def question_rows(questions: Sequence[Question]) -> tuple[Violation, ...]:
    """Return questions of sections in the form of violations: they are listed with them, and are not counted as any."""
    nowhere = (np.nan, np.nan, np.nan)
    return tuple(
        Violation("question", f"{one.first} – {one.second}", one.place or nowhere, np.nan, np.nan, one.text)
        for one in questions
    )


def _place(xyz: Floats) -> tuple[float, float, float]:
    return (float(xyz[0]), float(xyz[1]), float(xyz[2]))
