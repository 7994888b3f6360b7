"""What the options of the command line make of the head of a STEP file: who answers for it, where its zero is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.data.title_block import TitleBlock

if TYPE_CHECKING:
    from geofit.cad.step_origin import Origin
    from geofit.data.site import Site
    from geofit.project.step_files import Signed

__all__ = ["signed_by"]


def signed_by(
    site: Site | None, author: str | None, organisation: str | None, origin: str, *, certificate: str = ""
) -> Signed:
    """Return what STEP files state; author and organisation are by default those of the site's report.

    Raises
    ------
    InputError
        If the origin is not known, or the site has no datum.
    """
    from geofit.project.step_files import Signed

    title = site.title if site is not None else TitleBlock()
    return Signed(
        title.author if author is None else author,
        title.organisation if organisation is None else organisation,
        certificate,
        _origin(origin.strip(), site),
    )


def _origin(text: str, site: Site | None) -> Origin:
    if text in ("map", "local"):
        return text
    if text == "datum":
        if site is None or site.datum is None:
            raise InputError(
                message("cli.site-without-datum", "The site states no project datum"),
                message(
                    "cli.give-datum",
                    "Write datum = [E, N, Z] under [site] of the site file, or give the numbers: --origin E,N,Z.",
                ),
                value=text,
            )
        return site.datum
    try:
        easting, northing, elevation = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(
            message("cli.origin-unknown", "The origin '{text}' is unknown", text=text),
            message("cli.give-origin", "Give map, local, datum, or easting, northing and elevation: E,N,Z in metres."),
            value=text,
        ) from None
    return easting, northing, elevation
