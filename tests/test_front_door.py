"""The names of ``import geofit``: listed, found by Tab, documented; their short forms in a console and a notebook."""

from __future__ import annotations

import inspect
import re
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import geofit
from geofit.data.accuracy import Check
from geofit.data.picture import card, deviation_colours, plan_svg

FUNCTIONS = sorted(
    {
        f"{package.__name__}.{name}": getattr(package, name)
        for package in (geofit, geofit.io)
        for name in package.__all__
        if inspect.isfunction(getattr(package, name))
    }.items()
)
CLASSES = sorted((name, getattr(geofit, name)) for name in geofit.__all__ if inspect.isclass(getattr(geofit, name)))
#: Functions that accept whatever their types allow.
NO_ERRORS = ("judge", "thickness", "preview_file", "preview_table", "take_contacts", "compare_horizons")
UNIT = re.compile(r"\bmetres?\b|\bm\b|\bdegrees\b|probability|share\b|weight|m2\b|m3\b", re.IGNORECASE)


def sections(doc: str) -> dict[str, str]:
    """Return the parts of a numpydoc text by their underlined heading."""
    parts = re.split(r"^([A-Z][\w ]+)\n-{3,}\n", doc, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def described(section: str) -> dict[str, tuple[str, str]]:
    """Return type and description of each name in a section of parameters."""
    found = {}
    for block in filter(None, re.split(r"^(?=[*\w])", section, flags=re.MULTILINE)):
        head, _, body = block.partition("\n")
        names, _, kind = head.partition(" : ")
        for name in names.split(","):
            found[name.strip()] = (kind, body.strip())
    return found


def dots(path: ElementTree.Element) -> np.ndarray:
    """Return the (n, 2) pixels of the dots of a path."""
    return np.array([pair.split() for pair in re.findall(r"M([^h]+)h", path.get("d"))], dtype=float).reshape(-1, 2)


def test_tab_finds_every_name_before_it_is_imported():
    assert set(geofit.__all__) <= set(dir(geofit))
    assert set(geofit.io.__all__) <= set(dir(geofit.io))
    assert 20 <= len(geofit.__all__) <= 45
    assert geofit.__all__ == sorted(geofit.__all__)


@pytest.mark.parametrize("package", [geofit, geofit.io], ids=lambda package: package.__name__)
def test_every_name_is_there_and_is_defined_once(package):
    for name in package.__all__:
        value = getattr(package, name)
        if inspect.isfunction(value) or inspect.isclass(value):
            assert value.__name__ == name
            assert getattr(sys.modules[value.__module__], name) is value


def test_a_name_in_both_packages_is_the_same():
    for name in set(geofit.__all__) & set(geofit.io.__all__):
        assert getattr(geofit, name) is getattr(geofit.io, name)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="'geofit' has no attribute 'fit_horizons'"):
        geofit.fit_horizons  # noqa: B018


@pytest.mark.parametrize(("name", "function"), FUNCTIONS)
def test_a_function_documents_parameters_results_errors_and_source(name, function):
    doc = inspect.getdoc(function) or ""
    found = sections(doc)
    signature = inspect.signature(function)
    parameters = described(found.get("Parameters", ""))
    assert list(parameters) == list(signature.parameters), "Parameters: names and order of the signature"
    for parameter, (kind, text) in parameters.items():
        assert kind, f"{parameter}: state its type"
        assert text, f"{parameter}: describe it"
        if "array" in kind:
            assert re.search(r"\(\w+,( \w+)?\) array", kind), f"{parameter}: state the shape of the array"
        if re.match(r"float\b", kind):
            assert UNIT.search(text), f"{parameter}: state the unit"
    if signature.return_annotation not in ("None", None):
        assert "Returns" in found
    assert "Raises" in found or function.__name__ in NO_ERRORS
    assert "Notes" in found or "References" in found, "Notes: the source (article, equation), or where the rules are"


@pytest.mark.parametrize(("name", "cls"), CLASSES)
def test_a_class_documents_its_fields(name, cls):
    found = sections(inspect.getdoc(cls))
    if hasattr(cls, "__dataclass_fields__"):
        # What a caller passes: a class with its own constructor may keep its data in other fields.
        assert list(described(found["Parameters"])) == list(inspect.signature(cls).parameters)


def test_short_forms():
    points = geofit.PointSet([[0, 0, 1.0], [9, 0, 2.0], [0, 9, 3.0], [9, 9, 4.0]], kind=["borehole"] * 3 + ["adit"])
    fit = geofit.fit_horizon(points, geofit.FitSettings(epsilon=0.2), name="T2-T1")
    assert repr(points) == "<PointSet: 4 points, 1 adit, 3 borehole, z 1.0 to 4.0 m>"
    assert repr(points[:0]) == "<PointSet: 0 points>"
    assert repr(geofit.FitSettings()) == "FitSettings()"
    assert repr(fit.settings) == "FitSettings(epsilon=0.2)"
    assert eval(repr(fit.settings), {"FitSettings": geofit.FitSettings}) == fit.settings
    assert re.fullmatch(r"<HorizonFit T2-T1: 1 patch, 4 points, sigma \S+ m < 0.2 m PASS>", repr(fit))
    assert re.fullmatch(r"<Patch \w+: \d+ x \d+ control points, degree 1 x 1>", repr(fit.patches[0]))
    assert repr(fit.surface) == "<PatchSurface T2-T1: 1 patch>"
    assert re.match(r"<Accuracy PASS: sigma \S+ m < 0.2 m, 4 points, largest", repr(fit.accuracy))
    assert repr(Check("bias", False, 0.25, 0.1, "m", "")) == "<Check bias: FAIL, 0.25, limit 0.1 m>"
    assert repr(geofit.examine(fit)).startswith("<PredictionResult: ")
    site = geofit.Site("Dam", {"T2-T1": points})
    assert repr(site) == "<Site Dam: horizons 1, points 4, holes 0, sections 0, rows not used 0>"
    assert repr(geofit.fit_site(site)) == "<SiteFit: T2-T1 PASS>"


def test_rich_forms_are_well_formed_and_escape_names():
    points = geofit.PointSet([[0, 0, 1.0], [9, 0, 2.0], [0, 9, 3.0], [9, 9, 4.0]])
    fit = geofit.fit_horizon(points, boundary=[[-1, -1], [10, -1], [10, 10]], name="<b>T2 & T1</b>")
    for text in (fit._repr_html_(), geofit.Site("A < B", {"T": points}, boundary=fit.outline)._repr_html_()):
        root = ElementTree.fromstring(text)
        assert sum(len(dots(path)) for path in root.findall(".//{http://www.w3.org/2000/svg}path")) == 4
        assert len(root.findall(".//{http://www.w3.org/2000/svg}polygon")) == 1
    assert "&lt;b&gt;T2 &amp; T1&lt;/b&gt;" in fit._repr_html_()


@given(st.lists(st.tuples(st.floats(-1e7, 1e7), st.floats(-1e7, 1e7)), min_size=1, max_size=40))
def test_every_place_lies_inside_its_picture(places):
    root = ElementTree.fromstring(plan_svg([(np.array(places), "red")]))
    xy = dots(root[0])
    assert len(xy) == len(places)
    assert ((xy >= 0) & (xy <= [float(root.get("width")), float(root.get("height"))])).all()


def test_north_is_up_and_many_points_are_thinned_out():
    blue, red = ElementTree.fromstring(plan_svg([([[0, 0], [0, 50.0]], ["red", "blue"])]))
    assert (blue.get("stroke"), red.get("stroke")) == ("blue", "red")
    assert dots(blue)[0, 1] < dots(red)[0, 1]
    (many,) = ElementTree.fromstring(plan_svg([(np.random.default_rng(0).random((9_000, 2)), "red")]))
    assert len(dots(many)) == 1_500
    assert plan_svg([(np.empty((0, 2)), "red")]) == ""


def test_colours_of_deviations_change_at_the_limits():
    colours = deviation_colours([-1.0, -0.2, -0.1, 0.1, 0.2, 1.0], near=0.1, far=0.5)
    assert colours[2] == colours[3]
    assert len(set(colours.tolist())) == 5


def test_a_card_escapes_its_cells():
    assert "<td" in card("a", {"b": "<c>"})
    assert "&lt;c&gt;" in card("a", {"b": "<c>"})
