"""Projects whose files changed, moved or were damaged while they were closed."""

from __future__ import annotations

import hashlib
import json
import os
import shutil

import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.io.site_file import read_site
from geofit.project.building import make
from geofit.project.commands import ExcludeRows, SetSurface
from geofit.project.comparing import state_surfaces
from geofit.project.document import Document
from geofit.project.provenance import Row
from geofit.project.saving import SiteFileGoneError, read_project, read_saved_surfaces, save_state

NAMES = ("T2", "T3")
HEAD = "hole,x,y,z,horizon"
NEW = ("N1,10,10,100.5,T2", "N2,20,10,100.9,T2")


def quiet(stage, share):
    return True


def picks():
    """40 contacts of each horizon, T2 from row 2, T3 from row 42."""
    rng = np.random.default_rng(1)
    places = rng.uniform(0, 400, (len(NAMES), 40, 2))
    return [
        f"{name}_{k},{x:.2f},{y:.2f},{100 - 30 * h + 0.05 * x + rng.normal(0, 0.05):.3f},{name}"
        for h, name in enumerate(NAMES)
        for k, (x, y) in enumerate(places[h])
    ]


def written(folder, lines):
    (folder / "picks.csv").write_text("\n".join([HEAD, *lines]) + "\n", encoding="utf-8")


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "site"
    folder.mkdir()
    written(folder, picks())
    (folder / "site.toml").write_text(
        '[site]\nname = "Dam"\n[[picks]]\nfile = "picks.csv"\nkind = "borehole"\n', encoding="utf-8"
    )
    return folder


def opened(folder, rows=(5, 9)):
    """The site with rows of T2 excluded."""
    document = Document()
    document.open(read_site(folder / "site.toml"), folder / "site.toml")
    ExcludeRows("T2", tuple(Row("picks.csv", row) for row in rows)).redo(document)
    return document


def fitted(document):
    for name in document.horizons:
        provenance = document.provenance(name)
        document.put(provenance, make(provenance, document.given_for(provenance)))
        SetSurface(provenance).redo(document)


def saved(document, path, same=False):
    surfaces = {p: document.surface(n).with_(model=None) for n, p in document.state.provenances.items()
                if document.surface(n) is not None}  # fmt: skip
    return save_state(document.state, document.read, document.site_file, path, surfaces, same, progress=quiet)


def reopened(path):
    found = read_project(path)
    document = Document()
    document.open(found.site, found.site_file, found.state, path, found.data, found.saved, found.digest)
    return found, document


def excluded_holes(document, name="T2"):
    points = document.site.horizons[name]
    return {str(points.hole[row.find(points)]) for row in document.state.excluded.get(name, ())}


def test_exclusions_follow_their_points_where_the_file_changed_while_the_project_was_closed(folder):
    document, path = opened(folder), folder / "dam.geofit"
    fitted(document)
    saved(document, path)
    lines = picks()
    lines[7] = lines[7].replace(",T2", "").rsplit(",", 1)[0] + ",88.000,T2"  # row 9 is corrected
    written(folder, [*NEW, *lines])
    found, again = reopened(path)
    assert again.state.excluded == {"T2": {Row("picks.csv", 7)}}
    assert excluded_holes(again) == {"T2_3"}
    assert found.moved == 1
    assert [one.code for one in found.lost] == ["project.exclusion-lost"]
    assert again.dirty
    # The surface that was fitted is checked without the points that it left out, whatever their lines are now.
    surfaces = read_saved_surfaces(found.project, folder, again.site, progress=quiet)
    (surface,) = (one for provenance, one in surfaces.items() if provenance.horizon == "T2")
    assert "T2_3" not in surface.points.hole.tolist()
    assert "T2_1" in surface.points.hole.tolist()
    # What a script compares has them too.
    _, points = state_surfaces(path, ("T2",))["T2"]
    assert len(points) == 42


def test_a_project_whose_files_are_as_they_were_is_not_dirty(folder):
    document, path = opened(folder), folder / "dam.geofit"
    written_ = saved(document, path)
    found, again = reopened(path)
    assert not again.dirty
    assert again.state == document.state
    assert (found.moved, found.lost) == (0, ())
    assert found.digest == written_.digest == hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.parametrize("changed", [False, True])
def test_a_project_of_version_3_keeps_rows_by_number_and_says_where_their_file_changed(folder, changed):
    path = folder / "dam.geofit"
    saved(opened(folder), path)
    data = json.loads(path.read_text("utf-8"))
    for edit in data["edits"]:
        edit["values"].pop("point", None)
    path.write_text(json.dumps({**data, "version": 3}), encoding="utf-8")
    if changed:
        written(folder, [*NEW, *picks()])
    found, again = reopened(path)
    assert again.state.excluded == {"T2": {Row("picks.csv", 5), Row("picks.csv", 9)}}
    assert [one.code for one in found.lost] == ["project.exclusion-doubtful"] * 2 * changed


@pytest.mark.parametrize("damage", ["cut", "swapped", "gone"])
def test_a_damaged_surface_blocks_no_other_and_the_next_save_heals_it(folder, damage):
    document, path = opened(folder), folder / "dam.geofit"
    fitted(document)
    project = saved(document, path).project
    bad, good = (folder / result.surface for result in project.results)
    if damage == "cut":
        bad.write_bytes(bad.read_bytes()[:2000])
    elif damage == "swapped":
        shutil.copy(good, bad)
    else:
        bad.unlink()
    found, again = reopened(path)
    surfaces = read_saved_surfaces(found.project, folder, again.site, progress=quiet)
    assert [provenance.horizon for provenance in surfaces] == [project.results[1].horizon]
    for provenance, surface in surfaces.items():
        again.put(provenance, surface)
    (missing,) = again.missing()
    again.put(missing, make(missing, again.given_for(missing)))
    healed = saved(again, path, same=True).project
    assert {result.horizon for result in healed.results} == set(NAMES)
    assert read_project(path).changed == {}
    # Its figures are those of its own surface.
    assert len(read_saved_surfaces(healed, folder, again.site, progress=quiet)) == 2


def test_sources_have_the_hashes_of_what_was_read_and_stay_when_they_are_gone(folder):
    document, path = opened(folder), folder / "dam.geofit"
    read = {name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in ("site.toml", "picks.csv")}
    (folder / "site.toml").write_text((folder / "site.toml").read_text("utf-8") + "# later\n", encoding="utf-8")
    (folder / "picks.csv").unlink()
    project = saved(document, path).project
    assert {source.path: source.sha256 for source in project.sources} == read
    assert project.changed(folder) == {"site.toml": "changed", "picks.csv": "missing"}


def test_a_folder_that_is_gone_is_not_made_anew(folder):
    document, path = opened(folder), folder / "dam.geofit"
    fitted(document)
    saved(document, path)
    shutil.move(folder, folder.with_name("elsewhere"))
    with pytest.raises(InputError) as caught:
        saved(document, path, same=True)
    assert caught.value.code == "project.folder-gone"
    assert not folder.exists()


@pytest.mark.skipif(os.name == "nt", reason="links need a privilege on Windows")
def test_a_project_in_a_linked_folder_finds_its_site_again(folder, tmp_path):
    deep, links = tmp_path / "disk" / "deep" / "er", tmp_path / "links"
    deep.mkdir(parents=True)
    links.mkdir()
    (links / "projects").symlink_to(deep)
    path = links / "projects" / "dam.geofit"
    document = opened(folder)
    saved(document, path)
    for place in (path, deep / "dam.geofit"):
        found, again = reopened(place)
        assert found.changed == {}
        assert again.state == document.state


@pytest.mark.skipif(os.name == "nt", reason="links need a privilege on Windows")
def test_a_site_file_that_is_a_link_keeps_its_own_neighbours(folder, tmp_path):
    (tmp_path / "common.toml").write_bytes((folder / "site.toml").read_bytes())
    (folder / "site.toml").unlink()
    (folder / "site.toml").symlink_to(tmp_path / "common.toml")
    path = folder / "dam.geofit"
    saved(opened(folder), path)
    assert read_project(path).site_file == folder.resolve() / "site.toml"


def test_a_project_opens_with_its_site_file_where_that_is_now(folder, tmp_path):
    path = tmp_path / "dam.geofit"
    document = opened(folder)
    fitted(document)
    saved(document, path)
    moved = folder.with_name("moved")
    shutil.move(folder, moved)
    with pytest.raises(SiteFileGoneError) as caught:
        read_project(path)
    assert caught.value.code == "project.site-file-gone"
    found = read_project(path, site_file=moved / "site.toml")
    assert found.state == document.state
    assert (found.changed, found.lost) == ({}, ())
    assert len(read_saved_surfaces(found.project, tmp_path, found.site, progress=quiet)) == 2
    again = Document()
    again.open(found.site, found.site_file, found.state, path, found.data, found.saved, found.digest)
    assert again.dirty
    saved(again, path, same=True)
    assert read_project(path).site_file == moved / "site.toml"
