"""Leave one hole out, against brute force and two usual methods."""

from __future__ import annotations

import numpy as np
import pytest

from bodies.planted import ORIGIN, drilled, ellipsoid
from geofit.bodies import crossval
from geofit.bodies.body import BodyFit
from geofit.bodies.crossval import leave_one_hole_out, left_out_body
from geofit.bodies.data import BodyData
from geofit.bodies.fit import fit_body
from geofit.bodies.outlines import Outline, from_outlines
from geofit.bodies.posterior import BodyPosterior
from geofit.bodies.simulate import simulate
from geofit.data.errors import FitError
from geofit.streaming import executors
from geofit.streaming.executors import Where


def test_a_hole_left_out_by_hand(ring: BodyFit) -> None:
    found = leave_one_hole_out(ring, holes=4)
    assert list(found.methods) == ["body", "linear RBF", "indicator kriging"]
    assert not found.skipped
    for score in found.methods["body"].holes:
        again = fit_body(ring.data.without(score.hole))
        inside, outside = ring.data.inside_hole == score.hole, ring.data.outside_hole == score.hole
        wrong = (again.value(ring.data.inside[inside]) >= 0).sum() + (again.value(ring.data.outside[outside]) < 0).sum()
        assert score.misclassified == pytest.approx(4.0 * wrong)
        assert score.logged == pytest.approx(4.0 * (inside.sum() + outside.sum()))


def test_the_body_predicts_better_than_the_usual_methods() -> None:
    wrong = {"body": 0.0, "linear RBF": 0.0, "indicator kriging": 0.0}
    for seed in (0, 1, 2):
        body = fit_body(drilled(ellipsoid((0.65, 0.45, 0.35))[0], seed, named=True))
        found = leave_one_hole_out(body, holes=12)
        for name, method in found.methods.items():
            wrong[name] += method.misclassified
        assert found.methods["body"].contact_error < 10
    assert wrong["body"] < wrong["linear RBF"]
    assert wrong["body"] < wrong["indicator kriging"]


def test_a_hole_that_the_body_needs_is_skipped_with_its_reason() -> None:
    line = np.arange(-20.0, 21.0, 4.0)
    xyz = np.array([(x, 0.0, z) for x in (0.0, 30.0, 60.0) for z in line]) + ORIGIN
    hole = np.repeat(["A", "B", "C"], len(line))
    inside = (np.abs(xyz[:, 2] - ORIGIN[2]) < 9) & (hole == "A")
    contacts = np.array([(x, 0.0, z) for x in (0.0,) for z in (-10, 10)]) + ORIGIN
    data = BodyData(contacts, xyz[inside], xyz[~inside], None, ["A", "A"], hole[inside], hole[~inside])
    found = leave_one_hole_out(fit_body(data))
    assert set(found.skipped) == {"A"}
    assert "Nothing lies inside" in found.skipped["A"]


def test_data_without_names() -> None:
    with pytest.raises(FitError, match="three holes"):
        leave_one_hole_out(fit_body(drilled(ellipsoid((0.6, 0.4, 0.3))[0], 0)))


def test_holes_left_out_and_simulations_on_two_processes(ring: BodyFit, monkeypatch: pytest.MonkeyPatch) -> None:
    one, two = (leave_one_hole_out(ring, 4, workers=n) for n in (1, 2))
    assert one == two
    assert one.methods["body"].holes
    monkeypatch.setattr(crossval, "LARGE", 20)
    started: list[int] = []
    run = executors.run_tasks
    monkeypatch.setattr(executors, "run_tasks", lambda *given: started.append(given[3]) or run(*given))
    assert left_out_body(ring, 2) == left_out_body(ring)
    assert started == [2, 1]
    alone, apart = simulate(ring), simulate(ring, Where("local", 2))
    assert alone.values == pytest.approx(apart.values, rel=1e-9)


@pytest.fixture(scope="module")
def egg() -> BodyFit:
    return fit_body(drilled(ellipsoid((0.65, 0.45, 0.35))[0], 3, named=True))


def test_what_the_verdict_takes_from_holes_left_out(egg: BodyFit) -> None:
    found = leave_one_hole_out(egg, holes=8)
    alone = leave_one_hole_out(egg, holes=8, compared=False)
    assert list(alone.methods) == ["body"]
    assert alone.left_out == found.left_out
    left = found.left_out
    score = found.methods["body"]
    errors = np.concatenate([hole.contact_errors for hole in score.holes])
    assert left.error == pytest.approx(np.sqrt((errors**2).mean()))
    assert (left.scheme, left.groups, left.misclassified) == ("hole", len(score.holes), score.misclassified)
    assert 0.5 < left.inside <= 1.0


def test_the_band_of_holes_left_out_by_hand(egg: BodyFit) -> None:
    holes = leave_one_hole_out(egg, holes=8, compared=False).methods["body"].holes
    hole = next(one for one in holes if one.contacts)
    again = fit_body(egg.data.without(hole.hole))
    chance = BodyPosterior(again).probability(egg.data.contacts[egg.data.hole == hole.hole])
    assert hole.contacts == len(chance) == 2
    assert hole.covered == ((chance >= 0.05) & (chance <= 0.95)).sum()


def test_holes_left_out_lie_apart_as_all_holes_do_and_contacts_that_no_other_reaches_are_counted() -> None:
    """Those farthest apart were left out: of Copper Creek's GHv, the band seemed to contain 2 % of the contacts."""
    close = drilled(ellipsoid((0.3, 0.3, 0.3), (-0.6, -0.6, 0.0))[0], 5, rows=15, named=True)
    lonely = ORIGIN + np.array([80.0, 80.0, 0.0])
    depth = np.arange(-60.0, 60.0, 4.0)[:, None] * [0, 0, 1.0]
    inside = np.abs(depth[:, 2]) < 20
    out = np.isin(close.outside_hole, np.unique(close.hole))
    data = BodyData(
        np.concatenate([close.contacts, lonely + np.array([[0, 0, -20.0], [0, 0, 20.0]])]),
        np.concatenate([close.inside, lonely + depth[inside]]),
        np.concatenate([close.outside[out], lonely + depth[~inside]]),
        None,
        [*close.hole.tolist(), "L", "L"],
        [*close.inside_hole.tolist(), *["L"] * int(inside.sum())],
        [*close.outside_hole[out].tolist(), *["L"] * int((~inside).sum())],
    )
    body = fit_body(data)
    few = leave_one_hole_out(body, 5, compared=False).methods["body"]
    assert "L" not in [hole.hole for hole in few.holes]
    every = leave_one_hole_out(body, compared=False).methods["body"]
    assert len(every.holes) > 5
    for hole in every.holes:
        again = fit_body(data.without(hole.hole))
        places = data.contacts[data.hole == hole.hole]
        open_ground = BodyPosterior(again).open_ground(places)
        assert (hole.contacts, hole.beyond) == (int(open_ground.sum()), int((~open_ground).sum()))
    assert {hole.hole: hole.beyond for hole in every.holes if hole.beyond} == {"L": 2}
    assert every.beyond == 2


def test_sections_left_out_are_measured_at_right_angles_to_the_surface() -> None:
    angle = np.linspace(0, 2 * np.pi, 30, endpoint=False)
    outlines = [
        Outline(f"S{k}", ORIGIN + np.sqrt(1 - (x / 50) ** 2) * 30 * np.column_stack(
            [np.full(30, 0.0), np.cos(angle), np.sin(angle)]) + [x, 0, 0])
        for k, x in enumerate(np.linspace(-40, 40, 7))
    ]  # fmt: skip
    body = fit_body(from_outlines(outlines))
    found = leave_one_hole_out(body, compared=False)
    assert found.scheme == "section"
    middle = next(one for one in found.methods["body"].holes if one.hole == "S3")
    again = fit_body(body.data.without("S3"))
    distances = np.abs(again.distance(body.data.contacts[body.data.hole == "S3"]))
    assert middle.contact_errors == pytest.approx(tuple(distances), abs=1e-9)
    assert max(middle.contact_errors) < 1.0
    assert found.left_out.logged == 0.0


def test_too_few_holes_leave_nothing_to_examine() -> None:
    assert left_out_body(fit_body(drilled(ellipsoid((0.6, 0.4, 0.3))[0], 0))) is None
