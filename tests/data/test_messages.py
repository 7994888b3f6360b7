from __future__ import annotations

import json

import numpy as np
import pytest

from geofit.data.accuracy import plain
from geofit.data.languages import EN, ZH, translate
from geofit.data.messages import Untranslated, gravest_first, message, plural_message
from geofit.report import digits


def of(severity, name):
    return message("test.text", "{name}", name=name).with_severity(severity)


def test_a_length_in_a_sentence_has_the_digits_of_the_tables():
    texts = [str(message("test.length", "{d:length} m of {n}", d=d, n=3)) for d in (132.97341, 0.0301, 3.21e-5, 5970.1)]
    assert texts == ["132.973 m of 3", "0.0301 m of 3", "3.21e-5 m of 3", "5970.100 m of 3"]


def test_areas_and_volumes_have_whole_numbers_in_groups():
    text = str(
        message("test.whole", "{volume:whole} m3, {area:whole} m2, {d:whole}", volume=178160401.4, area=9.6, d=-15000.0)
    )
    assert text.replace("\u202f", " ").replace("\xa0", " ").replace("\u2009", " ") == "178 160 401 m3, 10 m2, −15 000"


def test_few_digits_of_a_large_number_are_written_out():
    found = message("test.few", "{a:.2g} m, {b:.3g} m, {c:.2g} m, {d:.2g}", a=262.4, b=-98_765.0, c=41.7, d=4.2e11)
    assert str(found).split() == ["260", "m,", "−98", "800", "m,", "42", "m,", "4.2e+11"]


def test_formatted_numbers_have_a_minus_sign_and_given_ones_stay_as_they_are():
    found = message("x.y-z", "{a:.2f} {b:length} {c:.1g} {d} {e}", a=-0.14, b=-4.2, c=-1e-7, d=-3.5, e="T3-T2")
    assert str(found) == "−0.14 −4.200 −1e-07 -3.5 T3-T2"
    assert found.as_data()["params"]["a"] == -0.14


@pytest.mark.parametrize("language", [EN, ZH], ids=lambda language: language.code)
@pytest.mark.parametrize("kind", [int, np.int64, np.uint32])
def test_large_counts_are_grouped_as_in_the_tables_of_reports(language, kind):
    found = plural_message("test.points", "{count} point of {total}", "{count} points of {total}", count=kind(15_000),
                           total=kind(9_999))  # fmt: skip
    assert translate(found, language) == f"{digits.count(15_000)} points of 9999"
    assert translate(message("test.moved", "{count} m3", count=-1_234_567), language).split() == [
        "-1",
        "234",
        "567",
        "m3",
    ]


def test_numbers_that_name_something_coordinates_and_formatted_ones_stay_as_they_are():
    row = message(
        "test.row", "{file}, row {row}: EPSG:{code}", file=Untranslated("20240101.csv"), row=15_000, code=32_648
    )
    assert str(row) == "20240101.csv, row 15000: EPSG:32648"
    place = message("test.place", "({x:.1f}, {y:g}), {flag}, {shape}", x=500_000.0, y=3e6, flag=True, shape=(15_000, 3))
    assert str(place) == "(500000.0, 3e+06), True, (15000, 3)"
    assert str(
        message("test.value", "{value} of {width:d} and {length}", value=20_000, width=30_000, length=40_000.0)
    ) == ("20000 of 30000 and 40000.0")


def test_json_keeps_the_numbers_of_a_sentence():
    data = json.loads(json.dumps(message("test.count", "{count} points", count=15_000).as_data()))
    assert data["params"] == {"count": 15_000}
    assert data["text"].split() == ["15", "000", "points"]


def test_the_gravest_come_first_and_equals_keep_their_order():
    given = [of("info", "a"), of("warning", "b"), of("error", "c"), of("warning", "d"), of("info", "e")]
    assert [one.params["name"] for one in gravest_first(given)] == ["c", "b", "d", "a", "e"]


def test_json_has_code_severity_text_and_parameters():
    inner = message("test.inner", "row {row}", row=7)
    assert plain(message("test.outer", "{place}: wrong", place=inner).with_severity("error")) == {
        "code": "test.outer",
        "severity": "error",
        "text": "row 7: wrong",
        "params": {"place": {"code": "test.inner", "severity": "info", "text": "row 7", "params": {"row": 7}}},
    }


def test_the_repr_is_short():
    assert repr(message("test.text", "row {row}", row=7)) == "<test.text: row 7>"


def test_a_shape_without_axes_is_shown():
    assert str(message("test.text", "shape {shape}", shape=())) == "shape ()"
