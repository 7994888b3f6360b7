"""The data of a site in one file: what a fit depends on comes back to the last bit."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.io.site_file import read_site
from geofit.io.snapshot import read_snapshot, write_snapshot
from geofit.project.provenance import fingerprint


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    from geofit.sample import write_site

    folder = tmp_path_factory.mktemp("site")
    write_site(folder)
    return read_site(folder / "site.toml")


def test_a_snapshot_has_the_data_to_the_last_bit(site, tmp_path):
    file = tmp_path / "deep" / "a.npz"
    write_snapshot(site, file)
    back = read_snapshot(file)
    assert list(back.horizons) == list(site.horizons)
    for name, points in site.horizons.items():
        assert fingerprint(back.horizons[name], back) == fingerprint(points, site)
    assert [(hole.name, hole.kind) for hole in back.holes] == [(hole.name, hole.kind) for hole in site.holes]
    assert all((a.xyz == b.xyz).all() for a, b in zip(back.holes, site.holes, strict=True))
    assert [one.name for one in back.sections] == [one.name for one in site.sections]
    assert (back.order, dict(back.faults), dict(back.inputs)) == (site.order, dict(site.faults), dict(site.inputs))
    for f in fields(site.ground):
        assert np.array_equal(getattr(back.ground, f.name), getattr(site.ground, f.name), equal_nan=True)


def test_the_same_site_gives_the_same_bytes(site, tmp_path):
    write_snapshot(site, tmp_path / "a.npz")
    write_snapshot(site, tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


@pytest.mark.parametrize("damage", ["absent", "no archive", "torn", "newer"])
def test_a_damaged_snapshot_says_so(site, tmp_path, damage):
    file = tmp_path / "a.npz"
    write_snapshot(site, file)
    data = file.read_bytes()
    if damage == "absent":
        file.unlink()
    elif damage == "no archive":
        file.write_bytes(b"nothing")
    elif damage == "torn":
        file.write_bytes(data[: len(data) // 2])
    else:
        import zipfile

        with zipfile.ZipFile(file, "w") as archive:
            archive.writestr("site.json", '{"format": "geofit snapshot", "version": 99}')
    with pytest.raises(InputError) as caught:
        read_snapshot(file)
    assert caught.value.reason.code == "io.snapshot-unreadable"
