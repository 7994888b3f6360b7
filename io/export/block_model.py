"""Block model of a body as CSV: centre, edge, field and chance of lying inside."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING

from geofit.bodies.blocks import block_model
from geofit.data.files import replacing

if TYPE_CHECKING:
    from geofit.bodies.body import ImplicitBody

__all__ = ["write_block_model"]


def write_block_model(body: ImplicitBody, path: str | PathLike[str], spacing: float | None = None) -> None:
    """Write every block around a body.

    Columns: ``x``, ``y``, ``z`` of the centre in map coordinates and the edge ``size``, metres; ``field``, negative
    inside, near the surface about the distance in metres; ``probability`` that the centre lies inside.

    Parameters
    ----------
    body : ImplicitBody
        The body.
    path : path
        The file.
    spacing : float, optional
        Edge of the blocks, metres; by default 1/48 of the longest side of the body.

    Raises
    ------
    SettingsError
        If the spacing is not a length, or gives more than five million blocks.
    """
    model = block_model(body, spacing)
    rows = zip(*model.centres.T.tolist(), model.value.tolist(), model.probability.tolist(), strict=True)
    with replacing(path) as part, part.open("w", encoding="utf-8", newline="\n") as out:
        out.write("x,y,z,size,field,probability\n")
        out.writelines(f"{x:.4f},{y:.4f},{z:.4f},{model.spacing:.4f},{f:.6g},{p:.4f}\n" for x, y, z, f, p in rows)
