"""A short, seeded part of benchmarks/fuzz.py, and planted bugs that it must find."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).resolve().parents[1] / "benchmarks"


@pytest.fixture(scope="module")
def fuzz():
    """Give the module of the benchmarks, with its groups of files."""
    sys.path.insert(0, str(BENCHMARKS))
    try:
        import fuzz

        yield fuzz
    finally:
        sys.path.remove(str(BENCHMARKS))
        for name in [name for name in sys.modules if name.split(".")[0] in ("fuzz", "fuzzing")]:
            del sys.modules[name]


@pytest.fixture(scope="module")
def files(fuzz, tmp_path_factory):
    """Give a function that returns the cases of a group, its sound files made once."""
    known = {}

    def of(group, *names):
        if group not in known:
            known[group] = fuzz.Files(getattr(fuzz, group), tmp_path_factory.mktemp(group))
        made = known[group]
        return fuzz.Files(made.group, made.folder, names or tuple(sorted(made.sound)), made.sound)

    return of


def test_messy_sites_end_in_results_or_a_geofit_error(fuzz):
    outcomes, failures = fuzz.run(15, 11, fuzz.sites.fit_one, 60)
    assert not failures, "\n".join(failures)
    assert outcomes["fitted"] >= 5


@pytest.mark.parametrize(("group", "cases"), [("tables", 200), ("others", 120), ("surfaces", 120)])
def test_damaged_files_end_in_results_or_a_geofit_error(fuzz, files, group, cases):
    every = files(group)
    light = files(group, *(name for name in every.names if name not in fuzz.surfaces.CAD))
    outcomes, failures = fuzz.run(cases, 11, light, 30)
    assert not failures, "\n".join(failures)
    assert outcomes["geofit error"] >= cases // 6
    assert outcomes["read"] >= cases // 6
    if group == "tables":
        assert min(outcomes["rows used"], outcomes["rows listed"]) > 100


def test_damaged_cad_files_end_in_results_or_a_geofit_error(fuzz, files):
    outcomes, failures = fuzz.run(4, 11, files("surfaces", *fuzz.surfaces.CAD), 60)
    assert not failures, "\n".join(failures)
    assert sum(outcomes.values()) == 4


@pytest.mark.parametrize("group", ["tables", "others", "surfaces"])
def test_sound_files_are_read(fuzz, files, group):
    every = files(group)
    for name, data in every.sound.items():
        (every.folder / name).write_bytes(data)
    for name in every.sound:
        every.group.read(name, every.folder, [], 1)


def test_a_case_is_the_same_each_time(fuzz, files):
    tables = files("tables")
    assert fuzz.run(3, 5, tables, 30) == fuzz.run(3, 5, tables, 30)


def test_the_harness_finds_what_takes_too_long_and_what_is_no_geofit_error(fuzz):
    def case(number):
        if number % 2:
            raise KeyError(number)
        while True:
            pass

    outcomes, failures = fuzz.run(2, 0, case, 1)
    assert outcomes == Counter(failed=2)
    assert "longer than its limit" in failures[0]
    assert "KeyError: 1" in failures[1]


def no_distance_class(monkeypatch):
    """Item 1: kriging that knows no distance class."""

    def planted(plane, z):
        return float(np.empty(0).max())

    monkeypatch.setattr("geofit.prediction.kriging.fit_variogram", planted)


def hull_without_area(monkeypatch):
    """Item 3: the hull of points above each other."""
    from scipy.spatial import Delaunay

    monkeypatch.setattr(
        "geofit.prediction.bands.within_hull", lambda points, places: Delaunay(points).find_simplex(places) >= 0
    )


def core_without_area(monkeypatch):
    """Item 2: a core that is a line."""
    from geofit.fitting import density

    def planted(plane):
        return 1.0, 1.0

    monkeypatch.setattr(density, "extents", planted)


def called_exact(monkeypatch):
    """Item 8: points of a fold called exact whether they are met or not."""
    from dataclasses import replace

    from geofit.fitting import pipeline

    def planted(surface):
        return surface.with_(accuracy=replace(surface.accuracy, residuals=surface.accuracy.residuals + 0.1))

    monkeypatch.setattr(pipeline, "exact_or_not", planted)


@pytest.mark.parametrize(
    ("plant", "layout", "settings"),
    [
        (no_distance_class, "cloud", {}),
        (hull_without_area, "vertical hole", {}),
        (core_without_area, "core", {}),
        (called_exact, "sections", {"frame": "sections"}),
    ],
)
def test_a_planted_bug_of_a_fit_is_found(fuzz, monkeypatch, plant, layout, settings):
    plant(monkeypatch)
    known = fuzz.sites.messy

    def messy(rng, _):
        points, found, _ = known(rng, layout)
        kept = settings or {"robust": found.robust}
        return points, fuzz.sites.FitSettings(**kept), None

    monkeypatch.setattr(fuzz.sites, "messy", messy)
    # A few cases at a time, until one fails.
    assert any(fuzz.run(3, seed, fuzz.sites.fit_one, 60)[0]["failed"] for seed in range(5, 19))


def test_a_project_that_removes_the_files_of_others_is_found(fuzz, files, monkeypatch):
    """Item 6: any name in the folder's name is removed."""
    import re

    monkeypatch.setattr("geofit.io.project.SURFACE_FILE", re.compile(r".*"))
    outcomes, failures = fuzz.run(40, 5, files("surfaces", "p.geofit"), 30)
    assert outcomes["failed"], outcomes
    assert "was touched" in failures[0] or "FileNotFoundError" in failures[0]


def test_a_row_that_is_lost_is_found(fuzz, files, monkeypatch):
    from geofit.io import journal

    known = journal.Journal.count

    def planted(self, file, read, listed):
        known(self, file, max(read - 1, 0), listed)

    monkeypatch.setattr(journal.Journal, "count", planted)
    assert fuzz.run(60, 5, files("tables", "picks.csv"), 30)[0]["failed"]


def test_an_error_of_a_library_is_found(fuzz, files, monkeypatch):
    """Items 11 and 12: what unpacks raises errors of its own."""

    def planted(path, **known):
        import zlib

        raise zlib.error("invalid block type")

    monkeypatch.setattr(fuzz.others, "read_volume", planted)
    assert fuzz.run(5, 5, files("others", "rock.npz"), 30)[0]["failed"] == 5
