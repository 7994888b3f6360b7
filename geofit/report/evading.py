"""A word next to a place in a picture, where it covers no other text."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.text import Annotation, Text
from matplotlib.transforms import Bbox

__all__ = ["EvadingWord"]

#: Points between the place and the word, and pixels between two texts.
_REACHES = (4.5, 8.0, 12.0, 18.0, 25.0)
_GAP = 1.0
#: Right and above first, as a word next to a point is read; then round the point.
_SIDES = ((1, 1), (1, 0), (1, -1), (0, 1), (0, -1), (-1, 1), (-1, 0), (-1, -1))
_ACROSS = {1: "left", 0: "center", -1: "right"}
_UP = {1: "bottom", 0: "center", -1: "top"}


class EvadingWord(Annotation):
    """A word that takes its side of a place when it is drawn: not before are sizes and scales known.

    Parameters
    ----------
    axes : Axes
    text : str
    place : (float, float)
        In the coordinates of the axes.
    texts : sequence of Text
        Texts of the axes that it must not cover; those before it in a list of such words are among them.
    marks : (m, 2) array
        Places whose marks it must not cover.
    mark_size : float
        Points.
    """

    def __init__(
        self,
        axes: Axes,
        text: str,
        place: tuple[float, float],
        texts: Sequence[Text],
        marks: np.ndarray,
        mark_size: float,
        **look: Any,
    ) -> None:
        super().__init__(text, place, xytext=(0, 0), textcoords="offset points", **look)
        self._texts, self._marks, self._mark_size = tuple(texts), marks, mark_size
        axes.add_artist(self)

    def draw(self, renderer: RendererBase) -> None:
        """Draw the word at the nearest side that is free."""
        self._choose_side(renderer)
        super().draw(renderer)

    def _choose_side(self, renderer: RendererBase) -> None:
        axes = self.axes
        assert axes is not None
        half = renderer.points_to_pixels(self._mark_size / 2)
        taken = [text.get_window_extent(renderer) for text in self._texts if text.get_visible()]
        taken += [Bbox([at - half, at + half]) for at in axes.transData.transform(self._marks)]
        least = np.inf
        for reach, (across, up) in product(_REACHES, _SIDES):
            tried = {"position": (across * reach, up * reach), "ha": _ACROSS[across], "va": _UP[up]}
            self.set(**tried)
            box = self.get_window_extent(renderer).padded(_GAP)
            covered = sum(_common(box, other) for other in taken) + _beyond(box, axes.bbox)
            if covered < least:
                least, best = covered, tried
            if covered == 0:
                return
        self.set(**best)


def _common(box: Bbox, other: Bbox) -> float:
    """Return the area that two boxes have in common."""
    both = Bbox.intersection(box, other)
    return 0.0 if both is None else float(both.width * both.height)


def _beyond(box: Bbox, frame: Bbox) -> float:
    """Return the area of a box outside a frame, where other words are."""
    return max(float(box.width * box.height) - _common(box, frame), 0.0)
