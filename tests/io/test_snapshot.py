"""The data of a site in one file: what a fit depends on comes back to the last bit."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.io.site_file import read_site
from geofit.io.snapshot import read_snapshot, write_snapshot
from geofit.project.body_sources import given_of_logs
from geofit.project.provenance import fingerprint
from geofit.site.fit_site import fit_site
from geofit.site.site_checks import add_site_checks


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


def test_a_snapshot_has_the_logs(site, tmp_path):
    file = tmp_path / "a.npz"
    write_snapshot(site, file)
    back = read_snapshot(file)
    assert given_of_logs(back.boreholes) == given_of_logs(site.boreholes)
    for one, other in zip(back.boreholes, site.boreholes, strict=True):
        assert dict(one.ends) == dict(other.ends)
        assert [path.straight for path in one.paths.values()] == [path.straight for path in other.paths.values()]
        for log, known in zip(one.logs, other.logs, strict=True):
            assert log.file == known.file
            assert np.array_equal(log.row, known.row)
            assert np.array_equal(log.ended, known.ended)


def test_a_surface_has_the_same_checks_with_a_snapshot(tmp_path):
    """One of 16 holes passes the surface without a contact: the data of an earlier state show it, too."""
    collar, log = ["hole,x,y,z,depth"], ["hole,from,to,code"]
    for k in range(16):
        collar.append(f"Z{k},{500_000 + 100 * (k % 4)},{3_100_000 + 100 * (k // 4)},400,60")
        rest = "30,60,C" if k == 5 else f"30,40,B\nZ{k},40,60,C"
        log += [f"Z{k},0,30,A", f"Z{k},{rest}"]
    (tmp_path / "collar.csv").write_text("\n".join(collar), encoding="utf-8")
    (tmp_path / "log.csv").write_text("\n".join(log), encoding="utf-8")
    text = '[boreholes]\ncollar = "collar.csv"\nintervals = ["log.csv"]\n[[horizon]]\nname = "B/C"\nbase = "B"\n'
    (tmp_path / "site.toml").write_text(text, encoding="utf-8")
    site = read_site(tmp_path / "site.toml")
    surface = fit_site(site).surfaces["B/C"]
    write_snapshot(site, tmp_path / "a.npz")
    bare = surface.with_(accuracy=replace(surface.accuracy, checks=()))
    again = add_site_checks(bare, read_snapshot(tmp_path / "a.npz"))
    (then,), (now,) = ([check for check in one.accuracy.checks if check.name == "contacts"] for one in (surface, again))
    assert (now.passed, now.value, str(now.text)) == (then.passed, then.value, str(then.text))
    assert now.passed is False


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
