"""The text of a STEP file made canonical: same surfaces, same bytes."""

from __future__ import annotations

import re

__all__ = ["canonical"]

#: Colours of the products in turn (red, green, blue): earth tones that stay apart.
COLOURS = ((0.76, 0.60, 0.42), (0.55, 0.64, 0.45), (0.45, 0.56, 0.68), (0.70, 0.47, 0.43), (0.60, 0.52, 0.66))

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


def canonical(text: str) -> str:
    """Return the text of a STEP file that is the same whenever and wherever it was written.

    What OpenCASCADE counts through the life of its process is counted anew; colours, which it writes in the
    order of memory addresses, are added here; characters beyond ASCII are encoded.

    Parameters
    ----------
    text : str
        A file by OpenCASCADE without colours.

    Returns
    -------
    str
        ASCII, with a coloured style for each sewn shell.
    """
    count = iter(range(1, len(text)))
    text = re.sub(r"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\(')\d+'", lambda m: f"{m[1]}{next(count)}'", text)
    text = re.sub(r"(Open CASCADE STEP translator [\d.]+) \d+(\.\d+)*", r"\1", text)
    return re.sub(r"[^\x00-\x7f]+", _encoded, _coloured(text))


def _coloured(text: str) -> str:
    head, end, tail = text.rpartition("ENDSEC;")
    free = max(int(number) for number in re.findall(r"^#(\d+) =", head, re.M)) + 1
    products = re.findall(
        r"MANIFOLD_SURFACE_SHAPE_REPRESENTATION\(\s*'[^']*'\s*,\s*\(\s*#\d+\s*,\s*#(\d+)\s*\)\s*,\s*#(\d+)",
        head,
    )
    styles = []
    for index, (item, context) in enumerate(products):
        red, green, blue = COLOURS[index % len(COLOURS)]
        numbers = range(free + 9 * index, free + 9 * index + 9)
        styles.append(STYLE.format(*numbers, item=item, context=context, red=red, green=green, blue=blue))
    return head + "".join(styles) + end + tail


def _encoded(match: re.Match[str]) -> str:
    """Encode characters as ISO 10303-21, 6.4.3 demands."""
    basic = max(match[0]) <= "\uffff"
    directive, code = ("\\X2\\", "utf-16-be") if basic else ("\\X4\\", "utf-32-be")
    return directive + match[0].encode(code).hex().upper() + "\\X0\\"
