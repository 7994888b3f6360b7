"""Loop closure against dense least squares, planted misclosures, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cave_surveys import chain, network

from geofit.caves.adjust import adjust_survey
from geofit.caves.shots import ShotList
from geofit.caves.survey import SurveyError
from geofit.data.errors import PointsError, SettingsError


def dense(adjusted):
    """Stations and standard deviations by dense least squares."""
    survey, n, m = adjusted.survey, len(adjusted.survey.stations), len(adjusted.survey.start)
    design = np.zeros((3 * m, 3 * n))
    root = np.zeros((3 * m, 3 * m))
    for k in range(m):
        design[3 * k : 3 * k + 3, 3 * survey.end[k] : 3 * survey.end[k] + 3] += np.eye(3)
        design[3 * k : 3 * k + 3, 3 * survey.start[k] : 3 * survey.start[k] + 3] -= np.eye(3)
        root[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = np.linalg.cholesky(np.linalg.inv(adjusted.covariance[k])).T
    free = np.setdiff1d(np.arange(n), adjusted.anchors)
    columns = (3 * free[:, None] + np.arange(3)).ravel()
    right = survey.offset.ravel() - np.delete(design, columns, axis=1) @ adjusted.xyz[adjusted.anchors].ravel()
    a = root @ design[:, columns]
    xyz, sigma = adjusted.xyz.copy(), np.zeros((n, 3))
    xyz[free] = np.linalg.lstsq(a, root @ right, rcond=None)[0].reshape(-1, 3)
    sigma[free] = np.sqrt(np.diag(np.linalg.inv(a.T @ a))).reshape(-1, 3)
    return xyz, sigma


@pytest.mark.parametrize("seed", range(6))
def test_stations_equal_dense_least_squares(seed):
    _, survey = network(seed, extra=seed * 3)
    adjusted = adjust_survey(survey.with_fixed({"7": (1.0, 2.0, 3.0)}) if seed % 2 else survey)
    xyz, sigma = dense(adjusted)
    np.testing.assert_allclose(adjusted.xyz, xyz, atol=1e-9)
    np.testing.assert_allclose(adjusted.sigma, sigma, atol=1e-9)
    assert len(adjusted.loops) == len(survey.start) - len(survey.stations) + len(adjusted.anchors)


@pytest.mark.parametrize("seed", range(3))
def test_without_noise_the_truth_returns(seed):
    points, survey = network(seed, noise=0.0)
    adjusted = adjust_survey(survey)
    order = [int(name) for name in survey.stations]
    np.testing.assert_allclose(adjusted.xyz, points[order], atol=1e-9)
    assert all(loop.distance < 1e-9 for loop in adjusted.loops)


@pytest.mark.parametrize(
    ("offset", "fixed", "error", "code"),
    [
        ([np.inf, 0, 0], {}, SurveyError, "caves.shot-between-too-long"),
        ([1e308, 0, 0], {}, SurveyError, "caves.shot-between-too-long"),
        ([10, 0, 0], {"A": (0, 0, 0), "C": (1e6, 0, 0)}, SurveyError, "caves.shot-between-too-long"),
        ([10, 0, 0], {"A": (1e12, 0, 0)}, PointsError, "data.coordinate-too-large"),
    ],
)
def test_lengths_that_cannot_be_meant_are_refused(offset, fixed, error, code):
    shots = ShotList()
    shots.add("A", "B", np.array(offset, float), 7)
    shots.add("B", "C", np.array([0.0, 5.0, 0.0]), 8)
    with pytest.raises(error) as wrong:
        adjust_survey(shots.survey("cave").with_fixed(fixed))
    assert wrong.value.code == code


def test_a_planted_misclosure_is_reported_and_spread_evenly():
    shots = ShotList()
    corners = np.array([[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]], float)
    error = np.array([0.3, -0.2, 0.4])
    for i in range(4):
        shots.add("ABCD"[i], "ABCD"[(i + 1) % 4], corners[(i + 1) % 4] - corners[i] + (error if i == 3 else 0), i)
    adjusted = adjust_survey(shots.survey("square"), length_error=0.5, angle_error=np.degrees(0.05))
    (loop,) = adjusted.loops
    np.testing.assert_allclose(np.abs(loop.misclosure), np.abs(error), atol=1e-12)
    assert loop.length == pytest.approx(40, abs=0.5)
    assert loop.percent == pytest.approx(100 * np.linalg.norm(error) / loop.length)
    assert sorted(loop.stations) == list("ABCD")
    # Along and across are equally uncertain here, so each shot takes a quarter; the longest a little more.
    np.testing.assert_allclose(adjusted.residual, np.tile(-error / 4, (4, 1)), atol=4e-3)


def test_a_blunder_is_suspicious_and_a_good_loop_is_not():
    _, survey = network(2, extra=1, noise=0.01)
    offset = survey.offset.copy()
    assert not adjust_survey(survey).loops[0].suspicious
    offset[-1] += [60.0, 0, 0]
    assert adjust_survey(replace(survey, offset=offset)).loops[0].suspicious


def test_a_traverse_between_two_fixed_stations_is_a_loop():
    survey = chain([[0, 0, 0], [10, 0, 0], [20, 0, 0]], 1.0).with_fixed({"2": (21.0, 0.0, 0.0)})
    adjusted = adjust_survey(survey)
    (loop,) = adjusted.loops
    np.testing.assert_allclose(loop.misclosure, [-1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(adjusted.xyz[1], [10.5, 0, 0], atol=1e-9)


def test_rigid_shots_keep_their_length():
    shots = ShotList()
    for i, (a, b) in enumerate(((0, 1), (1, 2), (2, 0))):
        shots.add(str(a), str(b), np.array([[5, 0, 0], [0, 5, 0], [-5, -4.0, 0]])[i], i, rigid=i == 0)
    adjusted = adjust_survey(shots.survey("triangle"))
    assert np.linalg.norm(adjusted.residual[0]) < 1e-4
    assert np.linalg.norm(adjusted.residual[1:], axis=1).min() > 0.1


def test_unconnected_stations_are_named_with_the_remedy():
    shots = ShotList()
    shots.add("A1", "A2", np.array([1.0, 0, 0]), 1)
    shots.add("B1", "B2", np.array([1.0, 0, 0]), 2)
    survey = shots.survey("two caves")
    with pytest.raises(
        SurveyError, match=r"2 stations of two caves are not connected to station A1: B1, B2.*missing shot"
    ):
        adjust_survey(survey)
    assert len(adjust_survey(survey.with_fixed({"A1": (0, 0, 0), "B1": (0, 9, 0)})).xyz) == 4
    assert adjust_survey(survey.connected_to("B2")).survey.stations == ("B1", "B2")
    with pytest.raises(SurveyError, match="no station X"):
        survey.connected_to("X")
    with pytest.raises(SurveyError, match="fixed stations Y"):
        survey.with_fixed({"Y": (0, 0, 0)})


def test_errors_must_be_positive():
    with pytest.raises(SettingsError, match="above 0"):
        adjust_survey(chain([[0, 0, 0], [1, 0, 0]], 1.0), length_error=0)
