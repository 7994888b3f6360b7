"""The mistakes of a first script: every function of the front door says what it was given and what it needs."""

from __future__ import annotations

import inspect

import numpy as np
import pytest
from refusals import refused

import geofit
import geofit.caves
import geofit.medial
import geofit.pores
from geofit.data.errors import ArgumentError, SettingsError
from geofit.implicit import (
    Convolution,
    CurveTube,
    Cylinder,
    FunctionField,
    Lattice,
    Plane,
    RoundCones,
    Sphere,
    Torus,
    TriangleMesh,
    complement,
    ellipsoid,
    field_contours,
    foot_points,
    isosurface_of_blocks,
    moved,
    r_union,
    smooth_union,
    spherical_metaballs,
    spline_of_field,
    union,
)

XYZ = np.random.default_rng(0).uniform((500000, 3100000, 900), (500100, 3100100, 905), (40, 3))


@pytest.fixture(scope="module")
def fit():
    return geofit.fit_horizon(geofit.PointSet(XYZ), name="T1")


@pytest.fixture(scope="module")
def read(fit, tmp_path_factory):
    """The same surface, read from a file: patches alone."""
    path = tmp_path_factory.mktemp("read") / "T1.igs"
    geofit.write_surface(fit, path)
    return geofit.read_surface(path)


@pytest.fixture(scope="module")
def shots(tmp_path_factory):
    """Passages along three shots."""
    path = tmp_path_factory.mktemp("cave") / "a.svx"
    path.write_text("*begin a\n1 2 10 0 0\n2 3 12 90 5\n3 4 8 45 -5\n*end a\n")
    return geofit.centreline_body(geofit.io.read_survex(path), radius=1.5)


@pytest.mark.parametrize("points", [XYZ, XYZ.tolist(), None, "points.csv"])
def test_points_are_a_point_set(points):
    with pytest.raises(ArgumentError, match=r"points is of type \w+; a PointSet is needed: PointSet\(xyz\)") as told:
        geofit.fit_horizon(points)
    assert isinstance(told.value, TypeError)


def test_settings_are_settings():
    with pytest.raises(ArgumentError, match="settings is of type dict; settings are needed"):
        geofit.fit_horizon(geofit.PointSet(XYZ), {"epsilon": 0.2})


def test_a_surface_that_was_read_is_no_fit(read):
    name = read.patches[0].name
    for call in (
        lambda: geofit.examine(read),
        lambda: geofit.separate_horizons({"a": read}, ["a"]),
        lambda: geofit.write_report(read, "nowhere"),
        lambda: geofit.write_report([read], "nowhere"),
    ):
        with pytest.raises(ArgumentError, match=r"is of type PatchSurface; a fit is needed: fit_horizon\(points\)"):
            call()
    for edit in (
        lambda: geofit.adjust(read, name, 1, 1, 0.1),
        lambda: geofit.weigh(read, name, 1, 1, 2.0),
        lambda: geofit.move_to(read, XYZ[0]),
    ):
        with pytest.raises(geofit.errors.FitError, match="was read from a file"):
            edit()


@pytest.mark.parametrize("surface", [None, XYZ, "a.step"])
def test_only_surfaces_are_written_and_judged(surface, tmp_path):
    with pytest.raises(ArgumentError, match=r"a surface is needed, or several by name: \{'T1': surface\}"):
        geofit.write_surface(surface, tmp_path / "a.step")
    with pytest.raises(ArgumentError, match="surfaces\\['a'\\] is of type"):
        geofit.write_surface({"a": surface}, tmp_path / "a.step")
    with pytest.raises(ArgumentError, match="surface is of type"):
        geofit.judge(surface, geofit.PointSet(XYZ))
    assert not list(tmp_path.iterdir())


def test_a_list_of_surfaces_has_no_names(fit, tmp_path):
    with pytest.raises(ArgumentError, match=r"surfaces is of type list; .*by name"):
        geofit.write_surface([fit, fit], tmp_path / "a.step")


@pytest.mark.parametrize("site", ["site.toml", {"T1": XYZ}, None])
def test_a_site_is_a_site(site):
    with pytest.raises(ArgumentError, match=r"a site is needed: read_site\(path\)"):
        geofit.fit_site(site)


def test_no_horizons_are_apart():
    assert geofit.separate_horizons({}, []).surfaces == {}


def test_a_form_of_report_that_is_unknown_is_refused(fit, tmp_path):
    with pytest.raises(SettingsError, match="The report format 'docx' is unknown; choose html, pdf, json") as told:
        geofit.write_report(fit, tmp_path / "report", forms=["docx"])
    assert told.value.code == "project.report-form-unknown"
    assert not (tmp_path / "report").exists()


def test_no_film_without_frames(tmp_path):
    with pytest.raises(SettingsError, match="no frames"):
        geofit.write_film([], tmp_path / "a.gif")


def test_without_uncertainty_there_is_no_standard_deviation(fit):
    with pytest.raises(ArgumentError, match=r"uncertainty is of type None; .*examine\(surface\)"):
        geofit.prediction_sd(fit, None, XYZ)


def test_a_volume_without_rock_has_no_contacts():
    volume = geofit.RockVolume(np.zeros((5, 5, 5), np.uint8), pore=0, voxel=1.0)
    with pytest.raises(geofit.GeofitError) as told:
        geofit.pore_surface(volume)
    assert told.value.code == "pores.no-rock"
    assert geofit.pore_surface(volume, construction="blend").triangulate(0.5).volume > 0


FUNCTIONS = sorted(
    {
        getattr(package, name)
        for package in (geofit, geofit.io, geofit.implicit, geofit.pores, geofit.caves, geofit.medial)
        for name in package.__all__
        if inspect.isfunction(getattr(package, name))
    },
    key=lambda function: function.__name__,
)


class Odd:
    """Nothing that a function takes."""


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda function: function.__name__)
def test_every_function_refuses_what_it_cannot_take(function):
    """None, another object, bytes and a dict in place of what is needed; keywords that are unknown; nothing at all."""
    parameters = inspect.signature(function).parameters.values()
    needed = [one.name for one in parameters if one.default is one.empty and one.kind != one.VAR_POSITIONAL]
    for wrong in (None, Odd(), b"x", {"q": 1}, 1.5):
        with pytest.raises(geofit.GeofitError):
            function(**dict.fromkeys(needed, wrong))
    if needed:
        with refused(ArgumentError, "data.arguments-unfit"):
            function()
    with refused(ArgumentError, "data.argument-unknown", name="qqqqqq"):
        function(**dict.fromkeys(needed, None), qqqqqq=1)


def test_a_mistyped_keyword_suggests_the_right_one(fit):
    for call in (
        lambda: geofit.FitSettings(epsilom=1),
        lambda: geofit.BodySettings(epsilom=1),
        lambda: fit.judged_by(epsilom=1),
        lambda: fit.settings.__class__(epsilon=1, epsilom=1),
    ):
        with refused(ArgumentError, "data.argument-mistyped", name="epsilom", near="epsilon"):
            call()
    with refused(ArgumentError, "data.argument-mistyped", name="boundry", near="boundary"):
        geofit.Site("s", {}, boundry=None)
    with refused(ArgumentError, "data.argument-mistyped", near="accuracy"):
        geofit.PointSet(XYZ).with_(acuracy=0.1)


@pytest.mark.parametrize("x", ["a", [1, "b"], Odd(), {"x": 1}, [[1], [1, 2]]])
def test_places_are_numbers(fit, x):
    for call in (
        lambda: fit.elevation(x, 1),
        lambda: fit.surface.elevation(1, x),
        lambda: fit.distance(x),
        lambda: fit.project(x),
        lambda: foot_points(Sphere(np.zeros(3), 1.0), x),
    ):
        with pytest.raises(geofit.GeofitError, match=r"number|coordinates"):
            call()


def test_elements_are_looked_at_where_several_are_taken(fit):
    with pytest.raises(ArgumentError, match=r"names\[1\] is 3; needed: a text"):
        geofit.fit_site(geofit.Site("s", {"a": geofit.PointSet(XYZ)}), ["a", 3])
    with pytest.raises(ArgumentError, match="names is of type str; needed: several values"):
        geofit.fit_site(geofit.Site("s", {"a": geofit.PointSet(XYZ)}), "a")
    with pytest.raises(ArgumentError, match="lower is of type None; a fit is needed"):
        geofit.compare_horizons(fit, None)


def test_what_goes_wrong_inside_is_not_blamed_on_the_arguments():
    """A bare error with arguments that fit stays what it is."""

    class Broken(Sphere):
        def value(self, xyz):
            raise ZeroDivisionError("inside")

    for given in ({}, {"reach": np.inf}):
        with pytest.raises(ZeroDivisionError, match="inside"):
            foot_points(Broken(np.zeros(3), 1.0), np.ones((2, 3)), **given)


BALL = Sphere(np.zeros(3), 1.0)
LINE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])
LATTICE = Lattice.around([-2] * 3, [2] * 3, cells=8)
FIELDS = {
    "sphere": BALL,
    "cylinder": Cylinder([0, 0, 0], [0, 0, 1], 1.0),
    "torus": Torus([0, 0, 0], [0, 0, 1], 2.0, 0.5),
    "tube": CurveTube(LINE, 0.3),
    "cones": RoundCones(LINE, 0.3),
    "plane": Plane([0, 0, 0], [0, 0, 1]),
    "quadric": ellipsoid([0, 0, 0], [1, 2, 3]),
    "balls": spherical_metaballs(LINE, 1.0),
    "convolution": Convolution(LINE[None, :2], 0.3),
    "spline": spline_of_field(BALL, LATTICE),
    "function": FunctionField(BALL.value, BALL.gradient),
    "moved": moved(BALL, shift=[1, 0, 0]),
    "complement": complement(BALL),
    "union": union(BALL, BALL),
    "smooth": smooth_union(BALL, BALL, radius=0.1),
    "r": r_union(BALL, BALL),
}
#: Fields that refuse places without finite coordinates: they are searched for in a tree.
REFUSING = {"tube"}


@pytest.mark.parametrize("field", FIELDS.values(), ids=FIELDS)
@pytest.mark.parametrize(
    "xyz", [np.zeros(3), np.zeros((5, 2)), np.zeros((5, 1)), np.zeros((2, 3, 2)), None, "a", Odd()]
)
def test_fields_have_values_at_points_only(field, xyz):
    """Two columns were read beyond their end by compiled loops, and one column counted three times."""
    for call in (field.value, field.gradient, *([field.range_in] if hasattr(field, "range_in") else [])):
        with pytest.raises(geofit.GeofitError):
            call(*[xyz] * (2 if call.__name__ == "range_in" else 1))


@pytest.mark.parametrize("name", [*FIELDS, "passages", "pores' balls"])
@pytest.mark.parametrize("place", [np.nan, np.inf, -np.inf, 1e300])
def test_places_that_are_none_have_no_value(name, place, shots):
    """Compiled loops took the cell of what is not a number for one of theirs, far beyond their arrays."""
    others = {"passages": shots, "pores' balls": geofit.medial.MetaballBody([[0, 0, 0]], [1.0])}
    field = others.get(name) or FIELDS[name]
    for xyz in (np.full((2, 3), place), np.array([[0.1, 0.1, place]])):
        if name in REFUSING:
            with pytest.raises(geofit.GeofitError):
                field.value(xyz)
            continue
        with np.errstate(all="ignore"):
            value, gradient = field.value(xyz), field.gradient(xyz)
            # The other places keep their values.
            np.testing.assert_array_equal(field.value(np.concatenate([xyz, LINE]))[-3:], field.value(LINE))
        assert value.shape == (len(xyz),)
        assert gradient.shape == xyz.shape
        if np.isnan(place):
            assert np.isnan(value).all()


def test_pores_have_values_at_places_that_are_none():
    rng = np.random.default_rng(0)
    volume = geofit.RockVolume(rng.random((8, 8, 8)) > 0.4, pore=True, voxel=1e-6)
    body = geofit.pore_surface(volume)
    places = np.array([[np.nan] * 3, [4e-6, 4e-6, np.nan], [np.inf] * 3, [1e300, 0, 0], [4e-6] * 3])
    with np.errstate(all="ignore"):
        assert np.isnan(body.value(places)).tolist() == [True, True, False, False, False]
        assert np.isfinite(body.gradient(places)).all(axis=1).tolist() == [False, False, True, True, True]


def test_boxes_have_two_corners_each():
    with refused(geofit.errors.SettingsError, "implicit.corners-differ", lower=2, upper=3):
        FIELDS["quadric"].range_in(np.zeros((2, 3)), np.ones((3, 3)))


@pytest.mark.parametrize(
    ("call", "argument", "needed"),
    [
        (lambda: Sphere([1, 2], 1.0), "centre", "(3,)"),
        (lambda: ellipsoid([0, 0], [1, 2, 3]), "centre", "(3,)"),
        (lambda: ellipsoid([0, 0, 0], [1, 2, 3], np.eye(2)), "rotation", "(3, 3)"),
        (lambda: RoundCones(LINE, np.ones(5)), "radii", "(3,)"),
        (lambda: TriangleMesh(np.zeros((5, 2)), [[0, 1, 2]]), "vertices", "(5, 3)"),
        (lambda: field_contours(BALL, [0, 0], [1, 0, 0], [0, 1, 0], size=(1, 1), spacing=0.1), "origin", "(3,)"),
        (lambda: isosurface_of_blocks(np.zeros(3), [[0, 0, 0]], LATTICE), "values", "(k, b, b, b)"),
    ],
)  # fmt: skip
def test_shapes_are_those_of_the_docstring(call, argument, needed):
    with refused(ArgumentError, "data.argument-shape-unfit", argument=argument, needed=needed):
        call()


@pytest.mark.parametrize(
    ("call", "argument", "code"),
    [
        (lambda: geofit.PointSet(XYZ, kind=[[1, 2], [3]]), "kind", "data.rows-unequal"),
        (lambda: geofit.RockVolume([[1, 2], [3]]), "array", "data.rows-unequal"),
        (lambda: FunctionField(np.sum, np.sum, [[1, 2], [3]]), "bounds", "data.rows-unequal"),
        (lambda: TriangleMesh(XYZ, [[1, 2], [3]]), "triangles", None),
        (lambda: TriangleMesh(XYZ, None), "triangles", None),
        (lambda: Lattice([0, 0, 0], 1.0, np.zeros((3, 2))), "shape", None),
        (lambda: geofit.pores.surface_area(np.ones((3, 3, 3)), ()), "edges", None),
        (lambda: geofit.pores.surface_area(np.ones((3, 3, 3)), ("a", 1, 2)), "edges", None),
        (lambda: geofit.pores.kozeny_permeability(0.2, 1e300), "diameter", "data.finite-needed"),
        (lambda: geofit.io.write_section_csv({}, ""), "path", "data.text-unusable"),
        (lambda: geofit.io.write_section_csv({}, "a\0b"), "path", "data.text-unusable"),
    ],
)
def test_what_ends_in_an_error_of_a_library_names_the_argument(call, argument, code):
    with pytest.raises(ArgumentError) as told:
        call()
    params = told.value.message.params
    assert str(params["argument"]).startswith(argument)
    assert "fault" not in params or params["fault"].code == code


def test_voxels_have_6_or_26_neighbours():
    with refused(geofit.pores.VolumeError, "pores.neighbours-unknown", count=18):
        geofit.pores.euler_number(np.ones((3, 3, 3)), neighbours=18)


def test_a_ratio_to_no_porosity_is_refused():
    with refused(geofit.pores.VolumeError, "pores.no-porosity-before"):
        geofit.pores.kozeny_ratio(0, 0.2)


def test_a_message_shows_what_its_format_does_not_fit():
    for share in (10**400, np.array([1 + 2j])):
        with pytest.raises(geofit.GeofitError) as told:
            geofit.metaballs(geofit.RockVolume(np.eye(4)[None] > 0, pore=True), share=share)
        assert str(told.value)


def test_a_body_is_selected_by_one_truth_for_each_place():
    data = geofit.BodyData(contacts=LINE)
    assert len(data.select([True, False, True], [], []).contacts) == 2
    for mask in (np.zeros((2, 2)), np.ones(5)):
        with refused(geofit.errors.PointsError, "data.wrong-shape", name="contacts"):
            data.select(mask, [], [])


def test_a_kind_of_table_that_is_unknown_is_refused(tmp_path):
    (tmp_path / "a.csv").write_text("x,y,z\n1,2,3\n")
    with refused(geofit.errors.InputError, "io.mapping-kind-unknown"):
        geofit.io.preview_table(geofit.io.Source(path=tmp_path / "a.csv"), kind="a")


def test_nothing_is_no_surface_and_no_place(fit):
    with refused(ArgumentError, "data.argument-type-unfit", argument="surface", given="None"):
        geofit.HorizonFit(surface=None)
    for call in (lambda: fit.elevation(None, 1), lambda: fit.surface.elevation(1, None), lambda: fit.distance(None)):
        with refused(ArgumentError, "data.argument-type-unfit", given="None"):
            call()
