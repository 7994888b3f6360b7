"""``python -m geofit`` is the command ``geofit``."""

from geofit.cli.main import main

main()
