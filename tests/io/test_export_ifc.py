"""IFC4X3 read back and validated by ifcopenshell."""

from __future__ import annotations

import numpy as np
import pytest
from surfaces import fold, horizon, nine

from geofit.data.errors import InputError, MissingDependencyError
from geofit.data.site import Hole
from geofit.io.export.ifc import write_ifc
from geofit.splines.patch import Patch

HOLES = (
    Hole("ZK1", "borehole", np.array([0.0, 50.0]), np.array([[5e5, 3.1e6, 520.0], [5e5, 3.1e6, 470.0]])),
    Hole(
        "PD1",
        "adit",
        np.array([0.0, 30.0, 60.0]),
        5e5 + np.array([[0, 0, 430], [30, 0, 430], [60, 0, 431.0]]),
    ),
)


def surfaces():
    first = horizon(nine()[1], outline=[[100, 80], [500, 20], [900, 100], [950, 600], [80, 650]])
    limb = fold()
    weights = np.ones(limb.control.shape[:2])
    weights[3:6, 2] = 1.7
    second = horizon([Patch("limb", limb.degree, limb.knots_u, limb.knots_v, limb.control, weights)])
    return {"T2/T1 上部": first, "fold": second}


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    ifcopenshell = pytest.importorskip("ifcopenshell")
    path = tmp_path_factory.mktemp("ifc") / "site.ifc"
    write_ifc(surfaces(), path, holes=HOLES, site="Dam 坝址", crs="EPSG:32648", tolerance=2.0)
    return path, ifcopenshell.open(path)


# ifcopenshell leaves the file of its rules open.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning")
def test_the_file_is_valid_against_the_schema_and_its_rules(written):
    import ifcopenshell.validate

    logger = ifcopenshell.validate.json_logger()
    ifcopenshell.validate.validate(written[1], logger, express_rules=True)
    # Version 0.9.0 evaluates IfcSurfaceWeightsPositive with an indexing error of its own on rational surfaces.
    found = [s for s in logger.statements if "unsupported operand" not in s["message"]]
    assert found == []
    assert written[1].schema_identifier.startswith("IFC4X3")


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning")
def test_the_validator_can_object(written, tmp_path):
    import ifcopenshell
    import ifcopenshell.validate

    text = written[0].read_text("ascii").replace("IFCSIUNIT(*,.LENGTHUNIT.", "IFCSIUNIT(*,.NOUNIT.")
    (tmp_path / "bad.ifc").write_text(text, "ascii")
    logger = ifcopenshell.validate.json_logger()
    ifcopenshell.validate.validate(str(tmp_path / "bad.ifc"), logger)
    assert logger.statements


def test_patches_come_back_as_they_are(written):
    strata = {stratum.Name: stratum for stratum in written[1].by_type("IfcGeotechnicalStratum")}
    for name, surface in surfaces().items():
        stratum = strata[name]
        origin = stratum.ObjectPlacement.RelativePlacement.Location.Coordinates
        assert origin == tuple(surface.origin)
        exact = next(r for r in stratum.Representation.Representations if r.RepresentationIdentifier == "Surface")
        assert len(exact.Items) == len(surface.patches)
        for item, patch in zip(exact.Items, surface.patches, strict=True):
            assert item.is_a("IfcBSplineSurfaceWithKnots")
            control = np.array([[point.Coordinates for point in row] for row in item.ControlPointsList])
            assert np.abs(control - patch.control).max() < 1e-12
            assert np.array_equal(np.repeat(item.UKnots, item.UMultiplicities), patch.knots_u)
            assert np.array_equal(np.repeat(item.VKnots, item.VMultiplicities), patch.knots_v)
            if patch.weights is not None:
                assert np.array_equal(np.array(item.WeightsData), patch.weights)


def test_the_triangles_are_trimmed(written):
    stratum = next(s for s in written[1].by_type("IfcGeotechnicalStratum") if s.Name != "fold")
    body = next(r for r in stratum.Representation.Representations if r.RepresentationIdentifier == "Body")
    (faces,) = body.Items
    points = np.array(faces.Coordinates.CoordList)
    assert points[:, 0].min() == pytest.approx(80, abs=1e-6)
    surface = surfaces()[stratum.Name]
    assert np.abs(surface.distance(points + surface.origin)).max() < 2e-6


def test_the_outline_is_a_closed_line_in_plan(written):
    for stratum in written[1].by_type("IfcGeotechnicalStratum"):
        shapes = {shape.RepresentationIdentifier: shape for shape in stratum.Representation.Representations}
        known = surfaces()[stratum.Name].outline
        assert ("FootPrint" in shapes) == (known is not None)
        if known is not None:
            (line,) = shapes["FootPrint"].Items
            origin = stratum.ObjectPlacement.RelativePlacement.Location.Coordinates
            corners = np.array([point.Coordinates for point in line.Points]) + origin[:2]
            assert np.abs(corners[:-1] - known).max() < 1e-9
            assert np.array_equal(corners[0], corners[-1])


def test_holes_stand_where_they_are(written):
    holes = {hole.Name: hole for hole in written[1].by_type("IfcBorehole")}
    assert {name: hole.ObjectType for name, hole in holes.items()} == {"ZK1": "borehole", "PD1": "adit"}
    for hole in HOLES:
        found = holes[hole.name]
        start = found.ObjectPlacement.RelativePlacement.Location.Coordinates
        line = found.Representation.Representations[0].Items[0]
        assert np.abs(np.array([p.Coordinates for p in line.Points]) + start - hole.xyz).max() < 1e-9
    (system,) = written[1].by_type("IfcProjectedCRS")
    assert system.Name == "EPSG:32648"


def test_holes_of_one_name_are_two(tmp_path):
    """Both had one identifier, of which programs keep the first."""
    ifcopenshell = pytest.importorskip("ifcopenshell")
    other = Hole("ZK1", "borehole", HOLES[0].depth, np.add(HOLES[0].xyz, [100.0, 0.0, 0.0]))
    write_ifc({}, tmp_path / "two.ifc", holes=(HOLES[0], other))
    holes = ifcopenshell.open(tmp_path / "two.ifc").by_type("IfcBorehole")
    assert [hole.Name for hole in holes] == ["ZK1", "ZK1"]
    assert len({hole.GlobalId for hole in holes}) == 2


def test_same_site_same_bytes(written, tmp_path):
    write_ifc(surfaces(), tmp_path / "b.ifc", holes=HOLES, site="Dam 坝址", crs="EPSG:32648", tolerance=2.0)
    assert (tmp_path / "b.ifc").read_bytes() == written[0].read_bytes()
    assert [p.name for p in tmp_path.iterdir()] == ["b.ifc"]


def test_refusals(tmp_path, monkeypatch):
    pytest.importorskip("ifcopenshell")
    with pytest.raises(InputError, match="No surface"):
        write_ifc({}, tmp_path / "a.ifc")
    monkeypatch.setitem(__import__("sys").modules, "ifcopenshell", None)
    with pytest.raises(MissingDependencyError, match=r"geofit-geology\[ifc\]"):
        write_ifc(surfaces(), tmp_path / "a.ifc")
    assert list(tmp_path.iterdir()) == []
