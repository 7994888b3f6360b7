"""Bodies with a known truth, fitted from holes: no sample on the wrong side, the right volume and topology."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from refusals import refused

from bodies.planted import ORIGIN, SIZE, Truth, drilled, ellipsoid, pair, torus
from geofit.bodies.body import BodyFit
from geofit.bodies.data import BodyData
from geofit.bodies.field import BodyField
from geofit.bodies.fit import fit_body
from geofit.bodies.frame import BodyFrame
from geofit.bodies.settings import BodySettings
from geofit.data.errors import FitError, PointsError, SettingsError


@pytest.mark.parametrize(
    ("make", "rows", "euler"),
    [
        (lambda: ellipsoid((0.6, 0.4, 0.3)), 7, 2),
        (lambda: torus(0.55, 0.22), 9, 0),
        (pair, 9, 4),
    ],
)
def test_ten_layouts_of_holes(make: Callable[[], tuple[Truth, float]], rows: int, euler: int) -> None:
    truth, volume = make()
    errors = []
    for seed in range(10):
        data = drilled(truth, seed, rows=rows)
        body = fit_body(data)
        assert (body.value(data.inside) < 0).all()
        assert (body.value(data.outside) > 0).all()
        assert body.accuracy is not None
        assert body.accuracy.max_abs < 1e-8
        mesh = body.triangulate()
        assert mesh.is_closed
        assert mesh.is_manifold
        assert mesh.euler == euler
        errors.append(abs(mesh.volume / (volume * SIZE**3) - 1))
    assert np.median(errors) < 0.05
    assert max(errors) < 0.10


def test_gradient_is_that_of_the_value(ring: BodyFit) -> None:
    rng = np.random.default_rng(0)
    low, high = (corner + ORIGIN for corner in (ring.field.lower, ring.field.upper))
    # Far outside the box too: the value goes on with the distance.
    x = rng.uniform(low - 20, high + 20, (300, 3))
    step = 1e-3
    for axis in range(3):
        d = step * np.eye(3)[axis]
        slope = (ring.value(x + d) - ring.value(x - d)) / (2 * step)
        np.testing.assert_allclose(ring.gradient(x)[:, axis], slope, atol=2e-4)


def test_distance_to_a_ball() -> None:
    rng = np.random.default_rng(1)
    unit = rng.normal(size=(400, 3))
    unit /= np.linalg.norm(unit, axis=1)[:, None]
    ball = fit_body(BodyData(50 * unit + ORIGIN, normals=unit))
    x = rng.uniform(-70, 70, (300, 3))
    np.testing.assert_allclose(ball.distance(x + ORIGIN), np.linalg.norm(x, axis=1) - 50, atol=5e-3)
    np.testing.assert_allclose(ball.gradient(50 * unit + ORIGIN), unit, atol=1e-6)


def test_same_input_same_bytes() -> None:
    data = drilled(ellipsoid((0.6, 0.4, 0.3))[0], 3)
    x = np.random.default_rng(0).uniform(-60, 60, (200, 3)) + ORIGIN
    assert fit_body(data).value(x).tobytes() == fit_body(data).value(x).tobytes()


@pytest.mark.parametrize("threads", [2, 8])
def test_the_number_of_threads_changes_nothing(threads: int) -> None:
    pools = pytest.importorskip("threadpoolctl")
    data = drilled(torus(0.55, 0.22)[0], 3, rows=9)
    meshes = []
    for limit in (1, threads):
        with pools.threadpool_limits(limit):
            meshes.append(fit_body(data).triangulate())
    assert meshes[0].vertices.tobytes() == meshes[1].vertices.tobytes()
    assert meshes[0].triangles.tobytes() == meshes[1].triangles.tobytes()


def test_thousands_of_contacts_are_met_and_every_sample_keeps_its_side() -> None:
    rng = np.random.default_rng(2)

    def radius(u: np.ndarray) -> np.ndarray:
        return 50 * (1 + 0.05 * np.sin(5 * u[:, 0]) * np.cos(4 * u[:, 1]))

    unit = rng.normal(size=(5000, 3))
    unit /= np.linalg.norm(unit, axis=1)[:, None]
    x = rng.uniform(-80, 80, (3000, 3))
    far = np.linalg.norm(x, axis=1)
    inside = far < radius(x / far[:, None])
    data = BodyData(unit * radius(unit)[:, None] + ORIGIN, x[inside] + ORIGIN, x[~inside] + ORIGIN)
    body = fit_body(data)
    assert body.fitted.system is None  # fitted in parts
    assert np.abs(body.distance(data.contacts)).max() < 1e-8
    assert body.accuracy is not None
    assert body.accuracy.wrong_side == 0
    step = 1e-4
    places = rng.uniform(-50, 50, (200, 3)) + ORIGIN
    for axis in range(3):
        d = step * np.eye(3)[axis]
        slope = (body.value(places + d) - body.value(places - d)) / (2 * step)
        np.testing.assert_allclose(body.gradient(places)[:, axis], slope, atol=1e-4)


def test_a_body_that_leaves_its_box_is_cut_and_says_where() -> None:
    box = ((*(ORIGIN[:2] - 90), ORIGIN[2] - 90), (ORIGIN[0], *(ORIGIN[1:] + 90)))
    body = fit_body(drilled(ellipsoid((0.6, 0.4, 0.3))[0], 0), BodySettings(box=box))
    assert body.accuracy is not None
    assert body.accuracy.open_sides == ("east",)
    mesh = body.triangulate()
    assert mesh.is_closed
    assert mesh.vertices[:, 0].max() < ORIGIN[0] + 1e-6


def test_anisotropy_carries_farther_along_its_major_axis() -> None:
    data = drilled(ellipsoid((0.8, 0.25, 0.25))[0], 4, rows=7)
    flat = fit_body(data, BodySettings(ranges=(3, 1, 1), azimuth=90))
    round_ = fit_body(data)
    assert np.ptp(flat.triangulate().vertices[:, 0]) > np.ptp(round_.triangulate().vertices[:, 0])


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (BodyData(inside=np.eye(3)), "Nothing bounds"),
        (BodyData(outside=np.eye(3)), "Nothing lies inside"),
        (BodyData(inside=np.eye(3), outside=-np.eye(3)), "but no contact"),
        (BodyData(contacts=[[0, 0, 1], [0, 0, -1]], inside=[[0, 0, 0]], outside=[[0, 0, 3]]), "one line"),
        (BodyData(contacts=[[0, 0, 1], [0.3, 0, -1]], inside=[[0, 0, 0]], outside=[[1, 0, 3]], hole="A"), "one hole"),
    ],
)
def test_data_that_bound_no_body(data: BodyData, words: str) -> None:
    with pytest.raises(FitError, match=words):
        fit_body(data)


@pytest.mark.parametrize("contacts", [0, 4])
@pytest.mark.parametrize("count", [1, 2])
def test_samples_of_both_sides_at_one_place_contradict_each_other(contacts: int, count: int) -> None:
    places = 50 * np.eye(4)[:, :3]
    both = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])[:count]
    with refused(FitError, "bodies.samples-all-contradict", count=count):
        fit_body(BodyData(places[:contacts], inside=both, outside=both))


def test_cells_larger_than_the_body_are_refused() -> None:
    body = fit_body(drilled(ellipsoid((0.6, 0.4, 0.3))[0], 3))
    assert body.triangulate(20.0).is_closed
    for mesh in (body.triangulate, lambda spacing: body.cut([], spacing)):
        with refused(SettingsError, "bodies.spacing-misses-body", spacing=1e6, most=body.overview_spacing):
            mesh(1e6)


def test_a_box_away_from_the_data() -> None:
    with pytest.raises(FitError, match="box"):
        fit_body(drilled(pair()[0], 0), BodySettings(box=((0, 0, 0), (1, 1, 1))))


def test_codes_with_arrays() -> None:
    with pytest.raises(SettingsError, match="codes"):
        fit_body(drilled(pair()[0], 0), codes="ORE")


def test_a_length_that_is_no_number_is_refused_by_name() -> None:
    with pytest.raises(PointsError, match="inside_length cannot be read as float64"):
        BodyData([[0.0, 0.0, 0.0]], [[1.0, 0.0, 0.0]], [[2.0, 0.0, 0.0]], inside_length=["deep"])


@pytest.mark.parametrize("seed", range(5))
def test_a_body_that_only_touches_a_side_is_found_between_the_places_of_the_raster(seed: int) -> None:
    centre = np.array([*np.random.default_rng(seed).uniform(-80, 80, 2), 99.0])

    class Ball:
        def value(self, x: np.ndarray) -> np.ndarray:
            return np.linalg.norm(x - centre, axis=1) - 1.01

        def gradient(self, x: np.ndarray) -> np.ndarray:
            return x - centre

    frame = BodyFrame(np.zeros(3), np.eye(3))
    field = BodyField(Ball(), frame, np.full(3, -100.0), np.full(3, 100.0))
    assert field.reaches() == ("top",)
    lower = BodyField(Ball(), frame, np.full(3, -100.0), np.full(3, 101.0))
    assert lower.reaches() == ()
