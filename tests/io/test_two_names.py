"""Holes that were entered twice: under two names, or with a log in each of two tables."""

from __future__ import annotations

import pytest

import geofit

SITE = """[site]
[[boreholes]]
collar = "collar.csv"
survey = "survey.csv"
intervals = ["a.csv", "b.csv"]
dip = "down-positive"
[[horizon]]
name = "base"
base = "T2"
"""


@pytest.fixture
def read(tmp_path):
    def read_site(collars, surveys, first, second):
        for name, head, rows in (
            ("collar.csv", "hole,x,y,z,depth", collars),
            ("survey.csv", "hole,depth,azimuth,dip", surveys),
            ("a.csv", "hole,from,to,code", first),
            ("b.csv", "hole,from,to,code", second),
        ):
            (tmp_path / name).write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
        (tmp_path / "site.toml").write_text(SITE, encoding="utf-8")
        return geofit.read_site(tmp_path / "site.toml")

    return read_site


def log(hole, depth):
    return [f"{hole},0,{depth},T2", f"{hole},{depth},90,T1"]


def found(site, code):
    return [issue for issue in site.issues if issue.reason.code == code]


PLACES = [(500_000.0, 3_100_000.0), (500_200.0, 3_100_000.0), (500_000.0, 3_100_200.0), (500_200.0, 3_100_200.0)]
COLLARS = [f"ZK{k},{x},{y},100,90" for k, (x, y) in enumerate(PLACES)]
SURVEYS = [f"ZK{k},0,30,60" for k in range(4)]
LOGS = [row for k in range(4) for row in log(f"ZK{k}", 40 + k)]


def test_one_hole_under_two_names_is_warned_of(read):
    """Its contacts count twice, and leaving out one of the two predicts the other: nothing had been said."""
    twin = ["BH7,500200.06,3100000.04,100.02,90"]
    site = read([*COLLARS, *twin], [*SURVEYS, "BH7,0,30.4,60.1"], [*LOGS, *log("BH7", 41.2)], log("X", 5))
    (issue,) = found(site, "io.holes-of-two-names")
    assert (issue.severity, issue.file, issue.value) == ("warning", "collar.csv", "BH7")
    assert issue.reason.params["names"] == ("BH7 = ZK1",)


@pytest.mark.parametrize(
    ("collar", "survey"),
    [
        ("FAN2,500200.06,3100000.04,100.02,90", "FAN2,0,40,60"),  # a fan: another direction
        ("CPT,500201.5,3100000,100,90", "CPT,0,30,60"),  # the test next to the hole
    ],
)
def test_holes_that_lie_near_each_other_are_two(read, collar, survey):
    site = read([*COLLARS, collar], [*SURVEYS, survey], LOGS, log("X", 5))
    assert not found(site, "io.holes-of-two-names")


def test_holes_logged_in_two_tables_are_warned_of(read):
    """Of inclined holes both contacts were used without a word: they are at two locations."""
    again = [*log("ZK0", 40), *log("ZK1", 41.3), *log("ZK2", 43.0)]
    site = read(COLLARS, SURVEYS, LOGS, again)
    (issue,) = found(site, "io.contact-in-two-logs")
    assert (issue.severity, issue.file, issue.row) == ("warning", "b.csv", 6)
    assert {key: issue.reason.params[key] for key in ("count", "file", "hole")} == {
        "count": 2, "file": "a.csv", "hole": "ZK2"
    }  # fmt: skip
    assert issue.reason.params["distance"] == pytest.approx(1.0)
    assert len(site.horizons["base"]) == 7
    assert not found(read(COLLARS, SURVEYS, LOGS, log("ZK0", 40)), "io.contact-in-two-logs")
