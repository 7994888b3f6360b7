"""Tables whose columns no name tells: their values do, with a low confidence, in words, and a mapping overrules."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.io import preview_file
from geofit.io.guess_values import CONFIDENCE
from geofit.io.mapping import ColumnMapping
from geofit.project.importing import import_files

HOLES = [(f"ZK{k}", 500000 + 37.5 * k, 3100000 + 11.2 * k, 120.25 + k) for k in range(8)]
LOGS = [(name, top, base, code) for name, *_ in HOLES for top, base, code in ((0, 9.5, "Q"), (9.5, 30, "T2"))]


def text(rows, header=None):
    lines = [header] if header else []
    return "\n".join([*lines, *(",".join(map(str, row)) for row in rows)]) + "\n"


def columns(preview):
    return {guess.role: guess.index for guess in preview.roles}


@pytest.mark.parametrize("header", ["A,B,C,D", None, "Kennung,Rechts,Hoch,Kote"])
def test_collars_and_logs(header, tmp_path, write):
    collar, log = write(text(HOLES, header), "one.csv"), write(text(LOGS, header), "two.csv")
    (found,), (logs,) = preview_file(collar), preview_file(log)
    assert (found.kind, columns(found)) == ("collar", {"hole": 0, "x": 1, "y": 2, "z": 3})
    assert (logs.kind, columns(logs)) == ("intervals", {"hole": 0, "from": 1, "to": 2, "code": 3})
    assert found.confidence == CONFIDENCE < 0.5
    assert all(guess.confidence <= CONFIDENCE and "by its values" in str(guess.reason) for guess in found.roles)
    site = import_files([collar, log], tmp_path / "s.toml")
    np.testing.assert_allclose(site.site.horizons["base of Q"].xyz[:, 2], [z - 9.5 for *_, z in HOLES])
    told = [issue for issue in site.issues if "by its values" in str(issue.reason) and issue.severity == "warning"]
    assert {(issue.file, str(issue.reason).split(" is taken as ")[1].split(",")[0]) for issue in told} == {
        ("one.csv", "hole"), ("one.csv", "x"), ("one.csv", "y"), ("one.csv", "z"),
        ("two.csv", "hole"), ("two.csv", "from"), ("two.csv", "to"), ("two.csv", "code"),
    }  # fmt: skip


def test_the_order_of_columns_does_not_matter(write):
    rows = [(code, base, top, name) for name, top, base, code in LOGS]
    # from stands after to: they are told by which is the smaller only where they stand in order.
    assert preview_file(write(text(rows, "A,B,C,D")))[0].kind == ""
    rows = [(code, top, base, name) for name, top, base, code in LOGS]
    (found,) = preview_file(write(text(rows, "A,B,C,D")))
    assert columns(found) == {"hole": 3, "from": 1, "to": 2, "code": 0}
    picks = [(z, y, x, "T1") for _, x, y, z in HOLES]
    (found,) = preview_file(write(text(picks, "A,B,C,D")))
    assert found.kind == "picks"
    assert columns(found) == {"x": 2, "y": 1, "z": 0, "horizon": 3}


def test_the_letter_e_is_no_easting(write):
    (found,) = preview_file(write(text([(*hole, "dry") for hole in HOLES], "A,B,C,D,E")))
    assert (found.kind, columns(found)) == ("collar", {"hole": 0, "x": 1, "y": 2, "z": 3})


def test_zones_in_front_of_eastings(write):
    picks = [(x + 38e6, y, z) for _, x, y, z in HOLES]
    (found,) = preview_file(write(text(picks, "A,B,C")))
    assert columns(found) == {"x": 0, "y": 1, "z": 2}
    picks = [(y, x + 38e6, z) for _, x, y, z in HOLES]
    (found,) = preview_file(write(text(picks, "A,B,C")))
    assert columns(found) == {"x": 1, "y": 0, "z": 2}


@pytest.mark.parametrize(
    "rows",
    [
        [(k, 2 * k, 3 * k) for k in range(9)],  # small numbers may be anything
        [(x, y, z, z / 2, 90) for _, x, y, z in HOLES],  # three columns of the size of an elevation
        [(x, y, x + 9, z) for _, x, y, z in HOLES],  # three of the size of a coordinate
        [(name, top, base) for name, top, base, _ in LOGS],  # no code
        [(name, top, base, top + 0.1, base + 0.1, code) for name, top, base, code in LOGS],  # two pairs of depths
    ],
)
def test_what_is_not_sure_is_not_taken(rows, write):
    header = "A,B,C,D,E,F"[: 2 * len(rows[0]) - 1]
    assert preview_file(write(text(rows, header)))[0].kind == ""


def test_a_known_name_or_a_mapping_goes_before_values(write, tmp_path):
    (found,) = preview_file(write(text(HOLES, "hole,B,C,D")))
    assert found.kind == ""
    picks = write(text([(x, y, z) for _, x, y, z in HOLES], "A,B,C"))
    said = ColumnMapping(file="table.csv", kind="picks", columns={"x": "B", "y": "A", "z": "C"})
    site = import_files([picks], tmp_path / "s.toml", mappings=[said])
    np.testing.assert_allclose(site.site.horizons["table"].xyz[0], [HOLES[0][2], HOLES[0][1], HOLES[0][3]])
