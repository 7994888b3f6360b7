"""Bodies along surveyed centre lines: caves, adits, tunnels.

Names are loaded when they are first used, so that ``import geofit.caves`` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_MODULES = {
    "AdjustedSurvey": "adjust",
    "Clearance": "clearance",
    "Loop": "adjust",
    "PassageBody": "body",
    "Survey": "survey",
    "SurveyError": "survey",
    "VolumeEstimate": "uncertainty",
    "adjust": "adjust",
    "centreline_body": "body",
    "clearance": "clearance",
    "strata": "strata",
    "volume_estimate": "uncertainty",
}

__all__ = sorted(_MODULES)


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'geofit.caves' has no attribute '{name}'")
    return getattr(import_module(f"geofit.caves.{_MODULES[name]}"), name)
