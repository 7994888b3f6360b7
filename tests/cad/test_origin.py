"""Where a STEP file has its zero: the file states the offset, and reading it back restores map coordinates."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import geofit.io
from geofit import FitSettings, PointSet, fit_horizon, read_surface
from geofit.bodies.fit import fit_body
from geofit.cad.solid_mesh import read_solids
from geofit.cad.step import read_shapes, write_step
from geofit.cad.step_origin import OFFSET_KEYS, offset_at, offset_of
from geofit.data.errors import SettingsError
from geofit.data.languages import ZH
from geofit.io.boreholes import read_boreholes
from geofit.project.step_files import Signed, certified, write_step_files

BODIES = Path(__file__).parents[2] / "sample_data" / "bodies"
DATUM = (500_000.5, 3_100_000.25, 1400.125)


def surface(name, corner, seed):
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, 300, (60, 2))
    z = 5 * np.sin(xy[:, 0] / 60) + rng.normal(0, 0.05, 60)
    return fit_horizon(PointSet(np.column_stack([xy, z]) + corner), FitSettings(), name=name)


@pytest.fixture(scope="module")
def surfaces():
    return {"T2": surface("T2", [534_567.0, 3_123_456.0, 1500.0], 1),
            "T3": surface("T3", [534_987.0, 3_123_111.0, 1460.0], 2)}  # fmt: skip


def in_file(path):
    """Return the translation of each product as the file itself gives it: nobody has added an offset."""
    text = path.read_text("ascii").replace("\n", "")
    moves = re.findall(r"ITEM_DEFINED_TRANSFORMATION\('[^']*','[^']*',#(\d+),#(\d+)\)", text)
    places = dict(re.findall(r"#(\d+) = AXIS2_PLACEMENT_3D\('[^']*',#(\d+)", text))
    points = {n: np.array([float(c) for c in xyz.split(",")])
              for n, xyz in re.findall(r"#(\d+) = CARTESIAN_POINT\('[^']*',\(([^)]*)\)\)", text)}  # fmt: skip
    return [points[places[after]] - points[places[before]] for before, after in moves]


@pytest.mark.usefixtures("read_here")
@pytest.mark.parametrize(
    ("origin", "offset"),
    [("map", (0, 0, 0)), ("local", (534_500.0, 3_123_100.0, 0.0)), (DATUM, DATUM), (np.array(DATUM), DATUM)],
)
@pytest.mark.parametrize("unit", ["m", "mm"])
def test_a_file_with_its_own_zero_reads_back_to_the_map(surfaces, tmp_path, origin, offset, unit):
    path = tmp_path / "dam.step"
    found = write_step(surfaces, path, origin=origin, unit=unit)
    assert all(back.passed for back in found.values())
    for back, one in zip(found.values(), surfaces.values(), strict=True):
        # Measured by OpenCASCADE in map coordinates.
        assert back.sigma == pytest.approx(one.accuracy.sigma, rel=1e-6)
    metres = 1.0 if unit == "m" else 1000.0
    for place, one in zip(in_file(path), surfaces.values(), strict=True):
        assert place / metres == pytest.approx(one.origin - offset, abs=1e-7)
    for shape in read_shapes(path):
        assert offset_at(shape.attributes) == pytest.approx(offset, abs=0)
        stated = [key for key in OFFSET_KEYS if key in shape.attributes]
        assert stated == (list(OFFSET_KEYS) if any(offset) else [])
    head = path.read_text("ascii").split("ENDSEC;")[0]
    assert ("Map coordinates = coordinates in this file" in head.replace("\n", "")) is any(offset)
    for name, one in surfaces.items():
        again = read_surface(path, name)
        assert np.abs(again.distance(one.points.xyz) - one.accuracy.residuals).max() < 1e-6
        at = one.points.xyz[:, :2]
        assert np.nanmax(np.abs(again.elevation(*at.T) - one.elevation(*at.T))) < 1e-6


def test_a_changed_offset_is_found_out(surfaces, tmp_path):
    from geofit.cad.imported import surface_of
    from geofit.cad.read_back import read_back
    from geofit.cad.sewing import shell
    from geofit.cad.step_origin import offset_attributes

    one, path = {"T2": surfaces["T2"]}, tmp_path / "dam.step"
    write_step(one, path, origin="local")
    text = path.read_text("ascii")
    assert text.count("'534500'") == 1
    path.write_text(text.replace("'534500'", "'534400'"), "ascii")
    (shape,) = read_shapes(path)
    stated = offset_attributes(np.array([534_500.0, 3_123_400.0, 0.0]))
    back = read_back(one["T2"], shape, surface_of(shape, whole=True), shell(one["T2"]), path, stated)
    assert {check.name for check in back.checks if check.passed is False} >= {"read-back attributes"}
    assert not back.passed


def test_files_of_their_own_share_one_offset(surfaces, tmp_path):
    signed = Signed(origin="local")
    files = write_step_files(surfaces, tmp_path / "dam.step", "m", True, signed, progress=lambda *_: True)
    offsets = [offset_at(read_shapes(file.path)[0].attributes).tolist() for file in files]
    assert offsets == [[534_500.0, 3_123_100.0, 0.0]] * 2


@pytest.mark.parametrize("origin", ["here", (1.0, 2.0), (1.0, 2.0, np.nan), (1.0, 2.0, "x"), None, 5])
def test_other_origins_are_refused(surfaces, tmp_path, origin):
    with pytest.raises(SettingsError, match="easting, northing and elevation"):
        write_step(surfaces, tmp_path / "dam.step", origin=origin)
    assert not list(tmp_path.iterdir())


def test_places_near_zero_and_negative_ones_are_rounded_down():
    assert offset_of("local", [(-120.0, 99.0, -5.0)]).tolist() == [-200.0, 0.0, 0.0]
    assert offset_of("local", [(250.0, 10.0, 1.0), (199.0, 400.0, 1.0)]).tolist() == [100.0, 0.0, 0.0]


def test_only_step_files_have_an_origin(surfaces, tmp_path):
    (path,) = geofit.io.write_surface(surfaces, tmp_path / "dam.step", origin="local")
    assert offset_at(read_shapes(path)[0].attributes).any()
    with pytest.raises(SettingsError, match="in map coordinates"):
        geofit.io.write_surface(surfaces, tmp_path / "dam.obj", origin="local")


def certificate_text(path):
    pdfium = pytest.importorskip("pypdfium2", reason="PDFium reads the PDF back; it comes with the extra 'test'")
    pdf = pdfium.PdfDocument(path)
    try:
        assert len(pdf) == 1
        return " ".join(pdf[0].get_textpage().get_text_range().split())
    finally:
        pdf.close()


def test_the_certificate_states_the_offset(surfaces, tmp_path):
    for origin, words in (("map", "map coordinates"), (DATUM, "E 500000.5, N 3100000.25, Z 1400.125")):
        signed = Signed("M. Weber", "Dam Office", "en", origin)
        (file,) = write_step_files(surfaces, tmp_path / "dam.step", "m", False, signed, progress=lambda *_: True)
        assert words in certificate_text(file.certificate)

    assert ZH("map coordinates") != "map coordinates"


@pytest.fixture(scope="module")
def body():
    tables = [BODIES / f"{table}.csv" for table in ("collar", "survey", "lithology")]
    return fit_body(read_boreholes(*tables[:2], tables[2:], dip="down-positive"), codes="VOID", name="空区 'V'")


@pytest.mark.parametrize("nurbs", [True, False])
def test_a_body_has_name_colour_attributes_and_origin(body, tmp_path, nurbs):
    path = tmp_path / "body.step"
    signed = Signed("M. Weber", "Dam Office", "en", "local").about([body.extent[0] + body.origin])
    found = body.write_step(path, nurbs=nurbs, colour="#5a91cf", **signed.fields)
    assert found.passed
    checks = {check.name: check for check in found.checks}
    assert checks["place"].value < 1e-6
    assert checks["read-back attributes"].passed
    (shape,) = read_shapes(path)
    assert shape.name == body.name
    accuracy = body.accuracy
    assert float(shape.attributes["sigma_m"]) == pytest.approx(accuracy.sigma, rel=1e-5)
    assert float(shape.attributes["epsilon_m"]) == accuracy.epsilon
    assert int(shape.attributes["points"]) == len(body.contacts)
    assert len(shape.attributes["data_sha256"]) == 64
    text = path.read_text("ascii").replace("\n", "")
    assert "('M. Weber'),('Dam Office')" in text
    assert [float(c) for c in re.findall(r"COLOUR_RGB\('',([^)]*)\)", text)[0].split(",")] == pytest.approx(
        [0x5A / 255, 0x91 / 255, 0xCF / 255], abs=1e-4
    )
    vertices = read_solids(path)[body.name].vertices
    mesh = body.triangulate().vertices
    assert np.abs(vertices.min(axis=0) - mesh.min(axis=0)).max() < 1.0
    assert np.abs(vertices.max(axis=0) - mesh.max(axis=0)).max() < 1.0
    again = tmp_path / "again.step"
    body.write_step(again, nurbs=nurbs, colour="#5a91cf", **signed.fields)
    assert again.read_bytes() == path.read_bytes()
    page = certified(path, {body.name: found}, {body.name: body.epsilon}, signed)
    easting = format(signed.offset[0], ".15g")
    text = certificate_text(page)
    for words in ("Body", f"E {easting}", "solids in it were compared", found.sha256[:32]):
        assert words in text, words
