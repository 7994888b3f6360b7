"""The project file: what is saved comes back; old versions open, newer ones report it; a broken save breaks nothing."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from surfaces import fold, horizon, nine

from geofit.data.errors import InputError
from geofit.data.files import replacing
from geofit.data.settings import FitSettings
from geofit.io import project as module
from geofit.io.project import Edit, Project, ProjectSource, is_project, load_surfaces, open_project, save_project

VERSION_1 = """{"format": "geofit project", "version": 1, "name": "Old dam",
"settings": {"T1": {"epsilon": 0.25, "conflict_distance": 0.05}},
"sources": [{"path": "a.csv", "mapping": {"recipe": "conflict_distance"}}],
"edits": [{"kind": "apart", "horizon": "T1", "values": {"kind": "apart"}}],
"results": [{"horizon": "T1", "surface": "old_surfaces/T1-0123abcd.step", "sha256": "",
"recipe": {"horizon": "T1", "settings": {"conflict_distance": 0.05}, "edits": [{"kind": "apart"}]}}]}"""
VERSION_0 = """{"format": "geofit project", "version": 0, "title": "Old dam",
"files": {"collar.csv": "ab12"}, "epsilon": {"T1": 0.25}}"""


def sample():
    return Project(
        name="坝址 Dam",
        crs="EPSG:32648",
        sources=(ProjectSource(path="picks.csv", role="picks", mapping={"x": "东", "skip": [1, 2]}),),
        settings={
            "T2/T1": FitSettings(epsilon=0.25, core=((0.0, 0.0), (1.0, 0.0), (1.0, 1.0))),
            "fold": FitSettings(frame="sections", max_control_points=900, smoothing=0.1),
        },
        edits=(Edit(kind="exclude", horizon="T2/T1", values={"file": "picks.csv", "row": 17}),),
    )


def files(folder):
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file())


def test_everything_comes_back(tmp_path):
    (tmp_path / "picks.csv").write_text("x,y,z\n1,2,3\n")
    saved = save_project(sample(), tmp_path / "dam.geofit", {"T2/T1": horizon(nine()[1], name="T2/T1")})
    back = open_project(tmp_path / "dam.geofit")
    assert back == saved
    assert back.settings == sample().settings
    assert len(back.sources[0].sha256) == 64
    assert back.changed(tmp_path) == {}
    (surface,) = load_surfaces(back, tmp_path).values()
    assert surface.settings.epsilon == 0.25
    for read, patch in zip(surface.patches, nine()[1], strict=True):
        assert np.abs(read.control - patch.control).max() < 1e-9


def test_the_text_is_diffable_and_the_same_each_time(tmp_path):
    for name in ("a", "b"):
        save_project(sample(), tmp_path / f"{name}.geofit")
    text = (tmp_path / "a.geofit").read_bytes()
    assert text == (tmp_path / "b.geofit").read_bytes()
    assert "坝址" in text.decode("utf-8")
    longest = max(map(len, text.decode("utf-8").splitlines()))
    assert longest < 120  # one value a line: a change is a line of a diff
    one = Project(**{**vars(sample()), "crs": "EPSG:4546"})
    save_project(one, tmp_path / "b.geofit")
    before, after = (p.read_text("utf-8").splitlines() for p in (tmp_path / "a.geofit", tmp_path / "b.geofit"))
    assert len(set(before) ^ set(after)) == 2


def test_changed_and_missing_sources_are_named(tmp_path):
    (tmp_path / "picks.csv").write_text("x,y,z\n1,2,3\n")
    saved = save_project(sample(), tmp_path / "dam.geofit", {"fold": horizon([fold()], name="fold")})
    (tmp_path / "picks.csv").write_text("x,y,z\n1,2,4\n")
    (tmp_path / saved.results[0].surface).unlink()
    assert saved.changed(tmp_path) == {"picks.csv": "changed", saved.results[0].surface: "missing"}


def test_a_new_surface_takes_the_place_of_the_former_after_the_project_names_it(tmp_path, monkeypatch):
    first = save_project(sample(), tmp_path / "dam.geofit", {"T": horizon([fold()], name="T")})
    text = (tmp_path / "dam.geofit").read_bytes()

    def broken(path):
        raise KeyboardInterrupt

    # Stopped between the surface and the project file: the project names what is there and whole.
    with monkeypatch.context() as patched:
        patched.setattr(module, "replacing", broken)
        with pytest.raises(KeyboardInterrupt):
            save_project(first, tmp_path / "dam.geofit", {"T": horizon(nine()[1], name="T")})
    assert (tmp_path / "dam.geofit").read_bytes() == text
    assert open_project(tmp_path / "dam.geofit").changed(tmp_path) == {"picks.csv": "missing"}
    second = save_project(first, tmp_path / "dam.geofit", {"T": horizon(nine()[1], name="T")})
    assert files(tmp_path) == ["dam.geofit", second.results[0].surface]
    assert second.results[0].surface != first.results[0].surface
    assert replacing is not broken


def test_version_0_opens(tmp_path):
    (tmp_path / "old.geofit").write_text(VERSION_0, encoding="utf-8")
    old = open_project(tmp_path / "old.geofit")
    assert old.name == "Old dam"
    assert old.sources == (ProjectSource(path="collar.csv", sha256="ab12"),)
    assert old.settings == {"T1": FitSettings(epsilon=0.25)}
    save_project(old, tmp_path / "new.geofit")
    assert json.loads((tmp_path / "new.geofit").read_text("utf-8"))["version"] == module.VERSION
    assert open_project(tmp_path / "new.geofit") == old
    assert set(module.MIGRATIONS) == set(range(module.VERSION))


def test_version_1_opens_under_the_names_of_today(tmp_path):
    (tmp_path / "old.geofit").write_text(VERSION_1, encoding="utf-8")
    old = open_project(tmp_path / "old.geofit")
    assert old.settings["T1"].coincidence_distance == 0.05
    assert old.sources[0].mapping == {"recipe": "conflict_distance"}
    assert (old.edits[0].kind, old.edits[0].values) == ("separate", {"kind": "separate"})
    provenance = old.results[0].provenance
    assert provenance["settings"] == {"coincidence_distance": 0.05}
    assert provenance["edits"] == [{"kind": "separate"}]


def test_version_3_opens_with_its_excluded_rows(tmp_path):
    save_project(sample(), tmp_path / "dam.geofit")
    data = json.loads((tmp_path / "dam.geofit").read_text("utf-8"))
    (tmp_path / "old.geofit").write_text(json.dumps({**data, "version": 3}), encoding="utf-8")
    assert open_project(tmp_path / "old.geofit") == open_project(tmp_path / "dam.geofit")


def test_an_old_surface_that_another_program_has_open_stays_and_the_project_is_saved(tmp_path, monkeypatch):
    first = save_project(sample(), tmp_path / "dam.geofit", {"T": horizon([fold()], name="T")})
    remove = Path.unlink

    def refused(path, missing_ok=False):
        if path.suffix == ".step" and not path.name.startswith("."):
            raise PermissionError(13, "The process cannot access the file", str(path))
        remove(path, missing_ok=missing_ok)

    monkeypatch.setattr(Path, "unlink", refused)
    second = save_project(first, tmp_path / "dam.geofit", {"T": horizon(nine()[1], name="T")})
    assert open_project(tmp_path / "dam.geofit") == second
    assert (tmp_path / first.results[0].surface).is_file()


@pytest.mark.parametrize(("name", "expected"), [("a.geofit", True), ("A.GEOFIT", True), ("site.toml", False)])
def test_a_project_is_known_by_its_ending_whatever_its_case(name, expected):
    assert is_project(Path(name)) is expected


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ('{"format": "geofit project", "version": 99, "anything": 1}', "newer geofit.*99.*Open it with"),
        ('{"format": "geofit project"}', "no version"),
        ('{"format": "geofit project", "version": true}', "no version"),
        ('{"format": "other"}', "does not state the format 'geofit project'"),
        ("[1, 2]", "does not state the format 'geofit project'"),
        ("GOCAD TSurf 1", "not a valid project file"),
        ("[" * 100_000, "not a valid project file"),
        ('{"format": "geofit project", "version": 2}', "name"),
        ('{"format": "geofit project", "version": 2, "name": 3}', "must be text"),
        ('{"format": "geofit project", "version": 2, "name": "a", "sorces": []}', "unknown key 'sorces'"),
        (
            '{"format": "geofit project", "version": 2, "name": "a", "settings": {"T": {"epsilon": -1}}}',
            "epsilon",
        ),
        ('{"format": "geofit project", "version": 2, "name": "a", "edits": [{"what": 1}]}', "what"),
        ('{"format": "geofit project", "version": 0}', "title"),
    ],
)
def test_what_is_no_project_says_so(text, match, tmp_path):
    (tmp_path / "a.geofit").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=match):
        open_project(tmp_path / "a.geofit")


def test_no_file_and_no_folder(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        open_project(tmp_path / "none.geofit")
    with pytest.raises(InputError, match="cannot be written"):
        save_project(sample(), tmp_path / "none" / "dam.geofit")


words = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
numbers = st.floats(allow_nan=False, allow_infinity=False)
plain_values = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**53), 2**53) | numbers | words,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(words, inner, max_size=3),
    max_leaves=6,
)
projects = st.builds(
    Project,
    name=words,
    crs=words,
    sources=st.lists(
        st.builds(
            ProjectSource,
            path=words.filter(lambda w: "\0" not in w),
            role=words,
            sha256=st.just("ff"),
            mapping=st.dictionaries(words, plain_values, max_size=3),
        ),
        max_size=3,
    ).map(tuple),
    settings=st.dictionaries(
        words,
        st.builds(FitSettings, epsilon=st.floats(1e-6, 1e6), smoothing=st.floats(1e-6, 1e6)),
        max_size=3,
    ),
    edits=st.lists(
        st.builds(Edit, kind=words, horizon=words, values=st.dictionaries(words, plain_values, max_size=3)),
        max_size=3,
    ).map(tuple),
)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(project=projects)
def test_any_project_comes_back(project, tmp_path):
    save_project(project, tmp_path / "any.geofit")
    assert open_project(tmp_path / "any.geofit") == project


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(cut=st.integers(0, 2000), byte=st.integers(0, 255), drop=st.integers(0, 40))
def test_a_damaged_file_is_read_or_refused(cut, byte, drop, tmp_path):
    save_project(sample(), tmp_path / "a.geofit")
    text = bytearray((tmp_path / "a.geofit").read_bytes())
    place = cut % len(text)
    text[place : place + drop] = bytes([byte])
    (tmp_path / "b.geofit").write_bytes(text)
    with suppress(InputError):
        open_project(tmp_path / "b.geofit")


FOREIGN = [
    r"dam_surfaces/..\..\x",
    "dam_surfaces/../../x-00000000.step",
    "dam_surfaces/x",
    "../dam_surfaces/x-00000000.step",
    r"dam_surfaces\x-00000000.step",
    "dam_surfaces/C:x-00000000.step",
    "/x-00000000.step",
    "dam_surfaces/.x-00000000.step",
    "dam_surfaces/x-00000000.step\0.txt",
]


def with_surface(folder, name):
    save_project(sample(), folder / "dam.geofit", {"T": horizon([fold()], name="T")})
    data = json.loads((folder / "dam.geofit").read_text("utf-8"))
    data["results"][0]["surface"] = name
    (folder / "dam.geofit").write_text(json.dumps(data), "utf-8")
    return data


@pytest.mark.parametrize("name", FOREIGN)
def test_a_surface_that_no_project_writes_is_refused(tmp_path, name):
    with_surface(tmp_path, name)
    with pytest.raises(InputError, match="surface"):
        open_project(tmp_path / "dam.geofit")


@pytest.mark.parametrize("name", FOREIGN[:6])
def test_a_save_removes_no_file_of_another_name(tmp_path, name, monkeypatch):
    # As on Windows a backslash leads out of the folder, here it is a letter of the name: no such file goes either.
    data = with_surface(tmp_path, name)
    strange = tmp_path / name
    strange.parent.mkdir(parents=True, exist_ok=True)
    strange.write_text("somebody's")
    result = module.ProjectResult(**data["results"][0])
    (tmp_path / "dam.geofit").unlink()
    save_project(Project(name="dam", results=(result,)), tmp_path / "dam.geofit", {"T": horizon([fold()], name="T")})
    assert strange.read_text() == "somebody's"


@pytest.mark.parametrize(
    ("key", "entry"),
    [
        ("results", {"horizon": 1, "surface": "a_surfaces/x-00000000.step", "sha256": ""}),
        ("results", {"horizon": "T", "surface": 7, "sha256": ""}),
        ("results", {"horizon": "T", "surface": "a_surfaces/x-00000000.step", "sha256": "", "provenance": []}),
        ("results", {"horizon": "T", "surface": "a_surfaces/x-00000000.step", "sha256": "", "n": "many"}),
        ("sources", {"path": 3}),
        ("sources", {"path": "a\0b"}),
        ("sources", {"path": "a", "mapping": "x"}),
        ("edits", {"kind": "exclude", "values": 1}),
        ("edits", {"kind": None}),
        ("edits", 5),
    ],
)
def test_values_of_the_wrong_type_are_refused(tmp_path, key, entry):
    data = {"format": "geofit project", "version": 2, "name": "dam", key: [entry]}
    (tmp_path / "p.geofit").write_text(json.dumps(data), "utf-8")
    with pytest.raises(InputError, match="does not contain what version 2 requires"):
        open_project(tmp_path / "p.geofit")
