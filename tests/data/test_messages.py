from __future__ import annotations

from geofit.data.accuracy import plain
from geofit.data.messages import gravest_first, message


def of(severity, name):
    return message("test.text", "{name}", name=name).with_severity(severity)


def test_a_length_in_a_sentence_has_the_digits_of_the_tables():
    texts = [str(message("test.length", "{d:length} m of {n}", d=d, n=3)) for d in (132.97341, 0.0301, 3.21e-5, 5970.1)]
    assert texts == ["132.973 m of 3", "0.0301 m of 3", "3.21e-5 m of 3", "5970.100 m of 3"]


def test_formatted_numbers_have_a_minus_sign_and_given_ones_stay_as_they_are():
    found = message("x.y-z", "{a:.2f} {b:length} {c:.1g} {d} {e}", a=-0.14, b=-4.2, c=-1e-7, d=-3.5, e="T3-T2")
    assert str(found) == "−0.14 −4.200 −1e-07 -3.5 T3-T2"
    assert found.as_data()["params"]["a"] == -0.14


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
