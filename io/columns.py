"""Which column holds what: roles of each kind of table, and their guess from the header."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches

from geofit.errors import InputError
from geofit.io.journal import Journal
from geofit.io.source import Source
from geofit.io.tables import Table

__all__ = [
    "ADIT_CONTACTS",
    "ADIT_PATH",
    "BOUNDARY",
    "COLLAR",
    "INTERVALS",
    "PICKS",
    "SECTION",
    "SURVEY",
    "TRACES",
    "Schema",
    "find_columns",
]


@dataclass(frozen=True)
class Schema:
    """The roles of one kind of table, each with its spellings, the surest first.

    Spellings are normalised as :func:`_plain` does. ``required`` roles must be found.
    """

    name: str
    required: Mapping[str, tuple[str, ...]]
    optional: Mapping[str, tuple[str, ...]]


def _spelled(words: str) -> tuple[str, ...]:
    return tuple(words.split())


_HOLE = _spelled(
    "hole holeid bhid holename holenumber holeno borehole boreholeid boreholename boreholeno drillhole dhid "
    "locationid locaid pointid well wellid wellname "
    "孔号 钻孔编号 钻孔号 钻孔 钻孔名称 孔名 勘探点编号 originalname id name 编号"
)
_X = _spelled(
    "x east easting eastings xcollar collarx xcoord xcoordinate coordx locationx locx pointx utme utmeasting "
    "e 坐标x x坐标 东坐标 东 东向坐标 横坐标"
)
_Y = _spelled(
    "y north northing northings ycollar collary ycoord ycoordinate coordy locationy locy pointy utmn "
    "utmnorthing n 坐标y y坐标 北坐标 北 北向坐标 纵坐标"
)
_Z = _spelled(
    "z elevation elev zcollar collarz zcoord zcoordinate coordz rl altitude height level groundlevel gl "
    "groundelevation collarelevation surfaceelevation pointz msl "
    "孔口高程 孔口标高 高程 标高 地面高程 坐标z z坐标 海拔"
)
_END = _spelled(
    "depth maxdepth totaldepth finaldepth enddepth eoh eohdepth td holedepth length holelength "
    "孔深 终孔深度 终孔孔深 钻孔深度 总深度 总深 深度"
)
_STATION = _spelled(
    "depth at md measureddepth surveydepth distance depthat stationdepth 深度 测点深度 "
    "测斜深度 测深 孔深 井深"
)
_AZIMUTH = _spelled(
    "azimuth azi az azim azm brg bearing dipazimuth dipdirection dipdir hazi 方位角 方位 倾向"
)
_DIP = _spelled("dip dipangle plunge 倾角 倾斜角 倾伏角")
_FROM = _spelled(
    "from depthfrom fromdepth start top depthtop geoltop 起始深度 起深 起始 层顶深度 顶板深度 顶深 自 从 起"
)
_TO = _spelled(
    "to depthto todepth end bottom base depthbase geolbase "
    "终止深度 止深 终止 结束深度 层底深度 底板深度 底深 至 到 止"
)
_CODE = _spelled(
    "code rockcode lithcode lithologycode geologycode unitcode "
    "stratumcode legendcode geolgeol lithology lith "
    "rock rocktype rockunit unit formation stratum stratigraphy strat simplelith geology weathering "
    "地层代号 代号 代码 编码 地层编号 层号 地层 岩性代号 岩性 "
    "岩性名称 岩石名称 岩层 风化程度 风化带 风化 风化等级"
)
_HORIZON = _spelled(
    "horizon surface formation featurename feature interface contact surfacename horizonname layer "
    "层位 界面 地层界面 界面名称 层面 地质界面 界线 地质界线"
)
_SECTION = _spelled("section sectionid sectionname profile line 剖面 剖面号 剖面编号 剖面名称")
_ADIT = _spelled(
    "adit aditid aditname tunnel gallery 平硐 平硐编号 平硐号 平洞 平洞编号 平洞号 硐号 洞号 探洞"
)
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
SURVEY = Schema("survey", {"hole": _HOLE, "depth": _STATION, "azimuth": _AZIMUTH, "dip": _DIP}, {})
INTERVALS = Schema("intervals", {"hole": _HOLE, "from": _FROM, "to": _TO, "code": _CODE}, {})
ADIT_PATH = Schema("adit path", {"adit": _ADIT, **_PLACE, "z": _Z}, {})
ADIT_CONTACTS = Schema("adit contacts", {"adit": _ADIT, "chainage": _CHAINAGE, "horizon": _HORIZON}, {})
SECTION = Schema("section", {"horizon": _HORIZON, "distance": _DISTANCE, "elevation": _Z}, {})
TRACES = Schema("traces", {"horizon": _HORIZON, **_PLACE}, {"z": _Z})
PICKS = Schema(
    "picks",
    {**_PLACE, "z": _Z},
    {"horizon": _HORIZON, "section": _SECTION, "hole": _PICKED_HOLE, "kind": _KIND, "accuracy": _ACCURACY},
)
BOUNDARY = Schema("boundary", _PLACE, {})

_GEOGRAPHIC = set(_spelled("lon long longitude lng lat latitude 经度 纬度"))
_BRACKETS = re.compile(r"[\[(（【<]([^\])）】>]*)[\])）】>]")
_SUFFIX = re.compile(r"[_ ](m|ft|feet|deg|metres?|meters?)$")


def _plain(header: str) -> tuple[str, str]:
    """Return a header without case, blanks, marks and unit, and its unit."""
    text = unicodedata.normalize("NFKC", header).casefold().strip().strip("\ufeff")
    unit = ""
    if found := _BRACKETS.search(text):
        unit, text = found.group(1).strip(), _BRACKETS.sub("", text).strip()
    if found := _SUFFIX.search(text):
        unit, text = found.group(1), text[: found.start()]
    return re.sub(r"[\s_\-./:#'\"]+", "", text), unit


def find_columns(table: Table, schema: Schema, source: Source, journal: Journal) -> dict[str, int]:
    """Return the column index of each role of a table.

    What the source states is taken; the rest is guessed from the header, and each guess is listed as a note.
    A table without a header is taken in the order of the schema when it has exactly the required columns.

    Raises
    ------
    InputError
        If a required column is missing, or the source names a role or a column that is not there.
    """
    spellings = {**schema.required, **schema.optional}
    columns = _stated(table, schema, source)
    plain = [_plain(name) for name in table.header]
    if not table.named and not columns and len(table.header) == len(schema.required):
        columns = {role: j for j, role in enumerate(schema.required)}
        order = ", ".join(schema.required)
        journal.add(
            "warning", table.name, f"No header: the columns are taken as {order}", "Add a header.", row=1
        )
    elif table.named:
        for role, names in spellings.items():
            if role in columns:
                continue
            free = [j for j in range(len(plain)) if j not in columns.values() and plain[j][0] in names]
            if not free:
                continue
            free.sort(key=lambda j: names.index(plain[j][0]))
            columns[role] = free[0]
            others = ", ".join(f"'{table.header[j]}'" for j in free[1:])
            journal.add(
                "note",
                table.name,
                f"Column '{table.header[free[0]]}' is taken as {role}"
                + (f"; also possible: {others}" if others else ""),
                f"State columns = {{ {role} = ... }} where this is wrong.",
                column=table.header[free[0]],
            )
    missing = [role for role in schema.required if role not in columns]
    if missing:
        raise _missing(table, schema, missing, plain)
    for role, j in columns.items():
        unit = plain[j][1] or (table.units[j] if j < len(table.units) else "")
        if unit.casefold() in ("ft", "feet"):
            journal.add(
                "warning",
                table.name,
                f"The {role} is marked as feet but read as metres",
                "Convert the column to metres (1 ft = 0.3048 m).",
                column=table.header[j],
            )
    return columns


def _stated(table: Table, schema: Schema, source: Source) -> dict[str, int]:
    roles = [*schema.required, *schema.optional]
    columns = {}
    for role, wanted in source.columns.items():
        if role not in roles:
            near = get_close_matches(role, roles, 1)
            raise InputError(
                f"A {schema.name} table has no column role '{role}'",
                (f"Did you mean '{near[0]}'? " if near else "") + f"The roles are {', '.join(roles)}.",
                file=table.name,
            )
        columns[role] = _locate(table, role, wanted)
    return columns


def _locate(table: Table, role: str, wanted: str | int) -> int:
    if isinstance(wanted, str):
        if wanted in table.header:
            return table.header.index(wanted)
        alike = [j for j, name in enumerate(table.header) if _plain(name)[0] == _plain(wanted)[0]]
        if len(alike) == 1:
            return alike[0]
    number = int(wanted) if str(wanted).isascii() and str(wanted).isdigit() else 0
    if 1 <= number <= len(table.header):
        return number - 1
    raise InputError(
        f"There is no column '{wanted}' for {role}; the columns are {', '.join(table.header)}",
        f"Name one of them, or give its number from 1 to {len(table.header)}.",
        file=table.name,
    )


def _missing(table: Table, schema: Schema, missing: list[str], plain: list[tuple[str, str]]) -> InputError:
    if {"x", "y"} & set(missing) and any(name in _GEOGRAPHIC for name, _ in plain):
        return InputError(
            "Longitude and latitude are degrees; easting and northing in metres are needed",
            "Project the coordinates to the site's grid first.",
            file=table.name,
        )
    names = " and ".join(f"'{role}'" for role in missing)
    found = ", ".join(table.header)
    what = f"No column for {names} was found in this {schema.name} table; " + (
        f"its columns are {found}" if table.named else f"it has no header and {len(table.header)} columns"
    )
    example = ", ".join(f'{role} = "..."' for role in missing)
    return InputError(
        what,
        f"Name the column in the header, or state columns = {{ {example} }} (--x, --y, --z, --surface, "
        "--section for a bare CSV; a column's number counted from 1 will do).",
        file=table.name,
        row=int(table.lines[0]) - 1 if table.named and len(table) and table.lines[0] > 1 else None,
        column=missing[0],
    )
