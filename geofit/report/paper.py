"""Paper of drawings to scale: a frame, a title block, pages as PDF and SVG; sections and plans use the same."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geofit.data.files import file_stems, replacing
from geofit.data.languages import Language, translate
from geofit.data.lengths import LENGTH_UNITS, LengthUnit
from geofit.data.messages import some_of
from geofit.data.stale import stale_warning
from geofit.report.style import MUTED, TEXT, WARNING, drawing, shortened, text_width

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "BLOCK",
    "EDGE",
    "PAPERS",
    "SCALES",
    "SheetTitle",
    "drawing_scale",
    "framed_page",
    "save_pdf",
    "save_svg",
    "scales_of",
    "svg_files",
]

#: Paper in landscape, millimetres.
PAPERS = {"A4": (297.0, 210.0), "A3": (420.0, 297.0), "A1": (841.0, 594.0), "A0": (1189.0, 841.0)}
#: Scales on offer, 1 : so many; where lengths are feet, an inch is 10, 20, 30 ... feet.
SCALES = (100, 200, 250, 500, 1000, 2000, 2500, 5000, 10_000, 20_000, 25_000, 50_000, 100_000)
SCALES_FEET = (120, 240, 360, 480, 600, 1200, 2400, 3600, 4800, 6000, 12_000, 24_000, 36_000, 60_000, 120_000)
#: Millimetres: frame from the paper's edge, title block; its cells, above which a warning has its own.
EDGE, BLOCK = 10.0, 24.0
CELLS = BLOCK - 8.0
#: Points of the warning.
_STALE_SIZE = 8.0
#: Lines of the patterns, and letters of the PDF as text.
_THIN: dict[Any, Any] = {"hatch.linewidth": 0.25, "pdf.fonttype": 42}


@dataclass(frozen=True)
class SheetTitle:
    """What the title block says; empty lines stay empty. ``date`` is ISO 8601.

    ``unit`` is that of all numbers drawn, but for eastings and northings where the site's ``grid`` has another one.
    """

    title: str
    project: str = ""
    number: str = ""
    author: str = ""
    date: str = ""
    unit: LengthUnit = "m"
    grid: LengthUnit | None = None

    def shown(self, metres: float) -> float:
        """Return a length in the unit of the drawing, free of the rounding of the conversion."""
        return round(metres / LENGTH_UNITS[self.unit], 6)

    def on_grid(self, metres: float) -> float:
        """Return an easting or northing in the unit of the grid."""
        return round(metres / LENGTH_UNITS[self.grid or self.unit], 6)


def scales_of(unit: LengthUnit) -> tuple[int, ...]:
    """Return the scales on offer for drawings in a unit."""
    return SCALES if unit == "m" else SCALES_FEET


def drawing_scale(scale: int, unit: LengthUnit) -> str:
    """Return a scale as a title block has it; in feet also how many an inch is.

    Examples
    --------
    >>> drawing_scale(500, "m"), drawing_scale(1200, "ft")
    ('1:500', '1:1200 (1 in = 100 ft)')
    """
    return f"1:{scale}" if unit == "m" else f"1:{scale} (1 in = {scale / 12:g} ft)"


def framed_page(
    paper: str, block: SheetTitle, name: str, line: str, scale: str, sheet: tuple[int, int], t: Language,
    stale: Sequence[str] = (),
) -> Figure:  # fmt: skip
    """Return a page with frame, title and title block.

    ``name`` follows the title over the drawing, ``line`` is the small line below them; ``scale`` as it is printed;
    ``sheet`` is the number of the page and of all pages; ``stale`` names what is drawn and is older than its data.
    """
    from matplotlib.figure import Figure
    from matplotlib.patches import Rectangle

    wide, high = PAPERS[paper]
    figure = Figure(figsize=(wide / 25.4, high / 25.4), dpi=72)

    def box(x: float, y: float, width: float, height: float) -> None:
        figure.add_artist(
            Rectangle((x / wide, y / high), width / wide, height / high, fill=False, ec=TEXT, lw=0.7,
                      transform=figure.transFigure)
        )  # fmt: skip

    box(EDGE, EDGE, wide - 2 * EDGE, high - 2 * EDGE)
    title = f"{block.title} · {name}" if name else block.title
    figure.text((EDGE + 6) / wide, (high - EDGE - 9) / high, title, size=13, weight="bold", color=TEXT)
    figure.text((EDGE + 6) / wide, (high - EDGE - 14) / high, line, size=7, color=MUTED)
    cells = (
        (t("Project"), block.project, 0.28),
        (t("Drawing number"), block.number, 0.16),
        (t("Prepared"), block.author, 0.16),
        (t("Date"), block.date, 0.12),
        (t("Scale"), scale, 0.2),
        (t("Sheet"), f"{sheet[0]} / {sheet[1]}", 0.08),
    )
    at, width = EDGE, wide - 2 * EDGE
    for word, value, share in cells:
        box(at, EDGE, share * width, CELLS)
        figure.text((at + 2) / wide, (EDGE + BLOCK - 12) / high, word, size=6, color=MUTED)
        figure.text((at + 2) / wide, (EDGE + 4) / high, value, size=8.5, color=TEXT)
        at += share * width
    if stale:
        box(EDGE, EDGE + CELLS, width, BLOCK - CELLS - 1)
        text = _stale_line(stale, width - 6, t)
        figure.text(
            (EDGE + 2) / wide, (EDGE + CELLS + 2.4) / high, text, size=_STALE_SIZE, weight="bold", color=WARNING
        )
    return figure


def _stale_line(names: Sequence[str], room: float, t: Language) -> str:
    """Return the warning of what is older than its data, with as many names as fit on a line (mm)."""
    short, text = [shortened(name) for name in names], ""
    for most in range(len(short), 0, -1):
        text = translate(stale_warning(some_of(short, most)), t)
        if text_width(text, _STALE_SIZE) <= room:
            break
    return text


def save_pdf(pages: Iterable[Callable[[], Figure]], title: str, path: str | PathLike[str]) -> None:
    """Write pages, each made when its turn comes, as one PDF."""
    import matplotlib as mpl
    from matplotlib.backends.backend_pdf import PdfPages

    information: dict[str, Any] = {"CreationDate": None, "ModDate": None, "Title": title}
    with drawing(8.0), mpl.rc_context(_THIN), replacing(path) as part, PdfPages(part, metadata=information) as written:
        for page in pages:
            written.savefig(page())


def save_svg(
    pages: Iterable[Callable[[], Figure]], names: Sequence[str], path: str | PathLike[str]
) -> tuple[Path, ...]:
    """Write pages as SVG, one file each; several get their names. Return the files."""
    import matplotlib as mpl

    files = svg_files(names, Path(path))
    with drawing(8.0), mpl.rc_context({**_THIN, "svg.hashsalt": "geofit", "svg.fonttype": "path"}):
        for page, file in zip(pages, files, strict=True):
            figure = page()
            with replacing(file) as part:
                figure.savefig(part, format="svg", metadata={"Date": None})
    return files


def svg_files(names: Sequence[str], path: Path) -> tuple[Path, ...]:
    """Return the files that :func:`save_svg` writes."""
    if len(names) == 1:
        return (path,)
    stems = file_stems([name or str(k) for k, name in enumerate(names, 1)])
    return tuple(path.with_name(f"{path.stem}_{stem}{path.suffix}") for stem in stems.values())
