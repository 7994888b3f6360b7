"""The page docs/pores.md and its picture, from what benchmarks/pores.py measured."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["write_page"]

_HEAD = """# Pore networks of real rocks

Written by `python benchmarks/pores.py --peers PYTHON --page`; do not edit. Rocks: micro-CT volumes. Times are CPU
time of one process after compiling, on a shared machine of two cores; the peers ran in the same run, in an
environment of their own. "Voxels lost" are those by which the union of the maximal balls differs from the pore space.

![Radii of pores and throats](images/pores.png)
"""
_TAIL = """
Network permeability treats each throat as a straight duct; {published}. OpenPNM's
permeability is that of snow2's network with its model of pyramids and cuboids.
"""


def write_page(rows: Mapping[str, Mapping[str, Any]], published: Mapping[str, float], docs: Path) -> None:
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
        "K, mD",
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
    told = [
        f"of {name} along axis 0 it is {own[name]['permeability'][0]:.0f} mD, and {k:.0f} mD were published (lattice "
        "Boltzmann)"
        for name, k in published.items()
        if name in own
    ]
    parts.append(_TAIL.format(published="; ".join(told) or "no published figure was compared"))
    (docs / "pores.md").write_text("\n".join(parts), encoding="utf-8")
    _picture(own, docs / "images" / "pores.png")


def _own_row(name: str, f: Mapping[str, Any]) -> tuple[object, ...]:
    counts = f"{f['balls']:,}", f["union_differs"], f"{f['pores']:,}", f"{f['throats']:,}", f"{f['coordination']:.2f}"
    k = " / ".join(f"{value:.0f}" for value in f["permeability"])
    return name, *counts, k, f"{f['seconds_network']:.2f}", f"{f['seconds_balls']:.2f}", f"{f['memory_gb']:.2f}"


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
