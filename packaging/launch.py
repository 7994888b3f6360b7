"""The packaged programs: ``geofit-gui`` opens the window, ``geofit`` is the command line."""

import multiprocessing
import sys
from pathlib import Path

if __name__ == "__main__":
    multiprocessing.freeze_support()  # tasks beside the window start this program once more
    if sys.argv[1:4] == ["-P", "-m", "geofit.cad.foreign"]:  # and so does the reading of foreign CAD files
        from geofit.cad.foreign import child

        sys.exit(child(sys.argv[4:]))
    if Path(sys.executable).stem.endswith("gui"):
        from geofit.gui.app import main
    else:
        from geofit.cli.main import main
    sys.exit(main())
