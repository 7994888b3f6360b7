"""Stale surfaces: what a surface was fitted to that is different now."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

from geofit.data.messages import Message, message

__all__ = ["StaleCause", "stale_warning"]


@dataclass(frozen=True)
class StaleCause:
    """Why a surface is stale: something that the fit depends on, at the fit and now.

    ``kind`` is "data" (fingerprints of all data of the horizon), "file" (SHA-256 of the file ``name``; None: it is not
    part of the site), "setting" (values of the setting ``name``), "excluded" (rows that are excluded only then or only
    now) or "faults" (those that cut the horizon).
    """

    kind: Literal["data", "file", "setting", "excluded", "faults"]
    name: str
    fitted: Any
    now: Any


def stale_warning(names: Iterable[str]) -> Message:
    """Return the warning of everything that shows a verdict on stale surfaces, and what to do about them."""
    return message(
        "data.stale-surfaces",
        "Stale (fitted to earlier data or settings): {names}. Fit again before you rely on the results.",
        names=tuple(names),
    ).with_severity("warning")
