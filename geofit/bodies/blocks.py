"""Block model of a body: cubic blocks around it, and the chance that each lies inside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.posterior import BodyPosterior
from geofit.data.errors import SettingsError
from geofit.data.messages import message
from geofit.implicit.lattice import Lattice

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["BlockModel", "block_lattice", "block_model"]

Floats = NDArray[np.float64]

#: Blocks along the longest side of the body by default, and the most in all.
BLOCKS = 48
MOST = 5_000_000


@dataclass(frozen=True, eq=False)
class BlockModel:
    """Cubic blocks in map coordinates.

    ``centres`` (n, 3) with z fastest; ``spacing`` is the edge in metres, ``shape`` the blocks along x, y, z; ``value``
    (n,) is the field at each centre, negative inside, and ``probability`` (n,) the chance that the centre lies inside;
    nan where it is not estimated (:meth:`geofit.bodies.posterior.BodyPosterior.probability`).
    """

    centres: Floats
    spacing: float
    shape: tuple[int, int, int]
    value: Floats
    probability: Floats


def block_lattice(body: BodyFit, spacing: float | None = None) -> Lattice:
    """Return nodes about the local origin that cover the body; they lie at whole multiples of the spacing on the map.

    Raises
    ------
    SettingsError
        If the spacing is not a length, or gives more than five million nodes.
    """
    lower, upper = body.extent
    longest = float((upper - lower).max())
    spacing = longest / BLOCKS if spacing is None else spacing
    if not (np.isfinite(spacing) and spacing > 0) or float(np.prod((upper - lower) / spacing + 2)) > MOST:
        least = float(np.prod(upper - lower) / MOST) ** (1 / 3)
        raise SettingsError(
            message(
                "bodies.block-size-unusable",
                "Blocks of {spacing} m cannot be used for a body {size:.1f} m long: at most {most} blocks are made, "
                "so give {least:.3g} m or more.",
                spacing=spacing,
                size=longest,
                most=MOST,
                least=1.1 * least,
            )
        )
    first = np.floor((lower + body.origin) / spacing) * spacing
    counts = np.maximum(np.ceil((upper + body.origin - first) / spacing).astype(int) + 1, 2)
    return Lattice(first - body.origin, spacing, (int(counts[0]), int(counts[1]), int(counts[2])))


def block_model(body: BodyFit, spacing: float | None = None) -> BlockModel:
    """Return the blocks around a body.

    Parameters
    ----------
    body : BodyFit
        The body.
    spacing : float, optional
        Edge of the blocks, metres; by default 1/48 of the longest side of the body. Centres lie at whole multiples.

    Raises
    ------
    SettingsError
        If the spacing is not a length, or gives more than five million blocks.
    """
    lattice = block_lattice(body, spacing)
    local = lattice.nodes()
    centres = local + body.origin
    return BlockModel(
        centres, lattice.spacing, lattice.shape, body.field.value(local), BodyPosterior(body).probability(centres)
    )
