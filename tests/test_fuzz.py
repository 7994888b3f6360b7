"""A short, seeded part of benchmarks/fuzz.py, and five planted bugs that it must find."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).resolve().parents[1] / "benchmarks"


@pytest.fixture
def fuzz(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import fuzz

    yield fuzz
    for name in ("fuzz", "fuzz_import"):
        sys.modules.pop(name, None)


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    sys.path.insert(0, str(BENCHMARKS))
    try:
        import fuzz

        return fuzz.originals(tmp_path_factory.mktemp("sound"))
    finally:
        sys.path.remove(str(BENCHMARKS))
        for name in ("fuzz", "fuzz_import"):
            sys.modules.pop(name, None)


def test_messy_sites_end_in_results_or_a_geofit_error(fuzz, tmp_path):
    outcomes, failures = fuzz.run(15, 11, lambda case: fuzz.fit_one(case, tmp_path))
    assert not failures, "\n".join(failures)
    assert outcomes["fitted"] >= 5


def test_damaged_files_end_in_results_or_a_geofit_error(fuzz, sound, tmp_path):
    light = tuple(name for name in sorted(sound) if not name.endswith((".step", ".igs", ".brep")))
    outcomes, failures = fuzz.run(150, 11, lambda case: fuzz.read_one(case, sound, tmp_path, light))
    assert not failures, "\n".join(failures)
    assert outcomes["geofit error"] >= 50
    outcomes, failures = fuzz.run(
        4, 11, lambda case: fuzz.read_one(case, sound, tmp_path, ("a.step", "a.igs", "a.brep"))
    )
    assert not failures, "\n".join(failures)


def test_sound_files_are_read(fuzz, sound, tmp_path):
    for name, data in sound.items():
        (tmp_path / name).write_bytes(data)
    (tmp_path / "picks.csv").write_text("x,y,z\n1,2,3\n4,5,6\n7,8,1\n")
    for name in sound:
        path = tmp_path / name
        fuzz.READERS.get(path.suffix, fuzz.read_site if name == "site.toml" else fuzz.load_mappings)(path)


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
    from geofit.fitting import partition

    def planted(plane):
        return 1.0, 1.0

    monkeypatch.setattr(partition, "_extents", planted)


def called_exact(monkeypatch):
    """Item 8: points of a fold called exact whether they are met or not."""
    from geofit.fitting import pipeline

    def planted(surface):
        return surface.with_(accuracy=pipeline.replace(surface.accuracy, residuals=surface.accuracy.residuals + 0.1))

    monkeypatch.setattr(pipeline, "_exact_or_not", planted)


@pytest.mark.parametrize(
    ("plant", "layout", "settings"),
    [
        (no_distance_class, "cloud", {}),
        (hull_without_area, "vertical hole", {}),
        (core_without_area, "core", {}),
        (called_exact, "sections", {"frame": "sections"}),
    ],
)
def test_a_planted_bug_of_a_fit_is_found(fuzz, tmp_path, monkeypatch, plant, layout, settings):
    plant(monkeypatch)
    known = fuzz.messy

    def messy(rng, _):
        points, found, _ = known(rng, layout)
        return points, fuzz.FitSettings(**settings) if settings else fuzz.FitSettings(robust=found.robust), None

    monkeypatch.setattr(fuzz, "messy", messy)
    # A few cases at a time, until one fails.
    assert any(fuzz.run(3, seed, lambda case: fuzz.fit_one(case, tmp_path))[0]["failed"] for seed in range(5, 19))


def test_a_project_that_removes_the_files_of_others_is_found(fuzz, sound, tmp_path, monkeypatch):
    """Item 6: any name in the folder's name is removed."""
    import re

    monkeypatch.setattr("geofit.io.project._SURFACE_FILE", re.compile(r".*"))
    outcomes, failures = fuzz.run(40, 5, lambda case: fuzz.read_one(case, sound, tmp_path, ("p.geofit",)))
    assert outcomes["failed"], outcomes
    assert "was touched" in failures[0] or "FileNotFoundError" in failures[0]
