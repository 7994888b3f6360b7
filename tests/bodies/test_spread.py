"""Ten kinds of bodies, any holes: P10 to P90 holds most true volumes, and the chance of lying inside is honest.

``python benchmarks/bodies.py --planted 200`` measures the same on more bodies.
"""

from __future__ import annotations

import numpy as np

from bodies.planted import ORIGIN, SIZE
from bodies.shapes import case
from geofit.bodies.fit import fit_body
from geofit.bodies.posterior import Posterior


def test_thirty_bodies_of_ten_kinds() -> None:
    held, errors, chance, inside = [], [], [], []
    for seed in range(30):
        one = case(seed)
        body, volume = fit_body(one.data), one.volume(56)
        assert body.accuracy is not None
        assert body.accuracy.wrong_side == 0
        volumes = body.volumes()
        held.append(volumes.p10 < volume < volumes.p90)
        errors.append(volumes.best / volume - 1)
        places = np.random.default_rng(seed).uniform(-0.9, 0.9, (3000, 3))
        chance.append(Posterior(body).probability(places * SIZE + ORIGIN))
        inside.append(one.truth(places) < 0)
    # 80 % of 30, and two standard errors of a share.
    assert 0.65 <= np.mean(held) <= 0.95
    assert np.median(np.abs(errors)) < 0.05
    p, true = np.concatenate(chance), np.concatenate(inside)
    for low, high in ((0.05, 0.2), (0.2, 0.4), (0.4, 0.6), (0.6, 0.8), (0.8, 0.95)):
        own = (p > low) & (p <= high)
        assert own.sum() > 300
        assert abs(p[own].mean() - true[own].mean()) < 0.08, (low, high)
