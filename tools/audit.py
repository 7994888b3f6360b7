"""What is installed here: packages, versions, licences, and known advisories where they can be looked up.

``make audit`` runs it. pip-audit, where it is installed, asks for advisories; it fails the run if it finds any.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from importlib.metadata import Distribution, distributions

__all__ = ["licence_of", "packages"]

#: Licences that a dependency must not have.
REFUSED = ("AGPL", "AFFERO")
_LONGEST = 60


def licence_of(package: Distribution) -> str:
    """Return the licence that a package states: its expression, its classifiers, or the first line of its text."""
    meta = package.metadata
    if expression := meta.get("License-Expression"):
        return str(expression)
    classified = [
        line.split("::")[-1].strip() for line in meta.get_all("Classifier") or [] if line.startswith("License ::")
    ]
    if classified:
        return ", ".join(sorted(set(classified)))
    text = (meta.get("License") or "").strip()
    return text.splitlines()[0][:_LONGEST] if text else "not stated"


def packages() -> list[tuple[str, str, str]]:
    """Return name, version and licence of every installed package, by name."""
    found = {package.metadata["Name"]: package for package in distributions() if package.metadata["Name"]}
    return [(name, found[name].version, licence_of(found[name])) for name in sorted(found, key=str.casefold)]


def main() -> int:
    """Print the list; return 1 for a refused licence or an advisory."""
    listed = packages()
    for name, version, licence in listed:
        print(f"{name:32} {version:16} {licence}")
    refused = [name for name, _, licence in listed if any(word in licence.upper() for word in REFUSED)]
    print(f"{len(listed)} packages; refused licences: {', '.join(refused) or 'none'}")
    if importlib.util.find_spec("pip_audit") is None:
        print("Advisories were not looked up: pip-audit is not installed (pip install pip-audit).")
        return 1 if refused else 0
    return subprocess.run([sys.executable, "-m", "pip_audit", "--local"], check=False).returncode or bool(refused)


if __name__ == "__main__":
    sys.exit(main())
