"""T21-T24, T26-T28 of the level-set equation: fronts whose course is known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

import geofit.implicit as implicit
from geofit.morphing.distance import both_distances, redistanced, samples_of
from geofit.morphing.levelset import Step, evolve

BOX = ([-1.0] * 3, [1.0] * 3)
RING, TUBE = 0.55, 0.22
BALL, TORUS = implicit.Sphere([0, 0, 0], 0.5), implicit.Torus([0, 0, 0], [0, 0, 1], RING, TUBE)
TIME = quad(lambda z: 1 / (np.hypot(RING, z) - TUBE), 0, 0.5)[0]


def pair(a: implicit.Field, b: implicit.Field, n: int) -> tuple[np.ndarray, np.ndarray, implicit.Lattice]:
    lattice = implicit.Lattice.around(*BOX, cells=n)
    return *both_distances(samples_of(a, lattice), samples_of(b, lattice)), lattice


def radii(phi: np.ndarray, lattice: implicit.Lattice) -> np.ndarray:
    return np.linalg.norm(implicit.isosurface(implicit.spline_grid(phi, lattice), lattice).vertices, axis=1)


def corridor(d_a: np.ndarray, d_b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.minimum(d_a, d_b), np.maximum(d_a, d_b)


def test_concentric_spheres_approach_each_other_exponentially() -> None:
    truth, errors = 0.7 - 0.4 * np.exp(-1), []
    for n, limit in ((24, 0.02), (48, 0.012), (96, 0.012)):
        d_a, d_b, lattice = pair(implicit.Sphere([0, 0, 0], 0.3), implicit.Sphere([0, 0, 0], 0.7), n)
        found = radii(evolve(d_a, d_b, lattice, until=1.0, corridor=corridor(d_a, d_b)).phi, lattice)
        assert np.abs(found - truth).max() <= limit * lattice.spacing
        errors.append(abs(found.mean() - truth))
    assert np.log2(errors[0] / errors[2]) / 2 >= 1.9


def test_curvature_holds_the_front_back() -> None:
    for n in (24, 48):
        d_a, d_b, lattice = pair(implicit.Sphere([0, 0, 0], 0.3), implicit.Sphere([0, 0, 0], 0.7), n)
        found = radii(evolve(d_a, d_b, lattice, until=1.0, eps=0.01).phi, lattice)
        assert abs(found.mean() - 0.523903) <= 0.02 * lattice.spacing
        assert found.max() - found.min() <= 0.01 * lattice.spacing


def test_a_sphere_collapses_by_its_curvature() -> None:
    errors, eps = [], 0.02
    for n in (24, 32):
        lattice = implicit.Lattice.around(*BOX, cells=n)
        d = implicit.sample(implicit.Sphere([0, 0, 0], 0.6), lattice)
        # Until r = 5 h of the coarsest lattice.
        time = (0.36 - (5 / 12) ** 2) / (4 * eps)
        still = np.zeros(lattice.shape)
        found = radii(evolve(d, d, lattice, until=time, eps=eps, speed=still).phi, lattice)
        errors.append(abs(found.mean() - 5 / 12))
    assert np.log(errors[0] / errors[1]) / np.log(32 / 24) >= 1.9


def test_unit_speed_expands_a_sphere_and_gives_its_volume_back() -> None:
    lattice = implicit.Lattice.around(*BOX, cells=48)
    d = implicit.sample(implicit.Sphere([0, 0, 0], 0.3), lattice)
    one = np.ones(lattice.shape)
    out = evolve(d, d, lattice, until=0.3, speed=-one)
    assert np.abs(radii(out.phi, lattice) - 0.6).max() <= 0.02 * lattice.spacing
    back = evolve(out.phi, d, lattice, until=0.3, speed=one)
    before, after = (implicit.isosurface(implicit.spline_grid(f, lattice), lattice).volume for f in (d, back.phi))
    assert abs(after / before - 1) <= 0.002


def test_a_block_grows_rounded_corners() -> None:
    lattice = implicit.Lattice.around(*BOX, cells=64)
    offset = np.abs(lattice.nodes()) - 0.3
    outside = np.linalg.norm(np.maximum(offset, 0), axis=1)
    d = (outside + np.minimum(offset.max(axis=1), 0)).reshape(lattice.shape)
    grown = evolve(d, d, lattice, until=0.25, speed=-np.ones(lattice.shape))
    mesh = implicit.isosurface(implicit.spline_grid(grown.phi, lattice), lattice)
    beyond = np.abs(mesh.vertices) - 0.3
    off = np.linalg.norm(np.maximum(beyond, 0), axis=1) - 0.25
    faces = (beyond > 0).sum(axis=1) == 1
    assert abs(off[faces].mean()) <= 0.02 * lattice.spacing
    # A sharp edge is none on a spline: what grows from it stays behind by half a spacing.
    assert np.abs(off).max() <= 0.6 * lattice.spacing


@pytest.fixture(scope="module")
def opening() -> tuple[list[Step], list[tuple[int, int]], np.ndarray, np.ndarray, implicit.Lattice]:
    d_a, d_b, lattice = pair(BALL, TORUS, 48)
    steps, shapes = [], []

    def each(step: Step) -> None:
        mesh = implicit.isosurface_of_samples(step.phi, lattice)
        assert mesh.is_closed
        assert mesh.is_manifold
        steps.append(step)
        shapes.append((mesh.components, mesh.euler))

    evolve(d_a, d_b, lattice, corridor=corridor(d_a, d_b), each=each)
    return steps, shapes, d_a, d_b, lattice


def test_a_ball_becomes_a_ring_once_and_when_it_has_to(opening) -> None:
    steps, shapes, *_, lattice = opening
    assert set(shapes) == {(1, 2), (1, 0)}
    first = shapes.index((1, 0))
    assert all(shape == (1, 0) for shape in shapes[first:])
    # The front meets itself in the middle at the speed d_B(0) = R - r: two spacings are this much time.
    assert steps[first - 1].time - 2 * lattice.spacing / (RING - TUBE) <= TIME
    assert steps[first].time + 2 * lattice.spacing / (RING - TUBE) >= TIME
    assert abs(steps[first].time - TIME) <= 0.04 * TIME


def test_the_hole_opens_within_a_percent_of_its_time() -> None:
    """At 96 cells; the field in the middle says when, within a step."""
    d_a, d_b, lattice = pair(BALL, TORUS, 96)
    time, value, shapes = [], [], []

    def each(step: Step) -> None:
        time.append(step.time)
        value.append(step.phi[48, 48, 48])
        if abs(step.time - TIME) < 0.1 * TIME:
            mesh = implicit.isosurface_of_samples(step.phi, lattice)
            shapes.append((mesh.components, mesh.euler))

    evolve(d_a, d_b, lattice, until=1.1 * TIME, corridor=corridor(d_a, d_b), each=each)
    after = int(np.argmax(np.array(value) > 0))
    opened = np.interp(0.0, value[after - 1 : after + 1], time[after - 1 : after + 1])
    assert abs(opened - TIME) <= 0.01 * TIME
    first = shapes.index((1, 0))
    assert shapes == [(1, 2)] * first + [(1, 0)] * (len(shapes) - first)
    assert 0 < first < len(shapes)


def test_energy_and_symmetric_difference_never_rise(opening) -> None:
    steps = opening[0]
    assert np.diff([step.energy for step in steps]).max() <= 0
    assert np.diff([step.different for step in steps]).max() <= 0
    assert abs(steps[-1].energy / (-2 * np.pi**2 * RING * TUBE**3 / 3) - 1) <= 0.01


def test_the_end_is_the_ring(opening) -> None:
    steps, *_, lattice = opening
    field = implicit.spline_grid(steps[-1].phi, lattice)
    mesh = implicit.isosurface(field, lattice)
    assert np.abs(TORUS.value(mesh.vertices)).max() <= 0.05 * lattice.spacing
    volume = implicit.curved_extent(field, mesh).volume
    assert abs(volume / (2 * np.pi**2 * RING * TUBE**2) - 1) <= 0.003


def test_the_clamp_keeps_every_step_in_the_corridor(opening) -> None:
    from geofit.morphing.look_loops import tetrahedra_volume

    steps, _, d_a, d_b, _lattice = opening
    whole = tetrahedra_volume(d_b)
    for step in steps:
        beyond = tetrahedra_volume(np.maximum(step.phi, -np.minimum(d_a, d_b)))
        missing = tetrahedra_volume(np.maximum(-step.phi, np.maximum(d_a, d_b)))
        assert (beyond + missing) / whole <= 1e-4


def test_distances_are_renewed_with_order_four_and_stay() -> None:
    def wavy(xyz: np.ndarray) -> np.ndarray:
        x, y, z = xyz.T
        return ((xyz**2).sum(axis=1) - 0.36) * (1.5 + np.sin(3 * x) + 0.5 * y * z)

    errors = []
    for n in (24, 48, 96):
        lattice = implicit.Lattice.around(*BOX, cells=n)
        truth = (np.linalg.norm(lattice.nodes(), axis=1) - 0.6).reshape(lattice.shape)
        near = np.abs(truth) < 2 * lattice.spacing
        field = redistanced(wavy(lattice.nodes()).reshape(lattice.shape), lattice, 6.5)
        errors.append(np.abs(field - truth)[near].max())
    assert np.log2(errors[0] / errors[2]) / 2 >= 3.5
    again = field
    for _ in range(10):
        again = redistanced(again, lattice, 6.5)
    assert np.abs(again - field)[near].max() <= 1e-4 * lattice.spacing
