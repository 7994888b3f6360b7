"""A site that grows: files added, files changed, and what that does to the work."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.io.site_file import read_site
from geofit.prediction.examine import examine
from geofit.project.adding import add_files
from geofit.project.building import edited, make
from geofit.project.commands import ExcludeRows, MoveToPoint, SetSurface, command_from
from geofit.project.comparing import compare_states, made_comparison, state_surfaces
from geofit.project.data_change import change_of_data, changed_files
from geofit.project.document import Document
from geofit.project.named_points import found_again, named_rows
from geofit.project.provenance import Row
from geofit.project.saving import read_project, save_state

NAME = "base"
HEAD = "hole,x,y,z,horizon\n"


def height(x, y):
    return 100 + 0.05 * x + 4 * np.sin(x / 60) * np.cos(y / 80)


def rows(n, seed, prefix="B"):
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0, 400, (2, n))
    z = height(x, y) + rng.normal(0, 0.05, n)
    return [f"{prefix}{k},{a:.2f},{b:.2f},{c:.3f},{NAME}" for k, (a, b, c) in enumerate(zip(x, y, z, strict=True))]


def written(folder, lines, name="picks.csv"):
    (folder / name).write_text(HEAD + "\n".join(lines) + "\n", encoding="utf-8")


@pytest.fixture
def site_file(tmp_path):
    folder = tmp_path / "site"
    folder.mkdir()
    written(folder, rows(60, 1))
    (folder / "site.toml").write_text(
        '[site]\nname = "Dam"\n[[picks]]\nfile = "picks.csv"\nkind = "borehole"\n'
        f'[[horizon]]\nname = "{NAME}"\nepsilon = 0.3\n',
        encoding="utf-8",
    )
    return folder / "site.toml"


def opened(site_file):
    document = Document()
    document.open(read_site(site_file), site_file)
    return document


def fitted(document, name=NAME):
    provenance = document.provenance(name)
    document.put(provenance, make(provenance, document.given_for(provenance)))
    SetSurface(provenance).redo(document)
    return provenance


def test_changed_files_are_found_by_their_hash(site_file):
    site = read_site(site_file)
    folder = site_file.parent
    assert changed_files(site, folder) == {}
    data = (folder / "picks.csv").read_bytes()
    (folder / "picks.csv").write_bytes(data)
    assert changed_files(site, folder) == {}
    written(folder, rows(61, 1))
    assert changed_files(site, folder) == {"picks.csv": "changed"}
    (folder / "picks.csv").unlink()
    assert changed_files(site, folder) == {"picks.csv": "missing"}


def test_excluded_rows_follow_their_points_and_the_others_are_listed(site_file):
    document = opened(site_file)
    before = document.read.horizons[NAME]
    ExcludeRows(NAME, (Row("picks.csv", 4), Row("picks.csv", 12), Row("picks.csv", 30))).redo(document)
    kept = before.xyz[[2, 10]]
    lines = rows(60, 1)
    lines[28] = lines[28].replace(",base", ",base").rsplit(",", 2)[0] + f",77.0,{NAME}"
    # Two new rows at the head move every line; row 30 was corrected.
    written(site_file.parent, [*rows(2, 9, "NEW"), *lines])
    change = change_of_data(document.state, document.read, read_site(site_file))
    after = read_site(site_file).horizons[NAME]
    carried = change.command.excluded[NAME]
    assert [row.row for row in carried] == [6, 14]
    assert (after.xyz[[row.find(after) for row in carried]] == kept).all()
    assert change.carried == 2
    assert [one.code for one in change.lost] == ["project.exclusion-lost"]
    (found,) = change.arrivals
    assert (found.new, found.corrected, found.gone) == (2, 1, 0)
    assert found.holes == ("NEW0", "NEW1")


def test_of_two_points_at_one_place_the_right_one_stays_excluded(site_file):
    lines = rows(10, 1)
    written(site_file.parent, [*lines, lines[3]])
    before = read_site(site_file).horizons[NAME]
    written(site_file.parent, [lines[9], *lines[:9], lines[3]])
    after = read_site(site_file).horizons[NAME]
    for row, now in ((Row("picks.csv", 12), Row("picks.csv", 12)), (Row("picks.csv", 5), Row("picks.csv", 6))):
        assert found_again(named_rows([row], before), after) == {row: now}


def test_the_change_is_undone_and_redone_and_the_earlier_surface_made_again(site_file):
    document = opened(site_file)
    first = fitted(document)
    surface = document.surface(NAME)
    written(site_file.parent, [*rows(60, 1), *rows(25, 5, "N")])
    site = read_site(site_file)
    change = change_of_data(document.state, document.read, site)
    document.know(site)
    change.command.redo(document)
    assert len(document.site.horizons[NAME]) == 85
    assert document.stale(NAME)
    assert document.earlier(NAME)[0] == first
    assert document.compared_pair(NAME) is None
    second = fitted(document)
    pair = document.compared_pair(NAME)
    assert pair == (first, second)
    provenance, given, _ = document.earlier(NAME)
    again = make(provenance, given)
    assert np.array_equal(again.patches[0].control, surface.patches[0].control)
    quiet = lambda stage, share: True  # noqa: E731
    found = made_comparison(pair, given, None, document.surface(NAME), document.read.horizons[NAME], progress=quiet)
    document.put_comparison(*found)
    comparison = document.comparison(NAME)
    assert {one.group for one in comparison.test.contacts} == {f"N{k}" for k in range(25)}
    assert comparison.test.share > 0.7
    change.command.undo(document)
    assert len(document.site.horizons[NAME]) == 60
    assert document.comparison(NAME) is None
    change.command.redo(document)
    assert len(document.site.horizons[NAME]) == 85


def test_lines_that_were_inserted_make_nothing_stale_but_their_horizon(site_file):
    folder = site_file.parent
    others = [line.replace(NAME, "top").replace("B", "T") for line in rows(40, 2)]
    written(folder, [*rows(60, 1), *others])
    # A site file that names horizons has these alone.
    site_file.write_text('[site]\nname = "Dam"\n[[picks]]\nfile = "picks.csv"\nkind = "borehole"\n', encoding="utf-8")
    document = opened(site_file)
    ExcludeRows("top", (Row("picks.csv", 65), Row("picks.csv", 70))).redo(document)
    fitted(document)
    first = fitted(document, "top")
    pull = MoveToPoint("top", 3, 1.0)
    document.put(replace(first, edits=(pull.edit,)), edited(document.surface("top"), pull.edit))
    pull.redo(document)
    surface, residual = document.surface("top"), document.listing("top").residual
    document.put_prediction(document.state.provenances["top"], examine(surface))
    # A new row of one horizon, at the head of the file that has both.
    written(folder, [*rows(1, 9, "NEW"), *rows(60, 1), *others])
    change = change_of_data(document.state, document.read, read_site(site_file))
    assert change.lost == ()
    assert list(change.command.earlier) == [NAME]
    document.know(read_site(site_file))
    command = command_from(json.loads(json.dumps(change.command.to_data())))
    assert command == change.command
    for line in (66, 65, 66):
        (command.redo if line == 66 else command.undo)(document)
        assert document.stale(NAME) == (line == 66)
        assert not document.stale("top")
        assert document.missing() == ()
        provenance, kept = document.state.provenances["top"], document.surface("top")
        assert provenance.edits == (pull.edit,)
        assert min(row.row for row in provenance.excluded) == line
        assert np.array_equal(kept.points.row, document.points("top").row)
        assert np.array_equal(kept.patches[0].control, surface.patches[0].control)
        assert np.array_equal(document.listing("top").residual, residual)
        assert document.prediction("top") is not None
    again = make(provenance, document.given_for(provenance))
    assert np.array_equal(again.patches[0].control, surface.patches[0].control)


def test_a_corrected_row_among_moved_ones_makes_its_horizon_stale(site_file):
    document = opened(site_file)
    fitted(document)
    # In another order the points are the same, but the fit sums them otherwise, and edits count them.
    for lines in (
        [*rows(60, 1)[1:], rows(60, 1)[0]],
        [rows(60, 1)[0].rsplit(",", 2)[0] + f",77.0,{NAME}", *rows(60, 1)[1:]],
    ):
        written(site_file.parent, lines)
        change = change_of_data(document.state, document.read, read_site(site_file))
        assert change.command.carried == {}
        assert list(change.command.earlier) == [NAME]


def test_a_project_keeps_the_earlier_state(site_file, tmp_path):
    document = opened(site_file)
    first = fitted(document)
    written(site_file.parent, rows(20, 5, "N"), "more.csv")
    added = add_files([site_file.parent / "more.csv"], site_file, document.read)
    change = change_of_data(document.state, document.read, added.site, added.tables)
    document.know(added.site)
    change.command.redo(document)
    fitted(document)
    state = document.state
    data = {name: document.data(name) for name in {one.data for one in state.earlier.values()}}
    surfaces = {p: document.surface(n).with_(model=None) for n, p in state.provenances.items()}
    project = tmp_path / "dam.geofit"
    save_state(state, document.read, site_file, project, surfaces, False, data, progress=lambda stage, share: True)
    again = read_project(project)
    assert again.changed == {}
    assert again.state == state
    back = Document()
    back.open(again.site, site_file, again.state, project, again.data)
    provenance, given, _ = back.earlier(NAME)
    assert provenance == first
    assert len(given.site.horizons[NAME]) == 60
    assert len(back.site.horizons[NAME]) == 80
    # The project is a state that can be compared, with its added files.
    assert len(state_surfaces(project)[NAME][1]) == 80
    shutil.rmtree(tmp_path / "dam_data")
    lost = read_project(project)
    assert list(lost.changed.values()) == ["missing"]
    assert lost.data == ()


def test_added_files_bring_new_holes_and_new_horizons(site_file):
    folder, site = site_file.parent, read_site(site_file)
    (folder / "other.csv").write_text(HEAD + "\n".join(rows(9, 3)).replace(NAME, "top"), encoding="utf-8")
    added = add_files([folder / "other.csv"], site_file, site)
    assert list(added.site.horizons) == [NAME, "top"]
    written(folder, rows(4, 8, "M"), "more.csv")
    both = add_files([folder / "more.csv"], site_file, added.site, added.tables)
    assert [len(points) for points in both.site.horizons.values()] == [64, 9]
    again = read_site(site_file, added=both.tables)
    assert {name: len(points) for name, points in again.horizons.items()} == {NAME: 64, "top": 9}


def test_logs_with_their_collars_are_a_campaign_of_their_own(tmp_path):
    from geofit.sample import write_site

    write_site(tmp_path)
    site_file = tmp_path / "site.toml"
    site = read_site(site_file)
    (tmp_path / "c2.csv").write_text("hole,x,y,z,depth\nZK900,500400,3100400,1500,300\n", encoding="utf-8")
    log = site.boreholes[0].logs[0]
    code = str(log.code[0])
    (tmp_path / "l2.csv").write_text(f"hole,from,to,code\nZK900,0,50,{code}\nZK900,50,300,other\n", encoding="utf-8")
    added = add_files([tmp_path / "c2.csv", tmp_path / "l2.csv"], site_file, site)
    assert len(added.site.boreholes) == len(site.boreholes) + 1
    assert "ZK900" in {hole.name for hole in added.site.holes}


@pytest.mark.parametrize("what", ["known", "unusable", "absent"])
def test_files_that_cannot_be_added_say_why(site_file, what):
    folder, site = site_file.parent, read_site(site_file)
    (folder / "junk.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    name = {"known": "picks.csv", "unusable": "junk.csv", "absent": "gone.csv"}[what]
    with pytest.raises(InputError) as caught:
        add_files([folder / name], site_file, site)
    assert caught.value.file == name
    assert str(caught.value.remedy)


def test_two_states_on_the_command_line(site_file, tmp_path):
    from typer.testing import CliRunner

    from geofit.cli.main import app

    later = tmp_path / "later"
    shutil.copytree(site_file.parent, later)
    written(later, [*rows(60, 1), *rows(25, 5, "N")])
    out = tmp_path / "out"
    run = CliRunner().invoke(app, ["compare", str(site_file), str(later / "site.toml"), "--out", str(out), "--json"])
    assert run.exit_code in (0, 1), run.output
    found = json.loads(run.stdout)
    assert found["kind"] == "comparison"
    one = found["horizons"][NAME]
    expected = compare_states(site_file, later / "site.toml")[NAME]
    assert one["mean"] == expected.change.mean
    assert one["inside"] == expected.test.share
    assert len(one["contacts"]) == 25
    assert {file.name for file in out.iterdir()} == {
        "base_moved.png", "base_moved.asc", "base_new_contacts.csv"
    }  # fmt: skip
    assert len((out / "base_new_contacts.csv").read_text(encoding="utf-8-sig").splitlines()) == 26
    run = CliRunner().invoke(app, ["compare", str(site_file), str(later / "site.toml")])
    assert "25" in run.output
    run = CliRunner().invoke(app, ["compare", str(site_file), str(later / "none.toml")])
    assert run.exit_code == 2
