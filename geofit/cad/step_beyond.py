"""Patches of a fit that its study area leaves out entirely: in a STEP file, but part of no face.

Points outside the area are measured to the surface as it continues there. Beneath the loops of its faces a file has it
anyway. A patch without a face is stored as a B-spline surface in a property of the product, where CAD systems do not
draw it, so that the file gets the verdict of the fit.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geofit.cad.step_text import products_of
from geofit.splines.patch import Patch

__all__ = ["patches_beyond", "with_patches_beyond"]

Floats = NDArray[np.float64]

#: Name of the property, and of its representation.
NAME = "patches beyond the outline"
_PROPERTY = """\
#{0} = PROPERTY_DEFINITION('{name}','{index}',#{product});
#{1} = PROPERTY_DEFINITION_REPRESENTATION(#{0},#{2});
#{2} = REPRESENTATION('{name}',({surfaces}),#{context});
"""
_SURFACE = re.compile(r"'([^']*)',(\d+),(\d+),\((\(.*?\))\),\.UNSPECIFIED\.(.*)")
_ENTITY = re.compile(r"^#(\d+) = (CARTESIAN_POINT|B_SPLINE_SURFACE_WITH_KNOTS)\((.*)\);$", re.M)


def with_patches_beyond(text: str, patches: Sequence[Sequence[Patch]], metre: float) -> str:
    """Return the text of a STEP file of ours with patches (about each surface's origin) that have no face in it.

    ``patches`` are those of each product, in the products' order (rational ones are left out); ``metre`` is how long a
    metre is in the file's unit.
    """
    head, end, tail = text.rpartition("ENDSEC;")
    free = max(int(number) for number in re.findall(r"^#(\d+) =", head, re.M)) + 1
    added: list[str] = []
    for index, ((product, context), own) in enumerate(zip(products_of(head), patches, strict=True)):
        surfaces = []
        for patch in (one for one in own if one.weights is None):
            lines = list(_surface(patch, free, metre))
            added += lines
            free += len(lines)
            surfaces.append(f"#{free - 1}")
        if surfaces:
            added.append(
                _PROPERTY.format(
                    free, free + 1, free + 2, name=NAME, index=index, product=product, context=context,
                    surfaces=",".join(surfaces),
                )
            )  # fmt: skip
            free += 3
    return head + "".join(added) + end + tail


def patches_beyond(path: Path) -> dict[int, list[Patch]]:
    """Return the patches without a face in a file, about the origins of their surfaces, by the number of the product.

    Another program that writes the file anew leaves them out or writes them in its own way: then there are none.
    """
    text = path.read_text("ascii", errors="replace")
    if f"PROPERTY_DEFINITION('{NAME}'" not in text:
        return {}
    entities = {int(number): (kind, content) for number, kind, content in _ENTITY.findall(text)}
    metre = 1000.0 if re.search(r"SI_UNIT\(\s*\.MILLI\.\s*,\s*\.METRE\.\s*\)", text) else 1.0
    items = dict(re.findall(rf"^#(\d+) = REPRESENTATION\('{NAME}',\(([^)]*)\),#\d+\);$", text, re.M))
    links = dict(re.findall(r"^#\d+ = PROPERTY_DEFINITION_REPRESENTATION\(#(\d+),#(\d+)\);$", text, re.M))
    found: dict[int, list[Patch]] = {}
    with suppress(KeyError, ValueError):
        for number, index in re.findall(rf"^#(\d+) = PROPERTY_DEFINITION\('{NAME}','(\d+)',#\d+\);$", text, re.M):
            surfaces = re.findall(r"#(\d+)", items[links[number]])
            found[int(index)] = [_patch(entities, int(surface), metre) for surface in surfaces]
    return found


def _surface(patch: Patch, free: int, metre: float) -> Iterator[str]:
    """Yield the points of a patch's control net and then its surface, one entity each."""
    nu, nv = patch.control.shape[:2]
    for k, point in enumerate((metre * patch.control).reshape(-1, 3).tolist()):
        yield f"#{free + k} = CARTESIAN_POINT('',({','.join(map(_real, point))}));\n"
    net = ",".join(f"({','.join(f'#{free + i * nv + j}' for j in range(nv))})" for i in range(nu))
    knots = [np.unique(sequence, return_counts=True) for sequence in (patch.knots_u, patch.knots_v)]
    counts = ",".join(f"({','.join(map(str, count.tolist()))})" for _, count in knots)
    values = ",".join(f"({','.join(map(_real, value.tolist()))})" for value, _ in knots)
    name = patch.name if re.fullmatch(r"[\w. -]*", patch.name, re.ASCII) else ""
    yield (
        f"#{free + nu * nv} = B_SPLINE_SURFACE_WITH_KNOTS('{name}',{patch.degree[0]},{patch.degree[1]},({net}),"
        f".UNSPECIFIED.,.F.,.F.,.F.,{counts},{values},.UNSPECIFIED.);\n"
    )


def _patch(entities: dict[int, tuple[str, str]], surface: int, metre: float) -> Patch:
    """Return the patch of a surface that :func:`_surface` wrote."""
    _, content = entities[surface]
    parts = re.fullmatch(r"'([^']*)',(\d+),(\d+),\((\(.*?\))\),\.UNSPECIFIED\.(.*)", content)
    if parts is None:
        raise ValueError(content[:80])
    name, p, q, net, rest = parts.groups()
    rows = [re.findall(r"#(\d+)", row) for row in re.findall(r"\(([^()]*)\)", net)]
    places = [[re.findall(r"[-+.\dE]+", entities[int(k)][1].partition(",")[2]) for k in row] for row in rows]
    counts_u, counts_v, values_u, values_v = (
        re.findall(r"[-+.\dE]+", group) for group in re.findall(r"\(([^()]*)\)", rest)
    )
    return Patch(
        name, (int(p), int(q)), _knots(values_u, counts_u), _knots(values_v, counts_v),
        np.array(places, dtype=np.float64) / metre,
    )  # fmt: skip


def _knots(values: list[str], counts: list[str]) -> Floats:
    return np.repeat(np.array(values, dtype=np.float64), [int(count) for count in counts])


def _real(value: float) -> str:
    """Return a number as ISO 10303-21 writes it, all its digits."""
    mantissa, mark, exponent = repr(value).upper().partition("E")
    return (mantissa if "." in mantissa else f"{mantissa}.") + mark + exponent
