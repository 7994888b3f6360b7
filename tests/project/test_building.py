"""A surface of a document is compared with the same surroundings as one of a run."""

from __future__ import annotations

from dataclasses import replace

import pytest

import geofit.io
from geofit.data.site import Site
from geofit.project.building import given_of, make
from geofit.project.provenance import Provenance
from geofit.sample import write_site
from geofit.site.fit_site import fit_site


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Site:
    folder = tmp_path_factory.mktemp("site")
    write_site(folder)
    return geofit.io.read_site(folder / "site.toml")


@pytest.mark.parametrize("name", ["T3-T2", "F1", "M1"])
def test_what_surrounds_a_horizon_is_compared_as_in_a_run(name, site):
    # Half of the area: the fault and the fold reach beyond it.
    low, high = site.boundary.min(axis=0), site.boundary.max(axis=0)
    half = site.boundary.clip(low, [(low[0] + high[0]) / 2, high[1]])
    cut = replace(site, boundary=half)
    run = fit_site(cut, [name]).surfaces[name]
    surface = make(Provenance(name, site.settings[name], ""), given_of(cut, Provenance(name, site.settings[name], "")))
    outcomes = [{one.name: (one.passed, one.value) for one in fit.accuracy.checks} for fit in (run, surface)]
    assert outcomes[0] == outcomes[1]
    assert ("contacts" in outcomes[0]) is (name == "T3-T2")
