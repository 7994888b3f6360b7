"""Bodies as STEP solids, read back."""

from __future__ import annotations

from pathlib import Path

import pytest

from geofit.bodies.body import BodyFit
from geofit.bodies.quads import patched_surface


def test_nurbs_solid_of_a_ring(ring: BodyFit, tmp_path: Path) -> None:
    found = ring.write_step(tmp_path / "ring.step")
    assert found.passed
    assert (found.grade, found.solids, found.free_edges, found.brep_valid) == ("nurbs", 1, 0, True)
    assert found.faces <= 500
    assert found.sigma < ring.settings.epsilon / 4
    assert found.volume == pytest.approx(ring.triangulate(1.5).volume, rel=1e-3)
    ring.write_step(tmp_path / "again.step")
    assert (tmp_path / "ring.step").read_bytes() == (tmp_path / "again.step").read_bytes()


def test_two_solids(two: BodyFit, tmp_path: Path) -> None:
    found = two.write_step(tmp_path / "two.step")
    assert found.passed
    assert found.solids == 2


def test_triangles_keep_the_volume(two: BodyFit, tmp_path: Path) -> None:
    found = two.write_step(tmp_path / "two.step", nurbs=False)
    assert found.passed
    assert found.grade == "triangles"
    assert found.volume == pytest.approx(two.overview.volume, rel=1e-9)


def test_seams_and_deviation(ring: BodyFit) -> None:
    patched = patched_surface(ring, tolerance=0.05)
    assert patched.deviation <= 0.05
    assert patched.seam_angle <= 1.0
    assert len(patched.patches) <= 500
