"""Models, meshes, drawings and documents given for a text table: told by how they begin, and refused."""

from __future__ import annotations

import re

from geofit.data.errors import InputError
from geofit.data.messages import message

__all__ = ["require_table"]

#: As far as the header of a model may reach.
_HEAD = 4096
_NUMBER = rb"\s+[-+.\deE]+"
_KINDS = (
    (message("io.kind-step-model", "a STEP model"), rb"\s*ISO-10303-21\s*;"),
    (message("io.kind-iges-model", "an IGES model"), rb"([^\r\n]{72}[SGDP][ 0-9]{6}\d\s*[\r\n]+){2}"),
    (message("io.kind-opencascade-shape", "an OpenCASCADE shape"), rb"\s*(DBRep_DrawableShape|CASCADE Topology)"),
    (message("io.kind-stl-mesh", "an STL mesh"), rb"\s*solid\b[^\n]*\n\s*facet\s+normal"),
    (message("io.kind-ply-mesh", "a PLY mesh"), rb"ply\r?\n"),
    (
        message("io.kind-obj-mesh", "an OBJ mesh"),
        rb"(\s*(#|o |g |s |mtllib )[^\n]*\n)*\s*v" + 3 * _NUMBER + rb"\s*\n\s*v[nt]?\s",
    ),
    (message("io.kind-gocad-object", "a GOCAD object"), rb"\s*GOCAD\s+\w+\s+\d"),
    (message("io.kind-vtk-file", "a VTK file"), rb"# vtk DataFile"),
    (message("io.kind-dxf-drawing", "a DXF drawing"), rb"(\s*999\r?\n[^\n]*\n)*\s*0\r?\n\s*SECTION\s"),
    (message("io.kind-xml-document", "an XML or HTML document"), rb"\s*<(\?xml|!DOCTYPE|html|VTKFile|svg|kml)\b"),
    (message("io.kind-json-document", "a JSON document"), rb"\s*\{\s*\"[^\"]*\"\s*:"),
    (message("io.kind-pdf-document", "a PDF document"), rb"%PDF-"),
    (message("io.kind-picture", "a picture"), rb"\x89PNG|\xff\xd8\xff|GIF8|II\*\0|MM\0\*"),
)
#: Surveys of caves: their stations are not points of a horizon.
_SURVEYS = (
    (message("io.kind-compass-survey", "a Compass survey"), rb"[^\r\n]*\r?\n\s*SURVEY NAME:"),
    (
        message("io.kind-survex-survey", "a Survex survey"),
        rb"(\s*(;[^\n]*)?\n)*\s*\*(begin|include|export|fix|data|units|cs|title)\b",
    ),
)


def require_table(data: bytes, name: str) -> None:
    """Refuse a file that is a model, a mesh, a drawing or a document: its numbers are not a table of points.

    Raises
    ------
    InputError
        If the file begins as one of these.
    """
    head = bytes(data[:_HEAD]).removeprefix(b"\xef\xbb\xbf")
    for what, pattern in (*_KINDS, *_SURVEYS):
        if re.match(pattern, head, re.IGNORECASE):
            remedy = message(
                "io.give-table", "Give a table of points or holes (CSV, XLSX); geofit info reads models and meshes."
            )
            if (what, pattern) in _SURVEYS:
                remedy = message("io.read-with-cave", "geofit cave reads it.")
            reason = message("io.file-not-table", "The file is {what}, not a table", what=what)
            raise InputError(reason, remedy, file=name)
