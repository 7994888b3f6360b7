"""One schema of the results: every document that is written follows the published JSON Schema, and bad ones do not."""

from __future__ import annotations

import copy
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from results import examined, horizon

from geofit.data.languages import EN
from geofit.data.messages import message
from geofit.data.title_block import Revision, TitleBlock
from geofit.report.gather import accuracy_report
from geofit.report.schema import (
    VERSION,
    failed_document,
    horizon_document,
    report_document,
    result_schema,
    to_json,
)

jsonschema = pytest.importorskip(
    "jsonschema", reason="jsonschema validates the results; it comes with the extra 'test'"
)

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def validator():
    schema = result_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.fixture(scope="module")
def result():
    made = examined(horizon())
    title = TitleBlock(project="P-1", revisions=(Revision("A", "2026-01-02", "first", "Li"),))
    edits = (message("test.edit", "raised"),)
    return replace(made, site=replace(made.site, title=title), excluded=made.surface.points[[1, 2]], edits=edits)


def parsed(document):
    return json.loads(to_json(document))


def test_the_published_schema_is_that_of_the_classes():
    script = ROOT / "tools" / "schema.py"
    done = subprocess.run([sys.executable, str(script), "--check"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_a_horizon_has_the_same_keys_in_its_own_file_and_in_the_report(result, validator):
    own = parsed(horizon_document(result))
    report = parsed(report_document(accuracy_report([result], date="2026-01-02")))
    validator.validate(own)
    validator.validate(report)
    (inside,) = report["horizons"]
    assert {key: own[key] for key in inside} == inside
    assert (own["kind"], report["kind"]) == ("horizon", "report")
    assert own["schema_version"] == report["schema_version"] == VERSION
    assert report["title"]["revisions"][0]["mark"] == "A"
    assert [point["row"] for point in inside["excluded"]] == [3, 4]


def test_a_horizon_that_was_not_examined_and_a_failed_run_are_valid_too(validator):
    validator.validate(parsed(horizon_document(replace(horizon(), read_back=None, storage=None))))
    validator.validate(parsed(failed_document({"T9": message("test.text", "1 point given")})))


@pytest.mark.parametrize(
    "spoil",
    [
        lambda data: data.pop("sigma"),
        lambda data: data.update(unknown=1),
        lambda data: data.update(verdict=3),
        lambda data: data.update(schema_version=VERSION + 1),
        lambda data: data["checks"][0].pop("passed"),
        lambda data: data["checks"][0].update(ok=True),
        lambda data: data["seams"][0].update(gap="wide"),
        lambda data: data["read_back"].pop("valid"),
        lambda data: data["notes"].append("a sentence without a code"),
    ],
)
def test_a_key_too_many_or_too_few_and_a_wrong_type_are_refused(result, validator, spoil):
    data = copy.deepcopy(parsed(horizon_document(result)))
    spoil(data)
    assert not validator.is_valid(data)


def test_the_language_of_the_report_does_not_change_its_json(result, tmp_path):
    from geofit.report.chapters import document

    report = accuracy_report([result], date="2026-01-02")
    before = to_json(report_document(report))
    document(report, EN)
    assert to_json(report_document(report)) == before
