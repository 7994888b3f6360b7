"""How coordinates were stored, by their digits: in single precision, or in kilometres."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.io import read_boreholes, read_points
from geofit.io.clouds import open_cloud

RNG = np.random.default_rng(0)
X, Y = 500_000 + RNG.uniform(0, 800, 200), 3_100_000 + RNG.uniform(0, 800, 200)
Z = 1500 + 0.2 * (X - 500_000)
X32, Y32 = X.astype(np.float32).astype(float), Y.astype(np.float32).astype(float)


def written(path, x, y, digits, header="x,y,z"):
    rows = [f"{a:.{digits}f},{b:.{digits}f},{c:.2f}" for a, b, c in zip(x, y, Z, strict=True)]
    path.write_text("\n".join([header, *rows]), encoding="utf-8")
    return path


def found(issues, code):
    return [issue for issue in issues if issue.reason.code == code]


@pytest.mark.parametrize("digits", [2, 3, 6])
def test_single_precision_is_warned_of_with_what_it_lost(digits, tmp_path):
    """Northings around 3,100,000 m are rounded to a quarter of a metre: nothing was listed."""
    issues = read_points(written(tmp_path / "a.csv", X32, Y32, digits)).issues
    (issue,) = found(issues, "io.single-precision")
    assert issue.severity == "warning"
    assert issue.reason.params["step"] == 0.25
    assert issue.reason.params["most"] == pytest.approx(np.abs(np.r_[X32 - X, Y32 - Y]).max(), rel=0.02)


@pytest.mark.parametrize("round_to", [0.001, 0.01, 0.1, 0.25, 0.5, 1.0])
def test_rounded_double_precision_is_not(round_to, tmp_path):
    x, y = (np.round(part / round_to) * round_to for part in (X, Y))
    assert not found(read_points(written(tmp_path / "a.csv", x, y, 3)).issues, "io.single-precision")


def test_parquet_states_its_precision(tmp_path):
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    for kind, count in (("f4", 1), ("f8", 0)):
        table = pa.table({"x": X.astype(kind), "y": Y.astype(kind), "z": Z})
        parquet.write_table(table, tmp_path / "a.parquet")
        cloud = open_cloud(tmp_path / "a.parquet")
        for _ in range(2):
            assert sum(map(len, cloud.chunks())) == len(X)
            assert len(found(cloud.issues, "io.single-precision")) == count


def test_kilometres_with_elevations_in_metres_are_warned_of(tmp_path):
    """They were fitted as a needle 0.8 m wide."""
    issues = read_points(written(tmp_path / "a.csv", X / 1000, Y / 1000, 5)).issues
    assert len(found(issues, "io.places-like-kilometres")) == 1
    marked = read_points(written(tmp_path / "b.csv", X / 1000, Y / 1000, 5, "x [km],y [km],z"))
    assert not found(marked.issues, "io.places-like-kilometres")
    np.testing.assert_allclose(marked.horizons["b"].xyz[:, 0], X, atol=0.006)
    for x, y in ((X, Y), (X - 499_900, Y - 3_099_000)):
        assert not found(read_points(written(tmp_path / "c.csv", x, y, 3)).issues, "io.places-like-kilometres")


def test_collars_in_kilometres_are_warned_of(tmp_path):
    rows = [f"B{i},{X[i] / 1000:.5f},{Y[i] / 1000:.5f},{Z[i]:.2f},30" for i in range(40)]
    (tmp_path / "collar.csv").write_text("\n".join(["hole,x,y,z,depth", *rows]), encoding="utf-8")
    (tmp_path / "log.csv").write_text("\n".join(["hole,from,to,lith", *(f"B{i},0,30,a" for i in range(40))]), "utf-8")
    holes = read_boreholes(tmp_path / "collar.csv", intervals=[tmp_path / "log.csv"])
    assert len(found(holes.issues, "io.places-like-kilometres")) == 1


def test_the_digits_that_a_spreadsheet_showed_are_warned_of(tmp_path):
    """3101242.81 was 3.10E+06 in the file, and every northing the same: nothing was listed."""
    rows = [f"{a:.2f},{b:.2E},{c:.2f}" for a, b, c in zip(X, Y, Z, strict=True)]
    (tmp_path / "a.csv").write_text("\n".join(["x,y,z", *rows]), encoding="utf-8")
    (issue,) = found(read_points(tmp_path / "a.csv").issues, "io.few-digits")
    assert (issue.column, issue.reason.params["step"], issue.reason.params["most"]) == ("y", 10_000, 5_000)


@pytest.mark.parametrize("form", ["{:.9E}", "{:.0f}", "{!r}"])
def test_numbers_with_all_digits_are_not(form, tmp_path):
    rows = [f"{form.format(a)},{form.format(b)},{c:.2f}" for a, b, c in zip(X.tolist(), Y.tolist(), Z, strict=True)]
    (tmp_path / "a.csv").write_text("\n".join(["x,y,z", *rows]), encoding="utf-8")
    assert not found(read_points(tmp_path / "a.csv").issues, "io.few-digits")
