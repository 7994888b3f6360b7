"""Settings of a body's fit: frozen, keyword-only, validated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import keywords_known
from geofit.data.messages import Message, Untranslated, message
from geofit.data.numbers import is_finite, shown
from geofit.data.setting_texts import BODY_SETTINGS

__all__ = ["BodySettings"]

Corner = tuple[float, float, float]


@keywords_known
@dataclass(frozen=True, kw_only=True)
class BodySettings:
    """How a body is fitted and judged.

    Parameters
    ----------
    epsilon : float
        Control error in metres: the fit passes when the sigma of its contacts is below it.
    step : float or None
        Distance in metres between samples along intervals; None: a quarter of the median interval's length, between
        0.1 m and a quarter of the distance between holes.
    closed : bool
        Whether ground farther than ``reach`` from the nearest contact or inside sample counts as outside. Without it
        the body may continue through ground without data.
    reach : float or None
        That distance in metres; None: twice the typical distance between holes, as the samples show it.
    box : pair of corners or None
        Lower and upper corner (map coordinates) at which the body is cut; None: the box of contacts and inside samples,
        enlarged by 1.1 times the reach.
    ranges : (float, float, float)
        Anisotropy: how far data act along the major, the middle and the minor axis, relative to each other.
    azimuth, dip, rake : float
        Direction of those axes in degrees: the plane of the major and middle axis dips by ``dip`` towards ``azimuth``
        (clockwise from grid north); the major axis lies in that plane, turned by ``rake`` from the line of steepest
        descent, clockwise seen from above.
    coincidence_distance : float
        Points nearer to each other than this many metres are one point. So are contacts within half of epsilon where
        others are 200 times as far, unless they bound a thin part of the body (:func:`geofit.bodies.data.prepare`).
    kernel : {"r3", "r"}
        Radial function of the field: r^3 is smooth; r follows the data more tightly, has a kink at each contact and
        takes no normals. It made planted bodies 7 % too small on average.
    dense : int
        Largest number of conditions that are solved at once; more are solved in overlapping parts.
    realizations : int
        Number of conditional simulations behind the volumes.
    seed : int
        Of those simulations.

    Raises
    ------
    SettingsError
        If a value is out of its range.

    Examples
    --------
    >>> BodySettings(epsilon=0.2, ranges=(3, 3, 1), dip=30, azimuth=90).ranges
    (3.0, 3.0, 1.0)
    """

    epsilon: float = 0.5
    step: float | None = None
    closed: bool = True
    reach: float | None = None
    box: tuple[Corner, Corner] | None = None
    ranges: tuple[float, float, float] = (1.0, 1.0, 1.0)
    azimuth: float = 0.0
    dip: float = 0.0
    rake: float = 0.0
    coincidence_distance: float = 1e-6
    kernel: str = "r3"
    dense: int = 600
    realizations: int = 100
    seed: int = 0

    def __post_init__(self) -> None:
        for name, text in BODY_SETTINGS.items():
            value = getattr(self, name)
            if text.number != "real" or (value is None and None in text.choices):
                continue
            if not is_finite(value) or value <= 0:
                raise SettingsError(
                    message(
                        "bodies.length-not-positive",
                        "{setting} is {value}; a finite number of metres above 0 is needed.",
                        setting=_named(name),
                        value=shown(value),
                    )
                )
        for name in ("azimuth", "dip", "rake"):
            if not is_finite(getattr(self, name)):
                raise SettingsError(
                    message(
                        "bodies.angle-not-finite",
                        "{setting} is {value}; a finite angle in degrees is needed.",
                        setting=_named(name),
                        value=shown(getattr(self, name)),
                    )
                )
        for name, text in BODY_SETTINGS.items():
            value = getattr(self, name)
            if text.number != "whole":
                continue
            if not isinstance(value, int) or not is_finite(value) or value < text.least:
                raise SettingsError(
                    message(
                        "data.setting-not-whole-number",
                        "{setting} is {value}; a whole number of at least {least} is needed.",
                        setting=_named(name),
                        value=shown(value),
                        least=text.least,
                    )
                )
        words = BODY_SETTINGS["kernel"].choices
        if not isinstance(self.kernel, str) or self.kernel not in words:
            raise SettingsError(
                message(
                    "data.setting-unknown-choice",
                    "{setting} is {value}; choose one of {words}.",
                    setting=_named("kernel"),
                    value=shown(self.kernel),
                    words=", ".join(map(repr, words)),
                )
            )
        if not isinstance(self.closed, bool):
            raise SettingsError(
                message(
                    "data.setting-not-true-or-false",
                    "{setting} is {value}; true or false is needed.",
                    setting=_named("closed"),
                    value=shown(self.closed),
                )
            )
        ranges = _numbers(self.ranges)
        if ranges.shape != (3,) or not (np.isfinite(ranges).all() and (ranges > 0).all()):
            raise SettingsError(
                message(
                    "bodies.ranges-not-three",
                    "{setting} is {value}; three finite numbers above 0 are needed.",
                    setting=_named("ranges"),
                    value=shown(self.ranges),
                )
            )
        object.__setattr__(self, "ranges", tuple(ranges.tolist()))
        if self.box is not None:
            box = _numbers(self.box)
            if box.shape != (2, 3) or not np.isfinite(box).all() or not (box[0] < box[1]).all():
                raise SettingsError(
                    message(
                        "bodies.box-unusable",
                        "{setting} is {value}; a lower and an upper corner in map coordinates are needed.",
                        setting=_named("box"),
                        value=shown(self.box),
                    )
                )
            object.__setattr__(self, "box", tuple(tuple(corner) for corner in box.tolist()))


def _named(name: str) -> Message:
    """Return what a setting is called, with its keyword."""
    label = BODY_SETTINGS[name].label
    return message("data.setting-label-keyword", "{label} ({name})", label=label, name=Untranslated(name))


def _numbers(value: Any) -> NDArray[np.float64]:
    """Return what was given as numbers; an empty array if it is none."""
    try:
        return np.asarray(value, float)
    except (TypeError, ValueError, OverflowError):
        return np.empty(0)
