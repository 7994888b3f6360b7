"""The bodies of the sample site: their logs against their truth, and fits against their volumes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from geofit.bodies.fit import fit_body
from geofit.bodies.intervals import as_body_data
from geofit.bodies.settings import BodySettings
from geofit.data.errors import SettingsError
from geofit.data.site import Site
from geofit.io.site_file import load_site
from geofit.sample import body_truth
from geofit.sample.bodies import BODIES

SAMPLE = Path(__file__).parents[2] / "sample_data" / "bodies.toml"


@pytest.fixture(scope="module")
def site() -> Site:
    return load_site(SAMPLE)


def test_thirty_deviated_holes_cross_the_ore(site: Site) -> None:
    (campaign,) = site.boreholes
    (log,) = campaign.logs
    assert all(issue.severity == "note" for issue in site.issues)
    assert len(set(log.hole[log.code == "ORE"].tolist())) == 30
    for hole, path in campaign.paths.items():
        ends = path.at(np.array([0.0, campaign.ends[hole]]))
        assert np.linalg.norm(ends[1, :2] - ends[0, :2]) > 3.0, hole


@pytest.mark.parametrize("name", BODIES)
def test_logged_contacts_lie_on_the_truth_within_their_noise(site: Site, name: str) -> None:
    truth, data = body_truth(name), as_body_data(site, name, BodySettings())
    step = 1e-3 * np.eye(3)
    slope = [(truth.value(data.contacts + d) - truth.value(data.contacts - d)) / 2e-3 for d in step]
    off = truth.value(data.contacts) / np.linalg.norm(slope, axis=0)
    # Depths are logged within 5 cm, azimuths and dips to a tenth of a degree, which is 0.2 m at 250 m.
    assert np.sqrt((off**2).mean()) < 0.25
    assert (truth.value(data.inside) < 0.5).all()
    assert (truth.value(data.outside) > -0.5).all()


@pytest.mark.parametrize("name", BODIES)
def test_fits_find_the_volume(site: Site, name: str) -> None:
    body = fit_body(site, codes=name)
    assert body.accuracy is not None
    assert body.accuracy.passed
    assert body.accuracy.wrong_side == 0
    assert body.overview.components == 1
    assert body.overview.euler == 2
    assert body.overview.volume == pytest.approx(body_truth(name).volume, rel=0.10)


def test_the_lens_has_the_volume_of_its_ellipsoid() -> None:
    # The warp shifts each column of it, which leaves the volume as it is.
    assert body_truth("ORE").volume == pytest.approx(4 / 3 * np.pi * 95 * 65 * 17, rel=2e-3)


def test_an_unknown_body_is_refused() -> None:
    with pytest.raises(SettingsError, match="ORE, VOID, GABBRO"):
        body_truth("GOLD")
