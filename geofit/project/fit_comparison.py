"""Two fits of a horizon side by side: which settings differ, their figures, and how far the surfaces lie apart."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from geofit.data.messages import Message, Untranslated, message, plural_message
from geofit.data.prediction import PredictionResult
from geofit.data.setting_texts import SETTINGS
from geofit.data.settings import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.provenance import Provenance
from geofit.site.change import HorizonChange, horizon_change

__all__ = ["FitFigure", "apart", "fit_figures", "title_of"]


@dataclass(frozen=True)
class FitFigure:
    """A line of the comparison: what it is, of both fits, and whether it differs."""

    name: Message
    first: Message
    second: Message

    @property
    def differs(self) -> bool:
        """Whether the two fits differ in it, as it is shown."""
        return str(self.first) != str(self.second)


def title_of(provenance: Provenance, number: int) -> Message:
    """Return the name of a fit in a list: its number, what differs from the defaults, exclusions and manual edits."""
    settings, plain = provenance.settings, FitSettings()
    parts: list[Message] = [
        message("project.fits-setting", "{label} {value}", label=SETTINGS[f.name].label, value=_value(f.name, settings))
        for f in fields(settings)
        if getattr(settings, f.name) != getattr(plain, f.name)
    ]
    if provenance.excluded:
        parts.append(
            plural_message(
                "project.fits-out", "{count} point left out", "{count} points left out", count=len(provenance.excluded)
            )
        )
    if provenance.edits:
        parts.append(
            plural_message(
                "project.fits-edits", "{count} manual edit", "{count} manual edits", count=len(provenance.edits)
            )
        )
    if not parts:
        return message("project.fits-plain", "Fit {number}: default settings", number=number)
    return message("project.fits-title", "Fit {number}: {parts}", number=number, parts=tuple(parts))


def fit_figures(
    first: HorizonFit,
    second: HorizonFit,
    predictions: tuple[PredictionResult | None, PredictionResult | None] = (None, None),
) -> tuple[FitFigure, ...]:
    """Return the settings that differ, then the figures of both fits."""
    both = (first, second)
    lines = [
        FitFigure(SETTINGS[f.name].with_unit(), _value(f.name, first.settings), _value(f.name, second.settings))
        for f in fields(first.settings)
        if getattr(first.settings, f.name) != getattr(second.settings, f.name)
    ]
    lines += [
        _line(
            message("project.fits-sigma", "σ, m"),
            [_number(one.accuracy.sigma if one.accuracy else None) for one in both],
        ),
        _line(
            message("project.fits-max", "Largest |d|, m"),
            [_number(a.max_abs if (a := one.accuracy) else None) for one in both],
        ),
        _line(message("project.fits-points", "Points"), [_count(len(one.points)) for one in both]),
        _line(message("project.fits-core", "Points of the core"), [_count(int(np.sum(one.core))) for one in both]),
        _line(message("data.control-points", "Control points"), [_count(one.control_points) for one in both]),
        _line(message("project.fits-failed", "Checks that failed"), [_count(_failed(one)) for one in both]),
        _line(
            message("project.fits-left-out", "RMS of points left out, m"),
            [_number(_left_out(one)) for one in predictions],
        ),
    ]
    return tuple(lines)


def apart(first: HorizonFit, second: HorizonFit) -> tuple[HorizonChange, Message]:
    """Return how far the second surface lies above the first, and that in words."""
    change = horizon_change(first, second)
    if not change.area > 0:
        return change, message("project.fits-nowhere", "The two surfaces have no area in common.")
    return change, message(
        "project.fits-apart",
        "B minus A: mean {mean:+.3g} m, rms {rms:.3g} m, largest {largest:+.3g} m at {x:.0f} / {y:.0f}; they differ by "
        "more than ε = {epsilon:g} m on {share:.0f} % of the area",
        mean=change.mean,
        rms=change.rms,
        largest=change.largest,
        x=change.place[0],
        y=change.place[1],
        epsilon=change.epsilon,
        share=100 * change.share,
    )


def _line(name: Message, values: list[Message]) -> FitFigure:
    return FitFigure(name, values[0], values[1])


def _value(name: str, settings: FitSettings) -> Message:
    value = getattr(settings, name)
    choices = SETTINGS[name].choices
    if isinstance(value, tuple):
        return message("project.fits-drawn", "drawn")
    found = next((text for choice, text in choices.items() if choice == value and type(choice) is type(value)), None)
    return found if found is not None else message("project.fits-value", "{value}", value=Untranslated(f"{value:g}"))


def _number(value: float | None) -> Message:
    if value is None or not np.isfinite(value):
        return message("project.fits-unknown", "not examined")
    return message("project.fits-value", "{value}", value=Untranslated(f"{value:.3g}"))


def _count(value: int) -> Message:
    return message("project.fits-value", "{value}", value=Untranslated(str(value)))


def _failed(fit: HorizonFit) -> int:
    return 0 if fit.accuracy is None else sum(check.passed is False for check in fit.accuracy.checks)


def _left_out(prediction: PredictionResult | None) -> float | None:
    """Return the worst of holes, sections and blocks that were left out."""
    if prediction is None or not prediction.left_out:
        return None
    return max(one.rms for one in prediction.left_out)
