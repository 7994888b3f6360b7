"""Maps, logs, grids, rock volumes and cave surveys: each is read or ends in a geofit error."""

from __future__ import annotations

import gzip
import zipfile
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np

from geofit.io import read_points, read_volume
from geofit.io.boundary import load_boundary
from geofit.io.centreline import read_centreline
from geofit.io.compass import read_compass
from geofit.io.grid import read_ground
from geofit.io.journal import Journal
from geofit.io.las import read_log
from geofit.io.source import Source
from geofit.io.survex import read_survex

__all__ = ["originals", "read"]

COMPASS = """SECRET CAVE
SURVEY NAME: A
SURVEY DATE: 7 10 79  COMMENT:
SURVEY TEAM:
A;B
DECLINATION:    1.00  FORMAT: DDDDLUDRADLNT  CORRECTIONS:  2.00 3.00 4.00

FROM         TO   LEN  BEAR   INC   LEFT    UP  DOWN RIGHT   FLAGS  COMMENTS

  A2         A1  12.00  135.00    5.00  0.00  4.00  0.50  0.00
  A3         A2  10.00   35.00   -5.00  1.00  4.00  0.50  2.00
  A4         A3   9.00  -999.00  90.00  1.00  4.00  -9.00  2.00 #|P# top
"""
SURVEX = """*begin a
*units tape metres
*fix 1 500000 3100000 100
*data normal from to tape compass clino
1 2 10.2 35 -5
2 3 5.5 - DOWN
3 1 7 200 4
*data passage station left right up down
1 1 1 2 0.5
2 1.5 - 2 0.5
*equate 3 4
*end a
"""
LAS = """~VERSION INFORMATION
VERS. 2.0 :
WRAP. NO :
~WELL INFORMATION
STRT.M 0 :
STOP.M 3 :
STEP.M 1 :
NULL. -999.25 :
WELL. B1 :
~CURVE INFORMATION
DEPT.M :
GR.API :
~ASCII
0 10
1 11.5
2 -999.25
3 9
"""
GOCAD = """GOCAD VSet 1
HEADER {
name:T2
}
VRTX 1 500000 3100000 10
PVRTX 2 500100 3100000 12 1.5
VRTX 3 500000 3100100 11
END
"""
GEOJSON = (
    '{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"horizon":"T2"},"geometry":{"type":'
    '"Polygon","coordinates":[[[500000,3100000],[500900,3100000],[500900,3100900],[500000,3100000]]]}}]}'
)


def originals(folder: Path) -> dict[str, bytes]:
    """Return sound files of every kind that can be written here."""
    voxels = (np.random.default_rng(0).random((4, 5, 6)) < 0.3).astype(np.uint8)
    header = "NDims = 3\nDimSize = 6 5 4\nElementType = MET_UCHAR\nElementSpacing = 1 2 3\nElementDataFile = LOCAL\n"
    files = {
        "cave.dat": COMPASS.encode(),
        "cave.svx": SURVEX.encode(),
        "line.csv": b"station,x,y,z,left,right,up,down\n"
        + b"1,1,7,3,1,1,2,0.5\n2,20,7,3,1,1,2,0.5\n3,40,9,4,1,1,2,0.5\n",
        "set.vs": GOCAD.encode(),
        "area.geojson": GEOJSON.encode(),
        "surfer.grd": b"DSAA\n3 2\n500000 500200\n3100000 3100100\n1 9\n1 2 3\n4 1.70141e38 9\n",
        "rock_4x5x6.raw": voxels.tobytes(),
        "rock_4x5x6.raw.gz": gzip.compress(voxels.tobytes()),
        "rock.mha": header.encode() + voxels.tobytes(),
    }
    np.save(folder / "rock.npy", voxels)
    np.savez_compressed(folder / "rock.npz", im=voxels)
    with zipfile.ZipFile(folder / "rock.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.write(folder / "rock.npy", "rock.npy")
    names = ["rock.npy", "rock.npz", "rock.zip", "rock.tif"]
    from PIL import Image

    first, *more = [Image.fromarray(page) for page in voxels]
    first.save(folder / "rock.tif", save_all=True, append_images=more)
    with suppress(ImportError):
        import pyogrio
        import shapely

        points = shapely.to_wkb(shapely.points(500_000 + 10 * np.arange(6), 3_100_000 + np.arange(6), np.arange(6)))
        for name in ("points.shp", "points.gpkg"):
            columns = [np.array(["T2"] * 6)]
            pyogrio.raw.write(folder / name, points, columns, ["horizon"], geometry_type="Point Z", crs="EPSG:32648")
        names += ["points.shp", "points.shx", "points.dbf", "points.gpkg"]
    with suppress(ImportError):
        import rasterio
        from rasterio.transform import Affine

        form = {"driver": "GTiff", "width": 5, "height": 4, "count": 1, "dtype": "float32", "crs": "EPSG:32648"}
        with rasterio.open(
            folder / "ground.tif", "w", transform=Affine(10.0, 0.0, 5e5, 0.0, -10.0, 3.1e6), **form
        ) as raster:
            raster.write(np.arange(20, dtype="float32").reshape(4, 5), 1)
        names.append("ground.tif")
    with suppress(ImportError):
        import lasio  # noqa: F401

        files["log.las"] = LAS.encode()
    return files | {name: (folder / name).read_bytes() for name in names}


def _volume(path: Path) -> object:
    return read_volume(path, pore=1, voxel=1.0)


READERS: dict[str, Callable[[Path], object]] = {
    ".dat": read_compass,
    ".svx": read_survex,
    ".csv": read_centreline,
    ".vs": read_points,
    ".geojson": lambda path: load_boundary(Source(path=path), Journal()),
    ".grd": read_ground,
    ".las": lambda path: [read_log(Source(path=path, table=name), Journal()) for name in ("WELL", "CURVES")],
    ".shp": read_points,
    ".gpkg": read_points,
    "ground.tif": read_ground,
}


def read(name: str, folder: Path, done: list[str], case: int) -> Counter[str]:
    """Read a damaged file; of a shapefile the parts are damaged one at a time."""
    if name in ("points.shx", "points.dbf"):
        name = "points.shp"
    (READERS.get(name) or READERS.get(Path(name).suffix) or _volume)(folder / name)
    return Counter()
