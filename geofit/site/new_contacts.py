"""The honest test of a prediction band: contacts that nobody knew when the surface was fitted."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message, plural_message
from geofit.data.points import PointSet
from geofit.data.prediction import Uncertainty
from geofit.fitting.horizon_fit import HorizonFit
from geofit.prediction.bands import prediction_sd

__all__ = ["BlindTest", "NewContact", "blind_test", "new_points"]

#: Share of new contacts that the band promises, and standard deviations to each side of it.
SHARE, WIDTH = 0.9, 1.6448536269514722
#: Metres within which a point of the later state is the point of the earlier one.
SAME_PLACE = 1e-3
#: Below this probability of so few inside, the band was too narrow.
LEAST = 0.05


@dataclass(frozen=True)
class NewContact:
    """One contact that the earlier state did not know.

    ``index`` among the later points; ``hole``, ``kind``, place and elevation as read, metres; ``predicted`` elevation
    of the earlier surface there, ``low`` and ``high`` its 90 % band, ``residual`` elevation minus predicted. nan where
    the earlier surface did not reach, or where its band is not known; ``inside`` is None then. ``group`` is the hole,
    or what else the contact belongs to: contacts of one group stand or fall together.
    """

    index: int
    group: str
    kind: str
    x: float
    y: float
    z: float
    predicted: float
    low: float
    high: float
    residual: float
    inside: bool | None


@dataclass(frozen=True, eq=False)
class BlindTest:
    """New contacts of a horizon against what its earlier state predicted."""

    name: str
    contacts: tuple[NewContact, ...]

    @property
    def judged(self) -> tuple[NewContact, ...]:
        """Contacts within the earlier surface, its band known."""
        return tuple(one for one in self.contacts if one.inside is not None)

    @property
    def inside(self) -> int:
        """Number of contacts inside the band."""
        return sum(one.inside is True for one in self.contacts)

    @property
    def share(self) -> float:
        """Share of the judged contacts inside the band; nan if there is none."""
        return self.inside / len(self.judged) if self.judged else float("nan")

    @property
    def rms(self) -> float:
        """Root mean square residual of the contacts that the earlier surface reached, metres; nan if there is none."""
        found = [one.residual for one in self.contacts if math.isfinite(one.residual)]
        return math.sqrt(sum(d * d for d in found) / len(found)) if found else float("nan")

    @property
    def probability(self) -> float:
        """Probability of so few inside, or fewer, if each lay inside with 90 %; nan without judged contacts.

        The binomial law takes contacts for independent; neighbours are not, so that the true probability is larger.
        """
        n = len(self.judged)
        if not n:
            return float("nan")
        return sum(math.comb(n, k) * SHARE**k * (1 - SHARE) ** (n - k) for k in range(self.inside + 1))

    @property
    def too_narrow(self) -> bool:
        """Whether so few lay inside that the band was too narrow, at a level of 5 %."""
        return self.probability < LEAST

    @property
    def text(self) -> Message:
        """The result as a sentence."""
        if not self.contacts:
            return message("site.no-new-contact", "{name}: no new contact", name=self.name)
        if not self.judged:
            return plural_message(
                "site.new-contacts-beyond-band",
                "{name}: {count} new contact, which no earlier band reaches",
                "{name}: {count} new contacts, which no earlier band reaches",
                count=len(self.contacts),
                name=self.name,
            )
        figures = {"name": self.name, "inside": self.inside, "count": len(self.judged), "share": self.share}
        if self.too_narrow:
            return message(
                "site.new-contacts-outside-band",
                "{name}: {inside} of {count} new contacts lie inside the earlier 90 % band ({share:.0%}): "
                "it was too narrow",
                **figures,
            )
        return message(
            "site.new-contacts-in-band",
            "{name}: {inside} of {count} new contacts lie inside the earlier 90 % band ({share:.0%})",
            **figures,
        )


def new_points(before: PointSet, after: PointSet) -> NDArray[np.intp]:
    """Return the indices of the points of the later state that the earlier state did not have.

    A contact of a hole that had a contact before is not new, even if its elevation was corrected; a point without a
    hole is new where no earlier point of its section lies within 1 mm.
    """
    holes = {hole for hole in before.hole.tolist() if hole}
    known = set(_places(before))
    return np.array(
        [
            index
            for index, (hole, key) in enumerate(zip(after.hole.tolist(), _places(after), strict=True))
            if (hole not in holes if hole else key not in known)
        ],
        np.intp,
    )


def blind_test(before: HorizonFit, uncertainty: Uncertainty | None, known: PointSet, after: PointSet) -> BlindTest:
    """Compare new contacts with the elevation and the 90 % band that the earlier state had for them.

    Parameters
    ----------
    before : HorizonFit
        The earlier surface, as fitted.
    uncertainty : Uncertainty or None
        ``examine(before).uncertainty``; None: only residuals are known.
    known : PointSet
        All points of the horizon in the earlier state, excluded ones too.
    after : PointSet
        Its points in the later state.

    Returns
    -------
    BlindTest
        One entry for each new point, in the order of ``after``.

    Notes
    -----
    The band is that for the contact of a new hole, noise included: predicted elevation plus and minus 1.645 standard
    deviations. Over the map residuals are vertical; over a best plane the distance across it is measured, and
    ``predicted`` is the elevation of the foot point.
    """
    index = new_points(known, after)
    xyz = after.xyz[index]
    flat = before.frame in ("map", "")
    if flat:
        predicted = np.asarray(before.elevation(xyz[:, 0], xyz[:, 1]))
        residual = xyz[:, 2] - predicted
    else:
        foot = before.project(xyz)
        beyond = np.zeros(len(xyz), bool) if foot.beyond is None else foot.beyond
        residual = np.where(beyond, np.nan, foot.distance)
        predicted = np.where(beyond, np.nan, foot.foot[:, 2] + before.origin[2])
    within = np.isfinite(residual)
    sd = np.full(len(index), np.nan)
    if uncertainty is not None and within.any():
        places = xyz[within][:, :2] if flat else xyz[within]
        sd[within] = prediction_sd(before, uncertainty, places, "contact")
    half = WIDTH * sd
    section = after.section
    low, high = predicted - half, predicted + half
    contacts = []
    for k, i in enumerate(index):
        inside = bool(abs(residual[k]) <= half[k]) if np.isfinite(half[k]) else None
        x, y, z = xyz[k].tolist()
        contacts.append(
            NewContact(
                int(i), str(after.hole[i] or section[i]), str(after.kind[i]), x, y, z, float(predicted[k]),
                float(low[k]), float(high[k]), float(residual[k]), inside,
            )
        )  # fmt: skip
    return BlindTest(before.name, tuple(contacts))


def _places(points: PointSet) -> list[tuple[str, int, int, int]]:
    rounded = np.round(points.xyz / SAME_PLACE).astype(np.int64)
    return [(section, *row) for section, row in zip(points.section.tolist(), rounded.tolist(), strict=True)]
