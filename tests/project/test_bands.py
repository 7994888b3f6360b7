"""A surface of the 90 % band that cannot be written costs only itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import with_code

from geofit import PointSet
from geofit.data.site import Site
from geofit.prediction import bands
from geofit.project.run import run_horizons


@pytest.mark.parametrize("what", ["one side", "both"])
def test_an_invalid_upper_band_leaves_the_horizon_and_the_other_band(what, tmp_path, monkeypatch):
    known = bands.band

    def planted(surface, found):
        if what == "both":
            raise ZeroDivisionError
        upper, lower = known(surface, found)
        broken = [replace(patch, control=np.full_like(patch.control, np.nan)) for patch in upper.patches]
        return upper.with_(patches=tuple(broken)), lower

    monkeypatch.setattr(bands, "band", planted)
    plan = np.random.default_rng(1).uniform(0, 100, (14, 2))
    xyz = np.column_stack([plan + np.array([500_000.0, 3_100_000.0]), 0.1 * plan[:, 0] + np.sin(plan[:, 1] / 20)])
    done = run_horizons(Site("s", {"T": PointSet(xyz)}), tmp_path, bands=True, date="2024-01-01")
    assert not done.failures
    assert done.results[0].accuracy.passed
    assert with_code(done.warnings, "project.band-missing").params["name"] == "T"
    written = {path.name for path in tmp_path.glob("*.step")}
    assert written == ({"T.step", "T_lower90.step"} if what == "one side" else {"T.step"})
