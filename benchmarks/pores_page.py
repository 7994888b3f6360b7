"""The page docs/pores.md and its picture, from what benchmarks/pores.py measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pores_sweep import kept

__all__ = ["write_page"]

_HEAD = """# Pore networks of real rocks

Written by `python benchmarks/pores.py --peers PYTHON --page`; do not edit. Rocks: micro-CT volumes. Times are CPU
time of one process after compiling, on a shared machine of two cores; the references ran in the same run, in an
environment of their own. "Voxels lost" are those by which the union of the maximal balls differs from the pore space.

![Radii of pores and throats](images/pores.png)
"""
_PUBLISHED = """
## The published network of Berea

{own} The published maximal-ball network of the same rock has 6,298 pores and 12,545 throats, coordination 3.91, mean
radii 15.36 and 7.15 µm. Radii are those of balls centred on voxels.
"""
_TRUTHS = """
## Bodies with known truth

One line for each acceptance test, with what is asked of it and what was measured in this run; "asserted" where only the
test itself says so. Tests are those in `tests/pores` if no other folder is named; [Tests of pores](pore_tests.md) lists
all of them with their cases, and where one asks for less than the method does. Not met: 24, the network within 25 % on
packs of 2 x 2 x 2 face-centred cells of 40, 48 and 72 voxels (+31 to +45 %); no lattice Boltzmann solver is included.
"""
_PNEXTRACT = """
## pnextract

Maximal balls by others; CPU time of its process, which reads the voxels from a file.
"""
_TAIL = """
Network permeability treats each throat as a straight duct that widens into its pores. OpenPNM's permeability is that of
snow2's network with its model of pyramids and cuboids.
"""
_BOLTZMANN = """
## Against lattice Boltzmann

Published permeabilities by lattice Boltzmann, along axis 0 or along all three, and what network and Laplace's equation
make of them.
Where the 128 voxels lie is not stated: of seven places tried for them, the middle of Berea 200³ was taken
because permeability and Kozeny's estimate fit best there. Its line is therefore weaker evidence than that of the whole.
"""


def write_page(
    rows: Mapping[str, Mapping[str, Any]],
    published: Mapping[str, tuple[float, ...]],
    truths: Sequence[Sequence[str]],
    docs: Path,
) -> None:
    """Write ``pores.md`` and ``images/pores.png`` into the folder of the documentation."""
    own = {name: row["own"] for name, row in rows.items() if "error" not in row["own"]}
    parts = [_HEAD]
    header = (
        "volume",
        "balls",
        "voxels lost",
        "pores",
        "throats",
        "coordination",
        "K of the network, mD",
        "K by Laplace, mD",
        "network, s",
        "balls, s",
        "GB",
    )
    cells = [_own_row(name, figures) for name, figures in own.items()]
    parts.append(_table(header, cells))
    peers = {name: row["peer"] for name, row in rows.items() if "peer" in row}
    if peers:
        parts.append("\n## PoreSpy snow2 and OpenPNM\n")
        parts.append(
            _table(("volume", "s", "times geofit's", "GB", "pores", "throats", "K, mD"), _peer_rows(own, peers))
        )
    parts.append(_TAIL)
    maximal = {name: peer["pnextract"] for name, peer in peers.items() if peer.get("pnextract")}
    if maximal:
        parts.append(_PNEXTRACT)
        header = ("volume", "s", "times geofit's", "pores", "throats")
        parts.append(_table(header, [_pnextract_row(name, own[name], f) for name, f in maximal.items() if name in own]))
    compared = [_compared(name, own[name], truth) for name, truth in published.items() if name in own]
    if compared:
        parts.append(_BOLTZMANN)
        parts.append(_table(("volume", "published, mD", "network", "Laplace"), compared))
    if "berea_400" in own:
        f = own["berea_400"]
        parts.append(
            _PUBLISHED.format(
                own=f"geofit finds {f['pores']:,} pores and {f['throats']:,} throats in Berea 400³, coordination "
                f"{f['coordination']:.2f}, mean radii {f['radius_um'][0]:.2f} and {f['radius_um'][1]:.2f} µm; their "
                f"volume differs from the connected pore space by {100 * f['porosity_gap']:+.2f} %."
            )
        )
    parts.append(_TRUTHS)
    parts.append(_table(("number", "what", "asked", "measured", "test"), [tuple(line) for line in truths]))
    # The sweep of the parameters is measured apart from this page.
    parts.append(kept(docs / "pores.md"))
    (docs / "pores.md").write_text("\n".join(parts), encoding="utf-8")
    _picture(own, docs / "images" / "pores.png")


def _own_row(name: str, f: Mapping[str, Any]) -> tuple[object, ...]:
    counts = f"{f['balls']:,}", f["union_differs"], f"{f['pores']:,}", f"{f['throats']:,}", f"{f['coordination']:.2f}"
    k = " / ".join(f"{value:.0f}" for value in f["permeability"])
    solved = " / ".join(f"{value:.0f}" for value in f["laplace"]) if f["laplace"] else "–"
    return name, *counts, k, solved, f"{f['seconds_network']:.2f}", f"{f['seconds_balls']:.2f}", f"{f['memory_gb']:.2f}"


def _pnextract_row(name: str, own: Mapping[str, Any], f: Mapping[str, Any]) -> tuple[object, ...]:
    times = f["seconds"] / (own["seconds_network"] + own["seconds_balls"])
    return name, f"{f['seconds']:.1f}", f"{times:.1f}", f"{f['pores']:,}", f"{f['throats']:,}"


def _compared(name: str, f: Mapping[str, Any], published: tuple[float, ...]) -> tuple[str, ...]:
    """Return published permeabilities, and how far network and Laplace's equation are from them."""
    rows = [" / ".join(f"{k:.0f}" for k in published)]
    for found in (f["permeability"], f["laplace"]):
        rows.append(" / ".join(f"{100 * (k / truth - 1):+.1f} %" for k, truth in zip(found, published, strict=False)))
    return name, *rows


def _peer_rows(own: Mapping[str, Any], peers: Mapping[str, Any]) -> list[tuple[object, ...]]:
    rows: list[tuple[object, ...]] = []
    for name, peer in peers.items():
        if "error" in peer or name not in own:
            rows.append((name, peer.get("error", "–"), "", "", "", "", ""))
            continue
        times = peer["seconds"] / (own[name]["seconds_network"] + own[name]["seconds_balls"])
        k = " / ".join(f"{v:.0f}" for v in peer["permeability"]) if peer["permeability"] else peer["permeability_error"]
        counts = f"{peer['pores']:,}", f"{peer['throats']:,}"
        rows.append((name, f"{peer['seconds']:.1f}", f"{times:.1f}", f"{peer['memory_gb']:.2f}", *counts, k))
    return rows


def _table(header: tuple[str, ...], rows: list[tuple[object, ...]]) -> str:
    lines = [header, ("---",) * len(header), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def _picture(own: Mapping[str, Any], path: Path) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, all_axes = plt.subplots(1, max(len(own), 1), figsize=(3.1 * max(len(own), 1), 2.9), squeeze=False)
    for axes, (name, figures) in zip(all_axes[0], own.items(), strict=False):
        pores, throats = (np.array(values) for values in figures["radii_um"])
        edges = np.linspace(0, np.quantile(pores, 0.995), 26)
        for values, colour, label in ((throats, "#d9a441", "throats"), (pores, "#0b5c8a", "pores")):
            share = np.full(len(values), 100 / len(values))
            axes.hist(values, edges, weights=share, color=colour, alpha=0.75, label=label)
        axes.set_title(name.replace("_", " ") + "³", loc="left", fontsize=10)
        axes.set_xlabel("radius, µm")
        axes.spines[["top", "right"]].set_visible(False)
    all_axes[0][0].set_ylabel("share, %")
    all_axes[0][-1].legend(frameon=False)
    figure.tight_layout()
    figure.savefig(path, dpi=140, metadata={"Software": ""})
    plt.close(figure)
