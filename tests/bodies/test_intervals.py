"""Logged intervals to contacts, samples and listed issues."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from geofit.bodies.between import between_samples
from geofit.bodies.data import BodyData, prepare
from geofit.bodies.fit import fit_body
from geofit.bodies.intervals import from_intervals
from geofit.bodies.settings import BodySettings
from geofit.data.errors import SettingsError
from geofit.data.site import Site
from geofit.io.site_file import read_site


class Vertical:
    def __init__(self, x: float) -> None:
        self.x = x

    def at(self, depth: np.ndarray) -> np.ndarray:
        return np.column_stack([np.full(len(depth), self.x), np.zeros(len(depth)), -np.asarray(depth)])


def holes(*rows: tuple[str, float, float, str]) -> SimpleNamespace:
    hole, top, base, code = (np.array(column) for column in zip(*rows, strict=True))
    log = SimpleNamespace(hole=hole, top=top, base=base, code=code)
    return SimpleNamespace(logs=(log,), paths={"A": Vertical(0.0), "B": Vertical(50.0)})


def test_contacts_lie_where_sides_meet_and_not_at_gaps() -> None:
    source = holes(("A", 0, 10, "X"), ("A", 10, 20, "ORE"), ("A", 20, 25, "ORE2"), ("A", 25, 40, "X"),
                   ("B", 0, 10, "X"), ("B", 12, 20, "ORE"))  # fmt: skip
    data = from_intervals(source, ["ORE", "ORE2"], step=2.5)
    np.testing.assert_allclose(data.contacts, [[0, 0, -10], [0, 0, -25]])
    assert data.inside_length.sum() == pytest.approx(23)
    assert data.outside_length.sum() == pytest.approx(35)
    assert [issue.kind for issue in data.issues] == ["gap"]


def test_overlap_of_both_sides_is_unknown_and_listed() -> None:
    data = from_intervals(holes(("A", 0, 10, "X"), ("A", 8, 20, "ORE")), "ORE", step=1)
    assert [issue.kind for issue in data.issues] == ["contradiction"]
    assert not ((data.inside[:, 2] < -8) & (data.inside[:, 2] > -10)).any()
    assert not len(data.contacts)


def test_unknown_code() -> None:
    with pytest.raises(SettingsError, match=r"does not occur.*X \(1\)"):
        from_intervals(holes(("A", 0, 10, "X")), "ORE")


def test_codes_in_another_case_are_outside_and_listed() -> None:
    source = holes(("A", 0, 10, "X"), ("A", 10, 20, "ORE"), ("B", 0, 10, "X"), ("B", 10, 20, "Ore"))
    data = from_intervals(source, "ORE", step=1)
    assert [issue.text.code for issue in data.issues] == ["bodies.code-differs-in-case"]
    assert "Ore (1)" in str(data.issues[0].text)
    assert not from_intervals(source, ["ORE", "Ore"], step=1).issues


def test_coincident_contacts_with_opposite_normals_are_listed() -> None:
    data = BodyData(
        contacts=[[0, 0, 0], [0, 0, 1e-9], [5, 0, 0], [0, 5, 0], [0, 0, 5]],
        inside=[[1, 1, 1]],
        outside=[[9, 9, 9]],
        normals=[[0, 0, 1], [0, 0, -1], [1, 0, 0], [np.nan] * 3, [np.nan] * 3],
    )
    found = prepare(data, BodySettings())
    assert len(found.contacts) == 4
    assert found.member.tolist() == [0, 0, 1, 2, 3]
    assert np.isfinite(found.normals[:, 0]).tolist() == [False, True, False, False]
    assert {issue.kind for issue in found.issues} == {"coincident", "normal"}


def test_samples_that_contradict_each_other_are_listed_and_left_out() -> None:
    data = BodyData([[0, 0, 0], [5, 0, 0], [0, 5, 0]], inside=[[1, 1, 1], [2, 2, 2]], outside=[[2, 2, 2], [9, 9, 9]])
    found = prepare(data, BodySettings())
    assert found.inside_used.tolist() == [True, False]
    assert found.outside_used.tolist() == [False, True]
    assert [issue.kind for issue in found.issues] == ["contradiction"]


def test_a_site_with_two_campaigns_that_share_a_hole_name() -> None:
    first = holes(("A", 0, 10, "X"), ("A", 10, 20, "ORE"), ("B", 0, 20, "X"))
    second = SimpleNamespace(logs=first.logs, paths={"A": Vertical(100.0), "B": Vertical(150.0)})
    data = from_intervals((first, second), "ORE", step=5)
    assert data.holes == ("A", "A (2)", "B", "B (2)")
    np.testing.assert_allclose(data.contacts, [[0, 0, -10], [100, 0, -10]])


def test_a_site_file_keeps_its_logs(tmp_path: Path) -> None:
    collar = [(f"H{i}{j}", 500_000 + 20 * i, 3_000_000 + 20 * j) for i in range(5) for j in range(5)]
    lines = ["hole,x,y,z,depth"] + [f"{name},{x},{y},100,60" for name, x, y in collar]
    (tmp_path / "collar.csv").write_text("\n".join(lines) + "\n")
    rows = ["hole,from,to,code"]
    for name, x, y in collar:
        half = 1 - ((x - 500_040) / 32) ** 2 - ((y - 3_000_040) / 32) ** 2
        if half > 0:
            top, base = 30 - 15 * half**0.5, 30 + 15 * half**0.5
            rows += [f"{name},0,{top:.2f},ROCK", f"{name},{top:.2f},{base:.2f},ORE", f"{name},{base:.2f},60,ROCK"]
        else:
            rows.append(f"{name},0,60,ROCK")
    (tmp_path / "lithology.csv").write_text("\n".join(rows) + "\n")
    (tmp_path / "site.toml").write_text(
        '[site]\nname = "Lens"\n[[horizon]]\nname = "ore top"\ntop = "ORE"\n'
        '[boreholes]\ncollar = "collar.csv"\nintervals = "lithology.csv"\n'
    )
    site = read_site(tmp_path / "site.toml")
    assert [sorted(set(log.code.tolist())) for campaign in site.boreholes for log in campaign.logs] == [["ORE", "ROCK"]]
    body = fit_body(site, codes="ORE")
    assert body.accuracy is not None
    assert body.accuracy.wrong_side == 0
    assert body.triangulate().volume == pytest.approx(4 / 3 * np.pi * 32 * 32 * 15, rel=0.05)
    with pytest.raises(SettingsError, match="no logged intervals"):
        fit_body(Site("empty", {}), codes="ORE")


@pytest.mark.parametrize("thin", [0.1, 0.3, 1.0])
def test_a_thin_interval_between_two_stretches_is_not_taken_for_a_crossing(thin: float) -> None:
    """Samples of two stretches were taken for neighbours, and the rock between them for one that they miss."""
    rows = [("A", 0, 20, "X"), ("A", 20, 28, "ORE"), ("A", 28, 28 + thin, "X"), ("A", 28 + thin, 36, "ORE"),
            ("A", 36, 60, "X"), ("B", 0, 60, "X")]  # fmt: skip
    data = from_intervals(holes(*rows), "ORE", step=2.2)
    for inside in (True, False):
        places, share, _ = between_samples(data, inside=inside)
        depth = -places[:, 2]
        assert len(depth)
        assert share.sum() < (data.inside_length if inside else data.outside_length).sum()
        rock = (depth > 20) & (depth < 36) & ~((depth > 28) & (depth < 28 + thin)) & (places[:, 0] == 0)
        assert (rock == inside).all()
    accuracy = fit_body(data).accuracy
    assert accuracy is not None
    assert (accuracy.extra_crossings, accuracy.missed_length, accuracy.excess_length) == (0, 0.0, 0.0)


def test_a_stretch_without_a_sample_parts_those_on_either_side_of_it() -> None:
    """Of samples at even distances none need lie in a thin interval: what is around it says nothing of its inside."""
    depth = np.array([2.0, 6, 10, 14, 18, 22, 26])
    path = Vertical(0.0)
    inside = np.isin(depth, [10, 14, 18])
    data = BodyData(
        path.at(np.array([8.0, 11.5, 12.5, 20.0])),
        path.at(depth[inside]),
        path.at(depth[~inside]),
        hole=["A"] * 4,
        inside_hole=["A"] * 3,
        outside_hole=["A"] * 4,
        inside_length=np.full(3, 4.0),
        outside_length=np.full(4, 4.0),
    )
    places = between_samples(data, inside=True)[0]
    np.testing.assert_allclose(-places[:, 2], [15, 16, 17])
    other = replace(data, hole=np.array(["A", "B", "B", "A"]))
    np.testing.assert_allclose(-between_samples(other, inside=True)[0][:, 2], [11, 12, 13, 15, 16, 17])


@pytest.mark.parametrize("dense", [600, 60])
def test_a_hole_between_whose_samples_the_body_bulged_is_honoured_there(dense: int) -> None:
    """In parts or not: the sides between two samples are asked for where the field has the other one."""
    rng = np.random.default_rng(4)
    unit = rng.normal(size=(120, 3))
    unit /= np.linalg.norm(unit, axis=1)[:, None]
    bump = np.array([[36.0, y, z] for y in (-3.0, 3.0) for z in (-2.0, 2.0)])
    contacts = np.concatenate([30 * unit[np.abs(unit[:, 1:]).max(axis=1) > 0.25], bump])
    outside = np.column_stack([np.full(4, 33.0), np.zeros(4), 30.0 - 15.0 * np.arange(4) - 7.5])
    data = BodyData(contacts, np.zeros((1, 3)), outside, outside_hole=["H"] * 4, outside_length=np.full(4, 15.0))
    places, share, _ = between_samples(data, inside=False)
    body = fit_body(data, BodySettings(dense=dense))
    assert (body.fitted.system is None) == (dense == 60)
    assert (body.value(places) > 0).all()
    accuracy = body.accuracy
    assert accuracy is not None
    assert (accuracy.extra_crossings, accuracy.excess_length) == (0, 0.0)
    assert np.abs(accuracy.residuals).max() < 1e-6
    alone = fit_body(BodyData(contacts, np.zeros((1, 3)), outside), BodySettings(dense=dense))
    wrong = alone.value(places) <= 0
    assert 0 < share[wrong].sum() < 15.0
