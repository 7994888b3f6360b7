"""The accuracy report of a site as plain data: numbers, words and tuples; pictures are named, not held.

What the JSON holds, and all that the HTML and the PDF are written from. None represents what was not measured; a
part that was not examined at all is None as a whole, and the report states it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from geofit.data.accuracy import Exceedance
from geofit.data.messages import Message
from geofit.data.stale import StaleCause
from geofit.data.title_block import TitleBlock
from geofit.data.verdict import Lamp

__all__ = [
    "AccuracyReport",
    "ChangeReport",
    "CheckLine",
    "ConflictLine",
    "ContactLine",
    "ContradictionLine",
    "CutPlace",
    "DipLine",
    "FaultCutLine",
    "FileCheck",
    "GroupLine",
    "HorizonReport",
    "InputFile",
    "LeftOutLine",
    "MovedLine",
    "OrderLine",
    "OutlierLine",
    "PartLine",
    "PatchLine",
    "PlanSheet",
    "PointLine",
    "PredictionReport",
    "RejectedRow",
    "SeamLine",
    "SectionSheet",
    "StorageLine",
    "SuggestionLine",
]


@dataclass(frozen=True)
class PointLine:
    """A data point and where it was read: coordinates and signed residual in metres; None: it was left out."""

    file: str
    row: int
    kind: str
    source: str
    x: float
    y: float
    z: float
    patch: str
    residual: float | None


@dataclass(frozen=True)
class GroupLine:
    """Residuals of a part of the points; ``by`` is "kind", "hole", "section" or "patch"; metres."""

    by: str
    name: str
    n: int
    sigma: float
    max_abs: float
    mean: float


@dataclass(frozen=True)
class CheckLine:
    """A question put to the surface or to the file; ``passed`` is None where it does not apply.

    ``places`` are where it is worst, map coordinates in metres, worst first.
    """

    name: str
    passed: bool | None
    value: float | None
    limit: float | None
    unit: str
    text: Message
    places: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True)
class SeamLine:
    """Largest gap (m) and angle (degrees) where two patches meet."""

    first: str
    second: str
    gap: float
    angle: float


@dataclass(frozen=True)
class PatchLine:
    """A patch: its name, degrees and number of control points in both directions."""

    name: str
    degree: tuple[int, int]
    control: tuple[int, int]


@dataclass(frozen=True)
class FileCheck:
    """What OpenCASCADE found when it read the STEP file back; metres, ``bytes`` the file's size."""

    file: str
    sha256: str
    bytes: int
    faces: int
    valid: bool
    self_intersects: bool
    sigma: float
    max_abs: float
    core_max_abs: float | None
    free_edges: int
    outline_edges: int
    edge_tolerance: float
    checks: tuple[CheckLine, ...]
    seams: tuple[SeamLine, ...]


@dataclass(frozen=True)
class ConflictLine:
    """Two coincident points: which was used, which were dropped, by how much (m), and why."""

    kept: Message
    dropped: Message
    difference: float
    text: Message


@dataclass(frozen=True)
class LeftOutLine:
    """Cross-validation by one scheme ("hole", "section", "block"): errors in metres, shares in the 90 % band.

    ``references`` holds the root mean square error of other methods on the same folds, by name.
    """

    scheme: str
    groups: int
    points: int
    rms: float
    mean_abs: float
    bias: float
    max_abs: float
    inside: float | None
    inside_raw: float | None
    references: tuple[tuple[str, float | None], ...]


@dataclass(frozen=True)
class SuggestionLine:
    """A place for a hole, in order of use: metres; the standard deviation before, and what this hole leaves."""

    x: float
    y: float
    z: float | None
    sd: float
    mean_after: float
    max_after: float


@dataclass(frozen=True)
class OutlierLine:
    """A point that its neighbours contradict: left-out error, its standard deviation (m), their ratio."""

    point: PointLine
    error: float
    sd: float
    ratio: float


@dataclass(frozen=True)
class PredictionReport:
    """The surface away from its data: cross-validation, standard deviation, places to drill, outliers.

    ``factor`` is by how much the standard deviation was widened; ``sd_mean`` and ``sd_max`` are metres.
    """

    left_out: tuple[LeftOutLine, ...]
    factor: float | None
    sd_mean: float | None
    sd_max: float | None
    suggestions: tuple[SuggestionLine, ...]
    outliers: tuple[OutlierLine, ...]
    notes: tuple[Message, ...]


@dataclass(frozen=True)
class OrderLine:
    """Two horizons: thickness in metres, and where and how much they cross.

    ``passed`` is None where they share no area. ``crossing_area`` (m²) and ``crossing_volume`` (m³) are 0 where the
    upper stays above the lower; else ``deepest`` is the place (x, y) of the least thickness. ``volume`` (m³) lies
    between them, below the ground if there is one, where a layer is ``present`` (m²), which is known to be from
    ``at_least`` to ``at_most`` where holes ``without`` it show that; ``doubtful`` (m³) is the volume between such
    holes alone.
    """

    upper: str
    lower: str
    passed: bool | None
    minimum: float | None
    mean: float | None
    crossing_area: float
    crossing_volume: float
    deepest: tuple[float, float] | None
    volume: float | None
    present: float | None
    at_least: float | None
    at_most: float | None
    without: int
    doubtful: float
    text: Message


@dataclass(frozen=True)
class ContradictionLine:
    """A place where a repair could not push two horizons apart: ``lack`` metres are missing.

    ``above`` and ``below`` name the exact points that stand against each other, empty where there is none.
    """

    upper: str
    lower: str
    x: float
    y: float
    lack: float
    above: Message
    below: Message
    text: Message


@dataclass(frozen=True)
class CutPlace:
    """Throw and heave at one location of a fault's trace, metres; ``heave`` is None at the area's edge."""

    distance: float
    x: float
    y: float
    z: float
    throw: float
    heave: float | None


@dataclass(frozen=True)
class FaultCutLine:
    """The displacement of a horizon along a fault, between the block ``up`` and the block ``down``; metres.

    ``places`` follow the trace, ``length`` is the distance from the first to the last.
    """

    fault: str
    horizon: str
    up: str
    down: str
    length: float
    throw_min: float
    throw_mean: float
    throw_max: float
    text: Message
    places: tuple[CutPlace, ...]


@dataclass(frozen=True)
class PartLine:
    """Residuals of core or periphery, metres; None where there are too few points."""

    n: int
    sigma: float | None
    max_abs: float | None
    share_within_interior_tolerance: float | None


@dataclass(frozen=True)
class StorageLine:
    """What the surface needs, and what a TIN and a square grid need for the same within ``tolerance`` metres."""

    control_points: int
    tolerance: float | None
    tin_points: int | None
    grid_points: int | None


@dataclass(frozen=True)
class SectionSheet:
    """A geological section to scale: its ends (x, y) and elevations in metres, and the name of its picture.

    ``scale`` is the denominator, heights are ``exaggeration`` times larger. ``banded`` and ``grounded`` say whether
    90 % bands and the ground are drawn.
    """

    name: str
    start: tuple[float, float]
    end: tuple[float, float]
    length: float
    low: float
    high: float
    scale: int
    exaggeration: int
    banded: bool
    grounded: bool
    picture: str


@dataclass(frozen=True)
class MovedLine:
    """A connected area that moved by more than epsilon: m2; where it moved most, and by how much there; its mean."""

    area: float
    x: float
    y: float
    most: float
    mean: float


@dataclass(frozen=True)
class ContactLine:
    """A contact found since: elevation, what the earlier surface predicted there, its 90 % band, the difference.

    None where the earlier surface did not reach, or its band is not known.
    """

    group: str
    kind: str
    x: float
    y: float
    z: float
    predicted: float | None
    low: float | None
    high: float | None
    residual: float | None
    inside: bool | None


@dataclass(frozen=True)
class ChangeReport:
    """How a horizon moved since its data changed, metres: later minus earlier; and the test of the earlier band.

    ``share`` of the common ``area`` (m2) moved by more than ``epsilon``; ``inside`` is the share of the ``judged`` new
    contacts within the earlier 90 % band.
    """

    epsilon: float
    mean: float | None
    rms: float | None
    largest: float | None
    x: float | None
    y: float | None
    area: float
    share: float | None
    areas: tuple[MovedLine, ...]
    contacts: tuple[ContactLine, ...]
    judged: int
    inside: float | None
    residual_rms: float | None
    too_narrow: bool
    text: Message
    verdict: Message


@dataclass(frozen=True)
class DipLine:
    """A measured dip and the surface's own at the nearest place; degrees, map coordinates in metres."""

    x: float
    y: float
    z: float
    azimuth: float
    dip: float
    surface_azimuth: float
    surface_dip: float
    angle: float
    file: str
    row: int


@dataclass(frozen=True)
class PlanSheet:
    """A contour plan to scale: the denominator, and metres between contours."""

    scale: int
    interval: float


@dataclass(frozen=True)
class HorizonReport:
    """Everything said about one horizon; metres.

    ``verdict`` is PASS, WARNING or FAIL, which follows from the ``lamps`` (:mod:`geofit.data.verdict`): at the data,
    checks, away from the data. ``sound`` shows whether sigma is below epsilon and every check passes.
    ``over`` counts points beyond tolerances, by the name of the setting. ``pictures`` names those that
    belong here, by what they show. ``plan`` is None for a folded surface, of which contours would cross.
    ``excluded`` are points that a person left out, ``edits`` manual edits. ``change`` is how the horizon moved since
    its data changed; None where no earlier state is known. ``dips`` were measured on the horizon. ``stale`` lists what
    has changed since the fit, empty where the surface is up to date.
    """

    horizon: str
    verdict: str
    lamps: tuple[Lamp, ...]
    sound: bool
    n_points: int
    n_used: int
    n_core: int
    n_periphery: int
    sigma: float
    epsilon: float
    max_abs: float
    mean: float
    core: PartLine
    periphery: PartLine
    over: Mapping[str, Exceedance]
    reason: Message
    notes: tuple[Message, ...]
    groups: tuple[GroupLine, ...]
    worst: tuple[PointLine, ...]
    seams: tuple[SeamLine, ...]
    checks: tuple[CheckLine, ...]
    read_back: FileCheck | None
    prediction: PredictionReport | None
    conflicts: tuple[ConflictLine, ...]
    patches: tuple[PatchLine, ...]
    storage: StorageLine
    settings: Mapping[str, Any]
    fit: Mapping[str, Any]
    pictures: Mapping[str, str]
    plan: PlanSheet | None = None
    excluded: tuple[PointLine, ...] = ()
    edits: tuple[Message, ...] = ()
    change: ChangeReport | None = None
    dips: tuple[DipLine, ...] = ()
    stale: tuple[StaleCause, ...] = ()

    @property
    def name(self) -> str:
        """Name of the horizon."""
        return self.horizon


@dataclass(frozen=True)
class InputFile:
    """A file that was read: its hash; rows read, used and listed (None for a file without rows)."""

    file: str
    sha256: str
    read: int | None
    used: int | None
    listed: int | None


@dataclass(frozen=True)
class RejectedRow:
    """A row that the readers did not use, or used with a warning."""

    severity: str
    file: str
    row: int
    column: str
    value: str
    reason: Message
    remedy: Message


@dataclass(frozen=True)
class AccuracyReport:
    """The accuracy report of a site.

    ``date`` is ISO 8601 (2026-11-21). ``orders`` is None where the order was not examined, empty where the site has
    no two horizons to compare. ``cuts`` are what faults displace, ``contradictions`` what separating crossings left.
    ``failures`` holds horizons that could not be fitted, with the reason. ``issues``
    counts errors, warnings and notes of the readers; ``rejected`` lists errors and warnings. ``versions`` names the
    programs. ``picture`` names the picture of all horizons, empty if there is none. ``title`` is what the cover says,
    ``sections`` are the geological sections.
    """

    site: str
    crs: str
    date: str
    horizons: tuple[HorizonReport, ...]
    failures: Mapping[str, Message]
    orders: tuple[OrderLine, ...] | None
    contradictions: tuple[ContradictionLine, ...]
    cuts: tuple[FaultCutLine, ...]
    inputs: tuple[InputFile, ...]
    issues: Mapping[str, int]
    rejected: tuple[RejectedRow, ...]
    versions: Mapping[str, str]
    picture: str
    title: TitleBlock = field(default_factory=TitleBlock)
    sections: tuple[SectionSheet, ...] = ()
