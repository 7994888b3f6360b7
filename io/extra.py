"""Optional packages: imported where they are used, with the install line where they are absent."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from geofit.data.distribution import install_line
from geofit.data.errors import MissingDependencyError
from geofit.data.messages import Message, message

__all__ = ["need"]


def need(module: str, extra: str, what: Message) -> Any:
    """Return an optional module.

    Raises
    ------
    MissingDependencyError
        With the install line, if it is not installed.
    """
    try:
        return import_module(module)
    except ImportError as error:
        package = module.split(".")[0]
        raise MissingDependencyError(
            message(
                "io.package-missing",
                "{what} needs the package {package}, which cannot be imported ({error}). Install it: {install}",
                what=what,
                package=package,
                error=error,
                install=install_line(extra),
            )
        ) from None
