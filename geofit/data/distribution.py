"""The name under which geofit is installed; another author's program has the name ``geofit`` on the public index."""

from __future__ import annotations

__all__ = ["DISTRIBUTION", "install_line"]

#: Name of the distribution, as in ``pyproject.toml``; the import name and the commands are ``geofit``.
DISTRIBUTION = "geofit-geology"


def install_line(extra: str) -> str:
    """Return the command that installs an extra's packages.

    It works for a wheel and for a clone: pip finds the distribution installed and adds what the extra lacks.

    Examples
    --------
    >>> install_line("gui")
    'python -m pip install "geofit-geology[gui]"'
    """
    return f'python -m pip install "{DISTRIBUTION}[{extra}]"'
