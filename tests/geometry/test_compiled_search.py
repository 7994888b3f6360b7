"""Searches for very many points find the feet of a dense search, and are never farther than those for few points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from converged import converged_distances, ring
from surfaces import fold, height_field, split

from geofit.geometry import cells, projection, trim_loops
from geofit.geometry.trim_loops import nearest_on_trimmed
from geofit.splines.patch import Patch


def weighted() -> Patch:
    patch = fold(24, 12)
    weights = 1 + 0.4 * np.random.default_rng(2).random(patch.control.shape[:2])
    return replace(patch, weights=weights)


SURFACES = {
    "horizon": (height_field(60, 30),),
    "creased": (height_field(24, 18, multiplicity=3),),
    "fold": (fold(),),
    "weighted fold": (weighted(),),
    "two patches": split(fold(), [0.5135135135135135], []),
}


def points_about(patches: tuple[Patch, ...], count: int, spread: float, seed: int = 3) -> np.ndarray:
    rng, made = np.random.default_rng(seed), []
    for patch in patches:
        u0, u1, v0, v1 = patch.domain
        u, v = rng.uniform(u0, u1, count), rng.uniform(v0, v1, count)
        made.append(patch.evaluate(u, v) + patch.normal(u, v) * rng.normal(0, spread, count)[:, None])
    return np.concatenate(made)


@pytest.fixture
def compiled(monkeypatch):
    def switch(least: int) -> None:
        for module in (cells, projection, trim_loops):
            monkeypatch.setattr(module, "COMPILED", least)

    return switch


@pytest.mark.parametrize("spread", [0.2, 25.0])
@pytest.mark.parametrize("trimmed", [False, True])
@pytest.mark.parametrize("name", SURFACES)
def test_many_points_find_what_few_find(compiled, name, trimmed, spread):
    patches = SURFACES[name]
    loops = tuple((ring(p, (0.5, 0.5), 0.4, 200), ring(p, (0.45, 0.55), 0.1, 60)) for p in patches) if trimmed else ()
    xyz = points_about(patches, 700, spread)
    compiled(10**9)
    few = nearest_on_trimmed(patches, xyz, loops)
    compiled(1)
    many = nearest_on_trimmed(patches, xyz, loops)
    assert many.converged.all()
    farther = np.abs(many.distance) - np.abs(few.distance)
    assert farther.max() < 1e-9
    # A search that looks everywhere may be nearer than one of the nearest lattice places; hardly ever it is.
    assert (farther < -1e-9).mean() < 0.01
    same = np.abs(farther) < 1e-9
    assert (np.sign(many.distance) == np.sign(few.distance))[same & (np.abs(few.distance) > 1e-6)].all()
    assert (many.beyond == few.beyond)[same].mean() > 0.995
    for k, patch in enumerate(patches):
        own = many.patch == k
        assert np.abs(patch.evaluate(many.u[own], many.v[own]) - many.foot[own]).max() < 1e-8
    assert np.abs(np.linalg.norm(many.foot - xyz, axis=1) - np.abs(many.distance)).max() < 1e-9


@pytest.mark.parametrize("spread", [0.2, 40.0])
@pytest.mark.parametrize("trimmed", [False, True])
@pytest.mark.parametrize("name", ["horizon", "creased", "fold"])
def test_many_points_against_a_dense_search(compiled, name, trimmed, spread):
    (patch,) = SURFACES[name]
    loops = (ring(patch, (0.5, 0.45), 0.42, 150), ring(patch, (0.55, 0.5), 0.12, 40)) if trimmed else ()
    xyz = points_about((patch,), 60, spread, seed=11)
    compiled(1)
    found = nearest_on_trimmed([patch], xyz, (loops,) if loops else ())
    assert np.abs(found.distance) == pytest.approx(converged_distances(patch, loops, xyz), abs=1e-9)


@pytest.mark.parametrize("seed", range(3, 8))
def test_feet_on_both_sides_of_a_crease_are_looked_for(compiled, seed):
    # Two of them may be less than half a step of the search lattice apart.
    patches = SURFACES["creased"]
    xyz = points_about(patches, 700, 25.0, seed)
    found = []
    for least in (1, 10**9):
        compiled(least)
        found.append(np.abs(nearest_on_trimmed(patches, xyz).distance))
    assert found[0] == pytest.approx(found[1], abs=1e-9)


def test_a_face_smaller_than_the_lattice_is_found(compiled):
    patch = height_field(8, 8)
    u0, u1, v0, v1 = patch.domain
    at, size = np.array([u0 + 0.3371 * (u1 - u0), v0 + 0.6113 * (v1 - v0)]), 1e-3 * (u1 - u0)
    loop = at + size * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    above = patch.evaluate(at[:1] + size / 2, at[1:] + size / 2) + np.array([0, 0, 3.0])
    xyz = np.concatenate([above, points_about((patch,), 40, 5.0)])
    compiled(1)
    found = nearest_on_trimmed([patch], xyz, ((loop,),))
    assert np.abs(found.distance) == pytest.approx(converged_distances_of_sliver(patch, loop, xyz), abs=1e-9)


def converged_distances_of_sliver(patch: Patch, loop: np.ndarray, xyz: np.ndarray) -> np.ndarray:
    """Return distances to a nearly flat face, by a shrinking lattice."""
    (u0, v0), (u1, v1) = loop.min(axis=0), loop.max(axis=0)
    best = []
    for point in xyz:
        middle, half = np.array([(u0 + u1) / 2, (v0 + v1) / 2]), np.array([(u1 - u0) / 2, (v1 - v0) / 2])
        for _ in range(70):
            s, t = np.meshgrid(np.linspace(-1, 1, 7), np.linspace(-1, 1, 7))
            u = np.clip(middle[0] + s.ravel() * half[0], u0, u1)
            v = np.clip(middle[1] + t.ravel() * half[1], v0, v1)
            d = np.linalg.norm(patch.evaluate(u, v) - point, axis=1)
            middle, half = np.array([u[d.argmin()], v[d.argmin()]]), 0.6 * half
        best.append(d.min())
    return np.array(best)
