"""The packaged programs: ``geofit-gui`` opens the window, ``geofit`` is the command line."""

import multiprocessing
import sys
from pathlib import Path

if __name__ == "__main__":
    multiprocessing.freeze_support()  # tasks beside the window start this program once more
    if Path(sys.executable).stem.endswith("gui"):
        from geofit.gui.app import main
    else:
        from geofit.cli.main import main
    sys.exit(main())
