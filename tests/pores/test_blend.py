"""Blended balls: a lone ball, two balls between their bounds, smooth normals, seams of blocks (PORES.md, 12 to 15)."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest
from brute import blobs
from hypothesis import given, settings
from hypothesis import strategies as st

import geofit.implicit as implicit
from geofit.implicit.blobs import Metaballs
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice
from geofit.medial.balls import MetaballBody
from geofit.medial.fit import metaballs
from geofit.pores import RockVolume, pore_surface

KERNELS = (*implicit.POTENTIALS, "guo")
DIRECTIONS = np.random.default_rng(0).normal(size=(200, 3))
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1)[:, None]


def balls_of(kernel, centres, radii):
    """Balls of visible radii with any kernel; the effective radius is 1.5 times the visible one, Blinn's 0.4."""
    if kernel == "guo":
        return MetaballBody(np.asarray(centres, float), np.asarray(radii, float))
    reach = 0.4 if kernel == "blinn" else 1.5
    level = float(implicit.potential(kernel).value(1 / reach**2))
    return implicit.spherical_metaballs(centres, reach * np.asarray(radii), kernel=kernel, threshold=level)


@pytest.mark.parametrize("radius", [0.7, 3.0, 40.0])
@pytest.mark.parametrize("kernel", KERNELS)
def test_one_ball_of_any_kernel_is_a_sphere(kernel, radius):
    centre = np.array([1.3, -0.4, 7.0])
    body = balls_of(kernel, [centre], [radius])
    for share, sign in ((1 - 1e-9, -1), (1 + 1e-9, 1)):
        assert (np.sign(body.value(centre + share * radius * DIRECTIONS)) == sign).all()
    places = centre + radius * np.random.default_rng(1).uniform(0.3, 1.3, (200, 1)) * DIRECTIONS
    step = 1e-5 * radius
    differences = np.stack(
        [(body.value(places + step * e) - body.value(places - step * e)) / (2 * step) for e in np.eye(3)], 1
    )
    np.testing.assert_allclose(body.gradient(places), differences, atol=1e-6 * np.abs(differences).max())


def union_of_spheres(radii, gap):
    """Volume of two spheres less their lens."""
    a, b = radii
    whole = 4 / 3 * np.pi * (a**3 + b**3)
    if gap >= a + b:
        return whole
    if gap <= abs(a - b):
        return 4 / 3 * np.pi * max(a, b) ** 3
    return whole - np.pi * (a + b - gap) ** 2 * (gap**2 + 2 * gap * (a + b) - 3 * (a - b) ** 2) / (12 * gap)


def volume_of_revolution(value, low, high, most, slices=300):
    """Volume of a body round the first axis, its wall found in each slice by halving."""
    width = (high - low) / slices
    x = low + (np.arange(slices) + 0.5) * width
    inner, outer = np.zeros(slices), np.full(slices, most)
    for _ in range(30):
        middle = 0.5 * (inner + outer)
        inside = value(np.column_stack([x, middle, np.zeros(slices)])) < 0
        inner, outer = np.where(inside, middle, inner), np.where(inside, outer, middle)
    return np.pi * width * (inner**2).sum()


@settings(max_examples=1000, deadline=None)
@given(st.floats(0.0, 3.0), st.floats(0.4, 1.0), st.floats(8, 40))
def test_two_balls_stay_between_their_union_and_its_bound(gap, small, kappa):
    """Never inside the union, and outside it by no more than R (sqrt(1 + ln 2 / kappa) - 1)."""
    centres, radii = np.array([[0.0, 0, 0], [gap, 0, 0]]), np.array([1.0, small])
    shapes = np.eye(3) * (np.sqrt(kappa) / radii)[:, None, None]
    field = Metaballs(centres, shapes, np.full(2, np.exp(kappa)), implicit.potential("blinn"), 1.0)
    swollen = np.sqrt(1 + np.log(2) / kappa)
    for centre, radius in zip(centres, radii, strict=True):
        assert (field.value(centre + 0.999 * radius * DIRECTIONS) < 0).all()
        far = centre + (swollen * radius + 1e-6) * DIRECTIONS
        outside = (np.linalg.norm(far[:, None] - centres, axis=2) > swollen * radii).all(axis=1)
        assert (field.value(far[outside]) > 0).all()
    low, high = min(-1.0, gap - small) * swollen, max(1.0, gap + small * swollen) * swollen
    volume = volume_of_revolution(field.value, low, high, swollen + 0.1)
    assert volume >= (1 - 1e-3) * union_of_spheres(radii, gap)
    assert volume <= (1 + 1e-3) * union_of_spheres(swollen * radii, gap)


@pytest.mark.parametrize("joint", [1.0, 1.5])
@pytest.mark.parametrize("kernel", [kernel for kernel in KERNELS if kernel != "blinn"])
def test_normals_turn_by_a_milliradian_in_a_hundredth_of_a_voxel(kernel, joint):
    """Across visible and effective radius of one ball, in the field of both, near the surface; Blinn's has no joint."""
    centres, radii = np.array([[0.0, 0, 0], [34.0, 5, 3]]), np.array([24.0, 20.0])
    body = balls_of(kernel, centres, radii)
    for centre, radius in zip(centres, radii, strict=True):
        at = [centre + (joint * radius + side) * DIRECTIONS for side in (-0.005, 0.005)]
        normals = [body.gradient(places) for places in at]
        length = [np.linalg.norm(normal, axis=1) for normal in normals]
        sine = np.linalg.norm(np.cross(*normals), axis=1) / np.maximum(length[0] * length[1], 1e-300)
        near = np.abs(body.value(at[0])) < 0.1 * radius
        assert near.sum() > 5
        assert sine[near].max() <= 1e-3


@pytest.mark.parametrize("construction", ["contact", "blend", "greedy"])
def test_vertices_at_the_seam_of_two_blocks_are_equal_bit_for_bit(construction):
    volume = RockVolume(blobs(6, (40, 32, 30)), pore=True, voxel=1.0)
    # Most of these pores are noise a voxel wide.
    with pytest.warns(UserWarning, match="voxels wide") if construction == "blend" else nullcontext():
        body = (
            metaballs(volume, max_balls=40)
            if construction == "greedy"
            else pore_surface(volume, construction=construction)
        )
    rim = []
    for first in (0, 20):
        mesh = isosurface(body, Lattice(np.array([float(first), 0, 0]), 1.0, (21, 33, 31)))
        on = mesh.vertices[mesh.vertices[:, 0] == 20.0]
        rim.append(on[np.lexsort(on.T)])
    assert len(rim[0]) > 10
    assert rim[0].tobytes() == rim[1].tobytes()


@pytest.mark.parametrize("edges", [(1e-6, 1e-6, 1e-6), (1e-6, 1e-6, 3e-6)])
@pytest.mark.parametrize("width", [1, 2])
def test_ducts_that_blended_balls_leave_without_triangles_are_a_warning(width, edges):
    pore = np.zeros((20, 12, 12), bool)
    pore[:, 1 : 1 + width, 1 : 1 + width] = True
    with pytest.warns(UserWarning, match="100% of the pores are one or two voxels wide"):
        body = pore_surface(RockVolume(pore, pore=True, voxel=edges), construction="blend")
    assert [(text.code, text.severity) for text in body.messages] == [("pores.ducts-without-triangles", "warning")]
    assert not len(body.triangulate().triangles)
    pore[:, 4:7, 4:7] = True
    with pytest.warns(UserWarning, match="voxels wide"):
        body = pore_surface(RockVolume(pore, pore=True, voxel=edges), construction="blend")
    assert body.messages[0].params["share"] == pytest.approx(width**2 / (width**2 + 9))
    pore[:, 1 : 1 + width, 1 : 1 + width] = False
    # Warnings are errors.
    assert pore_surface(RockVolume(pore, pore=True, voxel=1e-6), construction="blend").messages == ()
