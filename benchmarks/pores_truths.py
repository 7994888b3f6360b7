"""Figures of the pore tools on bodies whose truth is known, one for each acceptance test that has a figure.

Run ``python benchmarks/pores_truths.py``. It takes about two minutes; ``pores.py --page`` writes the result into
docs/pores.md. Tests that assert equality are named without a figure.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "tests" / "pores")]

from medial_shapes import branches, cone_distance, voxels  # noqa: E402
from shapes import capsules, pack  # noqa: E402

from geofit.medial.agreement import betti  # noqa: E402
from geofit.medial.fit import metaballs  # noqa: E402
from geofit.pores import (  # noqa: E402
    RockVolume,
    before_after,
    kozeny_permeability,
    kozeny_ratio,
    laplace_permeability,
    network_permeability,
    pore_network,
    pore_surface,
    surface_area,
)

#: Drag of sphere packs (Zick & Homsy 1982): lattice, solid fraction, coefficient, edges of the cell in voxels.
PACKS = (
    ("sc", 0.125, 4.292, (30,)),
    ("sc", 0.343, 15.4, (30,)),
    ("sc", 0.5236, 42.1, (20, 30, 40, 60)),
    ("bcc", 0.6802, 162.9, (40, 46, 60, 70, 90)),
    ("fcc", 0.7405, 438.0, (40, 50, 57, 64, 84, 96)),
)


class Line(NamedTuple):
    """Number of the acceptance test, what it is about, what is asked, what was measured, and where it is tested."""

    number: str
    about: str
    asked: str
    found: str
    test: str


def volume_of(pore: np.ndarray) -> RockVolume:
    return RockVolume(pore, pore=True, voxel=1.0)


def percent(found: float, truth: float) -> str:
    return f"{100 * (found / truth - 1):+.1f} %"


def simple_cubic() -> Line:
    network = pore_network(volume_of(pack("sc", 20, 3)))
    body = np.abs(network.pores.inscribed - 0.3660 * 20).max()
    window = np.abs(network.throats.inscribed - 0.2071 * 20).max()
    return Line(
        "8",
        "simple cubic pack, 20 voxels",
        "0.5 voxel; 6 links",
        f"{body:.2f} and {window:.2f} voxel; {network.coordination.max()} links",
        "test_network: simple_cubic_pack",
    )


def body_centred() -> Line:
    network = pore_network(volume_of(pack("bcc", 40, 2)))
    inner = ~network.pores.faces.any(axis=1)
    gap = np.abs(network.pores.inscribed[inner] - 0.2910 * 40 * np.sqrt(3) / 4).max()
    links = network.coordination[inner]
    return Line(
        "10",
        "body-centred pack, 40 voxels",
        "0.5 voxel; 4 links",
        f"{gap:.2f} voxel; {np.median(links):.0f} links (median), {100 * (links == 4).mean():.0f} % of pores with 4",
        "test_network: body_centred_pack",
    )


def trees() -> list[Line]:
    a, b = np.array([0.3, 0.6, 0.1]), np.array([60.3, 80.6, 0.1])
    body, low = voxels([(a, b, 8.0, 8.0)])
    found = metaballs(volume_of(body), max_balls=20)
    mesh = found.triangulate(1.0)
    away = np.abs(cone_distance(mesh.vertices + low, a, b, 8.0, 8.0)).max()
    truth = np.pi * 64 * 100 + 4 / 3 * np.pi * 512
    lines = [
        Line(
            "18",
            "capsule, 20 balls at most",
            "Dice 0.98; 1 %; 0.75 voxel",
            f"{len(found)} balls, Dice {found.dice:.4f}; {percent(mesh.volume, truth)}; {away:.2f} voxel",
            "medial/test_fit: a_capsule_in_any_direction",
        )
    ]
    body, _ = voxels(branches(0))
    metaballs(volume_of(np.ones((5, 5, 5), bool)))
    began = time.process_time()
    found = metaballs(volume_of(body), max_balls=300)
    took = time.process_time() - began
    full = sum(found.candidates - ball for ball in range(len(found)))
    lines += [
        Line(
            "16",
            f"lazy choice, tree of {body.size / 1e6:.1f} million voxels",
            "1 % of the full search; 5 s",
            f"{100 * found.evaluations / full:.2f} %: {found.evaluations:,} of {full:,}; {took:.1f} s",
            "medial/test_greedy: the_lazy_choice_is_the_full_search",
        ),
        Line(
            "19",
            "tree of 15 branches",
            "Betti (1, 0); 2 %",
            f"{betti(found.covered())[:2]}; {percent(found.figures.volume, body.sum())}",
            "medial/test_fit: a_tree_keeps_topology_volume_and_tips",
        ),
    ]
    edges = (0.88, 0.88, 1.5)
    body, _ = voxels(branches(2, levels=2, stem=40, radius=8), edges)
    found = metaballs(RockVolume(body, pore=True, voxel=edges), max_balls=300)
    lines.append(
        Line(
            "35",
            "tree in voxels 0.88 x 0.88 x 1.5",
            "Dice 0.97, 300 balls at most",
            f"Dice {found.dice:.4f}, {len(found)} balls",
            "medial/test_fit: voxels_that_are_not_cubes",
        )
    )
    return lines


def surfaces() -> list[Line]:
    gaps, same = [], []
    for lattice, phi, cell in (("sc", 0.4764, 40), ("bcc", 0.3198, 46), ("fcc", 0.2595, 57)):
        volume = volume_of(pack(lattice, cell, 1))
        network = pore_network(volume)
        body = pore_surface(volume, network)
        gaps.append(body.porosity - phi)
        same.append((betti(body.voxels()), betti(network.pore_of > 0)))
    areas = []
    for radius in (10, 17.3, 40):
        x = np.arange(-int(radius) - 3, int(radius) + 4)
        ball = x[:, None, None] ** 2 + x[:, None] ** 2 + x**2 <= radius**2
        areas.append(surface_area(ball) / (4 * np.pi * radius**2) - 1)
    return [
        Line(
            "21",
            "porosity of packs by contacts",
            "0.002",
            ", ".join(f"{gap:+.4f}" for gap in gaps),
            "test_generated: the_contact_surface_keeps_the_porosity_of_packs",
        ),
        Line(
            "–",
            "Betti numbers of packs after the surface",
            "those of the voxels",
            ", ".join(f"{b[:2]} of {v[:2]}" for b, v in same),
            "test_topology",
        ),
        Line(
            "22",
            "area of spheres, radius 10 to 40",
            "2 %",
            ", ".join(f"{100 * a:+.1f} %" for a in areas),
            "test_measures: area_of_spheres",
        ),
    ]


def ducts() -> list[Line]:
    x = np.arange(-11, 12) + 0.3
    section = x[:, None] ** 2 + x**2 <= 64
    tube = volume_of(np.repeat(section[None], 20, axis=0))
    truth = section.sum() ** 2 / (8 * np.pi) / section.size
    square = volume_of(np.pad(np.ones((20, 16, 16), bool), ((0, 0), (3, 3), (3, 3))))
    slit = volume_of(np.pad(np.ones((20, 16, 12), bool), ((0, 0), (3, 3), (0, 0))))
    found = [network_permeability(pore_network(v)).square_metres[0] for v in (tube, square, slit)]
    solved = [laplace_permeability(v).square_metres[0] for v in (tube, square, slit)]
    truths = truth, 0.035144 * 16**4 / 22**2, 16**3 / 12 / 22
    names = "tube", "square", "slit"
    rows = [f"{n} {percent(f, t)} / {percent(s, t)}" for n, f, s, t in zip(names, found, solved, truths, strict=True)]
    lines = [
        Line(
            "23",
            "permeability of ducts, network / Laplace",
            "1 % tube, 3 % square; 3 % tube, 5 % slit",
            ", ".join(rows),
            "test_permeability: tubes, square_ducts, slits",
        )
    ]
    rows = []
    for lattice, solid, drag, cells in PACKS:
        count = {"sc": 1, "bcc": 2, "fcc": 4}[lattice]
        radius = (3 * solid / (4 * np.pi * count)) ** (1 / 3)
        gaps = []
        for cell in cells:
            volume = volume_of(pack(lattice, cell, 1, radius=radius))
            truth = 2 * radius**2 / (9 * solid * drag) * cell**2
            network = network_permeability(pore_network(volume)).square_metres[0]
            laplace = laplace_permeability(volume).square_metres[0]
            gaps.append((percent(network, truth), percent(laplace, truth)))
        voxels = ", ".join(f"{cell}: {n} / {k}" for cell, (n, k) in zip(cells, gaps, strict=True))
        rows.append(f"{lattice} {solid}, voxels a cell {voxels}")
    lines.append(
        Line(
            "24",
            "permeability of packs, network / Laplace",
            "25 % / 15 %",
            "; ".join(rows),
            "test_permeability: packs",
        )
    )
    after = 0.075 * kozeny_ratio(0.178, 0.171)
    lines.append(
        Line(
            "25",
            "table 1 of the article",
            "0.0654 µm², d_p 40.2 µm",
            f"{after:.4f} µm², K(40.2 µm) {1e12 * kozeny_permeability(0.178, 40.2e-6):.4f} µm²",
            "test_permeability: the_articles_table",
        )
    )
    return lines


def graphs() -> Line:
    bell = capsules((21, 21, 60), [((10, 10, 10), (10, 10, 10), 8.4), ((10, 10, 49), (10, 10, 49), 8.4)])
    bell |= capsules((21, 21, 60), [((10, 10, 10), (10, 10, 49), 3.4)])
    network = pore_network(volume_of(bell))
    return Line(
        "11",
        "dumb-bell",
        "2 pores, 1 throat",
        f"{len(network.pores)} pores, {len(network.throats)} throat",
        "test_network, test_generated",
    )


def before_and_after(volume: RockVolume) -> Line:
    network = pore_network(volume)
    body = pore_surface(volume, network)
    table = before_after(volume, network, body)
    change = table.after.connectivity.connected / volume.porosity - 1
    kept = table.after.connectivity.porosity / network.porosity - 1
    return Line(
        "28",
        "Berea 110³ before and after",
        "-5 to 0 %; contact within 1 %",
        f"porosity {volume.porosity:.4f}, {100 * change:+.1f} % ({100 * table.dropped:.2f} % of the rock dropped); "
        f"contact {100 * kept:+.2f} %; Kozeny ratio {table.kozeny_ratio:.3f}",
        "test_permeability: kozeny_is_an_upper_bound_on_rock",
    )


#: Acceptance tests that assert equality or a bound, and need no figure.
ASSERTED = (
    Line("1", "distance map against scipy", "equal", "asserted", "test_distance: equal_to_scipy"),
    Line("2", "26 rays against the distance map", "equal", "asserted", "test_distance: one_pass"),
    Line("3", "chamfer masks", "0.001; Dijkstra", "asserted", "medial/test_chamfer, medial/test_weights"),
    Line("4", "maximal balls, 200 seeds", "brute force", "asserted", "test_balls: the_same_balls_as_brute_force"),
    Line(
        "6",
        "the article's rule errs both ways",
        "684 and 1,181 pairs",
        "asserted",
        "test_balls: the_articles_rule_errs",
    ),
    Line("7", "tube, plate, cube", "1 pore", "asserted", "test_network, test_hierarchy"),
    Line("9", "face-centred pack", "0.5 voxel; 8 and 4 links", "asserted", "test_network: face_centred_pack"),
    Line("12", "one ball", "sphere", "asserted", "medial/test_balls: a_lone_ball_is_a_sphere"),
    Line("13", "two balls", "bounds", "asserted", "test_blend: two_balls"),
    Line("14", "chain of balls", "0.001", "asserted", "medial/test_kernel: the_radius_of_a_chain"),
    Line("15", "continuity", "value and slope", "asserted", "test_blend: normals, seams"),
    Line("17", "radius search", "1,000 radii", "asserted", "medial/test_greedy: the_radius_search"),
    Line("20", "medial points of a body of revolution", "0.87 voxel", "asserted", "medial/test_axis"),
    Line("29", "48 rotations", "isomorphic", "asserted", "test_network: the_48_rotations"),
    Line("30", "slabs of 40 slices", "the whole", "asserted", "test_slabs: berea_200_in_slabs_of_40_slices"),
    Line("31", "sphere in 1 x 1 x 2 voxels", "1 %", "asserted", "test_balls: a_sphere_in_long_voxels"),
    Line("32", "degenerate volumes", "clear errors", "asserted", "test_volume"),
    Line("33", "meshes", "closed, manifold, 1 %", "asserted", "test_surface: the_mesh_is_closed"),
    Line("34", "centre lines, loops", "1 %; 1e-9 m", "asserted", "caves/test_body, caves/test_adjust"),
)


def truths(berea_110: RockVolume | None) -> list[Line]:
    """Return all lines, by number; those of the real rock only where it is present."""
    lines = [*ASSERTED, simple_cubic(), body_centred(), graphs(), *trees(), *surfaces(), *ducts()]
    if berea_110 is not None:
        lines.append(before_and_after(berea_110))
    return sorted(lines, key=lambda line: int(line.number) if line.number.isdigit() else 99)


if __name__ == "__main__":
    from pores_rocks import folder
    from pores_rocks import volume_of as rock

    for line in truths(rock("berea_110") if folder().is_dir() else None):
        print(" | ".join(line))
