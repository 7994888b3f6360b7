"""The report of surfaces that are there already: the forms that were asked for, and no other file."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from faulted import BOUNDARY, HEIGHT, faulted_site
from results import horizon

from geofit import PointSet
from geofit.data.errors import Cancelled, InputError
from geofit.data.languages import ZH
from geofit.implicit.mesh import TriangleMesh
from geofit.project.body_building import BodyResult
from geofit.project.building import Given
from geofit.project.fault_blocks import Blocks
from geofit.project.mesh_body import MeshBody
from geofit.project.reporting import write_report_files
from geofit.project.run import run_horizons, write_reports
from geofit.project.write_report import write_report
from geofit.site.fit_site import fit_site


def test_the_forms_that_were_asked_for_and_no_other_file(tmp_path):
    result = horizon()
    heard = []
    made = write_reports(
        [result],
        tmp_path / "new",
        lambda stage, share: heard.append((stage, share)),
        language=ZH,
        forms=("html", "json"),
        date="2024-05-06",
    )
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == ["report.html", "report.json"]
    assert made.files == {form: tmp_path / "new" / f"report.{form}" for form in ("html", "json")}
    data = json.loads(made.files["json"].read_text("utf-8"))
    assert data["date"] == "2024-05-06"
    assert data["horizons"][0]["sigma"] == pytest.approx(result.accuracy.sigma)
    assert "精度检验报告" in made.files["html"].read_text("utf-8")
    shares = [share for _, share in heard]
    assert shares == sorted(shares)
    assert shares[-1] <= 1


def test_a_horizon_without_a_check_off_its_data_gets_one_where_that_is_asked_for(tmp_path):
    result = horizon()  # made by hand: nothing stands behind it, and the examination reports it
    made = write_reports([result], tmp_path, forms=("json",), examined=True)
    (one,) = json.loads(made.files["json"].read_text("utf-8"))["horizons"]
    assert "was not fitted here" in str(one["prediction"])
    made = write_reports([result], tmp_path, forms=("json",))
    assert json.loads(made.files["json"].read_text("utf-8"))["horizons"][0]["prediction"] is None


def test_a_body_without_a_fit_has_no_chapter_and_the_report_says_so(tmp_path):
    corner = np.array([[0.0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    bodies = {"CAVE & ADIT": BodyResult(MeshBody("CAVE & ADIT", np.zeros(3), TriangleMesh(corner, faces)))}
    result = horizon()
    blocks = Blocks({}, Given(result.site))
    made = write_report_files(
        [result], blocks, tmp_path, "en", ["html"], False, "2026-01-01", bodies, progress=lambda *_: None
    )
    assert [one.code for one in made.warnings].count("project.body-without-fit") == 1
    summary = made.files["html"].read_text("utf-8").partition("Limits of use")[0]
    assert "Body CAVE &amp; ADIT has no chapter" in summary


def test_stopped_and_a_folder_that_cannot_be_made(tmp_path):
    with pytest.raises(Cancelled):
        write_reports([horizon()], tmp_path / "out", lambda stage, share: False)
    assert not list((tmp_path / "out").iterdir())
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        write_reports([horizon()], tmp_path / "file" / "out")


@pytest.fixture(scope="module")
def crossed():
    """A faulted site whose downthrown block alone crosses the horizon below it."""
    site = faulted_site()
    plan = np.random.default_rng(3).uniform(BOUNDARY[0], BOUNDARY[2], (150, 2))
    low = PointSet(np.column_stack([plan, HEIGHT(*plan.T) - 5.5]))
    return replace(site, horizons={**site.horizons, "low": low}, order=("T2", "low"))


def assert_the_crossing_block_does_not_pass(file):
    data = json.loads(file.read_text("utf-8"))
    crossing = {one["upper"]: not one["passed"] for one in data["orders"]}
    assert sorted(crossing.values()) == [False, True]
    verdicts = {one["horizon"]: one["verdict"] for one in data["horizons"]}
    assert {name: verdicts[name] for name in crossing} == {
        name: "WARNING" if crosses else "PASS" for name, crosses in crossing.items()
    }


def test_a_fault_block_that_crosses_a_horizon_of_the_order_does_not_pass_in_a_report(crossed, tmp_path):
    fits = fit_site(crossed)
    made = write_report(fits, tmp_path, site=crossed, forms=("json",), examined=False)
    assert_the_crossing_block_does_not_pass(made["json"])


def test_a_fault_block_that_crosses_a_horizon_of_the_order_does_not_pass_in_a_run(crossed, tmp_path):
    run_horizons(crossed, tmp_path)
    assert_the_crossing_block_does_not_pass(tmp_path / "report.json")
