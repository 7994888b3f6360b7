"""The text of a STEP file made canonical: same surfaces, same bytes."""

from __future__ import annotations

import re
from pathlib import Path

__all__ = ["canonical", "products_of", "read_written", "shaped_products"]

#: Colours of the products in turn (red, green, blue): earth tones that stay apart.
COLOURS = ((0.76, 0.60, 0.42), (0.55, 0.64, 0.45), (0.45, 0.56, 0.68), (0.70, 0.47, 0.43), (0.60, 0.52, 0.66))

#: What has faces in a representation: sewn shells, solids of faces or of triangles.
GEOMETRY = "SHELL_BASED_SURFACE_MODEL|MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS|TESSELLATED_SOLID|TESSELLATED_SHELL"

STYLE = """\
#{0} = MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(#{1}),#{context});
#{1} = STYLED_ITEM('color',(#{2}),#{item});
#{2} = PRESENTATION_STYLE_ASSIGNMENT((#{3}));
#{3} = SURFACE_STYLE_USAGE(.BOTH.,#{4});
#{4} = SURFACE_SIDE_STYLE('',(#{5}));
#{5} = SURFACE_STYLE_FILL_AREA(#{6});
#{6} = FILL_AREA_STYLE('',(#{7}));
#{7} = FILL_AREA_STYLE_COLOUR('',#{8});
#{8} = COLOUR_RGB('',{red},{green},{blue});
"""


def read_written(path: str | Path) -> str:
    """Return the text of a file that OpenCASCADE wrote.

    It breaks strings after 72 bytes, within a character of UTF-8 or a doubled quotation mark too. Line breaks in
    strings have no meaning (ISO 10303-21), and are left out.

    Raises
    ------
    ValueError
        If the text was cut off within a character.
    """
    data = Path(path).read_bytes().replace(b"\r\n", b"\n")
    return re.sub(rb"'[^']*(?:'\n*'[^']*)*'", lambda string: string[0].replace(b"\n", b""), data).decode("utf-8")


def canonical(text: str, colour: str = "") -> str:
    """Return the text of a STEP file that is the same whenever and wherever it was written.

    What OpenCASCADE counts through the life of its process is counted anew; colours, which it writes in the
    order of memory addresses, are added here; characters beyond ASCII are encoded.

    Parameters
    ----------
    text : str
        A file by OpenCASCADE without colours.
    colour : str
        Colour of all products, ``#rrggbb``; empty: a colour of :data:`COLOURS` for each.

    Returns
    -------
    str
        ASCII, with a coloured style for each sewn shell and each solid.
    """
    count = iter(range(1, len(text)))
    text = re.sub(r"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\(')\d+'", lambda m: f"{m[1]}{next(count)}'", text)
    text = re.sub(r"(Open CASCADE STEP translator [\d.]+) \d+(\.\d+)*", r"\1", text)
    return re.sub(r"[^\x00-\x7f]+", _encoded, _coloured(text, colour))


def shaped_products(text: str) -> list[tuple[str, list[str], str]]:
    """Return the representation, the shells or solids in it, and the context of each product that has any: numbers."""
    geometry = set(re.findall(rf"^#(\d+) = (?:{GEOMETRY})\(", text, re.M))
    found = re.findall(
        r"#(\d+) = (?:MANIFOLD_SURFACE_|ADVANCED_BREP_)?SHAPE_REPRESENTATION"
        r"\(\s*'[^']*'\s*,\s*\(([^)]*)\)\s*,\s*#(\d+)",
        text,
    )
    listed = [(number, re.findall(r"#(\d+)", items), context) for number, items, context in found]
    held = [(number, [item for item in items if item in geometry], context) for number, items, context in listed]
    return [(number, items, context) for number, items, context in held if items]


def products_of(text: str) -> list[tuple[str, str]]:
    """Return the numbers of the definition and of the context of each product that is a sewn shell or a solid."""
    shapes = dict(re.findall(r"SHAPE_DEFINITION_REPRESENTATION\(\s*#(\d+)\s*,\s*#(\d+)\s*\)", text))
    by_shape = {shape: definition for definition, shape in shapes.items()}
    definitions = dict(
        re.findall(r"#(\d+) = PRODUCT_DEFINITION_SHAPE\(\s*'[^']*'\s*,\s*'[^']*'\s*,\s*#(\d+)\s*\)", text)
    )
    return [(definitions[by_shape[shape]], context) for shape, _, context in shaped_products(text)]


def _coloured(text: str, colour: str) -> str:
    head, end, tail = text.rpartition("ENDSEC;")
    free = max(int(number) for number in re.findall(r"^#(\d+) =", head, re.M)) + 1
    styles: list[str] = []
    for index, (_, items, context) in enumerate(shaped_products(head)):
        red, green, blue = _shares(colour) if colour else COLOURS[index % len(COLOURS)]
        for item in items:
            numbers = range(free + 9 * len(styles), free + 9 * len(styles) + 9)
            styles.append(STYLE.format(*numbers, item=item, context=context, red=red, green=green, blue=blue))
    return head + "".join(styles) + end + tail


def _shares(colour: str) -> tuple[float, ...]:
    """Return red, green and blue of ``#rrggbb``, 0 to 1."""
    return tuple(round(value / 255, 4) for value in bytes.fromhex(colour.removeprefix("#")))


def _encoded(match: re.Match[str]) -> str:
    """Encode characters as ISO 10303-21, 6.4.3 demands."""
    basic = max(match[0]) <= "\uffff"
    directive, code = ("\\X2\\", "utf-16-be") if basic else ("\\X4\\", "utf-32-be")
    return directive + match[0].encode(code).hex().upper() + "\\X0\\"
