"""Field of a body as VTK XML image data (.vti), double precision, map coordinates."""

from __future__ import annotations

import base64
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.blocks import block_lattice
from geofit.bodies.posterior import BodyPosterior
from geofit.data.files import replacing
from geofit.implicit.lattice import sample

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["write_vti"]


def write_vti(
    body: BodyFit, path: str | PathLike[str], spacing: float | None = None, *, probability: bool = True
) -> None:
    """Write the field of a body at the nodes of a raster around it.

    Point arrays: ``field``, negative inside, near the surface about the distance in metres; ``probability`` of lying
    inside, nan where it is not estimated (:meth:`geofit.bodies.posterior.BodyPosterior.probability`).

    Parameters
    ----------
    body : BodyFit
        The body.
    path : path
        The file.
    spacing : float, optional
        Distance of the nodes, metres; by default 1/48 of the longest side of the body.
    probability : bool
        Whether to write it: it costs more than the field.

    Raises
    ------
    SettingsError
        If the spacing is not a length, or gives more than five million nodes.
    """
    lattice = block_lattice(body, spacing)
    arrays = {"field": sample(body.field, lattice)}
    if probability:
        arrays["probability"] = BodyPosterior(body).probability(lattice.nodes() + body.origin).reshape(lattice.shape)
    whole = " ".join(f"0 {n - 1}" for n in lattice.shape)
    origin = " ".join(map(repr, (lattice.origin + body.origin).tolist()))
    step = " ".join([repr(lattice.spacing)] * 3)
    parts = [
        '<?xml version="1.0"?>',
        '<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
        f'<ImageData WholeExtent="{whole}" Origin="{origin}" Spacing="{step}">',
        f'<Piece Extent="{whole}">',
        '<PointData Scalars="field">',
        *(_array(name, values) for name, values in arrays.items()),
        "</PointData>",
        "</Piece>",
        "</ImageData>",
        "</VTKFile>",
    ]
    with replacing(path) as part:
        part.write_text("\n".join(parts) + "\n", encoding="utf-8", newline="\n")


def _array(name: str, values: NDArray[np.float64]) -> str:
    """Return a data array, x fastest, as base64 behind the count of its bytes."""
    raw = values.astype("<f8").tobytes(order="F")
    text = base64.b64encode(np.uint64(len(raw)).astype("<u8").tobytes() + raw).decode()
    return f'<DataArray type="Float64" Name="{name}" format="binary">{text}</DataArray>'
