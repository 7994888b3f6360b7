"""TOML that somebody wrote: read, or refused with the line that is wrong."""

from __future__ import annotations

import tomllib
from typing import Any

from geofit.data.errors import InputError
from geofit.data.messages import Message, message
from geofit.io.parser_errors import parser_message

__all__ = ["parse_toml"]


def parse_toml(data: bytes, file: str, see: Message) -> dict[str, Any]:
    """Return what a TOML file holds.

    Parameters
    ----------
    data : bytes
        The file.
    file : str
        Its name, for errors.
    see : Message
        Where its keys are documented.

    Raises
    ------
    InputError
        If it is not UTF-8, not valid TOML, or nested too deeply.
    """
    try:
        return tomllib.loads(data.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        what, _ = parser_message(error)
        raise InputError(
            message("import.file-not-utf", "The file is not UTF-8: {error}", error=what),
            message("io.save-toml-as-utf8", "Save it as UTF-8."),
            file=file,
        ) from None
    except RecursionError:
        raise InputError(message("io.nested-too-deeply", "The file is nested too deeply"), see, file=file) from None
    except ValueError as error:  # also a number of more than 4,300 digits
        what, line = parser_message(error)
        raise InputError(
            message("io.toml-invalid", "The file is not valid TOML: {error}", error=what), see, file=file, row=line
        ) from None
