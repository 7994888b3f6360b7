"""The horizons of a site together: blocks, repair, order, and what dips and ground say."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from refusals import with_code
from truth import EASTING, NORTHING

from geofit import FitSettings, PointSet
from geofit.data.errors import Cancelled
from geofit.data.languages import EN, ZH
from geofit.data.site import Ground, Orientations, Site
from geofit.project.run import run_horizons, write_reports
from geofit.report.chapters import document
from geofit.report.document import ReportTable
from geofit.report.gather import accuracy_report
from geofit.report.result import HorizonResult
from geofit.report.schema import report_document, to_json
from geofit.site.fit_site import SiteFit, compare_in_order, fit_site
from geofit.site.separate import Contradiction
from geofit.site.site_checks import add_site_checks, ground_tolerance

ORIGIN = np.array([EASTING, NORTHING, 0.0])
AREA = np.array([[0, 0], [600, 0], [600, 500], [0, 500]]) + ORIGIN[:2]
THROW, THICK = 6.0, 9.0
#: The fault's trace at 1500 m: x = 290 m, dipping 70 degrees to the east.
TRACE, SLOPE = 290.0, np.tan(np.radians(70.0))


def height(x, y):
    return 1500 + 3 * np.sin(x / 150) * np.cos(y / 130)


def faulted(below=0.0):
    """A horizon that lies lower east of the fault, with no point in the heave."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(10, 590, 24), np.linspace(10, 490, 13)))
    z = height(x, y) - below
    edge = TRACE + (1500 - z) / SLOPE
    x, y, z, edge = (a[np.abs(x - edge) > 4] for a in (x, y, z, edge))
    z = np.where(x > edge, z - THROW, z)
    return PointSet(np.column_stack([x, y, z]) + ORIGIN, kind="borehole", file="t.csv", row=np.arange(len(x)) + 2)


def fault():
    y, depth = (a.ravel() for a in np.meshgrid(np.linspace(-50, 550, 12), np.linspace(-60, 60, 5)))
    return PointSet(np.column_stack([TRACE + depth / SLOPE, y, 1500 - depth]) + ORIGIN)


def dips(*rows):
    """Measurements (x, y, z, azimuth, dip) that name T2."""
    data = np.array(rows, float)
    n = len(data)
    names = (np.full(n, "T2"), np.full(n, "dips.csv"), np.arange(n) + 2)
    return Orientations(data[:, :3] + ORIGIN, data[:, 3], data[:, 4], *names)


def level(z, cell=20.0):
    x, y = (np.arange(low - cell, low + 660, cell) for low in ORIGIN[:2])
    return Ground(x, y, np.full((len(y), len(x)), float(z)))


@pytest.fixture(scope="module")
def site():
    return Site(
        name="faulted",
        horizons={"T2": faulted(), "T1": faulted(THICK), "F1": fault()},
        settings={"F1": FitSettings(frame="best-plane")},
        boundary=AREA,
        ground=level(1550),
        orientations=dips((100, 250, 1500, 90, 2), (500, 250, 1494, 90, 80)),
        order=("T2", "T1"),
        faults={"F1": ("T2", "T1")},
    )


@pytest.fixture(scope="module")
def fits(site):
    return fit_site(site, list(site.horizons))


def check_of(surface, name):
    return next((check for check in surface.accuracy.checks if check.name == name), None)


def test_a_faulted_horizon_is_fitted_block_by_block(fits):
    assert not fits.failures
    assert sorted(fits.surfaces) == ["F1", "T1 (A)", "T1 (B)", "T2 (A)", "T2 (B)"]
    assert fits.horizon["T1 (B)"] == "T1"
    assert sum(len(fits.surfaces[f"T2 ({k})"].points) for k in "AB") == len(faulted())
    assert [(cut.fault, cut.horizon) for cut in fits.cuts] == [("F1", "T2"), ("F1", "T1")]
    for cut in fits.cuts:
        assert np.abs(cut.throw - THROW).max() < 0.3


def test_blocks_are_compared_on_the_same_side_of_the_fault_only(site, fits):
    found = compare_in_order(site, fits)
    west = {name for name in ("T2 (A)", "T2 (B)") if fits.surfaces[name].points.xyz[0, 0] < TRACE + EASTING}
    west |= {name for name in ("T1 (A)", "T1 (B)") if fits.surfaces[name].points.xyz[0, 0] < TRACE + EASTING}
    assert len(found) == 2
    for order in found:
        assert (order.upper in west) == (order.lower in west)
        assert order.mean == pytest.approx(THICK, abs=0.05)
        assert order.check().passed


def test_the_dips_of_a_faulted_horizon_are_asked_of_the_block_they_stand_on(fits):
    blocks = {name: check_of(fits.surfaces[name], "dips") for name in ("T2 (A)", "T2 (B)")}
    assert sorted(check.passed for check in blocks.values()) == [False, True]
    (wrong,) = [name for name, check in blocks.items() if not check.passed]
    assert fits.surfaces[wrong].points.xyz[0, 0] > TRACE + EASTING
    assert check_of(fits.surfaces["T1 (A)"], "dips") is None


def test_the_ground_is_asked_with_a_tenth_of_its_cell(site, fits):
    surface = fits.surfaces["T2 (A)"]
    assert check_of(surface, "above ground").limit == pytest.approx(2.0)
    assert ground_tolerance(level(0, 5.0), 0.1) == pytest.approx(0.5)
    assert ground_tolerance(level(0, 0.5), 0.1) == pytest.approx(0.1)
    top = surface.points.xyz[:, 2].max()
    low = [add_site_checks(surface, replace(site, ground=level(z)), "T2") for z in (top - 1.5, top - 3.0)]
    assert [check_of(one, "above ground").passed for one in low] == [True, False]
    # Asked again, the answer takes the place of the first.
    names = [check.name for check in low[1].accuracy.checks]
    assert len(names) == len(set(names))


def test_throw_and_heave_stand_in_the_report(site, fits):
    results = [HorizonResult(surface, site) for surface in fits.surfaces.values()]
    report = accuracy_report(results, compare_in_order(site, fits), cuts=fits.cuts, date="2026-11-21")
    assert [one["horizon"] for one in json.loads(to_json(report_document(report)))["horizons"]] == [
        one.name for one in report.horizons
    ]
    cut = report.cuts[0]
    assert cut.throw_mean == pytest.approx(THROW, abs=0.2)
    assert len(cut.places) > 30
    heave = [place.heave for place in cut.places if place.heave is not None]
    assert np.mean(heave) == pytest.approx(THROW / SLOPE, abs=0.3)
    blocks = [block for chapter in document(report, EN).chapters for block in chapter.blocks]
    tables = [block for block in blocks if isinstance(block, ReportTable)]
    titles = [[column.title for column in table.columns] for table in tables]
    along = tables[titles.index(["Along the fault, m", "x, m", "y, m", "z, m", "Throw, m", "Heave, m"])]
    assert len(along.rows) == 11
    shown = [float(str(row[4])) for row in along.rows]
    assert shown == pytest.approx(
        [cut.places[round(k * (len(cut.places) - 1) / 10)].throw for k in range(11)], abs=0.01
    )


def test_a_fault_that_cannot_be_laid_is_named(site):
    bad = replace(site, horizons={**site.horizons, "F1": fault()[:2]})
    found = fit_site(bad, ["T2"])
    failure = found.failures["T2"]
    assert (failure.code, failure.params["fault"]) == ("site.fault-not-fitted", "F1")
    assert failure.params["reason"].params["given"].params["count"] == 2
    assert not found.surfaces


def crossing():
    """Two horizons whose holes stand apart, and whose surfaces cross between them."""
    rng = np.random.default_rng(4)
    x, y = rng.uniform(0, 600, 60), rng.uniform(0, 500, 60)
    upper = PointSet(np.column_stack([x, y, height(x, y)]) + ORIGIN, file="u.csv", row=np.arange(60) + 2)
    x, y = rng.uniform(0, 600, 14), rng.uniform(0, 500, 14)
    z = height(x, y) - 0.4
    lower = PointSet(np.column_stack([x, y, z]) + ORIGIN, file="l.csv", row=np.arange(14) + 2)
    return Site("crossing", {"U": upper, "L": lower}, boundary=AREA, order=("U", "L"))


def test_a_repair_pushes_crossing_horizons_apart_and_checks_them_again():
    site = crossing()
    before = fit_site(site, ["U", "L"])
    (order,) = compare_in_order(site, before)
    assert order.check().passed is False
    after = fit_site(site, ["U", "L"], separate=True)
    (order,) = compare_in_order(site, after)
    assert order.min > -0.05
    assert after.moved
    for name in after.moved:
        surface = after.surfaces[name]
        assert with_code(surface.accuracy.notes, "site.moved-to-keep-order").params["most"] > 0
        assert np.abs(surface.distance(surface.points.xyz) - surface.accuracy.residuals).max() < 1e-6


def test_a_repair_can_be_stopped():
    with pytest.raises(Cancelled):
        fit_site(crossing(), ["U", "L"], progress=lambda stage, _: stage != "separate horizons", separate=True)


def test_a_repair_says_what_it_leaves_alone(site):
    found = SiteFit()
    assert compare_in_order(site, found) == ()
    plain = replace(crossing(), order=())
    assert fit_site(plain, ["U"], separate=True).warnings[0].code == "site.order-names-no-pair"
    cut = fit_site(site, ["T2", "T1"], separate=True)
    (warning,) = cut.warnings
    assert (warning.code, warning.severity) == ("site.faulted-not-separated", "warning")
    assert warning.params["names"] == "T2, T1"


def test_what_exact_points_hold_stands_in_the_report_with_their_rows():
    site = crossing()
    found = fit_site(site, ["U"])
    stuck = Contradiction("U", "L", 500_100.0, 3_100_200.0, 0.25, "point, u.csv row 7", "")
    report = accuracy_report([HorizonResult(found.surfaces["U"], site)], contradictions=[stuck], date="2026-11-21")
    assert [one["horizon"] for one in json.loads(to_json(report_document(report)))["horizons"]] == [
        one.name for one in report.horizons
    ]
    for language, title in ((EN, "Missing, m"), (ZH, "尚差，m")):
        blocks = [block for chapter in document(report, language).chapters for block in chapter.blocks]
        (table,) = [b for b in blocks if isinstance(b, ReportTable) and title in [column.title for column in b.columns]]
        assert table.rows == (("U", "L", "0.250", "500100.00", "3100200.00", "point, u.csv row 7", "–"),)


def test_a_report_of_surfaces_at_hand_needs_no_fit(tmp_path):
    site = crossing()
    results = [HorizonResult(surface, site) for surface in fit_site(site, ["U", "L"]).surfaces.values()]
    heard = []
    made = write_reports(results, tmp_path / "r", lambda *news: heard.append(news), forms=("json",), date="2026-11-21")
    assert made.files == {"json": tmp_path / "r" / "report.json"}
    assert [path.name for path in (tmp_path / "r").iterdir()] == ["report.json"]
    data = json.loads(made.files["json"].read_text(encoding="utf-8"))
    assert [h["prediction"] for h in data["horizons"]] == [None, None]
    assert data["orders"][0]["passed"] is False
    assert [fraction for _, fraction in heard] == sorted(fraction for _, fraction in heard)
    with pytest.raises(Cancelled):
        write_reports(results, tmp_path / "s", lambda *_: False, forms=("json",))
    assert not (tmp_path / "s" / "report.json").exists()


def test_picture_json_and_run_count_the_same_checks(tmp_path, monkeypatch):
    """The order with the neighbours is among them from the beginning, whether it passes or not."""
    drawn = {}
    monkeypatch.setattr(
        "geofit.report.pictures.write_picture", lambda result, *_: drawn.update({result.name: result.verdict})
    )
    made = run_horizons(crossing(), tmp_path)
    for result in made.results:
        data = json.loads((tmp_path / f"{result.name}.json").read_text(encoding="utf-8"))
        assert drawn[result.name] == result.verdict
        assert [lamp["text"]["text"] for lamp in data["lamps"]] == [str(lamp.text) for lamp in result.verdict.lamps]
        assert "order" in str(result.verdict.lamps[1].text)


def test_bands_and_order_are_delivered(tmp_path):
    made = run_horizons(crossing(), tmp_path, bands=True)
    names = {path.name for path in tmp_path.iterdir()}
    assert {"U_upper90.step", "U_lower90.step", "L_upper90.step", "L_lower90.step"} <= names
    assert [order.check().passed for order in made.orders] == [False]
    data = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    assert data["orders"][0]["crossing_area"] > 0

    from geofit.io.surface_files import read_surfaces

    middle = made.results[1].surface
    upper, lower = (next(iter(read_surfaces(tmp_path / f"L_{side}90.step").values())) for side in ("upper", "lower"))
    x, y = EASTING + np.linspace(20, 580, 20), NORTHING + np.linspace(20, 480, 20)
    assert (lower.elevation(x, y) < middle.elevation(x, y)).all()
    assert (middle.elevation(x, y) < upper.elevation(x, y)).all()
