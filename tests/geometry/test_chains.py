"""Pieces of curves in any order and direction become the lines that they were cut from."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.geometry.chains import chains_of


def canonical(chain):
    """A line or a ring, whatever its direction and its first end."""
    chain = np.asarray(chain).tolist()
    if chain[0] != chain[-1]:
        return tuple(min(chain, chain[::-1]))
    ring = chain[:-1]
    turns = [way[k:] + way[:k] for way in (ring, ring[::-1]) for k in range(len(ring))]
    return ("ring", *min(turns))


@pytest.mark.parametrize("seed", range(20))
def test_shuffled_pieces_make_the_lines_again(seed):
    rng = np.random.default_rng(seed)
    numbers = rng.permutation(200)
    lines, first = [], 0
    for size in rng.integers(3, 20, 9):
        line = numbers[first : first + size].tolist()
        lines.append([*line, line[0]] if rng.random() < 0.5 else line)
        first += size
    pairs = np.concatenate([np.column_stack([line[:-1], line[1:]]) for line in lines])
    pairs = rng.permutation(pairs)
    turned = rng.random(len(pairs)) < 0.5
    pairs[turned] = pairs[turned, ::-1]
    found = chains_of(pairs, 200)
    assert sorted(map(str, map(canonical, found))) == sorted(map(str, map(canonical, lines)))
    closed = [bool(chain[0] == chain[-1]) for chain in found]
    assert closed == sorted(closed), "open lines first"


def test_each_piece_is_used_once_where_lines_cross():
    pairs = np.array([[0, 2], [2, 1], [3, 2], [2, 4]])
    found = chains_of(pairs, 5)
    assert [chain.tolist() for chain in found] == [[0, 2, 1], [3, 2, 4]]


def test_nothing_makes_nothing():
    assert chains_of(np.empty((0, 2), int), 3) == []
