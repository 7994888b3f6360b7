"""Pieces of a cut body are closed and add up, and share their cut faces."""

from __future__ import annotations

import numpy as np
import pytest

from bodies.planted import ORIGIN
from geofit.bodies.body import BodyFit
from geofit.bodies.strata import strata_table
from geofit.data.errors import FitError, SettingsError


class Plane:
    """z = z0 + slope * (x - x0), in map coordinates."""

    def __init__(self, name: str, height: float, slope: float, wave: float = 0.0, end: float = np.inf) -> None:
        self.name, self.height, self.slope, self.wave, self.end = name, height, slope, wave, end

    def elevation(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        along = np.asarray(x) - ORIGIN[0]
        z = ORIGIN[2] + self.height + self.slope * along + self.wave * np.sin((np.asarray(y) - ORIGIN[1]) / 15)
        return np.where(along > self.end, np.nan, z)


def test_one_surface_needs_no_list(ring: BodyFit) -> None:
    assert [piece.name for piece in ring.cut(Plane("top", 3, 0))] == [
        piece.name for piece in ring.cut([Plane("top", 3, 0)])
    ]


def test_pieces_are_closed_and_add_up(ring: BodyFit) -> None:
    surfaces = [Plane("top", 3, 0.1, 3), Plane("base", -6, 0), Plane("fault", 0, 3)]
    pieces = ring.cut(surfaces)
    assert len(pieces) == 7
    for piece in pieces:
        assert piece.mesh.is_closed
        assert piece.mesh.is_manifold
        x, y, z = piece.mesh.vertices.T
        for surface in surfaces:
            off = z - surface.elevation(x, y)
            # Later cuts cross the triangles of earlier cut faces, up to their sagitta off the waved surface.
            assert (off > -0.3).all() if piece.sides[surface.name] == "above" else (off < 0.3).all()
    assert sum(piece.volume for piece in pieces) == pytest.approx(ring.triangulate().volume, rel=1e-9)


def test_two_sides_share_their_cut_face(ring: BodyFit) -> None:
    above, below = ring.cut({"h": Plane("", 2, 0.05)})

    def face(mesh: object) -> set[tuple[float, ...]]:
        v = mesh.vertices  # type: ignore[attr-defined]
        on = np.abs(v[:, 2] - Plane("", 2, 0.05).elevation(v[:, 0], v[:, 1])) < 1e-7
        return {tuple(row) for row in v[on].tolist()}

    assert face(above.mesh) == face(below.mesh)
    assert len(face(above.mesh)) > 50


def test_a_surface_that_cuts_again_leaves_its_pieces_whole(ring: BodyFit) -> None:
    """The second cut had made two pieces of volume 0, of hundreds of loose triangles."""
    first, again = Plane("first", 2, 0.3), Plane("again", 2, 0.3)
    once, twice = ring.cut([first]), ring.cut([first, again])
    assert [dict(piece.sides) for piece in twice] == [
        {"first": "above", "again": "above"},
        {"first": "below", "again": "below"},
    ]
    assert [piece.volume for piece in twice] == [piece.volume for piece in once]


def test_a_surface_beyond_the_body_leaves_it_whole(ring: BodyFit) -> None:
    (piece,) = ring.cut([Plane("ground", 300, 0)])
    assert piece.sides == {"ground": "below"}
    assert piece.volume == pytest.approx(ring.triangulate().volume)


def test_a_surface_that_ends_within_the_body(ring: BodyFit) -> None:
    with pytest.raises(FitError, match="does not reach"):
        ring.cut([Plane("short", 0, 0, end=10)])


def test_table_of_strata(ring: BodyFit) -> None:
    horizons = {"base": Plane("", -8, 0.02), "top": Plane("", 6, 0.05, 2), "far": Plane("", -400, 0)}
    table = strata_table(ring, horizons, 6.0)
    assert [str(row.name) for row in table] == ["above top", "top to base", "base to far"]
    volumes = ring.volumes()
    assert sum(row.volumes.best for row in table) == pytest.approx(volumes.best, rel=1e-9)
    assert sum(row.volumes.error for row in table) == pytest.approx(volumes.error, rel=1e-9)
    pieces = ring.cut(horizons, 6.0)
    above = sum(piece.volume for piece in pieces if piece.sides["top"] == "above")
    flat = ring.triangulate(6.0).volume
    assert table[0].volumes.best == pytest.approx(above * volumes.best / flat, rel=1e-9)
    for row in table:
        assert row.volumes.p10 < row.volumes.best < row.volumes.p90
    # Parts vary less than together, but not all the same way.
    whole = volumes.sd
    assert whole < sum(row.volumes.sd for row in table) < 3 * whole


def test_a_table_without_horizons(ring: BodyFit) -> None:
    with pytest.raises(SettingsError, match="horizon"):
        strata_table(ring, {})
