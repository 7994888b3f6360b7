"""Import a package's names on first use; the stub beside the package is their only list.

The stub ``__init__.pyi`` is what editors and type checkers read; :func:`attach` makes the same names work at run
time, as SPEC 1 of Scientific Python proposes. A new name is one line in the stub.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

__all__ = ["attach"]

_LINE = re.compile(r"^from (\S+) import (\w+) as (\w+)$", re.MULTILINE)


def attach(package: str, file: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of a package.

    Parameters
    ----------
    package, file : str
        Its ``__name__`` and ``__file__``; ``__init__.pyi`` lies next to the file, with a line
        ``from MODULE import NAME as NAME`` for each name. A name may be a module itself.
    """
    stub = Path(file).with_name("__init__.pyi").read_text(encoding="utf-8")
    sources = {name: (module, what) for module, what, name in _LINE.findall(stub)}

    def get(name: str) -> Any:
        if name not in sources:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        module, what = sources[name]
        missing = object()
        value = missing if module == package else getattr(import_module(module), what, missing)
        if value is missing:
            value = import_module(f"{module}.{what}")
        setattr(sys.modules[package], name, value)
        return value

    def listed() -> list[str]:
        return sorted({*vars(sys.modules[package]), *sources})

    return get, listed, sorted(sources)
