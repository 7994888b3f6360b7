"""Holes that pass a surface without a contact of its horizon, through files as a geologist has them."""

from __future__ import annotations

import pytest

from geofit.io.site_file import read_site
from geofit.site.fit_site import fit_site

EAST, NORTH = 500_000.0, 3_100_000.0


def site_of(folder, holes):
    """Holes on a grid of 100 m: each with its logged intervals from 400 m down, (base depth, code) each."""
    collar, log = ["hole,x,y,z,depth"], ["hole,from,to,code"]
    for k, intervals in enumerate(holes):
        name, top = f"Z{k:02d}", 0.0
        collar.append(f"{name},{EAST + 100 * (k % 4)},{NORTH + 100 * (k // 4)},400,{intervals[-1][0]}")
        for base, code in intervals:
            log.append(f"{name},{top},{base},{code}")
            top = base
    (folder / "collar.csv").write_text("\n".join(collar), encoding="utf-8")
    (folder / "log.csv").write_text("\n".join(log), encoding="utf-8")
    text = '[boreholes]\ncollar = "collar.csv"\nintervals = ["log.csv"]\n[[horizon]]\nname = "B/C"\nbase = "B"\n'
    (folder / "site.toml").write_text(text, encoding="utf-8")
    return read_site(folder / "site.toml")


def contacts(folder, holes):
    surface = fit_site(site_of(folder, holes)).surfaces["B/C"]
    (check,) = [one for one in surface.accuracy.checks if one.name == "contacts"]
    assert surface.accuracy.passed
    return check


#: B from 30 to 40 m, with the hole ending in C.
WHOLE = [(30, "A"), (40, "B"), (60, "C")]


def test_holes_with_their_contacts_pass(tmp_path):
    check = contacts(tmp_path, [WHOLE] * 16)
    assert (check.passed, check.value) == (True, 0.0)


def test_a_hole_that_ends_above_the_horizon_contradicts_nothing(tmp_path):
    assert contacts(tmp_path, [*[WHOLE] * 15, [(30, "A"), (38, "B")]]).passed
    assert contacts(tmp_path, [*[WHOLE] * 15, [(25, "A")]]).passed


@pytest.mark.parametrize(
    ("odd", "far"),
    [
        ([(30, "A"), (70, "C")], 30.0),  # pinched out
        ([(30, "A"), (55, "B")], 15.0),  # deeper than the hole
        ([(60, "A")], 20.0),  # all of it above, though it is deep enough
    ],
)
def test_a_hole_that_passes_the_surface_without_a_contact_is_named(odd, far, tmp_path):
    check = contacts(tmp_path, [*[WHOLE] * 5, odd, *[WHOLE] * 10])
    assert (check.passed, check.value, check.unit) == (False, 1.0, "1")
    assert check.text.code == "site.holes-without-contact"
    assert check.text.params["names"] == ("Z05",)
    assert check.text.params["total"] == 16
    assert check.text.params["far"] == pytest.approx(far, abs=0.2)
    assert check.places[0] == pytest.approx((EAST + 100, NORTH + 100, 360.0), abs=0.2)


def test_a_horizon_eroded_before_its_cover_was_laid_down_is_no_failure(tmp_path):
    check = contacts(tmp_path, [*[WHOLE] * 5, [(45, "Q"), (70, "C")], *[WHOLE] * 10])
    assert (check.passed, check.value) == (None, 1.0)
    assert check.text.code == "site.holes-pass-cover"


def test_a_horizon_cut_off_by_an_unconformity_is_no_failure(tmp_path):
    """Z05 logs gravel, the younger U down to 50 m, and C: the surface passes it at 40 m, within U."""
    holes = [[(10, "Q"), (20, "U"), (40, "B"), (60, "C")]] * 16
    holes[5] = [(10, "Q"), (50, "U"), (70, "C")]
    site_of(tmp_path, holes)
    file = tmp_path / "site.toml"
    alone = file.read_text(encoding="utf-8")
    upper = '[[horizon]]\nname = "U/B"\nbase = "U"\n'
    for order, passed in (("", False), ('[site]\norder = ["U/B", "B/C"]\n', None)):
        file.write_text(order + alone + upper, encoding="utf-8")
        surface = fit_site(read_site(file), ["B/C"]).surfaces["B/C"]
        (check,) = [one for one in surface.accuracy.checks if one.name == "contacts"]
        assert (check.passed, check.value) == (passed, 1.0)
    assert check.text.code == "site.holes-pass-cover"


def test_a_part_without_a_log_is_not_asked(tmp_path):
    site_of(tmp_path, [*[WHOLE] * 5, [(30, "A"), (70, "C")], *[WHOLE] * 10])
    log = (tmp_path / "log.csv").read_text(encoding="utf-8")
    (tmp_path / "log.csv").write_text(log.replace("Z05,30,70,C\n", ""), encoding="utf-8")
    surface = fit_site(read_site(tmp_path / "site.toml")).surfaces["B/C"]
    (check,) = [one for one in surface.accuracy.checks if one.name == "contacts"]
    assert check.passed


def test_several_holes_are_listed_the_farthest_first(tmp_path):
    odd = [[(30, "A"), (50 + 5 * k, "C")] for k in range(7)]
    check = contacts(tmp_path, [*[WHOLE] * 4, *odd, *[WHOLE] * 5])
    assert check.value == 7
    assert len(check.places) == 7
    assert str(check.text).count("Z") == 5
    assert "Z10, Z09" in str(check.text)
