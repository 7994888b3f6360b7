"""The report of surfaces that are there already: the forms that were asked for, and no other file."""

from __future__ import annotations

import json

import pytest
from results import horizon

from geofit.data.errors import Cancelled, InputError
from geofit.data.languages import ZH
from geofit.project.run import write_reports


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


def test_stopped_and_a_folder_that_cannot_be_made(tmp_path):
    with pytest.raises(Cancelled):
        write_reports([horizon()], tmp_path / "out", lambda stage, share: False)
    assert not list((tmp_path / "out").iterdir())
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        write_reports([horizon()], tmp_path / "file" / "out")
