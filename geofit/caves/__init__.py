"""Bodies along surveyed centre lines: caves, adits, tunnels.

Other names are loaded when they are first used, so that ``import geofit.caves`` costs numpy only.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

# These functions must hide the modules of their names, so they cannot wait.
from geofit.caves.adjust import adjust_survey
from geofit.caves.clearance import clearance
from geofit.caves.strata import strata

_LAZY = {
    "AdjustedSurvey": "adjust",
    "Clearance": "clearance",
    "Loop": "adjust",
    "PassageBody": "body",
    "Survey": "survey",
    "SurveyError": "survey",
    "VolumeEstimate": "uncertainty",
    "centreline_body": "body",
    "volume_estimate": "uncertainty",
}

__all__ = ["adjust_survey", "clearance", "strata", *_LAZY]


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'geofit.caves' has no attribute '{name}'")
    return getattr(import_module(f"geofit.caves.{_LAZY[name]}"), name)
