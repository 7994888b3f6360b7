"""How a section fills its drawing: how much higher elevations are drawn, and what is seen. Plain numbers."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["SectionExtent", "automatic", "grown", "window"]

Range = tuple[float, float]

#: Vertical exaggerations that are chosen by themselves, largest first.
NICE = (100.0, 50.0, 20.0, 10.0, 5.0, 2.0)
#: Share of the width that a section keeps at least, where it is drawn higher by itself.
LEAST = 0.5
#: Room at each end of the section, as a share of its length, and above and below it, logical pixels.
ENDS, EDGE = 0.015, 4.0


@dataclass(frozen=True)
class SectionExtent:
    """What a section holds: its length, lowest and highest elevation, metres; names of so many pixels over a ``head``.

    ``head`` is the elevation of the highest place that has a name.
    """

    length: float
    low: float
    high: float
    head: float = 0.0
    names: float = 0.0

    def rise(self, upwards: float) -> float:
        """Return the height of the whole, at so many pixels a metre of elevation."""
        named = (self.head - self.low) * upwards + self.names if self.names else 0.0
        return max((self.high - self.low) * upwards, named, 1e-3)

    def scale(self, size: tuple[float, float], factor: float) -> float:
        """Return the most pixels a metre along the section with which all of it is seen."""
        wide, room = size[0] / (self.length * (1 + 2 * ENDS)), size[1] - 2 * EDGE
        by_height = room / (factor * max(self.high - self.low, 1e-3))
        if self.names and self.head > self.low:
            by_height = min(by_height, (room - self.names) / (factor * (self.head - self.low)))
        return max(min(wide, by_height), 1e-3 * wide)


def automatic(seen: SectionExtent, size: tuple[float, float]) -> float:
    """Return the largest of 1, 2, 5, 10, 20, 50, 100 with which a section still takes most of its drawing's width.

    Examples
    --------
    >>> flat, steep = SectionExtent(2000.0, 1300.0, 1400.0), SectionExtent(500.0, 1000.0, 1500.0)
    >>> automatic(flat, (800.0, 160.0)), automatic(steep, (800.0, 160.0))
    (5.0, 1.0)
    """
    widest = size[0] / (seen.length * (1 + 2 * ENDS))
    return next((factor for factor in NICE if seen.scale(size, factor) >= LEAST * widest), 1.0)


def window(seen: SectionExtent, size: tuple[float, float], factor: float) -> tuple[Range, Range]:
    """Return the distances and elevations at the edges of a drawing, ``size`` in logical pixels, that shows it all.

    A metre of elevation is drawn ``factor`` times as long as a metre along the section.
    """
    scale = seen.scale(size, factor)
    upwards = scale * factor
    beside = (size[0] / scale - seen.length) / 2
    spare = (size[1] - seen.rise(upwards)) / 2
    bottom = seen.low - spare / upwards
    return (-beside, seen.length + beside), (bottom, bottom + size[1] / upwards)


def grown(beside: Range, levels: Range, old: tuple[float, float], new: tuple[float, float]) -> tuple[Range, Range]:
    """Return the edges of a drawing of another size: about the same middle, at the same scales."""

    def about(edges: Range, share: float) -> Range:
        middle, half = (edges[0] + edges[1]) / 2, (edges[1] - edges[0]) / 2
        return middle - share * half, middle + share * half

    return about(beside, new[0] / old[0]), about(levels, new[1] / old[1])
