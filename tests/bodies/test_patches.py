"""Patches over parts of a body: which stage fails, and why; bodies of many parts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest
from numpy.typing import NDArray

import geofit.implicit as implicit
from geofit.bodies.quads import PartOfBody, fit_part, patched_surface
from geofit.data.errors import FitError
from geofit.implicit.field import Field
from geofit.implicit.mesh import TriangleMesh

NOTHING = TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), int))


@dataclass(frozen=True, eq=False)
class Shape:
    """A field in a box, as patches need it."""

    field: Field
    extent: tuple[NDArray[np.float64], NDArray[np.float64]]
    epsilon: float = 0.02
    cut_sides: tuple[str, ...] = ()
    cells: int = 64

    @cached_property
    def overview(self) -> TriangleMesh:
        return implicit.isosurface(self.field, implicit.Lattice.around(*self.extent, cells=self.cells))


def test_each_stage_that_fails_has_a_reason_of_its_own() -> None:
    ball = implicit.Sphere([0, 0, 0], 1.0)
    mesh = Shape(ball, (np.full(3, -1.2), np.full(3, 1.2))).overview
    assert len(fit_part(ball, mesh, NOTHING, 0.01, PartOfBody(1, 1, 100)).control) <= 100
    for tolerance, most, code in ((0.01, 4, "bodies.part-without-layout"), (1e-13, 30, "bodies.patches-off-body")):
        with pytest.raises(FitError) as caught:
            fit_part(ball, mesh, NOTHING, tolerance, PartOfBody(2, 3, most))
        assert caught.value.code == code
        assert "part 2 of 3" in str(caught.value)


def test_folds_finer_than_patches_are_named() -> None:
    """Waves on a ball that its coarse triangles do not show."""
    wavy = Waves()
    mesh = implicit.isosurface(implicit.Sphere([0, 0, 0], 1.0), implicit.Lattice.around(*wavy.bounds, cells=24))
    with pytest.raises(FitError) as caught:
        fit_part(wavy, mesh, NOTHING, 0.01, PartOfBody(1, 1, 30))
    assert caught.value.code in ("bodies.part-folds", "bodies.part-without-layout")


class Waves:
    """A ball with steep short waves."""

    bounds = (np.full(3, -1.4), np.full(3, 1.4))
    lipschitz = 40.0

    def value(self, xyz: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.linalg.norm(xyz, axis=1) - 1.0 + 0.2 * np.sin(60 * xyz).prod(axis=1))

    def gradient(self, xyz: NDArray[np.float64]) -> NDArray[np.float64]:
        steps = 1e-5 * np.eye(3)
        return np.stack([(self.value(xyz + s) - self.value(xyz - s)) / 2e-5 for s in steps], axis=1)


def test_a_body_of_many_parts_has_patches_for_each() -> None:
    """Twenty-two balls: with 24 patches kept for each of the others, nothing of 500 would be left for the first."""
    middles = np.array([(x, y, z) for x in (0, 3, 6) for y in (0, 3, 6) for z in (0, 3, 6)], float)[:22]

    class Balls:
        bounds = (np.full(3, -1.5), np.full(3, 7.5))
        lipschitz = 1.0

        def value(self, xyz: NDArray[np.float64]) -> NDArray[np.float64]:
            return np.asarray(np.linalg.norm(xyz[:, None] - middles, axis=2).min(axis=1) - 1.0)

        def gradient(self, xyz: NDArray[np.float64]) -> NDArray[np.float64]:
            off = xyz[:, None] - middles
            far = np.linalg.norm(off, axis=2)
            near = np.arange(len(xyz)), far.argmin(axis=1)
            return np.asarray(off[near] / np.maximum(far[near], 1e-300)[:, None])

    patched = patched_surface(Shape(Balls(), Balls.bounds, cells=40))
    assert len(patched.components) == 22
    assert len(patched.patches) <= 22 * 50
    assert patched.deviation <= 0.01
    assert patched.seam_angle <= 1.0
