"""Sites that once ended in tracebacks: fitted and examined, or refused with a reason."""

from __future__ import annotations

import os
from contextlib import nullcontext, suppress
from pathlib import Path

import pytest

from geofit import examine, fit_horizon
from geofit.data.errors import GeofitError
from geofit.data.messages import Message
from geofit.io import read_points

DATA = Path(os.environ.get("GEOFIT_DATA", Path(__file__).resolve().parents[2] / ".." / "shared" / "data")) / "hostile"
pytestmark = pytest.mark.skipif(not DATA.is_dir(), reason="the hostile files are not here (GEOFIT_DATA)")


def codes(note):
    yield note.code
    for value in note.params.values():
        for part in value if isinstance(value, tuple) else (value,):
            if isinstance(part, Message):
                yield from codes(part)


@pytest.mark.parametrize("name", ["tri.csv", "twop.csv", "vert.csv", "core_overflow.csv"])
def test_an_ordinary_site_is_fitted_and_examined_or_refused(name):
    found = read_points(DATA / name)
    (points,) = found.horizons.values()
    # Of three points, or two places, nothing may be known; an ordinary core has to be fitted.
    with nullcontext() if name == "core_overflow.csv" else suppress(GeofitError):
        surface = fit_horizon(points)
        notes = [*surface.accuracy.notes, *examine(surface).notes]
        assert "data.unforeseen-error" not in [code for note in notes for code in codes(note)]


@pytest.mark.parametrize("name", ["rowhuge.xlsx", "wide.xlsx"])
def test_a_workbook_that_unpacks_without_end_is_refused(name):
    pytest.importorskip("openpyxl", reason="workbooks need the extra xlsx")
    with pytest.raises(GeofitError, match=name):
        read_points(DATA / name)
