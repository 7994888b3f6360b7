"""The field's kernels, its system and its inequalities, against plain numpy and brute force."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.bodies.active import SidedSamples, complementarity
from geofit.bodies.blend import fit_blend, refit_blend
from geofit.bodies.body import BodyFit
from geofit.bodies.kernels import CUBIC, LINEAR, gradients, gram, values
from geofit.bodies.rbf import Rbf, Saddle


@pytest.mark.parametrize("reach", [CUBIC, 2.5])
def test_kernels_against_plain_numpy(reach: float) -> None:
    rng = np.random.default_rng(0)
    x, c, w = rng.normal(size=(7, 3)), rng.normal(size=(5, 3)), rng.normal(size=5)
    g, v = rng.normal(size=(4, 3)), rng.normal(size=(4, 3))

    def kernel(r: np.ndarray) -> np.ndarray:
        q = r / reach if reach else r
        return np.where(q < 1, (1 - q) ** 4 * (4 * q + 1), 0.0) if reach else r**3

    def plain(x: np.ndarray) -> np.ndarray:
        total = kernel(np.linalg.norm(x[:, None] - c, axis=2)) @ w
        e = 1e-5
        for k in range(3):
            d = e * np.eye(3)[k]
            for sign in (1, -1):
                total += sign * kernel(np.linalg.norm(x[:, None] - g - sign * d, axis=2)) @ v[:, k] / (2 * e)
        return total

    np.testing.assert_allclose(values(x, c, w, g, v, reach), plain(x), atol=1e-6)
    for k in range(3):
        d = 1e-4 * np.eye(3)[k]
        np.testing.assert_allclose(
            gradients(x, c, w, g, v, reach)[:, k], (plain(x + d) - plain(x - d)) / 2e-4, rtol=1e-4, atol=2e-4
        )
    whole = gram(c, g, c, g, reach)
    np.testing.assert_allclose(whole, whole.T, atol=1e-12)
    np.testing.assert_allclose(gram(x, x[:0], c, g, reach) @ np.concatenate([w, v.ravel()]), plain(x), atol=1e-6)


def test_the_linear_kernel_against_plain_numpy() -> None:
    rng = np.random.default_rng(0)
    x, c, w, none = rng.normal(size=(7, 3)), rng.normal(size=(5, 3)), rng.normal(size=5), np.zeros((0, 3))
    off = x[:, None] - c
    r = np.linalg.norm(off, axis=2)
    np.testing.assert_allclose(values(x, c, w, none, none, LINEAR), -r @ w, rtol=1e-12)
    slope = -(off / r[:, :, None] * w[:, None]).sum(axis=1)
    np.testing.assert_allclose(gradients(x, c, w, none, none, LINEAR), slope, rtol=1e-12)
    assert np.isfinite(gradients(c, c, w, none, none, LINEAR)).all()
    # One value fixes the constant that is its drift.
    one = Saddle(c[:1], reach=LINEAR).interpolate(np.array([2.5]))
    np.testing.assert_allclose(one.value(x), 2.5)
    # Positive variances that grow with the distance from the data, and none at them.
    system = Saddle(c, reach=LINEAR)
    assert (system.variance(x) > 0).all()
    np.testing.assert_allclose(system.variance(c), 0.0, atol=1e-12)
    np.testing.assert_allclose(system.interpolate(w).value(c), w, atol=1e-12)


def test_values_and_gradients_are_met() -> None:
    rng = np.random.default_rng(1)
    x, g = rng.uniform(-1, 1, (40, 3)), rng.uniform(-1, 1, (10, 3))
    f, slopes = rng.normal(size=40), rng.normal(size=(10, 3))
    rbf = Saddle(x, g).interpolate(f, slopes)
    np.testing.assert_allclose(rbf.value(x), f, atol=1e-10)
    np.testing.assert_allclose(rbf.gradient(g), slopes, atol=1e-10)


def test_complementarity_against_all_subsets() -> None:
    rng = np.random.default_rng(2)
    for _ in range(30):
        a = rng.normal(size=(5, 5))
        matrix, wanted = a @ a.T + 0.1 * np.eye(5), rng.normal(size=5)
        x = complementarity(matrix, wanted, np.zeros(5), np.zeros(5, bool))
        rest = matrix @ x - wanted
        assert (x >= 0).all()
        assert (rest > -1e-7).all()
        assert abs(x @ rest) < 1e-7


def test_volumes_hold_the_truth(ring: BodyFit) -> None:
    volumes = ring.volumes()
    assert volumes.p10 < volumes.p50 < volumes.p90
    assert volumes.p10 < 2 * np.pi**2 * 0.55 * 0.22**2 * 1e6 < volumes.p90
    assert len(volumes.values) == 100
    assert ring.volumes().values.tobytes() == volumes.values.tobytes()


def test_drift_and_its_gradient_are_those_of_its_ten_terms() -> None:
    rng = np.random.default_rng(4)
    trend, x, step = rng.normal(size=10), rng.normal(0, 50, (40, 3)), 1e-3
    none = np.zeros((0, 3))
    drift = Rbf(none, np.zeros(0), none, none, trend)
    terms = np.column_stack(
        [np.ones(len(x)), x, x[:, 0] ** 2, x[:, 0] * x[:, 1], x[:, 0] * x[:, 2], x[:, 1] ** 2, x[:, 1] * x[:, 2],
         x[:, 2] ** 2]
    )  # fmt: skip
    assert drift.value(x) == pytest.approx(terms @ trend, rel=1e-12, abs=1e-9)
    for axis in range(3):
        by = step * np.eye(3)[axis]
        slope = (drift.value(x + by) - drift.value(x - by)) / (2 * step)
        assert drift.gradient(x)[:, axis] == pytest.approx(slope, rel=1e-6, abs=1e-6)


def test_only_parts_with_new_samples_are_fitted_again() -> None:
    rng = np.random.default_rng(7)
    unit = rng.normal(size=(900, 3))
    unit /= np.linalg.norm(unit, axis=1)[:, None]
    contacts = unit * (1 + 0.1 * np.sin(5 * unit[:, :1]))
    oriented, none = np.zeros(len(contacts), bool), np.zeros((0, 3))
    corners = 1.5 * np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T.astype(float)
    first = SidedSamples.of(np.zeros((1, 3)), -np.ones(1), np.full(1, 0.1))
    former = fit_blend(contacts, oriented, none, first, corners)
    place = 0.9 * contacts[:1]
    assert former.field.value(place)[0] < 0
    more = SidedSamples.of(np.vstack([first.xyz, place]), np.array([-1.0, 1.0]), np.array([0.1, 0.01]))
    again = refit_blend(former, contacts, oriented, none, more, 1)
    holding = [part.holds(place)[0] for part in former.field.parts]
    assert 0 < sum(holding) < len(holding) / 2
    for held, one, other in zip(holding, former.field.parts, again.field.parts, strict=True):
        assert (one is other) == (not held)
    assert again.field.value(place)[0] > 0.0099
    assert np.abs(again.field.value(contacts)).max() < 1e-8
    assert again.active > former.active
