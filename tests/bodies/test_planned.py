"""Planned holes against the truth that the body was drilled from, and suggested holes."""

from __future__ import annotations

import numpy as np
import pytest

from bodies.planted import ORIGIN, SIZE, Truth, drilled, ellipsoid, torus
from geofit.bodies.body import BodyFit
from geofit.bodies.data import BodyData
from geofit.bodies.drilling import suggest_body_holes
from geofit.bodies.fit import fit_body
from geofit.bodies.planned import predict_hole
from geofit.data.errors import SettingsError


def test_crossings_lie_on_the_surface(ring: BodyFit) -> None:
    hole = predict_hole(ring, ORIGIN + np.array([-90, 3, 2]), azimuth=90, dip=0, length=180)
    assert [crossing.entering for crossing in hole.crossings] == [True, False, True, False]
    places = hole.collar + np.array([c.depth for c in hole.crossings])[:, None] * hole.direction
    assert np.abs(ring.value(places)).max() < 1e-6
    np.testing.assert_allclose([c.depth for c in hole.crossings], [13, 57, 123, 167], atol=4)
    assert hole.probability == 1.0
    assert hole.entry is not None
    assert hole.exit is not None
    assert hole.entry.p10 < hole.crossings[0].depth < hole.entry.p90
    assert hole.exit.p10 < hole.crossings[-1].depth < hole.exit.p90
    assert hole.inside.p50 == pytest.approx(88, abs=7)


def test_a_hole_along_a_logged_one_has_no_band(ring: BodyFit) -> None:
    k = int(np.argmax([(ring.data.hole == name).sum() for name in ring.data.holes]))
    own = ring.data.hole == ring.data.holes[k]
    first, last = ring.data.contacts[own][0], ring.data.contacts[own][-1]
    way = (last - first) / np.linalg.norm(last - first)
    start = first - 20 * way
    azimuth, dip = np.degrees([np.arctan2(way[0], way[1]), -np.arcsin(way[2])])
    hole = predict_hole(ring, start, azimuth=float(azimuth), dip=float(dip), length=60)
    assert hole.entry is not None
    assert hole.entry.p90 - hole.entry.p10 < 0.2
    assert hole.entry.p50 == pytest.approx(20, abs=0.1)


def test_a_hole_far_off_meets_nothing(ring: BodyFit) -> None:
    hole = predict_hole(ring, ORIGIN + np.array([500, 0, 100]), length=200)
    assert (hole.crossings, hole.probability, hole.entry, hole.exit) == ((), 0.0, None, None)
    assert hole.inside.p90 == 0.0


def test_bands_hold_the_truth() -> None:
    held, close = [], []
    for seed in range(6):
        rng = np.random.default_rng(100 + seed)
        truth = ellipsoid((0.6, 0.45, 0.35))[0] if seed % 2 else torus(0.55, 0.22)[0]
        body = fit_body(drilled(truth, seed, rows=7 + 2 * (seed % 2)))
        for _ in range(12):
            start = np.array([*rng.uniform(-0.6, 0.6, 2), 1.0])
            hole = predict_hole(body, start * SIZE + ORIGIN, azimuth=rng.uniform(0, 360), dip=75, length=200)
            depth = np.linspace(0, 2, 4001)
            inside = truth(start + depth[:, None] * hole.direction) < 0
            if inside.any() and hole.entry is not None:
                entry = depth[np.argmax(inside)] * SIZE
                held.append(hole.entry.p10 <= entry <= hole.entry.p90)
                close.append(abs(hole.entry.p50 - entry))
    assert len(held) > 40
    assert 0.6 < np.mean(held) < 0.97
    assert np.median(close) < 2.0


def test_suggested_holes_narrow_the_volume_more_than_holes_elsewhere() -> None:
    chosen, elsewhere, predicted = [], [], []
    for seed in range(4):
        truth = ellipsoid((0.7, 0.5, 0.4))[0]
        data = drilled(truth, seed, rows=6, named=True)
        body = fit_body(data)
        suggested = suggest_body_holes(body, 2)
        assert suggested[0].sd_before > suggested[0].sd_after == suggested[1].sd_before > suggested[1].sd_after
        collar = (suggested[0].hole.collar - ORIGIN) / SIZE
        predicted.append(suggested[0].sd_after / suggested[0].sd_before)
        volumes = body.volumes()
        before = volumes.sd
        # No hole narrows the numerical error.
        assert np.hypot(suggested[0].sd_before, volumes.error) == pytest.approx(before, rel=1e-9)
        chosen.append(fit_body(with_hole(data, truth, collar[:2])).volumes().sd / before)
        place = np.random.default_rng(seed).uniform(-1, 1, 2) * [0.6, 0.4]
        elsewhere.append(fit_body(with_hole(data, truth, place)).volumes().sd / before)
    # Measured: predicted 0.70, reached 0.55, elsewhere 0.83.
    assert np.mean(chosen) < 0.75
    assert np.mean(chosen) < np.mean(elsewhere) - 0.1
    assert np.mean(predicted) < 0.85


def with_hole(data: BodyData, truth: Truth, collar: np.ndarray) -> BodyData:
    """Return the data and those of one more vertical hole."""
    z = np.arange(1.0, -1.0, -0.04)
    line = np.column_stack([np.full(len(z), collar[0]), np.full(len(z), collar[1]), z])
    inside = truth(line) < 0
    value = truth(line)
    k = np.flatnonzero(inside[1:] != inside[:-1])
    share = value[k] / (value[k] - value[k + 1])
    contacts = line[k] + share[:, None] * (line[k + 1] - line[k])
    parts = [np.concatenate([old, new * SIZE + ORIGIN]) for old, new in (
        (data.contacts, contacts), (data.inside, line[inside]), (data.outside, line[~inside]))]  # fmt: skip
    names = [[*old, *["new"] * (len(part) - len(old))] for old, part in zip(
        (data.hole, data.inside_hole, data.outside_hole), parts, strict=True)]  # fmt: skip
    return BodyData(*parts, None, *names)


def test_holes_that_cannot_be_planned(ring: BodyFit) -> None:
    with pytest.raises(SettingsError, match="planned hole"):
        predict_hole(ring, ORIGIN, length=0)
    with pytest.raises(SettingsError, match="suggested"):
        suggest_body_holes(ring, 0)
