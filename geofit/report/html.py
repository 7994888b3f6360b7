"""The accuracy report as one HTML file: opens offline, prints on A4."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from geofit.data.files import replacing
from geofit.report.document import ReportDocument
from geofit.report.fonts import families

if TYPE_CHECKING:
    from jinja2 import Environment

__all__ = ["write_html"]

#: Where a machine lacks the typeface of the pictures.
BEHIND = ("Helvetica Neue", "Arial", "Microsoft YaHei", "PingFang SC", "sans-serif")


def write_html(document: ReportDocument, images: Mapping[str, bytes], path: Path) -> None:
    """Write a document as HTML with its pictures inside.

    Parameters
    ----------
    document : Document
        Laid out by :func:`geofit.report.chapters.document`.
    images : mapping of str to bytes
        PNG by the names that the document uses.
    path : Path
        The file.
    """
    inside = {name: base64.b64encode(data).decode("ascii") for name, data in images.items()}
    page = _environment().get_template("report.html.j2").render(document=document, images=inside, families=_families())
    with replacing(path) as part:
        part.write_text(page, encoding="utf-8")


def _families() -> str:
    """Return the families of CSS, that of the pictures first: text and plots have one typeface."""
    from markupsafe import Markup

    # The quotes belong to CSS; the names are those of installed fonts.
    return Markup(", ".join(f'"{name}"' if " " in name else name for name in (*families(), *BEHIND)))


def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("geofit.report"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters["kind"] = lambda value: type(value).__name__
    return environment
