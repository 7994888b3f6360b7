"""Pore networks to OpenPNM (json, csv), Statoil node and link files (pnflow), VTP and CSV; Statoil files back.

Lengths are metres, centres are measured from the low corner of the sample along the axes of the array. Files appear
whole or not at all.
"""

from __future__ import annotations

import csv
import gzip
import json
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.files import replacing
from geofit.data.messages import message
from geofit.pores.network import PoreNetwork

__all__ = [
    "StatoilNetwork",
    "openpnm_dictionary",
    "read_statoil",
    "write_network_csv",
    "write_network_vtp",
    "write_openpnm_csv",
    "write_openpnm_json",
    "write_statoil",
]

_FACES = ("axis0_low", "axis0_high", "axis1_low", "axis1_high", "axis2_low", "axis2_high")


def openpnm_dictionary(network: PoreNetwork) -> dict[str, NDArray[Any]]:
    """Return the network as OpenPNM's dictionary of ``pore.*`` and ``throat.*`` arrays, in metres.

    Pores at the sample's faces carry labels such as ``pore.axis0_low``; no pores are invented at the faces.
    """
    unit, pores, throats = network.unit, network.pores, network.throats
    out: dict[str, NDArray[Any]] = {
        "pore.coords": network.centre,
        "throat.conns": np.sort(throats.pores, axis=1).astype(np.int64),
        "pore.all": np.ones(len(pores), bool),
        "throat.all": np.ones(len(throats), bool),
        "pore.inscribed_diameter": 2 * pores.inscribed * unit,
        "pore.equivalent_diameter": np.cbrt(6 * pores.volume / np.pi) * unit,
        "pore.volume": pores.volume * unit**3,
        "throat.inscribed_diameter": 2 * throats.inscribed * unit,
        "throat.cross_sectional_area": throats.area * unit**2,
        "throat.perimeter": throats.perimeter * unit,
        "throat.total_length": throats.length.sum(axis=1) * unit,
        "throat.shape_factor": throats.shape_factor,
    }
    for face, label in enumerate(_FACES):
        out[f"pore.{label}"] = pores.faces[:, face]
    return out


def write_openpnm_json(network: PoreNetwork, path: str | PathLike[str]) -> None:
    """Write the arrays of :func:`openpnm_dictionary` as nested json, as OpenPNM's JSON writer lays them out."""
    content: dict[str, dict[str, Any]] = {"pore": {}, "throat": {}}
    for name, values in openpnm_dictionary(network).items():
        element, prop = name.split(".")
        content[element][prop] = values.tolist()
    with replacing(path) as part:
        part.write_text(json.dumps(content, indent=0), encoding="utf-8")


def write_openpnm_csv(network: PoreNetwork, path: str | PathLike[str]) -> None:
    """Write the arrays of :func:`openpnm_dictionary` as columns; vectors become ``name[0]``, ``name[1]``, ..."""
    columns: list[tuple[str, list[Any]]] = []
    for name, values in openpnm_dictionary(network).items():
        if values.ndim == 1:
            columns.append((name, values.tolist()))
        else:
            columns += [(f"{name}[{axis}]", values[:, axis].tolist()) for axis in range(values.shape[1])]
    _write_columns(path, columns)


def write_network_csv(network: PoreNetwork, folder: str | PathLike[str], stem: str = "network") -> tuple[Path, ...]:
    """Write ``<stem>_pores.csv``, ``<stem>_throats.csv``, ``<stem>_face_throats.csv`` and ``<stem>_dropped.csv``.

    Returns
    -------
    tuple of Path
        The four files.
    """
    folder = Path(folder)
    unit, throats, ends = network.unit, network.throats, network.face_throats
    tables: dict[str, list[tuple[str, list[Any]]]] = {}
    for name, pores in (("pores", network.pores), ("dropped", network.dropped)):
        middle = (pores.centre + 0.5) * np.array(network.voxel)
        tables[name] = [
            ("pore", list(range(len(pores)))),
            *((f"axis{axis}_m", middle[:, axis].tolist()) for axis in range(3)),
            ("radius_m", (pores.radius * unit).tolist()),
            ("inscribed_radius_m", (pores.inscribed * unit).tolist()),
            ("volume_m3", (pores.volume * unit**3).tolist()),
            *((label, pores.faces[:, face].astype(int).tolist()) for face, label in enumerate(_FACES)),
        ]
    tables["pores"].insert(1, ("coordination", network.coordination.tolist()))
    for name, sections in (("throats", throats), ("face_throats", ends)):
        tables[name] = [
            ("radius_m", (sections.radius * unit).tolist()),
            ("inscribed_radius_m", (sections.inscribed * unit).tolist()),
            ("area_m2", (sections.area * unit**2).tolist()),
            ("perimeter_m", (sections.perimeter * unit).tolist()),
            ("duct_conductance_m4", (sections.conductance * unit**4).tolist()),
        ]
    tables["throats"][:0] = [("pore1", throats.pores[:, 0].tolist()), ("pore2", throats.pores[:, 1].tolist())]
    tables["throats"] += [(f"length{end + 1}_m", (throats.length[:, end] * unit).tolist()) for end in range(2)]
    tables["face_throats"][:0] = [("pore", ends.pore.tolist()), ("face", [_FACES[face] for face in ends.face])]
    tables["face_throats"].append(("length_m", (ends.length * unit).tolist()))
    paths = []
    for name in ("pores", "throats", "face_throats", "dropped"):
        paths.append(folder / f"{stem}_{name}.csv")
        _write_columns(paths[-1], tables[name])
    return tuple(paths)


def _write_columns(path: str | PathLike[str], columns: list[tuple[str, list[Any]]]) -> None:
    longest = max((len(values) for _, values in columns), default=0)
    with replacing(path) as part, part.open("w", encoding="utf-8", newline="") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow([name for name, _ in columns])
        for row in range(longest):
            rows.writerow([values[row] if row < len(values) else "" for _, values in columns])


def write_network_vtp(network: PoreNetwork, path: str | PathLike[str]) -> None:
    """Write pores as vertices and throats as lines of VTK polydata, with radii for glyphs and tubes."""
    unit, pores, throats = network.unit, network.pores, network.throats
    m, n = len(throats), len(pores)
    points = "\n".join(" ".join(f"{x:.9g}" for x in row) for row in network.centre)

    def array(name: str, values: NDArray[Any], kind: str = "Float64") -> str:
        text = " ".join(f"{value:.9g}" if kind == "Float64" else str(int(value)) for value in values)
        return f'<DataArray type="{kind}" Name="{name}" format="ascii">{text}</DataArray>'

    parts = [
        '<?xml version="1.0"?>',
        '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64"><PolyData>',
        f'<Piece NumberOfPoints="{n}" NumberOfVerts="{n}" NumberOfLines="{m}" NumberOfStrips="0" NumberOfPolys="0">',
        "<PointData>",
        array("radius", pores.inscribed * unit),
        array("volume", pores.volume * unit**3),
        array("coordination", network.coordination, "Int64"),
        "</PointData><CellData>",
        # Cells count vertices first, then lines.
        array("throat radius", np.concatenate([np.full(n, np.nan), throats.inscribed * unit])),
        "</CellData>",
        f'<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{points}</DataArray></Points>',
        "<Verts>",
        array("connectivity", np.arange(n), "Int64"),
        array("offsets", np.arange(1, n + 1), "Int64"),
        "</Verts><Lines>",
        array("connectivity", throats.pores.ravel(), "Int64"),
        array("offsets", 2 * np.arange(1, m + 1), "Int64"),
        "</Lines></Piece></PolyData></VTKFile>",
    ]
    with replacing(path) as part:
        part.write_text("\n".join(parts), encoding="utf-8")


@dataclass(frozen=True, eq=False)
class StatoilNetwork:
    """A network in the Statoil format, in metres; pores count from 0, -2 is the inlet and -1 the outlet face.

    Attributes
    ----------
    size : ndarray, shape (3,)
    centre : ndarray, shape (n, 3)
    pore_volume, pore_radius, pore_shape : ndarray, shape (n,)
    pores : ndarray of int, shape (m, 2)
    radius, shape, total_length, throat_length, throat_volume : ndarray, shape (m,)
    pore_length : ndarray, shape (m, 2)
    """

    size: NDArray[np.float64]
    centre: NDArray[np.float64]
    pore_volume: NDArray[np.float64]
    pore_radius: NDArray[np.float64]
    pore_shape: NDArray[np.float64]
    pores: NDArray[np.int64]
    radius: NDArray[np.float64]
    shape: NDArray[np.float64]
    total_length: NDArray[np.float64]
    pore_length: NDArray[np.float64]
    throat_length: NDArray[np.float64]
    throat_volume: NDArray[np.float64]


def write_statoil(
    network: PoreNetwork, folder: str | PathLike[str], stem: str = "network", *, axis: int = 0
) -> tuple[Path, ...]:
    """Write the four files of the Statoil format, with flow along one axis of the array as their x.

    Face throats become links to the inlet (-1) and the outlet (0).

    Returns
    -------
    tuple of Path
        ``<stem>_node1.dat``, ``_node2.dat``, ``_link1.dat``, ``_link2.dat``.
    """
    if axis not in (0, 1, 2):
        raise InputError(
            message("io.axis-unknown", "axis={axis} is not an axis of the volume", axis=axis),
            message("io.give-axis", "Give 0, 1 or 2."),
        )
    folder, unit = Path(folder), network.unit
    order = [axis, *(other for other in range(3) if other != axis)]
    pores, throats, ends = network.pores, network.throats, network.face_throats
    use = (ends.face == 2 * axis) | (ends.face == 2 * axis + 1)
    face = np.where(ends.face[use] == 2 * axis, -1, 0)
    first = np.concatenate([face, throats.pores[:, 0] + 1])
    second = np.concatenate([ends.pore[use] + 1, throats.pores[:, 1] + 1])
    radius = np.concatenate([ends.inscribed[use], throats.inscribed]) * unit
    area = np.concatenate([ends.area[use], throats.area]) * unit**2
    wall = np.concatenate([ends.perimeter[use], throats.perimeter]) * unit
    factor = np.minimum(area / np.maximum(wall, 1e-150) ** 2, 0.25 / np.pi)  # the square of 1e-300 is 0
    halves = np.concatenate([np.column_stack([np.zeros(use.sum()), ends.length[use]]), throats.length]) * unit
    wide = np.where(first > 0, pores.inscribed[np.maximum(first, 1) - 1], np.inf) if len(pores) else np.zeros(0)
    widths = np.column_stack([wide, pores.inscribed[second - 1] if len(pores) else np.zeros(0)]) * unit
    own = halves * (1 - 0.6 * np.minimum(radius[:, None] / widths, 1))
    total = halves.sum(axis=1)
    middle = np.maximum(total - own.sum(axis=1), 0)

    links: list[list[int]] = [[] for _ in range(len(pores))]
    for number, (a, b) in enumerate(zip(first.tolist(), second.tolist(), strict=True), 1):
        links[b - 1].append(number)
        if a > 0:
            links[a - 1].append(number)
    best = np.zeros(len(pores))
    np.maximum.at(best, second - 1, factor)
    np.maximum.at(best, first[first > 0] - 1, factor[first > 0])
    size = np.array(network.shape) * network.voxel
    node1 = [f"{len(pores):6d} " + " ".join(f"{size[a]:14.6E}" for a in order)]
    for pore, (centre, found) in enumerate(zip(network.centre, links, strict=True), 1):
        others = [int(first[n - 1] if second[n - 1] == pore else second[n - 1]) for n in found]
        marks = [int(-1 in others), int(0 in others)]
        numbers = [len(found)], others, marks, found
        node1.append(
            f"{pore:6d} "
            + " ".join(f"{centre[a]:.6E}" for a in order)
            + "".join(f" {n:6d}" for part in numbers for n in part)
        )
    volume, inscribed = pores.volume * unit**3, pores.inscribed * unit
    files = {
        "node1": node1,
        "node2": [
            f"{n:6d} {volume[n - 1]:.6E} {inscribed[n - 1]:.6E} {best[n - 1]:.6E} {0.0:.6E}"
            for n in range(1, len(pores) + 1)
        ],
        "link1": [f"{len(first):6d}"]
        + [
            f"{n:6d} {first[n - 1]:6d} {second[n - 1]:6d} {radius[n - 1]:.6E} {factor[n - 1]:.6E} {total[n - 1]:.6E}"
            for n in range(1, len(first) + 1)
        ],
        "link2": [
            f"{n:6d} {first[n - 1]:6d} {second[n - 1]:6d} {own[n - 1, 0]:.6E} {own[n - 1, 1]:.6E} {middle[n - 1]:.6E} "
            f"{0.0:.6E} {0.0:.6E}"
            for n in range(1, len(first) + 1)
        ],
    }
    paths = []
    for name, lines in files.items():
        paths.append(folder / f"{stem}_{name}.dat")
        with replacing(paths[-1]) as part:
            part.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")
    return tuple(paths)


def read_statoil(folder: str | PathLike[str], stem: str) -> StatoilNetwork:
    """Read the four files of a network in the Statoil format, gzipped or not.

    Raises
    ------
    InputError
        If a file is missing, or their counts disagree.
    """
    rows = {name: _rows(Path(folder), f"{stem}_{name}.dat") for name in ("node1", "node2", "link1", "link2")}
    count, size = int(rows["node1"][0][0]), np.array(rows["node1"][0][1:4], float)
    links = int(rows["link1"][0][0])
    if not (
        len(rows["node1"]) - 1 == len(rows["node2"]) == count and len(rows["link1"]) - 1 == len(rows["link2"]) == links
    ):
        raise InputError(
            message(
                "io.network-counts-differ",
                "its four files state {pores} pores and {throats} links, but list others",
                pores=count,
                throats=links,
            ),
            message("io.export-network-again", "Export the network again."),
            file=str(Path(folder) / stem),
        )
    node1 = np.array([row[1:4] for row in rows["node1"][1:]], float)
    node2 = np.array(rows["node2"], float)
    link1, link2 = np.array(rows["link1"][1:], float), np.array(rows["link2"], float)
    return StatoilNetwork(
        size, node1, node2[:, 1], node2[:, 2], node2[:, 3],
        link1[:, 1:3].astype(np.int64) - 1, link1[:, 3], link1[:, 4], link1[:, 5],
        link2[:, 3:5], link2[:, 5], link2[:, 6],
    )  # fmt: skip


def _rows(folder: Path, name: str) -> list[list[str]]:
    for path in (folder / name, folder / f"{name}.gz"):
        if path.exists():
            data = gzip.decompress(path.read_bytes()) if path.suffix == ".gz" else path.read_bytes()
            return [line.split() for line in data.decode("ascii").splitlines() if line.strip()]
    raise InputError(
        message("io.network-file-missing", "a network needs four files, and this one is missing"),
        message("io.put-next-to-others", "Put it in the folder of the others."),
        file=str(folder / name),
    )
