"""Measured dips whose strikes contradict them or are words."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.io.orientations import read_orientations


@pytest.mark.parametrize(("turn", "warned"), [(90, 0), (-90, 0), (270, 0), (97, 0), (0, 7), (45, 7), (180, 7)])
def test_strikes_that_are_not_across_the_dips_are_warned_of(write, turn, warned):
    rng = np.random.default_rng(3)
    azimuth = np.round(rng.uniform(0, 360, 8))
    dip = [2, *rng.integers(10, 60, 7)]
    rows = [(k, k, 5, (a - turn) % 360, a, d) for k, (a, d) in enumerate(zip(azimuth, dip, strict=True))]
    text = "x,y,z,strike,azimuth,dip\n" + "".join(",".join(map(str, row)) + "\n" for row in rows)
    found, issues = read_orientations(write(text, "dips.csv"))
    np.testing.assert_array_equal(found.azimuth, azimuth)
    contradicting = [issue for issue in issues if issue.reason.code == "io.strike-contradicts-azimuth"]
    assert [(issue.row, issue.reason.params["count"]) for issue in contradicting] == ([(3, 7)] if warned else [])


def test_a_strike_in_words_loses_no_row(write):
    text = "x,y,z,strike,azimuth,dip\n" + "".join(f"{k},{k},5,N30E,120,20\n" for k in range(5))
    found, issues = read_orientations(write(text, "dips.csv"))
    assert len(found.azimuth) == 5
    assert not [issue for issue in issues if issue.severity == "error"]
