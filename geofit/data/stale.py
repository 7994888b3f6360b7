"""Stale surfaces and bodies: what each was made from that is different now."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

from geofit.data.messages import Message, Untranslated, message
from geofit.data.setting_texts import SETTINGS

__all__ = ["StaleCause", "stale_warning"]


@dataclass(frozen=True)
class StaleCause:
    """Why a surface or a body is stale: something that the fit depends on, at the fit and now.

    ``kind`` is "data" (fingerprints of all data of the horizon), "file" (SHA-256 of the file ``name``; None: it is not
    part of the site), "setting" (values of the setting ``name``), "excluded" (rows that are excluded only then or only
    now) or "faults" (those that cut the horizon). Of bodies it is "logs" (fingerprints of the intervals and paths of
    the site's boreholes), "file", "source" (fingerprints of the data in the file ``name``; None: it cannot be read) or
    "horizon" (fingerprints of what the surface ``name`` is made from; None: it has no surface).
    """

    kind: Literal["data", "file", "setting", "excluded", "faults", "logs", "source", "horizon"]
    name: str
    fitted: Any
    now: Any

    @property
    def text(self) -> Message:
        """What has changed, without its values."""
        match self.kind:
            case "data":
                return message("data.stale-data", "Data of the horizon: points, study area, ground, dips")
            case "file":
                return message("data.stale-file", "{file}, SHA-256", file=Untranslated(self.name))
            case "setting":
                return SETTINGS[self.name].with_unit()
            case "excluded":
                return message("data.stale-excluded", "Excluded points")
            case "faults":
                return message("data.stale-faults", "Faults that cut the horizon")
            case "logs":
                return message("data.stale-logs", "Logged intervals and paths of the boreholes")
            case "source":
                return message("data.stale-source", "Data in {file}", file=Untranslated(self.name))
            case "horizon":
                return message("data.stale-horizon", "Surface of horizon {name}", name=Untranslated(self.name))


def stale_warning(names: Iterable[str | Message]) -> Message:
    """Return the warning of everything that shows a verdict on what is stale, and what to do about it."""
    return message(
        "data.stale-surfaces",
        "Stale (fitted to earlier data or settings): {names}. Fit again before you rely on the results.",
        names=tuple(names),
    ).with_severity("warning")
