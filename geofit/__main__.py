"""``python -m geofit`` is the command ``geofit``."""

from geofit.cli import main

main()
