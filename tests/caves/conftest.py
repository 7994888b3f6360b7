"""The real survey, where the folder of real data is available."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def fulford():
    """Path of Fulford Cave, a Compass survey."""
    folder = Path(os.environ.get("GEOFIT_DATA", Path(__file__).parents[2] / ".." / "shared" / "data"))
    path = folder / "caves" / "Fulford.dat"
    if not path.exists():
        pytest.skip(f"the real survey is not at {path}; set GEOFIT_DATA")
    return path
