"""Files of a run: no two of one name, and none of an earlier run that contradicts the report."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import with_code

from geofit import PointSet
from geofit.data.files import file_stems
from geofit.data.site import Site
from geofit.project.run import run_horizons
from geofit.project.run_files import BODY_ENDINGS, HORIZON_ENDINGS, RUN_FILES, earlier_files, files_in, run_files


def points(seed: int = 1, n: int = 14) -> PointSet:
    plan = np.random.default_rng(seed).uniform(0, 100, (n, 2))
    z = 0.1 * plan[:, 0] + np.sin(plan[:, 1] / 20) - 20 * seed
    return PointSet(np.column_stack([plan + np.array([500_000.0, 3_100_000.0]), z]))


@pytest.mark.parametrize(
    "names", [("A", "A_upper90"), ("A_upper90", "A"), ("report", "site", "import_issues"), ("a", "A", "A-2")]
)
def test_no_file_of_a_horizon_is_that_of_another_or_of_the_run(names, tmp_path):
    codes = ("ORE", "report", "A", "A_lower90")
    files = run_files(tmp_path, names, names, codes)
    assert len(files.stems) == len(names) + len(codes)
    kinds = [(files.stems[name], HORIZON_ENDINGS) for name in names]
    kinds += [(files.stems[name], BODY_ENDINGS) for name in files.bodies.values()]
    every = [*RUN_FILES, *(stem + ending for stem, endings in kinds for ending in endings)]
    assert sorted(files.names) == sorted(every)
    assert len({name.casefold() for name in every}) == len(every)


def test_a_run_of_some_horizons_has_the_names_of_a_run_of_all(tmp_path):
    known = ("A", "A_upper90")
    assert run_files(tmp_path, known, ["A_upper90"], ()).stems == run_files(tmp_path, known, known, ()).stems
    blocks = run_files(tmp_path, known, known, (), ("A (west)", "A_upper90"))
    assert blocks.stems == {**run_files(tmp_path, known, known, ()).stems, "A (west)": "A_west"}
    assert blocks.horizons == ("A", "A_upper90", "A (west)")


@pytest.mark.usefixtures("read_here")
def test_horizons_called_like_other_files_keep_all_of_theirs(tmp_path):
    site = Site("s", {"A": points(1), "A_upper90": points(2), "report": points(3), "site": points(4)})
    done = run_horizons(site, tmp_path, bands=True, date="2024-01-01")
    assert not done.failures
    from geofit.io.surface_files import read_surfaces

    found = [name for path in tmp_path.glob("*.step") for name in read_surfaces(path)]
    assert len(found) == 12
    assert {"A", "A_upper90", "report", "site"} <= set(found)
    assert b'"kind": "report"' in (tmp_path / "report.json").read_bytes()


def test_files_of_an_earlier_run_that_contradict_the_report_are_removed_and_others_named(tmp_path):
    whole = Site("s", {"T": points(1), "Q": points(2), "R": points(3)})
    run_horizons(whole, tmp_path, bands=True, date="2024-01-01")
    for name in ("report.pdf", "Q_certificate.pdf", "T_notes.txt", "T.stl", "mine.step", "photo.png"):
        (tmp_path / name).write_text("of the user, or of an earlier run")
    gone = {"report.pdf", "T_upper90.step", "T_lower90.step"} | {f"Q{end}" for end in HORIZON_ENDINGS}
    now = Site("s", {"T": points(1), "Q": PointSet(points(2).xyz[:1])})
    done = run_horizons(now, tmp_path, date="2024-01-01")
    assert set(done.failures) == {"Q"}
    names = {path.name for path in tmp_path.iterdir()}
    assert not names & gone
    assert {"T.step", "T.json", "report.html", "T_notes.txt", "T.stl", "mine.step", "photo.png", "R.step"} <= names
    removed = with_code(done.warnings, "project.earlier-files-removed").params["names"]
    assert set(removed.split(", ")) == gone
    left = with_code(done.warnings, "project.earlier-files-left").params["names"]
    assert set(left.split(", ")) == {"T.stl", *(f"R{end}" for end in HORIZON_ENDINGS if end != "_certificate.pdf")}
    page = (tmp_path / "report.html").read_text("utf-8")
    assert page.count("R_upper90.step") == 1


def test_a_run_that_fits_nothing_removes_nothing(tmp_path):
    run_horizons(Site("s", {"T": points()}), tmp_path, date="2024-01-01")
    before = {path.name for path in tmp_path.iterdir()}
    done = run_horizons(Site("s", {"T": PointSet(points().xyz[:1])}), tmp_path, date="2024-01-01")
    assert done.report is None
    assert {path.name for path in tmp_path.iterdir()} == before
    assert "T.step" in with_code(done.warnings, "project.earlier-files-stale").params["names"]


def test_what_is_written_anew_is_not_of_an_earlier_run(tmp_path):
    for name in ("T.step", "T.png", "T_residuals.csv"):
        (tmp_path / name).write_text("earlier")
    before, files = files_in(tmp_path), run_files(tmp_path, ["T"], ["T"], ())
    (tmp_path / "part").write_text("now")
    (tmp_path / "part").replace(tmp_path / "T.step")
    (tmp_path / "T.json").write_text("now")
    assert earlier_files(files, before) == (["T.png", "T_residuals.csv"], [])
    assert earlier_files(run_files(tmp_path, ["Q"], ["Q"], ()), before) == ([], ["T.png", "T_residuals.csv"])


def test_a_long_chinese_name_is_fitted_and_read_back(tmp_path):
    names = ("强" * 120 + "甲", "强" * 120 + "乙")
    stems = file_stems(names)
    assert len(set(stems.values())) == 2
    assert all(140 < len(stem.encode()) < 160 for stem in stems.values())
    done = run_horizons(Site("s", {names[0]: points(1), names[1]: points(2)}), tmp_path, bands=True, date="2024-01-01")
    assert not done.failures
    from geofit.io.surface_files import read_surfaces

    assert [list(read_surfaces(tmp_path / f"{stems[name]}.step")) for name in names] == [[name] for name in names]
