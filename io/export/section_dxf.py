"""A section sheet as DXF (R2010): sections one below the other, x the distance and y the elevation."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.files import file_stems
from geofit.data.languages import EN, Language, translate
from geofit.data.lengths import LengthUnit, in_unit
from geofit.data.stale import stale_warning
from geofit.io.export.dxf import drawing_of
from geofit.site.section_view import HoleTrack, SectionView, lithologies

if TYPE_CHECKING:
    from ezdxf.layouts import Modelspace

__all__ = ["write_sheet_dxf"]

Floats = NDArray[np.float64]

#: Layers that belong to no horizon, with their colours; names of horizons are told apart from them.
GROUND, HOLES, FRAME, TEXT = "GROUND", "HOLES", "FRAME", "TEXT"
#: Height of the letters and half width of a hole's column, as shares of the section's length.
LETTERS, COLUMN = 0.008, 0.003


def write_sheet_dxf(
    views: Sequence[SectionView],
    title: str,
    path: str | PathLike[str],
    *,
    exaggeration: float = 1.0,
    unit: LengthUnit = "m",
    language: Language = EN,
) -> None:
    """Write sections with ground, holes, lithology, bands and points.

    Layers: one a horizon, with ``_inferred`` (dashed: above the ground or beyond the data), ``_band`` and ``_points``;
    one a lithology code, ``LITH_code``; one a body, ``BODY_name``, with ``_band`` (dashed: between these lines its
    surface lies with 80 % chance); GROUND, HOLES, FRAME, TEXT. Each section is drawn in true lengths below the
    one before it, in metres or in feet; ``exaggeration`` stretches elevations, and the title reports it. What
    is older than its data is named above the title in ``language``.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    views = [in_unit(view, unit) for view in views]
    horizons = list(dict.fromkeys(name for view in views for name in (*view.traces, *_with_points(view))))
    codes = lithologies(list(views))
    bodies = list(dict.fromkeys(f"BODY_{body.name}" for view in views for body in view.bodies))
    stems = file_stems([*horizons, *(f"LITH_{code}" for code in codes), *bodies])
    names = [stem + end for h in horizons for stem in (stems[h],) for end in ("", "_inferred", "_band", "_points")]
    names += [stems[f"LITH_{code}"] for code in codes]
    names += [stems[body] + end for body in bodies for end in ("", "_band")]
    with drawing_of(path, [*names, GROUND, HOLES, FRAME, TEXT], unit) as document:
        document.linetypes.add("DASHED_SECTION", pattern=[9.0, 6.0, -3.0])
        space, drop = document.modelspace(), 0.0
        for view in views:
            low, high = view.levels

            def at(places: Floats, base: float = low, drop: float = drop) -> list[tuple[float, float]]:
                return [(float(x), float((z - base) * exaggeration - drop)) for x, z in places]

            _section(space, view, at, stems)
            letters = LETTERS * view.length
            words = f"{title} {view.name}".strip() + ("" if exaggeration == 1 else f" (z x {exaggeration:g})")
            _text(space, words, at(np.array([[0.0, high]]))[0], 1.6 * letters, 4 * letters)
            if view.stale:
                warning = translate(stale_warning(view.stale), language)
                _text(space, warning, at(np.array([[0.0, high]]))[0], letters, 6.6 * letters)
            for level in _ticks(low, high):
                _text(space, f"{level:g}", at(np.array([[-7 * letters, level]]))[0], letters, 0.0)
            corners = at(np.array([[0.0, low], [view.length, low], [view.length, high], [0.0, high]]))
            space.add_lwpolyline(corners, close=True, dxfattribs={"layer": FRAME})
            drop += (high - low) * exaggeration + 0.12 * view.length


def _with_points(view: SectionView) -> list[str]:
    return [name for name, places in view.points.items() if len(places)]


def _section(space: Modelspace, view: SectionView, at: Any, stems: dict[str, str]) -> None:
    known = view.ground[np.isfinite(view.ground[:, 1])] if len(view.ground) else view.ground
    if len(known) > 1:
        space.add_lwpolyline(at(known), dxfattribs={"layer": GROUND})
    for name, traces in view.traces.items():
        for one in traces:
            line = np.column_stack([one.distance, one.z])
            attributes = {"layer": stems[name]}
            if not one.supported:
                attributes = {"layer": f"{stems[name]}_inferred", "linetype": "DASHED_SECTION"}
            space.add_lwpolyline(at(line), dxfattribs=attributes)
            if one.band is not None:
                for edge in (one.band.lower, one.band.upper):
                    space.add_lwpolyline(at(edge), dxfattribs={"layer": f"{stems[name]}_band"})
    for name, places in view.points.items():
        for place in at(places):
            space.add_point(place, dxfattribs={"layer": f"{stems[name]}_points"})
    for body in view.bodies:
        layer = stems[f"BODY_{body.name}"]
        for ring in body.rings:
            space.add_lwpolyline(at(ring), close=True, dxfattribs={"layer": layer})
        for line in body.band:
            space.add_lwpolyline(at(line), dxfattribs={"layer": f"{layer}_band", "linetype": "DASHED_SECTION"})
    for hole in view.holes:
        _hole(space, view, hole, at, stems)


def _hole(space: Modelspace, view: SectionView, hole: HoleTrack, at: Any, stems: dict[str, str]) -> None:
    space.add_lwpolyline(at(hole.track), dxfattribs={"layer": HOLES})
    letters, (x, y) = LETTERS * view.length, at(hole.track[[hole.track[:, 1].argmax()]])[0]
    ((_, edge),) = at(np.array([[0.0, view.levels[1]]]))
    # A letter is at most about as wide as high: a name that would cross the frame is above it.
    above = max(y, edge) if y + 0.3 + letters * len(hole.name) > edge else y
    _text(space, hole.name, (x, above), letters, 0.3, turned=90.0)
    tables = list(dict.fromkeys(interval.table for interval in hole.intervals))
    wide = 2 * COLUMN * view.length
    for interval in hole.intervals:
        left, right = (np.array([wide * (tables.index(interval.table) + k), 0.0]) for k in (0, 1))
        outline = np.concatenate([interval.track + left, interval.track[::-1] + right])
        attributes = {"layer": stems[f"LITH_{interval.code}"]}
        space.add_lwpolyline(at(outline), close=True, dxfattribs=attributes)
        filled = space.add_hatch(dxfattribs=attributes)
        filled.paths.add_polyline_path(at(outline), is_closed=True)
        filled.transparency = 0.5


def _text(
    space: Modelspace, words: str, place: tuple[float, float], height: float, above: float, turned: float = 0.0
) -> None:
    attributes = {"layer": TEXT, "rotation": turned}
    space.add_text(words, height=height, dxfattribs=attributes).set_placement((place[0], place[1] + above))


def _ticks(low: float, high: float) -> Floats:
    """Return about five round elevations."""
    step = 10.0 ** np.floor(np.log10(max(high - low, 1e-6) / 5))
    step *= next(k for k in (1.0, 2.0, 5.0, 10.0) if (high - low) / (step * k) <= 6)
    return np.asarray(step * np.arange(np.ceil(low / step), np.floor(high / step) + 1))
