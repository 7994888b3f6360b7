"""A unit whose base the hole did not reach has no base there, whatever way the log states it."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.bodies.intervals import from_intervals
from geofit.io import read_boreholes, take_contacts
from geofit.io.site_file import read_site
from geofit.site.fit_site import fit_site


def bases(write, rows, depth=50.0, head="hole,from,to,code"):
    collar = write(f"hole,x,y,z,depth\nB1,0,0,100,{depth}\n", "collar.csv")
    log = write(head + "\n" + "".join(f"B1,{row}\n" for row in rows.split(";")), "log.csv")
    holes = read_boreholes(collar, None, [log])
    return holes, take_contacts(holes, base="B")


@pytest.mark.parametrize(
    "rows",
    [
        "0,10,A;10,40,B;40,50,not reached",
        "0,10,A;10,40,B;40,50,Base not reached.",
        "0,10,A;10,40,B;40,50,未揭穿",
        "0,10,A;10,40,B;40,40,end of hole",
        "0,10,A;10,50,B;50,50,EOH",
        "0,10,A;10,40,B;40,60,NOT_REACHED",
        "0,10,A;10,20,B;20,40,B;40,50,not reached",
        # The log ends as its hole does, but for what was rounded.
        "0,10,A;10,49.6,B",
        "0,10,A;10,49.98,B",
    ],
)
def test_a_base_that_was_not_reached_is_no_contact(write, rows):
    holes, contacts = bases(write, rows)
    assert len(contacts.points) == 0
    assert any(issue.reason.code == "io.contacts-uncertain" for issue in contacts.issues)
    (log,) = holes.logs
    assert set(log.code.tolist()) == {"A", "B"}
    count = holes.counts[-1]
    assert count.read == count.used + count.listed


@pytest.mark.parametrize(
    ("rows", "depth"),
    [
        ("0,10,A;10,40,B;40,50,C", 40),
        # A mark ends the unit right above it, no other.
        ("0,10,A;10,40,B;40,45,C;45,50,not reached", 40),
        # Much of the hole is not logged: it may be that only the cover was.
        ("0,10,A;10,40,B", 40),
        ("0,10,A;10,49.5,B;49.5,50,C", 49.5),
    ],
)
def test_a_base_that_was_reached_is_one(write, rows, depth):
    np.testing.assert_allclose(bases(write, rows)[1].points.xyz[:, 2], [100 - depth])


def test_with_lower_limits_only_a_mark_ends_the_log_too(write):
    assert len(bases(write, "10,A;40,B;50,not reached", head="hole,to,code")[1].points) == 0
    np.testing.assert_allclose(
        bases(write, "10,A;40,B;45,C;50,not reached", head="hole,to,code")[1].points.xyz[:, 2], [60]
    )


def test_what_was_not_reached_is_outside_no_body(write):
    holes, _ = bases(write, "0,10,A;10,40,B;40,50,not reached")
    data = from_intervals(holes, "B")
    np.testing.assert_allclose(data.contacts[:, 2], [90])
    assert data.outside[:, 2].min() > 90
    assert (data.inside[:, 2] > 60).all()


def test_holes_that_end_in_a_unit_do_not_pull_its_base_up(tmp_path):
    """Base of B at 60 m below a flat ground; every third hole ends in B at 30 m, as its log states."""
    collar, log = ["hole,x,y,z,depth"], ["hole,from,to,code"]
    for k in range(25):
        name, short = f"Z{k:02d}", k % 3 == 0
        collar.append(f"{name},{500_000 + 100 * (k % 5)},{3_100_000 + 100 * (k // 5)},400,{40 if short else 80}")
        log += [f"{name},0,10,A", f"{name},10,{30 if short else 60},B"]
        log += [f"{name},30,40,not reached"] if short else [f"{name},60,80,C"]
    (tmp_path / "collar.csv").write_text("\n".join(collar), encoding="utf-8")
    (tmp_path / "log.csv").write_text("\n".join(log), encoding="utf-8")
    text = '[boreholes]\ncollar = "collar.csv"\nintervals = ["log.csv"]\n[[horizon]]\nname = "B/C"\nbase = "B"\n'
    (tmp_path / "site.toml").write_text(text, encoding="utf-8")
    site = read_site(tmp_path / "site.toml")
    surface = fit_site(site).surfaces["B/C"]
    assert len(surface.points) == 16
    assert surface.elevation(500_200.0, 3_100_200.0) == pytest.approx(340.0, abs=0.1)
    (check,) = [one for one in surface.accuracy.checks if one.name == "contacts"]
    assert check.passed
