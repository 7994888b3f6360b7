"""Attributes of the products in a STEP file, which CAD systems list with each surface.

Each is a user-defined attribute of the product (ISO 10303-41, general property; CAx-IF, *Recommended Practices for User
Defined Attributes*): a named text. OpenCASCADE reads them as the metadata of the product.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit import __version__
from geofit.cad.step_origin import OFFSET_KEYS
from geofit.cad.step_text import products_of
from geofit.data.accuracy import Accuracy
from geofit.geometry.area import fault_of_area
from geofit.implicit.closed_body import ClosedBody
from geofit.surfaces.protocol import FittedSurface

__all__ = [
    "CONTINUED",
    "KEYS",
    "attributes_at",
    "attributes_of",
    "attributes_of_body",
    "places_hash",
    "stated_frame",
    "stated_outline",
    "with_attributes",
]

Floats = NDArray[np.float64]

#: Names of the attributes, in the order of the file.
KEYS = (
    "sigma_m",
    "epsilon_m",
    "largest_residual_m",
    "points",
    "data_sha256",
    "geofit_version",
    "frame",
    "beyond_loops",
    "outline",
)
#: What ``beyond_loops`` states of a fit that ends at an outline: its patches continue beneath the loops of the faces.
CONTINUED = "continued"
#: Frames that a file states: the shape alone does not show whether a fold, or an upright surface, is meant.
STATED = ("best-plane", "sections")

_ATTRIBUTE = """\
#{0} = GENERAL_PROPERTY('user defined attribute','{key}','');
#{1} = PROPERTY_DEFINITION('{key}','',#{product});
#{2} = GENERAL_PROPERTY_ASSOCIATION('','',#{0},#{1});
#{3} = PROPERTY_DEFINITION_REPRESENTATION(#{1},#{4});
#{4} = REPRESENTATION('{key}',(#{5}),#{context});
#{5} = DESCRIPTIVE_REPRESENTATION_ITEM('{key}','{value}');
"""
_LINES = 6


def attributes_of(surface: FittedSurface) -> dict[str, str]:
    """Return the attributes of a fitted surface; without points or a check those of them are missing."""
    found, accuracy = {"geofit_version": __version__}, surface.accuracy
    if surface.frame in STATED:
        found["frame"] = surface.frame
    if surface.outline is not None and not any(surface.loops):
        found["beyond_loops"] = CONTINUED
        if surface.frame in STATED:
            # Of a height field it is the loop of the free edges.
            found["outline"] = " ".join(f"{x:.7f},{y:.7f}" for x, y in surface.outline.tolist())
    if len(surface.points):
        found |= {"points": str(len(surface.points)), "data_sha256": places_hash(surface.points.xyz)}
    return _in_order(found, accuracy)


def attributes_of_body(body: ClosedBody) -> dict[str, str]:
    """Return the attributes of a body: its points are the contacts; what was not fitted has no sigma."""
    found = {"geofit_version": __version__}
    if len(body.contacts):
        found |= {"points": str(len(body.contacts)), "data_sha256": places_hash(body.contacts)}
    return _in_order(found, getattr(body, "accuracy", None))


def _in_order(found: dict[str, str], accuracy: Accuracy | None) -> dict[str, str]:
    if accuracy is not None and accuracy.n:
        found["sigma_m"] = f"{accuracy.sigma:.6g}"
        found["epsilon_m"] = f"{accuracy.epsilon:.6g}"
        found["largest_residual_m"] = f"{accuracy.max_abs:.6g}"
    return {key: found[key] for key in KEYS if key in found}


def stated_frame(attributes: Mapping[str, str]) -> str:
    """Return the frame that a product states, "" where it states none."""
    frame = attributes.get("frame", "")
    return frame if frame in STATED else ""


def stated_outline(attributes: Mapping[str, str]) -> Floats | None:
    """Return the outline (k, 2) that a product states, map coordinates; None where it states none that can be used."""
    try:
        corners = [[float(number) for number in corner.split(",")] for corner in attributes["outline"].split()]
        outline = np.array(corners, dtype=np.float64)
    except (KeyError, ValueError):
        return None
    usable = outline.ndim == 2 and outline.shape[1] == 2 and len(outline) >= 3 and np.isfinite(outline).all()
    return outline if usable and fault_of_area(outline) is None else None


def places_hash(xyz: NDArray[np.float64]) -> str:
    """Return the SHA-256 of the points (n, 3) of a fit: easting, northing and elevation as float64."""
    return hashlib.sha256(np.ascontiguousarray(xyz, dtype="<f8").tobytes()).hexdigest()


def with_attributes(text: str, attributes: Sequence[Mapping[str, str]]) -> str:
    """Return the text of a STEP file of ours with attributes of its products, in the products' order."""
    head, end, tail = text.rpartition("ENDSEC;")
    free = max(int(number) for number in re.findall(r"^#(\d+) =", head, re.M)) + 1
    added = []
    for (product, context), values in zip(products_of(head), attributes, strict=True):
        for key, value in values.items():
            numbers = range(free, free + _LINES)
            free += _LINES
            quoted = value.replace("\\", "\\\\").replace("'", "''")
            added.append(_ATTRIBUTE.format(*numbers, key=key, value=quoted, product=product, context=context))
    return head + "".join(added) + end + tail


def attributes_at(label: Any) -> dict[str, str]:
    """Return our attributes of a product that OpenCASCADE has read."""
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_NamedData

    data = TDataStd_NamedData()
    if not label.FindAttribute(TDataStd_NamedData.GetID_s(), data):
        return {}
    found = {}
    for key in (*KEYS, *OFFSET_KEYS):
        name = TCollection_ExtendedString(key)
        if data.HasString(name):
            found[key] = str(data.GetString(name).ToExtString())
    return found
