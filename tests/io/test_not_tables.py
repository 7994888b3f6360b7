"""What is given for a table and is a model, a mesh, a drawing or a document is refused by what it is."""

from __future__ import annotations

import gzip

import numpy as np
import pytest
from surfaces import height_field, horizon

from geofit.data.errors import InputError
from geofit.io import read_points

IGES = "\n".join(f"{text:<72}{letter}{1:7d}" for text, letter in [("a surface", "S"), ("1H,,1H;,6Hgeofit", "G")]) + "\n"
BEGINNINGS = {
    "a STEP model": "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('x'),'2;1');\n",
    "an IGES model": IGES,
    "an OpenCASCADE shape": "\nDBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\n",
    "an STL mesh": "solid dam\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n",
    "a PLY mesh": "ply\nformat ascii 1.0\nelement vertex 3\n",
    "an OBJ mesh": "# dam\no dam\nv 500000 3100000 1\nv 500010 3100000 2\nv 500010 3100010 3\nf 1 2 3\n",
    "a GOCAD object": "GOCAD TSurf 1\nHEADER {\nname: a\n}\n",
    "a VTK file": "# vtk DataFile Version 3.0\nx\nASCII\n",
    "a DXF drawing": "  0\nSECTION\n  2\nHEADER\n",
    "an XML or HTML document": "<?xml version='1.0'?>\n<kml><Placemark/></kml>\n",
    "a JSON document": '{"horizon": "T",\n "points": [[1, 2, 3]]}\n',
    "a PDF document": "%PDF-1.7\n1 0 obj\n",
    "a Compass survey": "Fulford Cave\r\nSURVEY NAME: A\r\nSURVEY DATE: 6 29 1987\r\n",
    "a Survex survey": "; entrance\n\n*begin fulford\n*data normal from to tape compass clino\n",
}


@pytest.mark.parametrize("what", BEGINNINGS)
@pytest.mark.parametrize("start", ["", "\ufeff"])
def test_a_file_that_is_no_table_is_named(what, start, tmp_path):
    (tmp_path / "points.csv").write_text(start + BEGINNINGS[what], encoding="utf-8")
    with pytest.raises(InputError) as told:
        read_points(tmp_path / "points.csv")
    assert told.value.code == "io.file-not-table"
    assert f"The file is {what}, not a table" in str(told.value)


@pytest.mark.parametrize("suffix", ["step", "igs", "brep", "stl", "obj", "ply", "vtp", "dxf"])
def test_what_geofit_writes_is_not_read_back_as_points(suffix, tmp_path):
    from geofit.io import write_surface

    path = tmp_path / f"a.{suffix}"
    write_surface(horizon([height_field()]).surface, path)
    with pytest.raises(InputError) as told:
        read_points(path)
    assert told.value.code in ("io.file-not-table", "io.not-text")


@pytest.mark.parametrize("name", ["1003_s.step", "2802_s.igs", "666_s.igs", "4612_s.brep", "4651_s.brep"])
def test_damaged_models_are_named_too(name, real_data):
    with pytest.raises(InputError) as told:
        read_points(real_data / "hostile" / name)
    assert told.value.code == "io.file-not-table"


@pytest.mark.parametrize(
    "text",
    [
        "v x y z\n1 500000 3100000 1\n2 500010 3100000 2\n3 500010 3100010 3\n4 500000 3100010 4\n",
        "# vtk of yesterday\nx,y,z\n500000,3100000,1\n500010,3100000,2\n500010,3100010,3\n500000,3100010,4\n",
        "solid,x,y,z\n1,500000,3100000,1\n1,500010,3100000,2\n1,500010,3100010,3\n1,500000,3100010,4\n",
        "500000 3100000 1\n500010 3100000 2\n500010 3100010 3\n500000 3100010 4\n",
    ],
)
def test_tables_that_resemble_them_are_read(text, tmp_path):
    (tmp_path / "points.csv").write_text(text)
    (points,) = read_points(tmp_path / "points.csv").horizons.values()
    assert np.array_equal(np.sort(points.xyz[:, 2]), [1, 2, 3, 4])


def test_a_compressed_table_is_named(tmp_path):
    (tmp_path / "points.csv.gz").write_bytes(gzip.compress(b"x,y,z\n1,2,3\n"))
    with pytest.raises(InputError) as told:
        read_points(tmp_path / "points.csv.gz")
    assert told.value.code == "io.compressed-not-text"
