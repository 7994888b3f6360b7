"""The solution of the Laplace equation: pieces of blocks, and how few steps their correction leaves."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import ndimage

from geofit.pores import RockVolume
from geofit.pores.laplace import mobility
from geofit.pores.laplace_loops import assemble
from geofit.pores.laplace_solve import conjugate_gradients, pieces_in_blocks


def equations(seed):
    """Return links, diagonal, sources, voxels and mask of the blobs that connect the faces of the first axis."""
    noise = ndimage.gaussian_filter(np.random.default_rng(seed).normal(size=(60, 60, 60)), 2.5)
    pore = noise < np.quantile(noise, 0.3)
    label = np.asarray(ndimage.label(pore)[0])
    inside = np.isin(label, np.intersect1d(label[0][label[0] > 0], label[-1][label[-1] > 0]))
    order = np.flatnonzero(inside)
    number = np.full(pore.shape, -1, np.int32)
    number.ravel()[order] = np.arange(len(order))
    weights = mobility(RockVolume(pore, pore=True, voxel=1.0))[0][inside[pore]]
    return *assemble(weights, number, order, 0, np.ones(3)), order, inside


def test_pieces_are_connected_within_their_blocks():
    links, _, _, order, inside = equations(1)
    piece = pieces_in_blocks(links[0], order, inside.shape)
    place = np.stack(np.unravel_index(order, inside.shape))
    blocks = set()
    for number in range(piece.max() + 1):
        mine = place[:, piece == number]
        (block,) = {tuple(at) for at in (mine // 6).T.tolist()}
        blocks.add(block)
        mask = np.zeros(inside.shape, bool)
        mask[tuple(mine)] = True
        box = tuple(slice(low, high + 1) for low, high in zip(mine.min(axis=1), mine.max(axis=1), strict=True))
        assert ndimage.label(mask[box])[1] == 1
    assert len(blocks) < piece.max() + 1  # some blocks hold several


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_few_steps_reach_the_flow_of_many(seed):
    links, diagonal, source, order, inside = equations(seed)
    start = 1.0 - (np.unravel_index(order, inside.shape)[0] + 0.5) / len(inside)
    piece = pieces_in_blocks(links[0], order, inside.shape)
    _, flow, steps = conjugate_gradients(links, diagonal, source[0], piece, start, 1e-3, 5000)
    _, exact, _ = conjugate_gradients(links, diagonal, source[0], piece, start, 1e-13, 5000)
    assert flow == pytest.approx(exact, rel=1e-3)
    assert 0 < steps <= 75
    # Without the correction, all voxels in one piece, it takes at least twice as many.
    one = np.zeros_like(piece)
    _, slow, more = conjugate_gradients(links, diagonal, source[0], one, start, 1e-3, 5000)
    assert slow == pytest.approx(exact, rel=5e-3)
    assert more >= 2 * steps
    assert conjugate_gradients(links, diagonal, source[0], piece, start, 1e-13, 5)[2] == -1
