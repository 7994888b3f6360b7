"""What several tests share and is dear to make: the sample site, fitted once."""

from __future__ import annotations

import importlib
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


@pytest.fixture
def read_here(monkeypatch):
    """CAD files that a test itself has written are read in this process: cad/test_foreign.py shows a child as good."""
    from geofit.cad.foreign import READERS

    def read(path, reader):
        module, function = READERS[reader]
        return getattr(importlib.import_module(module), function)(path)

    for module in ("step", "iges_brep"):
        monkeypatch.setattr(f"geofit.cad.{module}.read_in_child", read)
