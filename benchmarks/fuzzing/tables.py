"""Tables, AGS files, drawings, a grid and triangles: each ends in rows, listed rows or a geofit error; none is lost."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np

from geofit.data.site import Ground, Section
from geofit.io import read_boreholes, read_points
from geofit.io.adits import load_adit_contacts, load_adits
from geofit.io.grid import load_grid
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.sections import Drawing, load_section, load_sections
from geofit.io.source import Source
from geofit.io.traces import load_traces
from geofit.io.tsurf import read_tsurf
from geofit.project.importing import import_files

__all__ = ["originals", "read"]


def originals(folder: Path) -> dict[str, bytes]:
    """Return sound files: tables, both AGS editions, drawings, a grid, triangles."""
    import ezdxf

    holes = [(f"B{i}", 500000 + 40 * i, 3100000 + 9 * i, 100 + i) for i in range(12)]
    drawing = ezdxf.new()
    drawing.modelspace().add_lwpolyline([(5 * i, 80 + i) for i in range(20)], dxfattribs={"layer": "T2"})
    drawing.modelspace().add_line((0, 60), (90, 66), dxfattribs={"layer": "T1"})
    drawing.saveas(folder / "C1.dxf")
    plan = ezdxf.new()
    plan.modelspace().add_lwpolyline([(500000 + 5 * i, 3100000 + i) for i in range(9)], dxfattribs={"layer": "T2"})
    plan.modelspace().add_polyline3d([(500000, 3100050, 90), (500040, 3100050, 90.5)], dxfattribs={"layer": "PD1"})
    plan.modelspace().add_text("T2", dxfattribs={"layer": "PD1", "insert": (500020, 3100051)})
    plan.saveas(folder / "plan.dxf")
    stations = [(name, depth, 90, 80 - depth / 9) for name, *_ in holes for depth in (0, 9)]
    logs = [(name, top, top + 10, code) for name, *_ in holes for top, code in ((0, "Q"), (10, "T2"), (20, "T1"))]

    def table(header: str, rows: list[tuple[object, ...]], sep: str = ",") -> bytes:
        return "\n".join([header.replace(",", sep), *(sep.join(map(str, row)) for row in rows), ""]).encode()

    def group(name: str, headings: str, rows: list[tuple[object, ...]]) -> str:
        quoted = ['"DATA",' + ",".join(f'"{cell}"' for cell in row) for row in rows]
        heads = ",".join(f'"{cell}"' for cell in headings.split(","))
        return "\n".join([f'"GROUP","{name}"', f'"HEADING",{heads}', *quoted, "", ""])

    def old_group(name: str, headings: str, rows: list[tuple[object, ...]]) -> str:
        heads = ",".join(f'"*{cell}"' for cell in headings.split(","))
        quoted = [",".join(f'"{cell}"' for cell in row) for row in rows]
        quoted.insert(3, '"<CONT>"' + ',""' * (len(rows[0]) - 1))
        return "\n".join([f'"**{name}"', heads, '"<UNITS>"' + ',"m"' * (len(rows[0]) - 1), *quoted, "", ""])

    return {
        "collar.csv": table("hole,x,y,z,depth", [(*hole, 30) for hole in holes]),
        "survey.csv": table("hole,depth,azimuth,dip", stations, ";"),
        "log.csv": table("孔号,起始深度,终止深度,地层代号", logs),
        "picks.csv": table("x,y,z,horizon,kind", [(*hole[1:], "T2", '"a, b"') for hole in holes]),
        "new.ags": (
            group("LOCA", "LOCA_ID,LOCA_NATE,LOCA_NATN,LOCA_GL", holes)
            + group("GEOL", "LOCA_ID,GEOL_TOP,GEOL_BASE,GEOL_GEOL", logs)
        ).encode(),
        "old.ags": (
            old_group("HOLE", "HOLE_ID,HOLE_NATE,HOLE_NATN,HOLE_GL", holes)
            + old_group("GEOL", "HOLE_ID,GEOL_TOP,GEOL_BASE,GEOL_GEOL", logs)
        ).encode("cp1252"),
        "profiles.csv": table(
            "section,horizon,distance,elevation,x0,y0,x1,y1",
            [(f"P{i % 3}", "T2", 5 * i, 80 + i, 500000, 3100000, 500100, 3100010 + i % 3) for i in range(12)],
        ),
        "nameless.csv": "\n".join(",".join(map(str, hole)) for hole in holes).encode(),
        "base.asc": b"ncols 3\nnrows 3\nxllcenter 500000\nyllcenter 3100000\ncellsize 200\n1 2 3\n4 -9999 6\n7 8 9\n",
        "top.ts": b"GOCAD TSurf 1\nHEADER {\nname:T1\n}\nTFACE\nVRTX 1 0 0 0\nVRTX 2 9 0 1\nPVRTX 3 0 9 2 7\n"
        b"ATOM 4 1\nVRTX 5 9 9 4\nTRGL 1 2 3\nTRGL 4 2 5\nEND\n",
        "plan.dxf": (folder / "plan.dxf").read_bytes(),
        "C1.dxf": (folder / "C1.dxf").read_bytes(),
    }


def _counts(name: str, folder: Path, whole: bool) -> tuple[Counter[str], dict[str, int]]:
    """Read a damaged file the way users do; return what became of the rows, and the rows of each file."""
    path = folder / name
    if whole:
        # Elsewhere, or the next import would read what this one has written.
        site = folder.with_name(f"{folder.name}_site")
        site.mkdir(exist_ok=True)
        counts = import_files(sorted(folder.glob("*.[cad]*")), site / "site.toml").counts
    elif name == "C1.dxf":
        journal = Journal()
        section = Section("C1", np.array([[500000.0, 3100000.0], [500100.0, 3100000.0]]))
        load_section(Source(path=path), section, Drawing(), HorizonNames(), journal)
        counts = tuple(journal.counts)
    elif name == "plan.dxf":
        journal, names = Journal(), HorizonNames(["T2"])
        ground = Ground(np.array([499000.0, 501000.0]), np.array([3099000.0, 3101000.0]), np.full((2, 2), 100.0))
        load_traces(Source(path=path), ground, names, journal)
        load_adit_contacts(Source(path=path), load_adits(Source(path=path), journal), names, journal)
        counts = tuple(journal.counts)
    elif name == "profiles.csv":
        journal = Journal()
        load_sections(Source(path=path), {}, HorizonNames(), journal)
        counts = tuple(journal.counts)
    elif name == "base.asc":
        journal = Journal()
        load_grid(Source(path=path), "base", HorizonNames(), journal)
        counts = tuple(journal.counts)
    elif name == "top.ts":
        read_tsurf(path)
        counts = read_points(path).counts
    elif name == "nameless.csv":
        counts = read_boreholes(path).counts
    elif path.suffix == ".ags":
        counts = read_boreholes(path, intervals=[path]).counts
    elif name == "picks.csv":
        counts = read_points(path).counts
    else:
        counts = read_boreholes(folder / "collar.csv", folder / "survey.csv", [folder / "log.csv"]).counts
    for count in counts:
        if count.read != count.used + count.listed or min(count.read, count.used, count.listed) < 0:
            raise AssertionError(f"rows are lost: {count}")
    total = Counter({key: sum(getattr(count, key) for count in counts) for key in ("read", "used", "listed")})
    return total, {count.file: count.read for count in counts}


def read(name: str, folder: Path, done: list[str], case: int) -> Counter[str]:
    """Read a damaged file, every eighth time through the import of the whole folder; return what became of its rows."""
    rows, per_file = _counts(name, folder, whole=case % 8 == 0)
    if set(done) <= {"swap cells", "repeat"} and name in per_file and name.endswith("csv"):
        lines = (folder / name).read_bytes().split(b"\n")
        filled = sum(bool(line.strip(b",; \t\r")) for line in lines)
        if not filled - 1 <= per_file[name] <= filled:
            raise AssertionError(f"{filled} lines are filled, {per_file[name]} rows were read")
    return Counter({f"rows {what}": rows[what] for what in ("used", "listed")})
