"""Bodies of many kinds, any holes: P10 to P90 holds most true volumes, and the chance of lying inside is honest.

``python benchmarks/bodies.py --planted 200`` measures the same on more bodies.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from bodies.planted import ORIGIN, SIZE
from bodies.shapes import Case, case, other_case
from geofit.bodies.data import BodyData
from geofit.bodies.fit import fit_body
from geofit.bodies.posterior import BodyPosterior


@pytest.mark.parametrize(("make", "error"), [(case, 0.05), (other_case, 0.08)])
def test_bodies_of_kinds_that_were_used_and_not_used_to_calibrate(make: Callable[[int], Case], error: float) -> None:
    held, errors, chance, inside = [], [], [], []
    for seed in range(40):
        one = make(seed)
        if len(one.data.contacts) < 6:
            continue
        body, volume = fit_body(one.data), one.volume(56)
        assert body.accuracy is not None
        assert body.accuracy.wrong_side == 0
        volumes = body.volumes()
        held.append(volumes.p10 < volume < volumes.p90)
        errors.append(volumes.best / volume - 1)
        places = np.random.default_rng(seed).uniform(-0.9, 0.9, (3000, 3))
        chance.append(BodyPosterior(body).probability(places * SIZE + ORIGIN))
        inside.append(one.truth(places) < 0)
    # 80 %, and two standard errors of a share.
    assert 0.65 <= np.mean(held) <= 0.95
    assert np.median(np.abs(errors)) < error
    p, true = np.concatenate(chance), np.concatenate(inside)
    for low, high in ((0.05, 0.2), (0.2, 0.4), (0.4, 0.6), (0.6, 0.8), (0.8, 0.95)):
        own = (p > low) & (p <= high)
        assert own.sum() > 300
        assert abs(p[own].mean() - true[own].mean()) < 0.08, (low, high)


@pytest.mark.parametrize(("holes", "few"), [(2, True), (3, False)])
def test_too_few_contacts_for_a_band_are_a_warning(holes: int, few: bool) -> None:
    x, y = np.meshgrid(np.linspace(-15, 15, holes), np.linspace(-15, 15, holes))
    plan = np.column_stack([x.ravel(), y.ravel()])
    height = 40 * np.sqrt(1 - (plan**2).sum(axis=1) / 30**2)
    contacts = np.concatenate([np.column_stack([plan, sign * height]) for sign in (-1, 1)])
    around = np.array(
        [[x, y, z] for x in (-50, 0, 50) for y in (-50, 0, 50) for z in (-60, 0, 60) if (x, y, z) != (0, 0, 0)]
    )
    body = fit_body(BodyData(contacts, [[0.0, 0.0, 0.0]], around))
    assert body.accuracy is not None
    warned = [note.code for note in body.accuracy.warnings]
    assert ("bodies.too-few-contacts-for-band" in warned) == few
