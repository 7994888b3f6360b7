"""What several tests share and is dear to make: the sample site, fitted once."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import pytest

import geofit

#: Where programs keep their state: not that of the user who runs the tests.
STATE = tempfile.TemporaryDirectory(prefix="geofit-state-")
os.environ["XDG_STATE_HOME"] = STATE.name
SAMPLE = Path(__file__).parents[1] / "sample_data" / "site.toml"


@pytest.fixture(scope="session")
def sample_site():
    """The committed sample site."""
    return geofit.io.read_site(SAMPLE)


@pytest.fixture(scope="session")
def sample_surfaces(sample_site):
    """The fits of the sample site's horizons by name: clean, so every check is silent on them."""
    site = sample_site
    return {
        name: geofit.fit_horizon(points, site.settings.get(name), site.boundary, name=name)
        for name, points in site.horizons.items()
    }
