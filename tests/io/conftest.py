"""A small site of which every number is known."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

SITE = """
[site]
name = "Small"
crs = "local grid"
[boundary]
file = "boundary.csv"
[ground]
file = "ground.asc"
[boreholes]
collar = "collar.csv"
survey = "survey.csv"
intervals = ["lithology.csv", "风化.csv"]
dip = "down-positive"
[adits]
path = "adits.csv"
contacts = "adit_contacts.csv"
[[section]]
name = "C1"
line = [[500000, 3100000], [500300, 3100400], [500300, 3100900]]
file = "sections/C1.csv"
[traces]
file = "outcrops.csv"
[picks]
file = "geophysics.csv"
kind = "geophysics"
[[horizon]]
name = "T2-T1"
base = "T2"
epsilon = 0.25
accuracy = { borehole = 0.03, section = 0.2 }
[[horizon]]
name = "weathering"
base = "强风化"
"""

FILES = {
    "boundary.csv": "x,y\n499900,3099900\n501000,3099900\n501000,3101000\n499900,3101000\n",
    "ground.asc": (
        "ncols 3\nnrows 2\nxllcorner 499500\nyllcorner 3099500\ncellsize 1000\nNODATA_value -9999\n"
        "120 120 120\n100 100 100\n"
    ),
    "collar.csv": "hole,x,y,z,depth\nB1,500100,3100100,110,50\nB2,500200,3100100,111,60\nB3,500300,3100100,112,40\n",
    "survey.csv": "hole,depth,azimuth,dip\nB2,0,90,60\nB2,30,90,60\n",
    "lithology.csv": (
        "hole,from,to,code\nB1,0,5,Q\nB1,5,12,T2\nB1,12,20,T2\nB1,20,50,T1\nB2,0,20,T2\nB2,20,60,T1\nB3,0,40,T2\n"
    ),
    "风化.csv": "孔号,起始深度,终止深度,风化程度\nB1,0,8,强风化\nB1,8,50,弱风化\n",
    "adits.csv": "adit,x,y,z\nPD1,500000,3100500,90\nPD1,500100,3100500,90\nPD1,500100,3100600,91\n",
    "adit_contacts.csv": "adit,chainage,horizon\nPD1,50,T2-T1\n",
    "sections/C1.csv": "horizon,distance,elevation\nT2-T1,0,80\nT2-T1,250,81\nT2-T1,600,82\n",
    "outcrops.csv": "horizon,x,y\nT2-T1,500500,3100500\n",
    "geophysics.csv": "horizon,x,y,z,kind,accuracy\nT2-T1,500600,3100600,70,,0.5\nT2-T1,500700,3100600,71,map,\n",
}


@pytest.fixture
def files() -> dict[str, str]:
    """Return the text of each table of the small site."""
    return FILES


@pytest.fixture
def make_site(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes the small site with some files changed or absent (None)."""

    def make(site: str = SITE, **changes: str | bytes | None) -> Path:
        for name, text in (FILES | {key.replace("__", "/"): value for key, value in changes.items()}).items():
            path = tmp_path / (name if "." in name else name + ".csv")
            path.parent.mkdir(exist_ok=True)
            if text is not None:
                path.write_bytes(text if isinstance(text, bytes) else text.encode())
            elif path.exists():
                path.unlink()
        (tmp_path / "site.toml").write_text(site, encoding="utf-8")
        return tmp_path / "site.toml"

    return make


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes one file."""

    def write(text: str | bytes, name: str = "table.csv", encoding: str = "utf-8") -> Path:
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
        return path

    return write


@pytest.fixture(scope="session")
def real_data() -> Path:
    """Return the folder of real data, or skip."""
    folder = Path(os.environ.get("GEOFIT_DATA", Path(__file__).parents[2] / ".." / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"real data are not at {folder}; set GEOFIT_DATA")
    return folder
