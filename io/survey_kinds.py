"""Whether a file is a survey along centre lines, by its ending and its first lines."""

from __future__ import annotations

from pathlib import Path

from geofit.data.errors import InputError
from geofit.io.centreline import CENTRELINE
from geofit.io.columns import plain_name
from geofit.io.sniff import decode, find_separator, split_line

__all__ = ["SURVEY_ENDINGS", "is_survey"]

#: Endings that surveys of caves have, and those of tables that may be a centre line.
SURVEY_ENDINGS = (".dat", ".svx", ".csv", ".txt")
#: Bytes that show what a file is.
_HEAD = 1 << 14
#: The sizes of a section that no other table of a site has together.
_SECTIONS = ({"radius"}, {"width", "height"}, {"left", "right", "up", "down"})


def is_survey(path: str | Path) -> bool:
    """Return whether a file is a Compass or Survex survey, or a text table of a centre line.

    Parameters
    ----------
    path : str or Path
        The file; a file that is missing or is not text is not a survey.

    Returns
    -------
    bool
        True for ``.svx``, for a ``.dat`` with the head of a Compass survey (other programs use this ending too), and
        for a ``.csv`` or ``.txt`` whose header has x, y, z and a radius, width and height, or left, right, up and down.
    """
    path = Path(path)
    ending = path.suffix.casefold()
    if ending not in SURVEY_ENDINGS or not path.is_file():
        return False
    if ending == ".svx":
        return True
    try:
        lines = _first_lines(path)
    except (InputError, OSError):
        return False
    if ending == ".dat":
        return any(line.strip().upper().startswith("SURVEY NAME:") for line in lines)
    return bool(lines) and _is_centreline(split_line(lines[0], find_separator(lines[:20])))


def _first_lines(path: Path) -> list[str]:
    """Return the first lines that are not blank or comments; one that may be cut off is left out."""
    with path.open("rb") as stream:
        data = stream.read(_HEAD)
    whole = data if len(data) < _HEAD else data[: data.rfind(b"\n") + 1]
    text, _ = decode(whole, path.name)
    return [line for line in text.splitlines() if line.strip() and not line.startswith("#")]


def _is_centreline(header: list[str]) -> bool:
    names = {plain_name(cell)[0] for cell in header}
    roles = {role for role, words in {**CENTRELINE.required, **CENTRELINE.optional}.items() if names & set(words)}
    return roles >= {"x", "y", "z"} and any(roles >= sizes for sizes in _SECTIONS)
