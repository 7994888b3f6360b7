from __future__ import annotations

import pytest

from bodies.planted import drilled, pair, torus
from geofit.bodies.body import BodyFit
from geofit.bodies.fit import fit_body


@pytest.fixture(scope="session")
def ring() -> BodyFit:
    return fit_body(drilled(torus(0.55, 0.22)[0], 1, rows=9, named=True), name="ring")


@pytest.fixture(scope="session")
def two() -> BodyFit:
    return fit_body(drilled(pair()[0], 1, rows=9), name="two")
