"""The verdict on a surface: three lamps (at the data, checks, away from the data) and the word that follows from them.

Windows, console, STEP export and reports show what :func:`verdict_of` returns, so that they agree.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from geofit.data.accuracy import Accuracy, Check, ReadBack
from geofit.data.messages import Message, message
from geofit.data.prediction import LeftOut, LeftOutBody, PredictionResult, Scheme

__all__ = ["FAR", "LEAST_INSIDE", "Lamp", "Level", "Verdict", "verdict_of"]

Level = Literal["none", "pass", "warning", "fail"]

#: Share of left-out points that the 90 % band must contain, by the worst scheme; a wider band is not a fault.
LEAST_INSIDE = 0.85
#: A left-out error from this many epsilons on turns the lamp red; above one epsilon it is amber.
FAR = 10.0
#: Below it a sigma says only how sums round, metres.
ROUNDING = 1e-9
_WORDS: dict[Level, str] = {"none": "–", "pass": "PASS", "warning": "WARNING", "fail": "FAIL"}
_ORDER: tuple[Level, ...] = ("none", "pass", "warning", "fail")
_SCHEMES = {
    "hole": message("data.verdict-holes", "holes left out"),
    "section": message("data.verdict-sections", "sections left out"),
    "block": message("data.verdict-blocks", "blocks left out"),
}


@dataclass(frozen=True)
class Lamp:
    """One of the three: what it is about, its level, and the figures behind it."""

    title: Message
    level: Level
    text: Message


@dataclass(frozen=True)
class Verdict:
    """Three lamps: ``data`` (sigma against epsilon), ``checks`` (n of m), ``away`` (left-out error, band coverage).

    ``level`` is "fail" where sigma is not below epsilon, "warning" where it is and another lamp is amber or red,
    "pass" where no lamp is; ``word`` is PASS, WARNING or FAIL. A lamp that was not examined does not count.
    """

    data: Lamp
    checks: Lamp
    away: Lamp

    @property
    def lamps(self) -> tuple[Lamp, Lamp, Lamp]:
        """The lamps in their order."""
        return self.data, self.checks, self.away

    @property
    def level(self) -> Level:
        """What the lamps come to."""
        if self.data.level != "pass":
            return self.data.level
        return "warning" if {"warning", "fail"} & {self.checks.level, self.away.level} else "pass"

    @property
    def word(self) -> str:
        """PASS, WARNING or FAIL."""
        return _WORDS[self.level]

    @property
    def text(self) -> Message:
        """Everything in one sentence, the lamps that are not green first."""
        worst = sorted(self.lamps, key=lambda lamp: -_ORDER.index(lamp.level))
        return message(
            "data.verdict-sentence", "{word}: {lamps}", word=self.word, lamps=tuple(lamp.text for lamp in worst)
        )


def verdict_of(
    accuracy: Accuracy,
    prediction: PredictionResult | LeftOutBody | None = None,
    read_back: ReadBack | None = None,
    orders: Iterable[Check] = (),
) -> Verdict:
    """Return the verdict on a surface or a body from all that is known of it.

    Parameters
    ----------
    accuracy : Accuracy
        Sigma, epsilon (m) and the checks of the surface.
    prediction : PredictionResult, LeftOutBody or None
        Left-out errors, of a surface or of a body; None: not examined.
    read_back : ReadBack or None
        The checks of the file, where one was written.
    orders : iterable of Check
        How the horizon lies to its neighbours.
    """
    checks = (*accuracy.checks, *(read_back.checks if read_back else ()), *orders)
    if isinstance(prediction, LeftOutBody):
        away = _away_of_body(prediction, accuracy.epsilon)
    else:
        away = _away(prediction, accuracy.epsilon)
    return Verdict(_at_the_data(accuracy), _checks(checks), away)


def _at_the_data(a: Accuracy) -> Lamp:
    figures = {"sigma": a.sigma, "epsilon": a.epsilon}
    if a.passed and a.sigma < ROUNDING:
        text = message("data.verdict-exact", "σ < 1e-9 m < ε {epsilon:g} m", epsilon=a.epsilon)
    elif a.sigma < min(ROUNDING, a.epsilon):
        text = message(
            "data.verdict-exact-and-runs-away",
            "σ < 1e-9 m < ε {epsilon:g} m, but the surface runs far beyond the elevations of its data",
            epsilon=a.epsilon,
        )
    elif a.passed:
        text = message("data.verdict-below", "σ {sigma:length} m < ε {epsilon:g} m", **figures)
    elif a.sigma < a.epsilon:
        text = message(
            "data.verdict-runs-away",
            "σ {sigma:length} m < ε {epsilon:g} m, but the surface runs far beyond the elevations of its data",
            **figures,
        )
    else:
        text = message("data.verdict-not-below", "σ {sigma:length} m ≥ ε {epsilon:g} m", **figures)
    return Lamp(message("data.verdict-data", "At the data"), "pass" if a.passed else "fail", text)


def _checks(checks: Sequence[Check]) -> Lamp:
    title = message("data.verdict-checks", "Checks")
    asked = [check for check in checks if check.passed is not None]
    failed = tuple(dict.fromkeys(check.name for check in asked if not check.passed))
    if not asked:
        return Lamp(title, "none", message("data.verdict-no-checks", "no check applies"))
    figures = {"passed": sum(bool(check.passed) for check in asked), "total": len(asked)}
    if failed:
        text = message(
            "data.verdict-failed", "{passed} of {total} checks pass; failed: {names}", names=failed, **figures
        )
        return Lamp(title, "warning", text)
    return Lamp(title, "pass", message("data.verdict-passed", "{passed} of {total} checks pass", **figures))


def _away(prediction: PredictionResult | None, epsilon: float) -> Lamp:
    title = message("data.verdict-away", "Away from the data")
    known = () if prediction is None else tuple(one for one in prediction.left_out if np.isfinite(one.rms))
    if not known:
        if prediction is None:
            return Lamp(title, "none", message("data.verdict-not-examined", "not examined away from the data"))
        # No point could be predicted from the others, or leaving them out failed: that is not a pass.
        text = message("data.verdict-cannot-examine", "the error away from the data cannot be estimated")
        return Lamp(title, "warning", text)
    farthest = max(known, key=lambda one: one.rms)
    level, error = _error(farthest.rms, farthest.scheme, epsilon)
    worst = _least_inside(known)
    if worst is None:
        return _with_outliers(_with_offsets(Lamp(title, level, error), prediction), prediction, epsilon)
    if round(worst.inside, 2) < LEAST_INSIDE and level == "pass":
        level = "warning"
    text = message(
        "data.verdict-left-out",
        "{error}; the 90 % band contains {share:.0f} % ({scheme})",
        error=error,
        share=100 * worst.inside,
        scheme=_SCHEMES[worst.scheme],
    )
    return _with_outliers(_with_offsets(Lamp(title, level, text), prediction), prediction, epsilon)


def _with_offsets(lamp: Lamp, prediction: PredictionResult | None) -> Lamp:
    """Return the lamp with the most significant offset between sources, which turns green to amber."""
    if prediction is None or not prediction.offsets:
        return lamp
    text = message("data.verdict-source-off", "{lamp}; {offset}", lamp=lamp.text, offset=prediction.offsets[0].text)
    return Lamp(lamp.title, "warning" if lamp.level == "pass" else lamp.level, text)


def _with_outliers(lamp: Lamp, prediction: PredictionResult | None, epsilon: float) -> Lamp:
    """Return the lamp with the worst outlier; one farther than epsilon from its neighbours turns green to amber."""
    if prediction is None or not prediction.outliers:
        return lamp
    worst = max(prediction.outliers, key=lambda one: abs(one.error))
    figures = {"lamp": lamp.text, "name": worst.name, "error": abs(worst.error)}
    text = message("data.verdict-outlier", "{lamp}; outlier: {name}, {error:length} m off its neighbours", **figures)
    if len(prediction.outliers) > 1:
        text = message(
            "data.verdict-outliers",
            "{lamp}; {count} outliers, the farthest off its neighbours: {name}, {error:length} m",
            count=len(prediction.outliers),
            **figures,
        )
    return Lamp(lamp.title, "warning" if lamp.level == "pass" and abs(worst.error) > epsilon else lamp.level, text)


def _error(rms: float, scheme: Scheme, epsilon: float) -> tuple[Level, Message]:
    ratio = rms / epsilon
    level: Level = "pass" if ratio <= 1 else "warning" if ratio < FAR else "fail"
    if ratio < 0.01:
        return level, message(
            "data.verdict-left-out-error-small",
            "left-out error {error:length} m < 0.01 ε ({scheme})",
            error=rms,
            scheme=_SCHEMES[scheme],
        )
    text = message(
        "data.verdict-left-out-error",
        "left-out error {error:length} m = {ratio:g} ε ({scheme})",
        error=rms,
        ratio=float(f"{ratio:.2g}"),
        scheme=_SCHEMES[scheme],
    )
    return level, text


def _away_of_body(found: LeftOutBody, epsilon: float) -> Lamp:
    """Return the lamp of a body: as that of a surface, with the contacts and metres that are predicted wrongly."""
    title = message("data.verdict-away", "Away from the data")
    if not np.isfinite(found.error):
        return Lamp(
            title,
            "fail" if found.missed else "none",
            message(
                "data.body-nothing-predicted", "none of {missed} left-out contacts is predicted", missed=found.missed
            )
            if found.missed
            else message("data.verdict-cannot-examine", "the error away from the data cannot be estimated"),
        )
    level, error = _error(found.error, found.scheme, epsilon)
    parts = [error]
    if found.missed:
        parts.append(message("data.contacts-missed", "contacts not predicted: {count}", count=found.missed))
    if found.logged:
        parts.append(
            message(
                "data.misclassified",
                "{wrong:.1f} m of {logged:.1f} m on the wrong side",
                wrong=found.misclassified,
                logged=found.logged,
            )
        )
    if np.isfinite(found.inside):
        parts.append(message("data.band-contains", "the 90 % band contains {share:.0f} %", share=100 * found.inside))
    if found.beyond:
        parts.append(
            message("data.contacts-beyond", "contacts beyond the reach of other data: {count}", count=found.beyond)
        )
    if level == "pass" and (found.missed or found.beyond or round(found.inside, 2) < LEAST_INSIDE):
        level = "warning"
    return Lamp(title, level, message("data.left-out-body", "{parts}", parts=tuple(parts)))


def _least_inside(known: Sequence[LeftOut]) -> LeftOut | None:
    """Return the scheme whose left-out points lie least often inside the band."""
    covered = [one for one in known if np.isfinite(one.inside)]
    return min(covered, key=lambda one: one.inside, default=None)
