"""The roles of each kind of table, and how their columns are spelled."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass

__all__ = [
    "ADIT_CONTACTS",
    "ADIT_PATH",
    "BODY_POINTS",
    "BOUNDARY",
    "COLLAR",
    "COLLAR_ON_GROUND",
    "GEOGRAPHIC",
    "HORIZON_COLUMNS",
    "INTERVALS",
    "ORIENTATIONS",
    "PICKS",
    "SCHEMAS",
    "SECTION",
    "SECTIONS",
    "SECTION_LINES",
    "SURVEY",
    "TRACES",
    "Schema",
    "plain_name",
]


@dataclass(frozen=True)
class Schema:
    """The roles of one kind of table, each with its spellings, the surest first.

    Spellings are normalised as :func:`plain_name` does. ``required`` roles must be found, but for ``derived``
    ones, which other rows give where no column does.
    """

    name: str
    required: Mapping[str, tuple[str, ...]]
    optional: Mapping[str, tuple[str, ...]]
    derived: frozenset[str] = frozenset()

    @property
    def needed(self) -> tuple[str, ...]:
        """Roles that need a column of their own."""
        return tuple(role for role in self.required if role not in self.derived)


def _spelled(words: str) -> tuple[str, ...]:
    return tuple(words.split())


_HOLE = _spelled(
    "hole holeid bhid holename holenumber holeno borehole boreholeid boreholename boreholeno drillhole dhid collarid "
    "locationid locaid pointid well wellid wellname bore boreid wellbore uwi "
    "孔号 钻孔编号 钻孔号 钻孔 钻孔名称 孔名 勘探点编号 "
    "bohrung bohrloch bohrlochnr bohrungsnr bohrungnr bohrlochname bohrpunkt aufschluss "
    "sondage forage nomsondage nomforage originalname id name 编号"
)
_X = _spelled(
    "x east easting eastings locanate holenate xcollar collarx xcoord xcoordinate coordx locationx locx "
    "pointx utme utmeasting "
    "e 坐标x x坐标 东坐标 东 东向坐标 横坐标 rechtswert ostwert abscisse"
)
_Y = _spelled(
    "y north northing northings locanatn holenatn ycollar collary ycoord ycoordinate coordy locationy locy pointy utmn "
    "utmnorthing n 坐标y y坐标 北坐标 北 北向坐标 纵坐标 hochwert nordwert ordonnée ordonnee"
)
_Z = _spelled(
    "z elevation elev locagl holegl zcollar collarz zcoord zcoordinate coordz rl altitude height level groundlevel gl "
    "groundelevation collarelevation surfaceelevation pointz msl "
    "孔口高程 孔口标高 高程 标高 地面高程 坐标z z坐标 海拔 höhe hoehe ansatzhöhe geländehöhe "
    "geländeoberkante gok cote"
)
_END = _spelled(
    "depth maxdepth locafdep holefdep totaldepth finaldepth enddepth eoh eohdepth td holedepth length holelength "
    "孔深 终孔深度 终孔孔深 钻孔深度 总深度 总深 深度 endteufe endtiefe bohrtiefe "
    "teufe tiefe profondeur profondeurtotale profondeurfinale"
)
_STATION = _spelled(
    "depth at md horntop measureddepth surveydepth distance depthat stationdepth 深度 测点深度 测斜深度 测深 孔深 井深 "
    "tiefe teufe messtiefe messteufe profondeur"
)
_AZIMUTH = _spelled(
    "gridazimuth azimuthgrid gridazi azigrid azimuth azi az azim azm hornornt holeornt brg bearing dipazimuth "
    "dipdirection dipdir hazi 方位角 方位 倾向 azimut richtung bohrrichtung "
    "magneticazimuth azimuthmagnetic magazimuth azimuthmag magazi azimag magaz azmag magneticbearing 磁方位角 磁方位"
)
_DIP = _spelled("dip dipangle hornincl holeincl plunge 倾角 倾斜角 倾伏角 neigung fallen einfallen pendage plongement")
_FROM = _spelled(
    "from depthfrom fromdepth start top depthtop topdepth geoltop "
    "起始深度 起深 起始 层顶深度 层顶埋深 顶板深度 顶板埋深 顶深 自 从 起 "
    "topelevation elevationtop 层顶高程 层顶标高 顶板高程 顶板标高 "
    "von tiefevon teufevon vontiefe oberkante de profondeurde toit"
)
_TO = _spelled(
    "to depthto todepth end bottom base depthbase basedepth depthbottom bottomdepth geolbase "
    "终止深度 止深 终止 结束深度 层底深度 层底埋深 底板深度 底板埋深 底深 至 到 止 "
    "baseelevation elevationbase bottomelevation elevationbottom 层底高程 层底标高 底板高程 底板标高 "
    "bis tiefebis teufebis bistiefe unterkante à profondeurà mur"
)
_CODE = _spelled(
    "code rockcode lithcode lithologycode geologycode unitcode "
    "stratumcode legendcode geolgeol geolleg lithology lith "
    "rock rocktype rockunit unit formation stratum stratigraphy strat simplelith geology weathering "
    "地层代号 代号 代码 编码 地层编号 层号 地层 岩性代号 岩性 "
    "岩性名称 岩石名称 岩土名称 地层名称 土层名称 岩层 风化程度 风化带 风化 风化等级 "
    "schicht gestein petrographie stratigraphie couche lithologie"
)
_HORIZON = _spelled(
    "horizon surface formation featurename feature interface contact surfacename horizonname layer "
    "层位 界面 地层界面 界面名称 层面 地质界面 界线 地质界线 horizont"
)
_SECTION = _spelled("section sectionid sectionname profile line 剖面 剖面号 剖面编号 剖面名称")
_ADIT = _spelled("adit aditid aditname tunnel gallery 平硐 平硐编号 平硐号 平洞 平洞编号 平洞号 硐号 洞号 探洞")
_CHAINAGE = _spelled("chainage station distance depth md length 桩号 里程 硐深 洞深 距离 深度")
_DISTANCE = _spelled("distance dist s chainage along station x 距离 水平距离 平距 水平距 起点距 里程 桩号")
_KIND = _spelled("kind source type method datatype 类型 来源 数据来源 类别 方法")
_ACCURACY = _spelled("accuracy sigma stddev sd std uncertainty 精度 中误差 误差 标准差")

#: A pick file's "id" is mostly a running number, not a hole.
_PICKED_HOLE = tuple(word for word in _HOLE if word not in ("id", "编号"))
_PLACE = {"x": _X, "y": _Y}
COLLAR = Schema(
    "collar",
    {"hole": _HOLE, **_PLACE, "z": _Z},
    {"depth": _END, "azimuth": _AZIMUTH, "dip": _DIP},
)
#: Where there is a ground, collars without an elevation stand on it.
COLLAR_ON_GROUND = Schema("collar", {"hole": _HOLE, **_PLACE}, {"z": _Z, **COLLAR.optional})
SURVEY = Schema("survey", {"hole": _HOLE, "depth": _STATION, "azimuth": _AZIMUTH, "dip": _DIP}, {})
#: Without a column of upper limits they are the lower ones of the row above (:mod:`geofit.io.lower_limits`).
INTERVALS = Schema("intervals", {"hole": _HOLE, "from": _FROM, "to": _TO, "code": _CODE}, {}, frozenset({"from"}))
ADIT_PATH = Schema("adit path", {"adit": _ADIT, **_PLACE, "z": _Z}, {})
ADIT_CONTACTS = Schema("adit contacts", {"adit": _ADIT, "chainage": _CHAINAGE, "horizon": _HORIZON}, {})
SECTION = Schema("section", {"horizon": _HORIZON, "distance": _DISTANCE, "elevation": _Z}, {})
#: Several sections in one table; ``x0`` to ``y1`` are the ends of the row's section line, where it is straight.
SECTIONS = Schema(
    "sections",
    {"section": _spelled("section sectionid sectionname profile 剖面 剖面号 剖面编号 剖面名称"), **SECTION.required},
    {
        "x0": _spelled("x0 xstart startx xbegin eaststart 起点x x起点"),
        "y0": _spelled("y0 ystart starty ybegin northstart 起点y y起点"),
        "x1": _spelled("x1 xend endx eastend 终点x x终点"),
        "y1": _spelled("y1 yend endy northend 终点y y终点"),
    },
)
TRACES = Schema("traces", {"horizon": _HORIZON, **_PLACE}, {"z": _Z})
PICKS = Schema(
    "picks",
    {**_PLACE, "z": _Z},
    {"horizon": _HORIZON, "section": _SECTION, "hole": _PICKED_HOLE, "kind": _KIND, "accuracy": _ACCURACY},
)
#: Which columns are horizons only the user knows: they are not roles.
HORIZON_COLUMNS = Schema("horizon columns", _PLACE, {"hole": _PICKED_HOLE, "z": _Z})
BOUNDARY = Schema("boundary", _PLACE, {})
SECTION_LINES = Schema("section lines", {"section": _SECTION, **_PLACE}, {})
ORIENTATIONS = Schema(
    "orientations",
    {**_PLACE, "z": _Z},
    {
        "dip": _DIP,
        "azimuth": _AZIMUTH,
        "strike": _spelled("strike 走向"),
        "nx": _spelled("nx gx orientx normalx polex"),
        "ny": _spelled("ny gy orienty normaly poley"),
        "nz": _spelled("nz gz orientz normalz polez"),
        "horizon": _HORIZON,
    },
)

BODY_POINTS = Schema(
    "points of a body",
    {**_PLACE, "z": _Z},
    {
        **{role: ORIENTATIONS.optional[role] for role in ("nx", "ny", "nz")},
        "side": _spelled("side inside inout position 内外 位置 侧"),
        "hole": _PICKED_HOLE,
        "section": _SECTION,
    },
)

#: Every kind of table by its name.
SCHEMAS = {
    schema.name: schema
    for schema in (
        COLLAR,
        SURVEY,
        INTERVALS,
        ADIT_PATH,
        ADIT_CONTACTS,
        SECTION,
        SECTIONS,
        SECTION_LINES,
        TRACES,
        PICKS,
        HORIZON_COLUMNS,
        ORIENTATIONS,
        BOUNDARY,
    )
}

GEOGRAPHIC = set(_spelled("lon long longitude lng lat latitude 经度 纬度"))
_BRACKETS = re.compile(r"[\[(（【<]([^\])）】>]*)[\])）】>]")
_SUFFIX = re.compile(
    r"(?:[_ ]|,\s*)(m|(?:us[-_ ]?)?(?:survey[-_ ]?)?(?:ft|feet|foot)\.?|ft[-_ ]?us|km|cm|mm|deg|metres?|meters?)$"
)


def plain_name(header: str) -> tuple[str, str]:
    """Return a header without case, blanks, marks and unit, and its unit."""
    text = unicodedata.normalize("NFKC", header).casefold().strip().strip("\ufeff")
    unit = ""
    if found := _BRACKETS.search(text):
        unit, text = found.group(1).strip(), _BRACKETS.sub("", text).strip()
    if found := _SUFFIX.search(text):
        unit, text = found.group(1), text[: found.start()]
    return re.sub(r"[\s_\-./:#'\"]+", "", text), unit
