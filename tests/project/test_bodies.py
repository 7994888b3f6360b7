"""Bodies of a document: made from their provenance, saved with the project, read back, made again, told apart."""

from __future__ import annotations

import json
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from geofit.bodies.settings import BodySettings
from geofit.bodies.violations import violations
from geofit.data.errors import InputError
from geofit.io.project import VERSION, open_project
from geofit.io.site_file import read_site
from geofit.morphing.errors import MorphError
from geofit.project.body_building import BodyResult, make_body, origin_text
from geofit.project.body_record import BodyRecord, BodyStyle, ClosedMesh, Intervals, MorphFrame, next_colour
from geofit.project.body_saving import largest_difference, saved_body
from geofit.project.body_shelf import SPARE, BodyShelf
from geofit.project.body_sources import given_of_logs, interval_codes, site_codes
from geofit.project.mesh_body import MeshBody, read_mesh_body
from geofit.project.saving import read_project, save_state
from geofit.project.state import State

SITE = Path(__file__).parents[2] / "sample_data" / "site.toml"
ORE = Intervals(("ORE",), "bodies.toml")


def nothing(*_):
    return None


@pytest.fixture(scope="module")
def site():
    return read_site(SITE)


@pytest.fixture(scope="module")
def ore(site):
    return make_body(ORE, BodySettings(), "ORE", site.boreholes, SITE.parent, {})


def saved(folder, site, bodies):
    """Save bodies as a project; return the file."""
    state = replace(
        State.of_site(site), bodies={n: BodyRecord(p, BodyStyle("#112233")) for n, (p, _) in bodies.items()}
    )
    drawn = {name: saved_body(result) for name, (_, result) in bodies.items()}
    path = folder / "dam.geofit"
    save_state(state, site, SITE, path, {}, False, bodies=drawn, progress=nothing)
    return path, state


def test_the_same_provenance_makes_the_same_body(site, ore):
    provenance, result = ore
    again, body = make_body(ORE, BodySettings(), "ORE", site.boreholes, SITE.parent, {})
    assert again == provenance
    assert largest_difference(result, body) == 0
    assert np.array_equal(result.mesh.vertices, body.mesh.vertices)
    assert result.accuracy.verdict == "PASS"
    assert result.violations == ()
    assert result.volumes.p10 < result.volumes.best < result.volumes.p90


def test_a_result_goes_to_another_process_and_back(ore):
    body = pickle.loads(pickle.dumps(ore[1])).body
    xyz = ore[1].body.data.contacts[:20] + 3.0
    assert np.array_equal(body.value(xyz), ore[1].body.value(xyz))
    assert body.volumes().p10 == ore[1].volumes.p10


def test_codes_are_those_of_the_logs(site):
    assert next(iter(interval_codes(site.boreholes))) == "R"
    assert set(site_codes(SITE.with_name("bodies.toml"), progress=nothing)) >= {"ORE", "VOID", "GABBRO"}


def test_other_intervals_are_other_data(site):
    (campaign,) = site.boreholes
    log = campaign.logs[0]
    moved = replace(log, top=log.top + 0.01)
    other = replace(campaign, logs=(moved, *campaign.logs[1:]))
    assert given_of_logs((campaign,)) == given_of_logs(site.boreholes)
    assert given_of_logs((other,)) != given_of_logs((campaign,))


def test_a_project_without_bodies_keeps_its_version_and_has_no_word_of_them(tmp_path, site):
    path, _ = saved(tmp_path, site, {})
    data = json.loads(path.read_text("utf-8"))
    assert data["version"] == VERSION
    assert "bodies" not in data
    assert not list(tmp_path.glob("*_surfaces"))


def test_bodies_come_back_with_what_they_were_made_from(tmp_path, site, ore):
    path, state = saved(tmp_path, site, {"ORE": ore})
    data = json.loads(path.read_text("utf-8"))
    assert data["version"] == VERSION == 4
    (entry,) = data["bodies"]
    assert entry["sigma"] == pytest.approx(ore[1].accuracy.sigma)
    assert entry["volumes"]["p90"] == ore[1].volumes.p90
    opened = read_project(path)
    assert opened.state.bodies == state.bodies
    (back,) = opened.bodies.values()
    assert next(iter(opened.bodies)) == ore[0]
    assert back.origin == "read back"
    assert "not been made again" in str(origin_text(back))
    assert largest_difference(back, ore[1]) == 0
    # Made again, it is told apart from what was read.
    again = replace(ore[1], origin="again", difference=largest_difference(back, ore[1]))
    assert "same as the project's file" in str(origin_text(again))


def test_saving_again_keeps_the_file_of_a_body_that_is_not_made_yet(tmp_path, site, ore):
    path, state = saved(tmp_path, site, {"ORE": ore})
    (file,) = (tmp_path / "dam_surfaces").iterdir()
    save_state(state, site, SITE, path, {}, True, bodies={}, progress=nothing)
    assert open_project(path).bodies[0].mesh == f"dam_surfaces/{file.name}"
    # Without the body its file goes.
    save_state(State.of_site(site), site, SITE, path, {}, True, bodies={}, progress=nothing)
    assert not file.exists()
    assert json.loads(path.read_text("utf-8"))["version"] == VERSION


def test_a_changed_file_of_a_body_is_told_and_not_shown(tmp_path, site, ore):
    path, _ = saved(tmp_path, site, {"ORE": ore})
    (file,) = (tmp_path / "dam_surfaces").iterdir()
    file.write_bytes(file.read_bytes()[:-1] + b"x")
    opened = read_project(path)
    assert opened.changed == {f"dam_surfaces/{file.name}": "changed"}
    assert opened.bodies == {}
    assert list(opened.state.bodies) == ["ORE"]


@pytest.mark.parametrize(
    "change",
    [
        {"mesh": "../../etc/ORE-12345678.ply"},
        {"mesh": "dam_surfaces/ORE.ply"},
        {"record": {"source": {"kind": "dream"}, "settings": {}, "given": "", "style": {"colour": "#112233"}}},
        {"record": {}},
        {"more": 1},
    ],
)
def test_a_project_that_names_no_body_is_refused(tmp_path, site, ore, change):
    path, _ = saved(tmp_path, site, {"ORE": ore})
    data = json.loads(path.read_text("utf-8"))
    data["bodies"][0] |= change
    path.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(InputError):
        read_project(path)


def test_version_2_with_bodies_is_refused(tmp_path, site, ore):
    path, _ = saved(tmp_path, site, {"ORE": ore})
    data = json.loads(path.read_text("utf-8")) | {"version": 2}
    path.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(InputError, match="bodies"):
        open_project(path)


def test_a_closed_mesh_is_a_body_and_an_open_one_is_refused(tmp_path, site, ore):
    saved(tmp_path, site, {"ORE": ore})
    (file,) = (tmp_path / "dam_surfaces").iterdir()
    provenance, result = make_body(ClosedMesh(file.name), BodySettings(), "A", (), file.parent, {})
    assert isinstance(result.body, MeshBody)
    assert result.accuracy is None
    assert result.mesh.volume == pytest.approx(ore[1].mesh.volume, rel=1e-6)
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    for name, faces in (
        ("out", "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"),
        ("in", "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n"),
    ):
        (tmp_path / f"{name}.obj").write_text(corners + faces, encoding="utf-8")
        body = read_mesh_body(tmp_path / f"{name}.obj", name)
        assert body.overview.volume == pytest.approx(1 / 6)
        assert [note.code for note in body.notes] == ["morphing.mesh-turned"] * (name == "in")
    (tmp_path / "open.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n", encoding="utf-8")
    with pytest.raises(MorphError, match="edges"):
        read_mesh_body(tmp_path / "open.obj", "open")
    assert provenance.given


def test_a_frame_is_made_from_what_its_ends_are_made_from(site, ore):
    void, _ = make_body(Intervals(("VOID",), "bodies.toml"), BodySettings(), "VOID", (), SITE.parent, {})
    source = MorphFrame((ore[0], ore[0]), ("ORE", "ORE too"), "blend", "time", (), 24, 0.5)
    provenance, result = make_body(source, BodySettings(), "between", site.boreholes, SITE.parent, {})
    assert result.body.name == "between"
    assert result.mesh.volume == pytest.approx(ore[1].mesh.volume, rel=0.02)
    assert provenance.given != void.given


def test_violations_are_listed_with_hole_place_and_length(ore):
    body = ore[1].body
    assert violations(body) == ()
    data = replace_data(body, np.array([40.0, 0.0, 0.0]))
    off = violations(replace(body, data=data, accuracy=None))
    assert {"contact", "sample"} <= {one.kind for one in off}
    wrong = [one for one in off if one.kind == "sample"]
    assert all(one.length > 0 for one in wrong)
    value = body.value(np.array([one.place for one in wrong]))
    inside = np.array(["inside, lies" in str(one.text) for one in wrong])
    assert (np.sign(value) == np.where(inside, 1, -1)).all()


def replace_data(body, shift):
    from geofit.bodies.data import BodyData

    d = body.data
    return BodyData(
        d.contacts + shift, d.inside + shift, d.outside + shift, d.normals, d.hole, d.inside_hole, d.outside_hole,
        d.inside_length, d.outside_length,
    )  # fmt: skip


def test_colours_differ_until_there_are_no_more():
    records = {}
    for k in range(10):
        colour = next_colour(records)
        assert colour not in {record.style.colour for record in records.values()} or k >= 8
        records[str(k)] = BodyRecord(None, BodyStyle(colour))


def test_the_shelf_has_a_bound(ore):
    shelf = BodyShelf()
    for k in range(2 * SPARE):
        shelf.put(replace(ore[0], given=str(k)), BodyResult(ore[1].body), {replace(ore[0], given="0")})
    assert len(shelf) == SPARE + 2
    assert shelf.get(replace(ore[0], given="0")) is not None
    assert shelf.get(replace(ore[0], given="1")) is None
