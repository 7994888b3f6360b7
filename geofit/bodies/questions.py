"""What outlines leave open between neighbouring sections: where a body branches, begins or ends there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.outlines import Outline, SectionPlane, section_planes
from geofit.data.messages import Message, message

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["Question", "section_questions"]

Floats = NDArray[np.float64]

#: Nodes across a plane between two sections, planes between them, and halvings of the gap in which the count changes.
NODES = 96
PLANES = 24
HALVINGS = 12
#: Planes up to this angle from their mean are in the order in which they lie; others in the order given.
PARALLEL = np.cos(np.radians(30))


@dataclass(frozen=True)
class Question:
    """What a person should decide between two neighbouring sections, and what the fitted body made of it.

    Parameters
    ----------
    code : {"branches", "not joined", "ends"}
        The numbers of parts differ; they agree, but the body does not join the sections; the body ends before the
        section.
    first, second : str
        Names of the sections.
    parts : (int, int)
        Parts of the body on each.
    place : (float, float, float) or None
        Map coordinates of where the number of parts changes between them.
    share : float or None
        The same as a share of the way from the first section to the second.
    text : Message
        The question.
    """

    code: Literal["branches", "not joined", "ends"]
    first: str
    second: str
    parts: tuple[int, int]
    place: tuple[float, float, float] | None
    share: float | None
    text: Message


def section_questions(outlines: Sequence[Outline], body: BodyFit | None = None) -> tuple[Question, ...]:
    """Return what the outlines leave open between neighbouring sections.

    Parameters
    ----------
    outlines : sequence of Outline
        As given to :func:`geofit.bodies.outlines.from_outlines`.
    body : BodyFit, optional
        The body fitted to them; with it, each question states what the body does there, and gaps of the body between
        sections with the same number of parts are listed too.
    """
    planes = _ordered(section_planes(outlines))
    found = []
    for first, second in pairwise(planes):
        counts = len(first.parts), len(second.parts)
        path = None if body is None else _Between(body, first, second)
        if counts[0] != counts[1]:
            found.append(_branching(first, second, counts, path))
        elif path is not None and (least := min(path.counts[1:-1])) < counts[0]:
            share = float(path.shares[1 + int(np.argmin(path.counts[1:-1]))])
            text = message(
                "bodies.parts-not-joined",
                "Sections '{first}' and '{second}' have {parts} parts each; the body between them has only {least}. "
                "Do the parts go on from one section to the other?",
                first=first.name,
                second=second.name,
                parts=counts[0],
                least=least,
            )
            code: Literal["ends", "not joined"] = "ends" if least == 0 else "not joined"
            found.append(Question(code, first.name, second.name, counts, path.place(share), share, text))
    return tuple(found)


def _branching(first: SectionPlane, second: SectionPlane, counts: tuple[int, int], path: _Between | None) -> Question:
    share = None if path is None else path.change(counts[0])
    if path is None or share is None:
        text = message(
            "bodies.parts-differ",
            "Section '{first}' has {one} parts, section '{second}' {two}: which of them are joined?",
            first=first.name,
            one=counts[0],
            second=second.name,
            two=counts[1],
        )
        return Question("branches", first.name, second.name, counts, None, None, text)
    text = message(
        "bodies.parts-differ-far-apart",
        "Section '{first}' has {one} parts, section '{second}' {two}: the body changes {distance:.1f} m from the "
        "first. Is that right?",
        first=first.name,
        one=counts[0],
        second=second.name,
        two=counts[1],
        distance=share * path.length,
    )
    return Question("branches", first.name, second.name, counts, path.place(share), share, text)


def _ordered(planes: Sequence[SectionPlane]) -> list[SectionPlane]:
    """Return parallel planes in the order in which they lie, others in the order given."""
    normals = np.array([plane.normal for plane in planes])
    normals *= np.where(normals @ normals[0] < 0, -1.0, 1.0)[:, None]
    mean = normals.mean(axis=0)
    mean /= np.linalg.norm(mean)
    if (normals @ mean < PARALLEL).any():
        return list(planes)
    # From the side of the section given first to that of the last one.
    mean *= -1.0 if (planes[-1].origin - planes[0].origin) @ mean < 0 else 1.0
    return sorted(planes, key=lambda plane: float((plane.origin - planes[0].origin) @ mean))


class _Between:
    """The body on planes between two sections: each is the mean of both, weighted by the share of the way."""

    def __init__(self, body: BodyFit, first: SectionPlane, second: SectionPlane) -> None:
        self.body, self.first, self.second = body, first, second
        # The second section's axes, turned as those of the first.
        u, _, v = np.linalg.svd(second.axes @ first.axes.T)
        self.axes = (u @ v).T @ second.axes
        both = [
            np.concatenate(first.rings),
            np.concatenate([(ring @ second.axes) @ self.axes.T for ring in second.rings]),
        ]
        self.reach = 0.75 * max(float(np.ptp(corners, axis=0).max()) for corners in both)
        self.length = float(np.linalg.norm(second.origin - first.origin))
        self.shares = np.linspace(0.0, 1.0, PLANES + 1)
        self.counts = [self.count(share) for share in self.shares]

    def place(self, share: float) -> tuple[float, float, float]:
        x, y, z = (self.first.origin + share * (self.second.origin - self.first.origin)).tolist()
        return x, y, z

    def count(self, share: float) -> int:
        """Return how many parts the body has on the plane at a share of the way."""
        from scipy.ndimage import label

        axes = (1 - share) * self.first.axes + share * self.axes
        line = np.linspace(-self.reach, self.reach, NODES)
        nodes = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
        value = self.body.value(np.array(self.place(share)) + nodes @ axes)
        return int(label(value.reshape(NODES, NODES) < 0)[1])

    def change(self, start: int) -> float | None:
        """Return where, from 0 to 1, the number of parts first differs from ``start``; None if it never does."""
        changed = [k for k, count in enumerate(self.counts) if count != start]
        if not changed or changed[0] == 0:
            return None
        low, high = float(self.shares[changed[0] - 1]), float(self.shares[changed[0]])
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if self.count(middle) == start else (low, middle)
        return (low + high) / 2
