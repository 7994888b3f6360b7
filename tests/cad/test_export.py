"""IGES and BREP read back by OpenCASCADE."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused
from surfaces import fold, horizon, nine

from geofit.cad.export import write_brep, write_iges
from geofit.cad.faces import faces_of, free_loops, from_geom
from geofit.cad.iges_names import iges_labels, iges_names
from geofit.data.errors import InputError
from geofit.io.export.write import renamed
from geofit.io.surface_files import read_surfaces

OUTLINE = [[100, 80], [500, 20], [900, 100], [950, 600], [80, 650]]


@pytest.fixture(scope="module")
def surfaces():
    return {"T1 top": horizon(nine()[1], outline=OUTLINE), "强风化": horizon([fold()])}


def read_iges(path):
    from OCP.IGESControl import IGESControl_Reader
    from OCP.Interface import Interface_Static

    reader = IGESControl_Reader()
    before = Interface_Static.CVal_s("xstep.cascade.unit")
    Interface_Static.SetCVal_s("xstep.cascade.unit", "M")
    try:
        reader.ReadFile(str(path))
        reader.TransferRoots()
        return [reader.Shape(k) for k in range(1, reader.NbShapes() + 1)]
    finally:
        Interface_Static.SetCVal_s("xstep.cascade.unit", before)


def read_brep(path):
    from OCP.BRep import BRep_Builder
    from OCP.BRepTools import BRepTools
    from OCP.TopoDS import TopoDS_Iterator, TopoDS_Shape

    shape = TopoDS_Shape()
    assert BRepTools.Read_s(shape, str(path), BRep_Builder())
    parts, walk = [], TopoDS_Iterator(shape)
    while walk.More():
        parts.append(walk.Value())
        walk.Next()
    return parts


def patches(shape):
    """Faces as patches in map coordinates."""
    from OCP.BRep import BRep_Tool

    return [from_geom("face", BRep_Tool.Surface_s(face)) for face in faces_of(shape)]


def furthest(shape, surface):
    """Largest distance of places on what was read from the surface that was written, metres."""
    share = np.linspace(0, 1, 9)
    worst = 0.0
    for patch in patches(shape):
        u0, u1, v0, v1 = patch.domain
        places = patch.evaluate(u0 + share[:, None] * (u1 - u0), v0 + share * (v1 - v0)).reshape(-1, 3)
        worst = max(worst, float(np.abs(surface.distance(places)).max()))
    return worst


def area(shape):
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, properties)
    return properties.Mass()


def test_brep_is_what_was_sewn(surfaces, tmp_path):
    write_brep(surfaces, tmp_path / "a.brep")
    parts = read_brep(tmp_path / "a.brep")
    assert [len(faces_of(part)) for part in parts] == [9, 1]
    for part, surface in zip(parts, surfaces.values(), strict=True):
        assert furthest(part, surface) < 1e-7
        assert free_loops(part) == 1
        assert area(part) == pytest.approx(area(surface.to_cadquery().wrapped), rel=1e-9)


def test_iges_is_in_metres_trimmed_and_named(surfaces, tmp_path):
    write_iges(surfaces, tmp_path / "a.igs")
    first, second = read_iges(tmp_path / "a.igs")
    assert (len(faces_of(first)), len(faces_of(second))) == (9, 1)
    for part, surface in zip((first, second), surfaces.values(), strict=True):
        # Nine decimals in the file; 3.1e6 m leaves 5e-10 m to a double.
        assert furthest(part, surface) < 2e-8
        assert area(part) == pytest.approx(area(surface.to_cadquery().wrapped), rel=1e-7)
    text = (tmp_path / "a.igs").read_text("ascii")
    assert "T1_top" in str(text)
    # The whole name is the property 406-15 of the group.
    assert "406,1,6HT1 top;" in str(text)
    assert ",6,1HM," in str(text).replace("\n", "").replace(" ", "")


def test_iges_names_are_ascii_and_no_two_alike(surfaces, tmp_path):
    """Horizons in Chinese had all been HORIZON, and one surface when they were read again."""
    names = ["强风化", "中风化", "Höhe", "T2 上", "T2 下", "T2", "HORIZON", "a\nb"]
    plain = iges_names(names)
    assert plain == {
        "强风化": "HORIZON-2", "中风化": "HORIZON-3", "Höhe": "Hohe", "T2 上": "T2-2", "T2 下": "T2-3", "T2": "T2",
        "HORIZON": "HORIZON", "a\nb": "a_b",
    }  # fmt: skip
    labels = list(iges_labels(names).values())
    assert len(set(labels)) == len(names)
    assert max(map(len, labels)) <= 8
    write_iges(dict.fromkeys(names[:4], surfaces["强风化"]), tmp_path / "a.igs")
    assert list(read_surfaces(tmp_path / "a.igs")) == ["HORIZON", "HORIZON-2", "Hohe", "T2"]
    warnings = renamed(dict.fromkeys(names, surfaces["强风化"]), "iges")
    assert [(one.params["name"], one.params["plain"]) for one in warnings] == [
        (name, own) for name, own in plain.items() if own != name
    ]
    assert not renamed(surfaces, "step")


@pytest.mark.parametrize("writer", [write_brep, write_iges])
def test_same_surfaces_give_the_same_bytes_and_nothing_else(writer, surfaces, tmp_path):
    for name in ("a", "b"):
        writer(surfaces, tmp_path / name)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a", "b"]


def test_the_unit_of_the_process_stays(surfaces, tmp_path):
    from OCP.UnitsMethods import UnitsMethods

    before = UnitsMethods.GetCasCadeLengthUnit_s()
    write_iges({"T1": surfaces["T1 top"]}, tmp_path / "a.igs")
    assert UnitsMethods.GetCasCadeLengthUnit_s() == before


@pytest.mark.parametrize("writer", [write_brep, write_iges])
def test_refuses_nothing(writer, tmp_path):
    with refused(InputError, "data.no-surface"):
        writer({}, tmp_path / "a")
