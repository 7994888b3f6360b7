"""The command line: each command registers itself, in the order in which the help lists them.

Exit codes: 0 every sigma < epsilon; 1 some verdict FAIL; 2 bad input or usage; 130 stopped.
"""

from __future__ import annotations

import atexit
import gc
from importlib import import_module

from geofit.cli.app import app

__all__ = ["app", "main"]

_COMMANDS = (
    "demo", "fit", "report", "check", "compare", "info", "import_files", "export", "section", "body", "morph",
    "pores", "metaballs", "cave", "gui",
)  # fmt: skip
for _command in _COMMANDS:
    import_module(f"geofit.cli.{_command}")


def main() -> None:
    """Run the command line."""
    # Python's last garbage collection takes a third of a second, and the process ends anyway.
    atexit.register(gc.freeze)
    app()
