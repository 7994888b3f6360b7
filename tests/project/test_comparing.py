"""Two states of a site: which surfaces are compared, and what is said of those that are not."""

from __future__ import annotations

import json

import numpy as np
import pytest

from geofit.project.comparing import compare_states

SITE = """[site]
name = "faulted"
[boundary]
file = "boundary.csv"
[[picks]]
file = "picks.csv"
kind = "borehole"
[[picks]]
file = "fault.csv"
[[horizon]]
name = "T3"
[[horizon]]
name = "F"
{more}
[faults]
F = ["T3"]
"""
THROW = 12.0


def state(folder, west, east, more=""):
    """Write a plane that a vertical fault throws down in the east, with so many holes on either side."""
    folder.mkdir()
    rng = np.random.default_rng(4)
    rows = []
    for name, count, low in (("W", west, 10), ("E", east, 510)):
        x, y = rng.uniform(low, low + 480, count), rng.uniform(10, 590, count)
        z = 100 + 0.02 * x - 0.01 * y - (THROW if name == "E" else 0.0)
        rows += [f"{name}{k},T3,{500_000 + x[k]:.3f},{3_100_000 + y[k]:.3f},{z[k]:.3f}" for k in range(count)]
    extra = ["X1,T1,500100,3100100,50", "X2,T1,500200,3100100,50"] if "T1" in more else []
    (folder / "picks.csv").write_text("\n".join(["hole,horizon,x,y,z", *rows, *extra]), encoding="utf-8")
    places = [f"F,500500,{3_100_000 + y},{z}" for y in range(0, 601, 100) for z in (60, 100, 140)]
    (folder / "fault.csv").write_text("\n".join(["horizon,x,y,z", *places]), encoding="utf-8")
    corners = "500000,3100000\n501000,3100000\n501000,3100600\n500000,3100600"
    (folder / "boundary.csv").write_text(f"x,y\n{corners}\n", encoding="utf-8")
    (folder / "site.toml").write_text(SITE.format(more=more), encoding="utf-8")
    return folder / "site.toml"


@pytest.fixture(scope="module")
def states(tmp_path_factory):
    folder = tmp_path_factory.mktemp("states")
    return state(folder / "old", 14, 9), state(folder / "new", 14, 25)


def test_blocks_are_compared_on_the_same_side_of_a_fault_whatever_their_names(states):
    """The larger block is A: new holes in the smaller one had made the command compare across the fault, and stop."""
    reported = []
    found = compare_states(*states, reported=reported.append)
    assert {name: len(one.test.contacts) for name, one in found.items()} == {"T3 (A)": 16, "T3 (B)": 0}
    assert [one.test.name for one in found.values()] == list(found)
    for one in found.values():
        assert abs(one.change.largest) < 0.5 < THROW
        assert one.change.area > 0.9 * 500 * 600
    renamed = [text.params["earlier"] for text in reported if text.code == "project.block-compared"]
    assert renamed == ["T3 (B)", "T3 (A)"]
    # A vertical fault covers nothing of the plan; the command had stopped at it.
    assert [text.params["name"] for text in reported if text.code == "project.horizon-not-compared"] == ["F"]


def test_what_is_not_compared_is_named_and_one_failure_does_not_stop_the_others(states, tmp_path):
    from typer.testing import CliRunner

    from geofit.cli.main import app

    new = state(tmp_path / "new", 14, 9, more='[[horizon]]\nname = "T1"')
    reported = []
    found = compare_states(states[0], new, ("T3", "T1"), reported=reported.append)
    assert list(found) == ["T3 (A)", "T3 (B)"]
    (failed,) = reported
    assert (failed.code, failed.severity, failed.params["name"]) == ("project.state-not-fitted", "error", "T1")
    run = CliRunner().invoke(app, ["compare", str(states[0]), str(new), "--json"])
    assert run.exit_code == 2
    assert list(json.loads(run.stdout)["horizons"]) == ["T3 (A)", "T3 (B)"]


def test_a_vertical_fault_has_no_two_elevations_at_one_location(states):
    from geofit.io import read_site

    assert "io.horizon-elevations-differ" not in {issue.reason.code for issue in read_site(states[0]).issues}
