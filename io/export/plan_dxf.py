"""A contour plan as DXF (R2010) in map coordinates: contours at their elevations, labels, holes, study area."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike

import numpy as np

from geofit.data.files import file_stems
from geofit.data.lengths import LengthUnit, in_unit
from geofit.data.site import Site
from geofit.io.export.dxf import drawing_of
from geofit.sampling.contours import ContourLine

__all__ = ["write_plan_dxf"]

#: Layers that belong to no horizon; names of horizons are told apart from them.
AREA, HOLES, SECTIONS, TEXT = "STUDY_AREA", "HOLES", "SECTIONS", "TEXT"
#: Every so many contours one is heavy and labelled; height of the letters, as a share of the plan's width.
HEAVY, LETTERS = 5, 0.008


def write_plan_dxf(
    contours: Mapping[str, Sequence[ContourLine]],
    intervals: Mapping[str, float],
    site: Site,
    title: str,
    path: str | PathLike[str],
    *,
    unit: LengthUnit = "m",
    note: str = "",
) -> None:
    """Write contour plans.

    Layers: one a horizon, with ``_heavy`` (every fifth contour) and ``_labels``; STUDY_AREA, HOLES, SECTIONS, TEXT.
    Contours are 2D polylines that carry their elevation; a label stands along the middle of its contour.

    Parameters
    ----------
    contours : mapping of str to sequence of Contour
        By horizon.
    intervals : mapping of str to float
        Metres between the contours of each horizon.
    site : Site
        Study area, holes and section lines.
    title : str
        Written below the plan.
    path : path
        The file.
    unit : {"m", "ft", "ft-us"}
        That of the drawing.
    note : str
        Written below the title, if anything.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    names = file_stems([AREA, HOLES, SECTIONS, TEXT, *contours])
    layers = [layer for name in contours for layer in (names[name], f"{names[name]}_heavy", f"{names[name]}_labels")]
    contours = {name: in_unit(tuple(lines), unit) for name, lines in contours.items()}
    intervals, area = in_unit(dict(intervals), unit), in_unit(site.boundary, unit)
    sections, holes = in_unit(tuple(site.sections), unit), in_unit(tuple(site.holes), unit)
    corners = [one.line for lines in contours.values() for one in lines] + [hole.xyz[:1, :2] for hole in holes]
    places = np.concatenate(corners) if corners else np.zeros((1, 2))
    low, high = places.min(axis=0), places.max(axis=0)
    size = LETTERS * max(float((high - low).max()), 1.0)
    with drawing_of(path, [*layers, AREA, HOLES, SECTIONS, TEXT], unit) as document:
        space = document.modelspace()
        for name, lines in contours.items():
            for one in lines:
                heavy = round(one.elevation / intervals[name]) % HEAVY == 0
                line = one.line[:-1] if one.closed else one.line
                layer = names[name] + ("_heavy" if heavy else "")
                attributes = {"layer": layer, "elevation": one.elevation}
                space.add_lwpolyline(line.tolist(), close=one.closed, dxfattribs=attributes)
                if heavy and len(one.line) > 2:
                    k = len(one.line) // 2
                    way = one.line[k] - one.line[k - 1]
                    angle = (float(np.degrees(np.arctan2(way[1], way[0]))) + 90) % 180 - 90
                    text = space.add_text(f"{round(one.elevation, 6):g}", height=size,
                                          dxfattribs={"layer": f"{names[name]}_labels", "rotation": angle})  # fmt: skip
                    text.set_placement((float(one.line[k, 0]), float(one.line[k, 1]), one.elevation))
        if area is not None:
            space.add_lwpolyline(np.asarray(area).tolist(), close=True, dxfattribs={"layer": AREA})
        for section in sections:
            space.add_lwpolyline(section.line.tolist(), dxfattribs={"layer": SECTIONS})
        for hole in holes:
            x, y, z = hole.xyz[0].tolist()
            space.add_circle((x, y, z), size / 2, dxfattribs={"layer": HOLES})
            name_text = space.add_text(hole.name, height=size, dxfattribs={"layer": HOLES})
            name_text.set_placement((x + size, y + size / 2, z))
        for words, height, below in ((title, 2.0, 5.0), (note, 1.0, 7.5)):
            if words:
                text = space.add_text(words, height=height * size, dxfattribs={"layer": TEXT})
                text.set_placement((float(low[0]), float(low[1]) - below * size, 0.0))
