"""``geofit-gui [site.toml|project.geofit]``: what the machine lacks is reported before a window is tried."""

from __future__ import annotations

import argparse
import multiprocessing
import sys
from collections.abc import Sequence
from pathlib import Path

from geofit import __version__
from geofit.data.errors import GeofitError
from geofit.data.messages import Message, message
from geofit.gui.ready import require_display, require_packages

__all__ = ["main", "start"]


def main(argv: Sequence[str] | None = None) -> int:
    """Run the desktop application; return its exit code, 2 if it cannot start."""
    multiprocessing.freeze_support()
    parser = argparse.ArgumentParser("geofit-gui", description="NURBS surfaces of geological horizons, in a window.")
    parser.add_argument("file", nargs="?", type=Path, metavar="FILE", help="site.toml or project.geofit to open")
    parser.add_argument("--version", action="version", version=f"geofit {__version__}")
    return start(parser.parse_args(argv).file)


def start(file: Path | None) -> int:
    """Open the window, on a file if one is given; say on stderr what is missing if it cannot open, and return 2."""
    try:
        if file is not None and not file.is_file():
            raise GeofitError(
                message(
                    "gui.no-such-file",
                    "There is no file {file}. Give a site file (site.toml) or a project (*.geofit).",
                    file=str(file),
                )
            )
        require_packages()
        require_display()
        # What the window needs takes a second or two to load: first a sign that it is coming.
        from geofit.gui.splash import Splash, application

        application()
        splash = Splash()
        splash.show()
        splash.tell(_words(message("gui.loading", "Loading…")), 0.1)
        from geofit.gui.desktop import Desktop

        splash.tell(_words(message("gui.opening", "Opening the window…")), 0.7)
        desktop = Desktop()
    except GeofitError as error:
        print(f"geofit-gui: {error}", file=sys.stderr)
        return 2
    return desktop.run(file, splash)


def _words(text: Message) -> str:
    """Return a message in the language of the windows, before they have taken it."""
    from geofit.gui.preferences import Preferences
    from geofit.gui.translate import speak, translated

    speak(Preferences().language)
    return translated(text)


if __name__ == "__main__":
    sys.exit(main())
