"""Settings of a fit: frozen, keyword-only, validated."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from geofit.data.errors import SettingsError
from geofit.data.given import keywords_known
from geofit.data.messages import Message, Untranslated, message
from geofit.data.numbers import is_finite, shown
from geofit.data.setting_texts import SETTINGS, SettingText

__all__ = ["FitSettings", "named"]


@keywords_known
@dataclass(frozen=True, kw_only=True)
class FitSettings:
    """How a horizon is fitted and judged.

    Parameters
    ----------
    epsilon : float
        Control error in metres: the fit passes when sigma (eq. 3) is below it.
    interior_tolerance : float
        Largest distance in metres at which a peripheral point may lie from the surface (paper, sec. 3.2); one of a
        coarser stated accuracy as far as that explains.
    boundary_tolerance : float
        Largest distance in metres between the edges of neighbouring patches (paper, sec. 3.2). The patches
        share their edge control points, so the gap is zero up to the STEP file's digits.
    across : {"cubic", "linear"}
        Interpolation of the core across its sections. The paper usually chooses "linear"; "cubic" is
        smoother, and on gentle horizons several times nearer to the rock between the sections.
    seam : {"tangent", "position"}
        Whether patches meet with one tangent plane, or at the edge only (a break is allowed).
    core : "auto", "all", "none" or (k, 2) polygon
        Region that is interpolated exactly: found by density, unless its points do not support each other within
        epsilon; every point; no point; or the rectangle around a polygon in map coordinates. A core is bounded by
        parameter lines, so the rectangle runs along the surface's frame (along the sections where most run one way,
        else along a tilted study area or, without one, a tilted strip of points, else east and north), whatever way
        the polygon's sides run; a side goes on to the edge of the study area where the strip between them is narrow
        and holds next to no points. ``surface.partition`` has its corners.
    frame : {"auto", "map", "best-plane", "sections"}
        Whether the surface is a height field over the map, over its best plane (steep faults), or a
        parametric surface through ordered section lines (overturned folds).
    smoothing : "auto" or float
        Weight of the bending energy in the periphery: restricted maximum likelihood, or the ratio of noise
        variance to field variance in m^2 per unit of energy.
    robust : bool
        Whether peripheral points that their neighbours contradict (left-out error beyond 3.5 times its
        standard deviation) take no part in the fit. They are named in the notes, and count in sigma.
    strict : bool
        Whether every peripheral point is brought within the interior tolerance where knots allow it, also those that
        noise explains or that contradict their neighbours. The surface may swing between them.
    max_iterations : int
        Cap of the refinement and adjustment steps.
    max_control_points : int or None
        Cap of the number of control points; None: 40 a data point, 15 with a core, between 1,600 and 20,000, and as
        many as it takes to interpolate the core or, without one, to meet the points, up to 120,000.
    dips : {"check", "fit"}
        Whether dips measured on the horizon are compared with its surface only, or are data of the fit as well: each
        is an observation of the surface's gradient.
    dip_accuracy : float
        Standard deviation in degrees of a measured dip about the surface's own, the waviness of the bed included.
    coincidence_distance : float
        Points nearer to each other in plan than this many metres are coincident: if their elevations
        differ they are resolved by accuracy, and listed.

    Raises
    ------
    SettingsError
        If a value is out of its range.

    Examples
    --------
    >>> FitSettings(epsilon=0.25, seam="position").epsilon
    0.25
    """

    epsilon: float = 0.5
    interior_tolerance: float = 0.1
    boundary_tolerance: float = 0.01
    across: Literal["cubic", "linear"] = "cubic"
    seam: Literal["tangent", "position"] = "tangent"
    core: Literal["auto", "all", "none"] | tuple[tuple[float, float], ...] = "auto"
    frame: Literal["auto", "map", "best-plane", "sections"] = "auto"
    smoothing: Literal["auto"] | float = "auto"
    robust: bool = False
    strict: bool = False
    max_iterations: int = 20
    max_control_points: int | None = None
    dips: Literal["check", "fit"] = "check"
    dip_accuracy: float = 5.0
    coincidence_distance: float = 0.01

    def __repr__(self) -> str:
        changed = [f for f in fields(self) if getattr(self, f.name) != f.default]
        return f"FitSettings({', '.join(f'{f.name}={getattr(self, f.name)!r}' for f in changed)})"

    def __post_init__(self) -> None:
        if not isinstance(self.core, str):
            object.__setattr__(self, "core", _polygon(self.core))
        for name, text in SETTINGS.items():
            value = getattr(self, name)
            if name == "core" and not isinstance(value, str):
                continue
            if not any(value is choice or (isinstance(value, str) and value == choice) for choice in text.choices):
                _require(name, value, text)


def named(name: str) -> Message:
    """Return what a setting is called, with its keyword."""
    return message(
        "data.setting-label-keyword", "{label} ({name})", label=SETTINGS[name].label, name=Untranslated(name)
    )


def _given(name: str, value: Any) -> dict[str, Any]:
    return {"setting": named(name), "value": shown(value)}


def _require(name: str, value: Any, text: SettingText) -> None:
    """Refuse a value that is neither one of the setting's choices nor a number within its range."""
    given = _given(name, value)
    if text.number == "real":
        if is_finite(value) and value > 0:
            return
        unit = message("data.setting-unit-metres", "metres")
        if text.unit == "°":
            unit = message("data.setting-unit-degrees", "degrees")
        if not text.unit:
            unit = message("data.setting-auto-or-value", "or the word 'auto'")
        refused = message(
            "data.setting-not-positive",
            "{setting} is {value}; a finite number above 0 is needed ({unit}).",
            unit=unit,
            **given,
        )
    elif text.number == "whole":
        if isinstance(value, int) and is_finite(value) and value >= text.least:
            return
        refused = message(
            "data.setting-not-whole-number",
            "{setting} is {value}; a whole number of at least {least} is needed.",
            least=text.least,
            **given,
        )
    elif True in text.choices:
        refused = message("data.setting-not-true-or-false", "{setting} is {value}; true or false is needed.", **given)
    elif name == "core":
        refused = message(
            "data.setting-unknown-choice-or-polygon",
            "{setting} is {value}; choose one of {words} or a polygon of map coordinates.",
            words=_words(text),
            **given,
        )
    else:
        refused = message(
            "data.setting-unknown-choice", "{setting} is {value}; choose one of {words}.", words=_words(text), **given
        )
    raise SettingsError(refused)


def _words(text: SettingText) -> str:
    return ", ".join(map(repr, text.choices))


def _polygon(value: ArrayLike) -> tuple[tuple[float, float], ...]:
    try:
        corners = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        corners = np.empty(0)
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 3 or not np.isfinite(corners).all():
        text = message(
            "data.setting-polygon-wrong-shape",
            "{setting} has shape {shape}; a polygon of at least three (easting, northing) corners is needed.",
            shape=corners.shape,
            setting=named("core"),
        )
        raise SettingsError(text)
    return tuple((float(x), float(y)) for x, y in corners)
