"""How a chapter about something that is judged begins: the badge of its verdict, and its three lamps as a sentence."""

from __future__ import annotations

from collections.abc import Iterable

from geofit.data.languages import Language, translate
from geofit.data.verdict import Lamp
from geofit.report.document import CheckMark, Paragraph, VerdictMark

__all__ = ["lamp_mark", "lamps_paragraph", "verdict_badge"]


def verdict_badge(word: str, t: Language, *, stale: bool = False) -> VerdictMark:
    """Return the badge of a verdict: "PASS", "WARNING" or "FAIL"; a stale surface does not pass without a warning."""
    words = {"PASS": t("PASS"), "WARNING": t("WARNING"), "FAIL": t("FAIL")}
    if stale:
        return VerdictMark(False if word == "FAIL" else None, t("{name} (stale)", name=words[word]))
    return VerdictMark({"PASS": True, "FAIL": False}.get(word), words[word])


def lamps_paragraph(lamps: Iterable[Lamp], t: Language) -> Paragraph:
    """Return what the lamps of a verdict say: at the data, checks, away from the data."""
    return Paragraph(" · ".join(t("{title}: {text}", title=lamp.title, text=lamp.text) for lamp in lamps))


def lamp_mark(lamp: Lamp, t: Language) -> CheckMark:
    """Return what one lamp says as a cell of a table of verdicts."""
    text = translate(lamp.text, t)
    return CheckMark({"pass": True, "fail": False}.get(lamp.level), f"! {text}" if lamp.level == "warning" else text)
