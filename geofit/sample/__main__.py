"""``python -m geofit.sample OUT`` writes the sample site into the folder OUT."""

from __future__ import annotations

import argparse

from geofit.sample.site import write_site


def main() -> None:
    """Write the sample site and print how many points each horizon has."""
    parser = argparse.ArgumentParser("python -m geofit.sample", description="Write the sample site.")
    parser.add_argument("out", metavar="OUT", help="folder to write into; created if missing")
    for horizon, n in write_site(parser.parse_args().out).items():
        print(f"{horizon:<6} {n:>4} points")


if __name__ == "__main__":
    main()
