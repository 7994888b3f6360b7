"""LandXML 1.2: horizons as TIN surfaces."""

from __future__ import annotations

import re
from collections.abc import Mapping
from os import PathLike
from xml.sax.saxutils import quoteattr

import numpy as np

from geofit import __version__
from geofit.data.errors import InputError
from geofit.data.files import replacing
from geofit.data.legible import legible_keys
from geofit.data.messages import message
from geofit.geometry.mesh import Mesh

__all__ = ["write_landxml"]


def write_landxml(meshes: Mapping[str, Mesh], path: str | PathLike[str]) -> None:
    """Write TIN surfaces; points are northing, easting, elevation to 1e-6 m, as the schema has it.

    Raises
    ------
    InputError
        If a surface is not single-valued, or upright: a TIN has one elevation a place.
    """
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        # The schema demands date and time; fixed, so that the same surfaces give the same bytes.
        '<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2" version="1.2" date="2000-01-01" '
        'time="00:00:00" language="English" readOnly="false">',
        '<Units><Metric linearUnit="meter" areaUnit="squareMeter" volumeUnit="cubicMeter" '
        'temperatureUnit="celsius" pressureUnit="milliBars" diameterUnit="meter"/></Units>',
        f'<Application name="geofit" version="{__version__}"/>',
        "<Surfaces>",
    ]
    for name, mesh in legible_keys(meshes).items():
        xyz, corners = mesh.xyz, mesh.points[mesh.triangles, :2]
        (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
        area = ax * by - ay * bx
        if area.min() <= 0 <= area.max():
            raise InputError(
                message(
                    "io.surface-overturned",
                    "'{name}' is upright or overturned in places; a LandXML TIN has one elevation a place",
                    name=name,
                ),
                message("io.write-other-format", "Write it as STEP, OBJ or GOCAD TSurf."),
                file=str(path),
            )
        triangles = mesh.triangles if area.min() > 0 else mesh.triangles[:, ::-1]
        low, high = xyz[:, 2].min(), xyz[:, 2].max()
        title = quoteattr(re.sub(r"[\x00-\x1f]", " ", name))
        lines.append(
            f'<Surface name={title}><Definition surfType="TIN" area2DSurf="{np.abs(area).sum() / 2:.3f}" '
            f'elevMax="{high:.6f}" elevMin="{low:.6f}">'
        )
        lines.append("<Pnts>")
        lines += [f'<P id="{k}">{y:.6f} {x:.6f} {z:.6f}</P>' for k, (x, y, z) in enumerate(xyz.tolist(), 1)]
        lines.append("</Pnts>")
        lines.append("<Faces>")
        lines += [f"<F>{a} {b} {c}</F>" for a, b, c in (triangles + 1).tolist()]
        lines.append("</Faces>")
        lines.append("</Definition></Surface>")
    lines += ["</Surfaces>", "</LandXML>"]
    with replacing(path) as part:
        part.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
