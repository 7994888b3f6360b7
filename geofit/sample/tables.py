"""How the sample site's tables, drawings and site file are written.

They differ as real ones do: English and Chinese headers, UTF-8 with and without byte order mark, GB18030,
commas and semicolons, decimal points and decimal commas, sections as DXF and as CSV.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geofit.data.files import replacing
from geofit.data.site import Ground
from geofit.sample.holes import Adit, Borehole
from geofit.sample.sections import SampleDrawing
from geofit.sample.truth import BOUNDARY

__all__ = [
    "section_file",
    "table",
    "write",
    "write_adits",
    "write_boreholes",
    "write_boundary",
    "write_ground",
    "write_outcrops",
    "write_picks",
    "write_section",
    "write_site_file",
]

Floats = NDArray[np.float64]
Row = Sequence[str]

#: Sections that came as CSV; the others are DXF.
_AS_CSV = ("C6", "C7", "C8", "L2", "L3")
#: Thickness that a crossing of the fault's gouge, or of the marker bed, has in the log, metres.
_LOGGED = {"F1": (0.4, 1.5), "M1": (0.1, 0.3)}


def write(path: Path, text: str, encoding: str = "utf-8") -> None:
    """Write a text; the file is whole or absent."""
    with replacing(path) as part:
        part.write_bytes(text.encode(encoding))


def table(header: Row, rows: Iterable[Row], sep: str = ",") -> str:
    """Return a table as text."""
    return "".join(sep.join(row) + "\n" for row in [header, *rows])


def write_boundary(path: Path) -> None:
    """Write the corners of the study area."""
    write(path, table(("x", "y"), ((f"{x:.1f}", f"{y:.1f}") for x, y in BOUNDARY)))


def write_ground(path: Path, ground: Ground, cell: float) -> None:
    """Write an ESRI ASCII grid: rows from north to south, values at the cells' centres."""
    head = {
        "ncols": len(ground.x),
        "nrows": len(ground.y),
        "xllcorner": ground.x[0] - cell / 2,
        "yllcorner": ground.y[0] - cell / 2,
        "cellsize": cell,
        "NODATA_value": -9999,
    }
    lines = [f"{key:<13} {value:.12g}" for key, value in head.items()]
    lines += [" ".join(f"{z:.2f}" for z in row) for row in ground.z[::-1]]
    write(path, "\n".join(lines) + "\n")


def write_boreholes(folder: Path, holes: list[Borehole]) -> None:
    """Write collars, surveys and the three logs: lithology, weathering, structures."""
    collars = (
        (hole.name, *(f"{c:.2f}" for c in hole.collar), f"{hole.depth:.1f}") for hole in holes
    )  # fmt: skip
    header = ("孔号", "坐标X", "坐标Y", "孔口高程", "孔深")
    write(folder / "collar.csv", table(header, collars), "utf-8-sig")
    stations = ((hole.name, *(f"{value:.1f}" for value in station)) for hole in holes for station in hole.survey)
    write(folder / "survey.csv", table(("hole_id", "depth", "azimuth", "dip"), stations))
    lithology = (row for hole in holes for row in _lithology(hole))
    write(folder / "lithology.csv", table(("hole_id", "from", "to", "code", "description"), lithology))
    weathering = (row for hole in holes for row in _weathering(hole))
    write(folder / "风化.csv", table(("孔号", "起始深度", "终止深度", "岩性"), weathering), "gb18030")
    rng = np.random.default_rng(46)
    structures = (row for hole in holes for row in _structures(hole, rng))
    write(folder / "structures.csv", table(("hole_id", "from", "to", "code"), structures, ";"))


_ROCK = {
    "Q": "river gravel and talus",
    "T3": "thick-bedded limestone",
    "T2": "sandstone with slate",
    "T1": "phyllite",
}


def _intervals(hole: Borehole, limits: list[tuple[float, str]], last: str) -> Iterable[Row]:
    """Tile a hole: ``limits`` are the (base, code) of all but the last interval."""
    top = 0.0
    for base, code in [*limits, (hole.depth, last)]:
        yield hole.name, f"{top:.2f}", f"{base:.2f}", code
        top = base


def _lithology(hole: Borehole) -> Iterable[Row]:
    bases = [(hole.cover, "Q")]
    bases += [
        (at, code) for code, contact in (("T3", "T3-T2"), ("T2", "T2-T1")) for at in hole.contacts.get(contact, ())
    ]
    for row in _intervals(hole, bases, hole.bottom_rock):
        yield *row, _ROCK[row[-1]]


def _weathering(hole: Borehole) -> Iterable[Row]:
    limits = [(hole.cover, "覆盖层")]
    for at in hole.contacts.get("W", ()):
        limits += [(round(hole.cover + 0.4 * (at - hole.cover), 2), "强风化"), (at, "弱风化")]
    return _intervals(hole, limits, "微风化" if "W" in hole.contacts else "弱风化")


def _structures(hole: Borehole, rng: np.random.Generator) -> Iterable[Row]:
    """Log gouge and marker bed; what a hole meets again has a code of its own, and is in the picks."""
    met = sorted((at, code, "r" * i) for code in _LOGGED for i, at in enumerate(hole.contacts.get(code, ())))
    limits = []
    for (at, code, again), (end, *_) in pairwise([*met, (hole.depth, "", "")]):
        to = min(at + rng.uniform(*_LOGGED[code]), 0.5 * (at + end))
        limits += [(at, "R"), (to, code + again)]
    for row in _intervals(hole, limits, "R"):
        yield [cell.replace(".", ",") for cell in row]


def write_adits(folder: Path, adits: list[Adit]) -> None:
    """Write the adits' axes and what they meet."""
    nodes = ((adit.name, *(f"{c:.2f}" for c in node)) for adit in adits for node in adit.nodes)
    write(folder / "adits.csv", table(("adit", "x", "y", "z"), nodes))
    contacts = ((adit.name, f"{at:.2f}", horizon) for adit in adits for at, horizon in adit.contacts)
    write(folder / "adit_contacts.csv", table(("adit", "chainage", "horizon"), contacts))


def section_file(drawing: SampleDrawing) -> str:
    """Return the name of a section's file, relative to the site's folder."""
    return f"sections/{drawing.name}.{'csv' if drawing.name in _AS_CSV else 'dxf'}"


def write_section(path: Path, drawing: SampleDrawing) -> None:
    """Write a drawing: distance along the section line against elevation, a layer or a name per horizon."""
    if path.suffix == ".csv":
        rows = (
            (horizon, f"{d:.2f}", f"{z:.3f}")
            for horizon, lines in drawing.lines.items()
            for line in lines
            for d, z in line
        )
        write(path, table(("horizon", "distance", "elevation"), rows))
        return
    # Release 12 entities only: without a header the file holds neither dates nor identifiers.
    from ezdxf.addons.r12writer import r12writer

    with (
        replacing(path) as part,
        part.open("w", encoding="ascii", newline="\n") as stream,
        r12writer(stream) as dxf,
    ):
        for horizon, lines in drawing.lines.items():
            for line in lines:
                vertices = [(round(float(d), 2), round(float(z), 3)) for d, z in line]
                if len(vertices) == 1:
                    dxf.add_point(vertices[0], layer=horizon)
                else:
                    dxf.add_polyline_2d(vertices, layer=horizon)


def write_outcrops(path: Path, outcrops: dict[str, Floats]) -> None:
    """Write the map's traces: no elevation, they lie on the ground."""
    rows = ((horizon, f"{x:.2f}", f"{y:.2f}") for horizon, line in outcrops.items() for x, y in line)
    write(path, table(("horizon", "easting", "northing"), rows))


def write_picks(path: Path, picks: dict[str, Floats], holes: list[Borehole]) -> None:
    """Write the seismic picks, and the televiewer's of what a hole meets for the second time."""
    rows = [
        (horizon, *(f"{c:.2f}" for c in pick), "geophysics", "") for horizon, line in picks.items() for pick in line
    ]
    rows += [
        (horizon, *(f"{c:.2f}" for c in pick), "borehole", hole.name)
        for hole in holes
        for horizon in _LOGGED
        for pick in hole.path(np.array(hole.contacts.get(horizon, ())[1:]))
    ]
    write(path, table(("horizon", "x", "y", "z", "kind", "hole"), rows))


_SITE = """\
# A fictional hydropower dam site, generated by `python -m geofit.sample`: no real place, no real data.
# Eastings are the columns x or 坐标X, northings y or 坐标Y; metres throughout.
[site]
name = "Heishui bend dam site (fictional)"
crs = "local grid, fictional"
# Top to bottom. W cuts strata, F1 is a fault, M1 an overturned fold.
order = ["T3-T2", "T2-T1"]

[report]
project = "HB-2026"
client = "Heishui River Hydropower Co. (fictional)"
organisation = "Geological Survey Team 3 (fictional)"
document = "HB-2026-GEO-012"
status = "for review"
author = "Li Wen"

[[report.revision]]
mark = "A"
date = 2026-11-02
text = "First issue"
author = "Li Wen"

[boundary]
file = "boundary.csv"

[ground]
file = "ground.asc"

[boreholes]
collar = "collar.csv"
survey = "survey.csv"
intervals = ["lithology.csv", "风化.csv", "structures.csv"]
dip = "down-positive"

[adits]
path = "adits.csv"
contacts = "adit_contacts.csv"

{sections}
[traces]
file = "outcrops.csv"

[picks]
file = "geophysics.csv"

# Two conformable contacts: limestone T3 on sandstone T2, T2 on phyllite T1.
[[horizon]]
name = "T3-T2"
base = "T3"
epsilon = 0.5
{accuracy}

[[horizon]]
name = "T2-T1"
base = "T2"
epsilon = 0.5
{accuracy}

# Lower limit of moderately weathered rock.
[[horizon]]
name = "W"
base = "弱风化"
epsilon = 0.5
{accuracy}

# Steep fault: upper side of its gouge.
[[horizon]]
name = "F1"
top = "F1"
epsilon = 0.5
{accuracy}

# Marker bed in T1, an overturned fold. Where a hole meets it again it logs M1r: geophysics.csv has the place.
[[horizon]]
name = "M1"
top = "M1"
epsilon = 0.5
{accuracy}
"""
_ACCURACY = "accuracy = { borehole = 0.03, adit = 0.03, section = 0.03, outcrop = 0.1, geophysics = 0.1 }"


def write_site_file(path: Path, drawings: list[SampleDrawing]) -> None:
    """Write the file that binds the others."""
    sections = "\n".join(
        f'[[section]]\nname = "{drawing.name}"\n'
        f"line = [{', '.join(f'[{x:.3f}, {y:.3f}]' for x, y in drawing.line)}]\n"
        f'file = "{section_file(drawing)}"\n'
        for drawing in drawings
    )
    write(path, _SITE.format(sections=sections, accuracy=_ACCURACY))
