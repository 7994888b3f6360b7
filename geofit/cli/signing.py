"""What the options of the command line make of the head of a STEP file: who answers for it, where its zero is."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, cast

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.data.title_block import TitleBlock

if TYPE_CHECKING:
    from geofit.cad.step_origin import Origin
    from geofit.data.site import Site
    from geofit.project.step_files import Signed

__all__ = ["read_origin", "signed_by"]

#: An origin as given: map, local, datum (of the site), or easting, northing and elevation in metres.
GivenOrigin = str | tuple[float, float, float]


def read_origin(text: str) -> GivenOrigin:
    """Return the origin that the command line names, before any file is read.

    Raises
    ------
    InputError
        If the text is neither a known word nor three finite numbers.
    """
    word = text.strip()
    if word in ("map", "local", "datum"):
        return word
    try:
        easting, northing, elevation = (float(part) for part in word.split(","))
        if isfinite(easting + northing + elevation):
            return easting, northing, elevation
    except ValueError:
        pass
    raise InputError(
        message("cli.origin-unknown", "The origin '{text}' is unknown", text=text),
        message("cli.give-origin", "Give map, local, datum, or easting, northing and elevation: E,N,Z in metres."),
        value=text,
    )


def signed_by(
    site: Site | None, author: str | None, organisation: str | None, origin: GivenOrigin, *, certificate: str = ""
) -> Signed:
    """Return what STEP files state; author and organisation are by default those of the site's report.

    Raises
    ------
    InputError
        If the origin is the site's datum, and the site has none.
    """
    from geofit.project.step_files import Signed

    title = site.title if site is not None else TitleBlock()
    return Signed(
        title.author if author is None else author,
        title.organisation if organisation is None else organisation,
        certificate,
        _datum_of(site) if origin == "datum" else cast("Origin", origin),
    )


def _datum_of(site: Site | None) -> Origin:
    if site is None or site.datum is None:
        raise InputError(
            message("cli.site-without-datum", "The site states no project datum"),
            message(
                "cli.give-datum",
                "Write datum = [E, N, Z] under [site] of the site file, or give the numbers: --origin E,N,Z.",
            ),
            value="datum",
        )
    return site.datum
