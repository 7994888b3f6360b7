from __future__ import annotations

from geofit.data.accuracy import plain
from geofit.data.messages import gravest_first, message


def of(severity, name):
    return message("test.text", "{name}", name=name).with_severity(severity)


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
