"""Contacts by rule: codes that count as one, thin beds that do not count, the first or the last bed."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.data.errors import InputError, SettingsError
from geofit.data.logs import IntervalLog, LoggedHoles
from geofit.io.contact_rules import ContactRule, code_key
from geofit.io.contacts import load_rule
from geofit.io.journal import Journal
from geofit.io.site_file import read_site


class Straight:
    def at(self, depth):
        depth = np.atleast_1d(np.asarray(depth, float))
        return np.column_stack([np.zeros_like(depth), np.zeros_like(depth), 100 - depth])


def logged(*holes):
    """Holes from lists of (code, thickness)."""
    rows = []
    for k, beds in enumerate(holes):
        depth = 0.0
        for code, thickness in beds:
            rows.append((f"B{k}", depth, depth + thickness, code))
            depth += thickness
    hole, top, base, code = (np.array(column) for column in zip(*rows, strict=True))
    log = IntervalLog("log.csv", hole, top.astype(float), base.astype(float), code, np.arange(len(rows)) + 2)
    ends = {f"B{k}": sum(t for _, t in beds) for k, beds in enumerate(holes)}
    return LoggedHoles({name: Straight() for name in ends}, ends, (log,))


BEDS = [("soil", 5), ("sand", 3), ("clay", 0.4), ("silt", 4), ("clay", 6), ("sand", 0.3), ("clay", 2), ("rock", 10)]


@pytest.mark.parametrize(
    ("rule", "depth"),
    [
        (ContactRule(("sand",), "top"), 5.0),
        (ContactRule(("sand",), "base"), 18.7),
        (ContactRule(("sand",), "base", "first"), 8.0),
        (ContactRule(("sand",), "top", "last"), 18.4),
        (ContactRule(("sand", "silt"), "base", "first"), 8.0),
        # The clay of 0.4 m within is a parting, the sand of 0.3 m is none of the bed.
        (ContactRule(("sand", "silt"), "base", None, 0.5), 12.4),
        (ContactRule(("sand", "silt"), "base", None, 0.35), 12.4),
        (ContactRule(("clay",), "top", None, 0.5), 12.4),
        (ContactRule(("clay",), "base", "first", 0.0), 8.4),
        (ContactRule(("soil", "sand", "silt", "clay"), "base"), 20.7),
    ],
)
def test_depth_of_the_contact(rule, depth):
    points = load_rule(logged(BEDS), rule, Journal())
    assert points.xyz[:, 2] == pytest.approx([100 - depth])


def test_a_hole_with_thin_beds_only_is_named():
    journal = Journal()
    holes = logged(BEDS, [("soil", 4), ("sand", 0.2), ("rock", 9)])
    points = load_rule(holes, ContactRule(("sand",), "top", None, 0.5), journal)
    assert points.hole.tolist() == ["B0"]
    assert "io.beds-too-thin" in [issue.reason.code for issue in journal.issues]


def test_a_bed_at_the_hole_end_stays_however_thin():
    beds = [("soil", 4), ("rock", 0.1)]
    assert load_rule(logged(beds), ContactRule(("rock",), "top", None, 1.0), Journal()).xyz[0, 2] == 96


def test_rules_by_chance_keep_their_promise():
    """Whatever the beds: no bed that decides is thinner than asked, and 0 m changes nothing."""
    rng = np.random.default_rng(4)
    for _ in range(200):
        beds = [(str(rng.choice(["a", "b", "c"])), round(float(rng.uniform(0.1, 3)), 2)) for _ in range(12)]
        holes = logged([("soil", 1), *beds, ("end", 2)])
        plain = load_rule(holes, ContactRule(("a", "b"), "top"), Journal())
        log = holes.logs[0]
        of = np.isin(log.code, ["a", "b"])
        if of.any():
            assert plain.xyz[0, 2] == pytest.approx(100 - log.top[of][0])
        thick = load_rule(holes, ContactRule(("a", "b"), "top", None, 1.0), Journal())
        if len(thick):
            top = 100 - thick.xyz[0, 2]
            assert log.code[np.abs(log.top - top) < 1e-9][0] in ("a", "b")


def test_the_site_file_states_rules_and_complains_clearly(tmp_path):
    (tmp_path / "c.csv").write_text("hole,x,y,z,depth\n" + "".join(f"B{k},{k},0,100,30\n" for k in range(4)), "utf-8")
    log = "".join(f"B{k},0,5,soil\nB{k},5,8,sand\nB{k},8,12,silt\nB{k},12,30,rock\n" for k in range(4))
    (tmp_path / "l.csv").write_text("hole,from,to,code\n" + log, "utf-8")
    head = '[boreholes]\ncollar = "c.csv"\nintervals = ["l.csv"]\n[[horizon]]\nname = "h"\n'
    file = tmp_path / "site.toml"
    file.write_text(head + 'base = ["sand", "silt"]\nthinner = 0.5\noccurrence = "last"\n', "utf-8")
    assert read_site(file).horizons["h"].xyz[:, 2].tolist() == [88.0] * 4
    for wrong, code in (
        ('base = ["sand"]\noccurrence = "second"\n', "io.occurrence-unknown"),
        ("thinner = 0.5\n", "io.rule-without-code"),
        ("base = [1]\n", "io.codes-not-text"),
        ('base = "sand"\nthinner = -1\n', "io.key-and-error"),
        ('base = "sand"\ntop = "silt"\n', "io.top-and-base"),
    ):
        file.write_text(head + wrong, "utf-8")
        with pytest.raises(InputError) as caught:
            read_site(file)
        assert caught.value.reason.code == code


def test_a_rule_needs_a_code():
    with pytest.raises(SettingsError):
        ContactRule(())


def test_a_code_that_no_interval_has_is_named_though_others_are_found():
    journal = Journal()
    points = load_rule(logged(BEDS), ContactRule(("sand", "snad"), "top"), journal)
    assert len(points) == 1
    (issue,) = (one for one in journal.issues if one.reason.code == "io.rule-code-not-logged")
    assert (issue.severity, issue.value) == ("warning", "snad")
    assert "Did you mean 'sand'?" in str(issue.remedy)


def test_codes_in_another_case_are_warned_of():
    journal = Journal()
    holes = logged([("soil", 4), ("T2", 2), ("rock", 9)], [("soil", 4), ("t2", 3), ("rock", 9)])
    assert load_rule(holes, ContactRule(("T2",)), journal).hole.tolist() == ["B0"]
    (found,) = [issue for issue in journal.issues if issue.reason.code == "io.code-differs-in-case"]
    assert found.severity == "warning"
    assert 'base = ["T2", "t2"]' in str(found.remedy)
    journal = Journal()
    assert load_rule(holes, ContactRule(("T2", "t2")), journal).hole.tolist() == ["B0", "B1"]
    assert not journal.issues


def test_codes_in_letters_that_look_alike_are_warned_of():
    """T2 typed on a Cyrillic keyboard: its contacts were lost without a word."""
    journal = Journal()
    holes = logged([("soil", 4), ("T2", 2), ("rock", 9)], [("soil", 4), ("\u04222", 3), ("rock", 9)])
    assert load_rule(holes, ContactRule(("T2",)), journal).hole.tolist() == ["B0"]
    (found,) = [issue for issue in journal.issues if issue.reason.code == "io.code-differs-in-case"]
    assert found.value == "\u04222"


def test_greek_letters_have_a_meaning():
    assert len({code_key(code) for code in ("β", "B", "γ", "α", "A")}) == 5


def test_a_bed_that_no_hole_leaves_is_the_reason_of_a_horizon_without_points(tmp_path):
    (tmp_path / "collar.csv").write_text("hole,x,y,z,depth\nB1,0,0,90,9\nB2,50,0,91,9\n", "utf-8")
    (tmp_path / "log.csv").write_text("hole,from,to,code\nB1,0,4,Q\nB1,4,9,T\nB2,0,5,Q\nB2,5,9,T\n", "utf-8")
    file = tmp_path / "site.toml"
    tables = '[boreholes]\ncollar = "collar.csv"\nintervals = ["log.csv"]\n[[horizon]]\nname = "T"\nbase = "T"\n'
    file.write_text(tables, "utf-8")
    with pytest.raises(InputError) as caught:
        read_site(file)
    assert caught.value.reason.code == "io.horizon-open-everywhere"
    assert caught.value.reason.params["count"] == 2
