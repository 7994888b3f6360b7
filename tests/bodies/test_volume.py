"""One volume of a body, within 1e-3 of the truth, and the same wherever it is stated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from bodies.planted import ORIGIN, SIZE, drilled, pair, plate, torus
from geofit.bodies.fit import fit_body
from geofit.bodies.implicit_body import OwnField
from geofit.bodies.simulate import volumes_of
from geofit.implicit.distance import Torus
from geofit.implicit.field import Field
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice
from geofit.implicit.quadric import ellipsoid


@dataclass(frozen=True)
class Analytic(OwnField):
    """A body whose volume is known in closed form."""

    field: Field
    name: str = "analytic"
    spacing: float = 1.0

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """A box somewhat larger than the field's own."""
        lower, upper = (np.asarray(corner, float) for corner in self.field.bounds)
        room = 0.03 * float((upper - lower).max())
        return lower - room, upper + room


def turned(seed: int) -> np.ndarray:
    return np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]


def solid(kind: str, seed: int) -> tuple[Analytic, float]:
    """Return a body at an odd place and in an odd direction, metres, and its volume in m3."""
    middle, turn = np.array([3.1, -7.7, 11.3]), turned(seed)
    if kind == "torus":
        ring, radius = 300.0 + 7 * seed, 55.0 + 9 * seed
        return Analytic(Torus(middle, turn[0], ring, radius)), 2 * np.pi**2 * ring * radius**2
    axes = {"ball": (90.0, 90.0, 90.0), "ellipsoid": (300.0, 200.0, 120.0), "lens": (300.0, 240.0, 40.0)}[kind]
    return Analytic(ellipsoid(middle, axes, turn)), 4 / 3 * np.pi * float(np.prod(axes))


@pytest.mark.parametrize("kind", ["ball", "ellipsoid", "lens", "torus"])
@pytest.mark.parametrize("seed", range(4))
def test_numerical_error_of_the_volume_of_analytic_bodies(kind: str, seed: int) -> None:
    body, volume = solid(kind, seed)
    off = abs(body.size.volume - volume)
    assert off < 1e-3 * volume
    assert off < body.size.volume_error + 1e-5 * volume
    assert body.size.volume_error < 1e-3 * volume
    # Flat triangles of the same cells are farther off: the file of triangles says so.
    assert abs(body.overview.volume - volume) > 3 * off


def test_the_volume_of_a_fitted_body_does_not_depend_on_the_cells() -> None:
    body = fit_body(drilled(torus(0.55, 0.22)[0], 1, rows=9))
    lower, upper = body.extent
    cell = float((upper - lower).max()) / 160
    fine, coarse = body.local_mesh(cell).volume, body.local_mesh(2 * cell).volume
    assert body.size.volume == pytest.approx((4 * fine - coarse) / 3, rel=2e-4)
    volumes = body.volumes()
    assert volumes.best == body.size.volume
    assert volumes.error == body.size.volume_error < 1e-3 * volumes.best
    assert volumes.p50 == pytest.approx(volumes.best, rel=1e-9)


@pytest.mark.parametrize(("dip", "thickness"), [(45, 4.0), (20, 1.0), (45, 2.0)])
def test_a_plate_thinner_than_the_raster_has_its_whole_extent_volume_and_overview(dip: float, thickness: float) -> None:
    """A plate of 4 m had a part of its volume, one of 2 m none at all, and its triangles half of what was stated."""
    body = fit_body(drilled(plate(dip, thickness / SIZE), 1, rows=9, step=0.005, named=True))
    lower, upper = (corner + body.origin for corner in body.extent)
    assert ((body.contacts > lower) & (body.contacts < upper)).all()
    place = np.random.default_rng(0).uniform(-0.8, 0.8, (200_000, 3)) * SIZE + ORIGIN
    volume = float((body.value(place) < 0).mean()) * (1.6 * SIZE) ** 3
    assert abs(body.size.volume - volume) < body.size.volume_error + 0.05 * volume
    assert body.overview.is_closed
    assert body.overview.volume == pytest.approx(body.size.volume, rel=0.02)


@pytest.mark.parametrize("seed", [1, 2])
def test_smaller_cells_follow_every_part_of_the_surface(seed: int) -> None:
    body = fit_body(drilled(pair()[0], seed, rows=9))
    spacing = body.overview_spacing / 2
    field, lower, upper = body.field, *body.extent
    counts = np.maximum(np.ceil((upper - lower) / spacing).astype(int), 1) + 4
    lattice = Lattice((lower + upper) / 2 - counts * spacing / 2, spacing, tuple((counts + 1).tolist()))
    everywhere, mesh = isosurface(field, lattice, capped=True), body.local_mesh(spacing)
    assert mesh.components == everywhere.components == 2
    assert mesh.vertices.tobytes() == everywhere.vertices.tobytes()
    assert mesh.triangles.tobytes() == everywhere.triangles.tobytes()


def test_volumes_of_a_body_that_was_not_simulated() -> None:
    alone = volumes_of(8.0, np.zeros(5))
    assert (alone.p10, alone.p50, alone.p90, alone.best, alone.sd, alone.error) == (8.0, 8.0, 8.0, 8.0, 0.0, 0.0)


@pytest.mark.parametrize("spread", [0.0, 0.01, 3.0])
def test_the_spread_of_a_volume_contains_its_numerical_error(spread: float) -> None:
    """Simulations of a body that is known to 400 m3 and measured to 30,000 had a spread of 400 m3."""
    drawn = np.random.default_rng(2).normal(0, 1, 4001)
    drawn = spread * (drawn - np.median(drawn)) / drawn.std(ddof=1)
    volumes = volumes_of(800.0, drawn, 4.0)
    wanted = float(np.hypot(spread, 4.0))
    assert (volumes.best, volumes.error) == (800.0, 4.0)
    assert volumes.p50 == pytest.approx(800.0, abs=1e-9)
    assert volumes.sd == pytest.approx(wanted, rel=0.01)
    assert volumes.p90 - volumes.p10 == pytest.approx(2 * 1.2816 * wanted, rel=0.05)
    assert volumes_of(800.0, drawn).sd == pytest.approx(spread, abs=1e-9)
