"""What is installed here: packages, versions, licences, and known advisories where they can be looked up.

``make audit`` runs it, with pip-audit where that can be installed. The run fails for a known advisory; it does not
where advisories are out of reach, and reports it.
"""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from importlib.metadata import Distribution, distributions

__all__ = ["advisories", "licence_of", "packages"]

#: Licences that a dependency must not have.
REFUSED = ("AGPL", "AFFERO")
_LONGEST = 60
#: Seconds that the look-up of advisories may take.
PATIENCE = 300.0


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


def advisories(seconds: float = PATIENCE) -> tuple[list[str], str]:
    """Return the known advisories, a line each, and why they could not be looked up; that is empty if they were."""
    if importlib.util.find_spec("pip_audit") is None:
        return [], "pip-audit is not installed (python -m pip install pip-audit)"
    command = [sys.executable, "-m", "pip_audit", "--local", "--format", "json", "--progress-spinner", "off"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=seconds)
        found = json.loads(done.stdout)["dependencies"]
    except subprocess.TimeoutExpired:
        return [], f"pip-audit had no answer after {seconds:g} s"
    except (ValueError, KeyError, TypeError):
        return [], (done.stderr.strip().splitlines() or ["pip-audit wrote no report"])[-1]
    return [
        f"{package['name']} {package['version']}: {one['id']}, mended in {', '.join(one['fix_versions']) or 'none'}"
        for package in found
        for one in package.get("vulns", ())
    ], ""


def main() -> int:
    """Print the list; return 1 for a refused licence or an advisory."""
    listed = packages()
    for name, version, licence in listed:
        print(f"{name:32} {version:16} {licence}")
    refused = [name for name, _, licence in listed if any(word in licence.upper() for word in REFUSED)]
    print(f"{len(listed)} packages; refused licences: {', '.join(refused) or 'none'}")
    known, why = advisories()
    if why:
        print(f"Advisories were not looked up: {why}.")
    else:
        print(f"Known advisories: {len(known)}", *known, sep="\n  ")
    return 1 if refused or known else 0


if __name__ == "__main__":
    sys.exit(main())
