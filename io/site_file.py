"""site.toml: the file that binds the tables and drawings of one site."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.logs import LoggedHoles
from geofit.data.messages import Untranslated, message
from geofit.data.points import KINDS, PointSet
from geofit.data.progress import Progress, tell
from geofit.data.settings import FitSettings
from geofit.data.site import Ground, Hole, Orientations, Site
from geofit.io.added_tables import with_tables
from geofit.io.adits import load_adit_contacts, load_adits
from geofit.io.axes import Region, grown_box, place_in
from geofit.io.boreholes import Boreholes, load_boreholes
from geofit.io.boundary import load_boundary
from geofit.io.contact_rules import ContactRule
from geofit.io.contacts import load_rule
from geofit.io.crs import is_code, require_grid
from geofit.io.desurvey import METHODS
from geofit.io.grid import load_grid, load_ground
from geofit.io.hints import nearest_name
from geofit.io.horizon_columns import load_horizon_columns
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.mapping import ColumnMapping, load_mappings
from geofit.io.orientations import load_orientations
from geofit.io.picks import load_picks
from geofit.io.places import list_places
from geofit.io.shared_holes import warn_of_shared_holes, warn_of_twins
from geofit.io.site_drawings import gather, read_sections
from geofit.io.site_keys import HORIZON, SETTINGS, TOP, Reader
from geofit.io.site_relations import read_datum, read_relations
from geofit.io.site_rules import read_rule
from geofit.io.source import Source
from geofit.io.title_block import read_title_block
from geofit.io.traces import load_traces
from geofit.io.units import metres_of

__all__ = ["build_site", "load_site", "read_site"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class _Horizon:
    """One [[horizon]] table."""

    name: str
    rule: ContactRule | None
    accuracy: Mapping[str, float]
    settings: FitSettings


@arguments_checked
def read_site(path: str | Path, progress: Progress | None = None, *, added: Sequence[str] = ()) -> Site:
    """Read a site file and everything that it names.

    The format is described in ``docs/site_file.md``. Rows that cannot be used are listed in ``issues``; for
    each file ``read == used + listed`` in ``counts``.

    Parameters
    ----------
    path : path
        The ``site.toml``; the files that it names count from its folder.
    progress : callable, optional
        Called as ``progress(stage, fraction)``.
    added : sequence of str
        Tables that count as if they were at the end of the site file, as TOML.

    Returns
    -------
    Site

    Raises
    ------
    InputError
        If the site file has an unknown key, a file cannot be used at all, or a horizon has no point.

    Notes
    -----
    Keys of the site file: ``docs/site_file.md``; formats of the tables: ``docs/formats_in.md``.
    """
    site = load_site(path, progress, added=added)
    if site.horizons:
        return site
    reason = message("io.site-without-horizon", "The site has no horizon")
    remedy = message("io.add-horizon-and-files", "Add a [[horizon]] table and files that contain its points.")
    if refused := [issue for issue in site.issues if issue.severity == "error" and issue.row]:
        reason = message(
            "io.site-without-usable-row",
            "The site has no horizon; entries of the files that are not used: {count}, the first is {file}, row {row}: "
            "{reason}",
            count=len(refused),
            file=Untranslated(refused[0].file),
            row=refused[0].row,
            reason=refused[0].reason,
        )
        remedy = message("io.correct-listed", "Correct the listed entries.")
    error = Reader(Path(path)).fail(reason, remedy)
    error.issues = site.issues
    raise error


def load_site(path: str | Path, progress: Progress | None = None, *, added: Sequence[str] = ()) -> Site:
    """Read a site file, which may have no horizon yet; see :func:`read_site`."""
    source = Source(path=Path(path))
    journal = Journal()
    top = with_tables(journal.read(source), added, source.name)
    return build_site(top, source.path, journal, progress=progress)


def build_site(
    top: dict[str, Any],
    path: Path,
    journal: Journal,
    *,
    mappings: Sequence[ColumnMapping] | None = None,
    progress: Progress | None = None,
) -> Site:
    """Read the files that the tables of a site file name.

    Parameters
    ----------
    top : dict
        What the site file holds, as TOML gives it.
    path : Path
        Where the site file is, or will be: the files that it names count from its folder.
    journal : Journal
        Takes what the readers find.
    mappings : sequence of ColumnMapping, optional
        Column mappings; None: those of the file that ``[site]`` names.
    progress : callable, optional
        Called as ``progress(stage, fraction)``.

    Raises
    ------
    InputError
        As :func:`read_site`.
    """
    with journal.handed_over():
        return _built(top, Reader(path), journal, mappings, progress)


def _built(
    top: dict[str, Any],
    reader: Reader,
    journal: Journal,
    mappings: Sequence[ColumnMapping] | None,
    progress: Progress | None,
) -> Site:
    path = reader.path
    reader.keys(top, TOP, "The site file")
    label = reader.get(top, "site", dict, "the site file") or {}
    reader.keys(label, ("name", "crs", "mapping", "order", "unit", "datum"), "[site]")
    crs = reader.get(label, "crs", str, "[site]") or ""
    require_grid(crs, reader.file)
    reader.target = crs if is_code(crs) else None
    if unit := reader.get(label, "unit", str, "[site]"):
        metres_of(unit, reader.file)
        reader.unit = unit
    if mappings is not None:
        reader.mappings = tuple(mappings)
    elif mapping := reader.get(label, "mapping", str, "[site]"):
        reader.mappings = load_mappings(path.parent / mapping)
    horizons = [_horizon(reader, table) for table in reader.tables(top, "horizon")]
    names = HorizonNames([horizon.name for horizon in horizons])
    folded = [name.casefold() for name in names.names]
    if repeated := [name for k, name in enumerate(names.names) if folded[k] in folded[:k]]:
        raise reader.fail(
            message("io.horizon-name-repeated", "Two [[horizon]] tables have the same name (ignoring case)"),
            message("io.give-each-own-name", "Give each its own name."),
            "name",
            repeated[0],
        )

    title = read_title_block(reader, top)
    tell(progress, "read boundary and ground", 0.0)
    boundary, ground, region = _site_area(reader, top, journal)
    tell(progress, "read boreholes and adits", 0.1)
    gathered: dict[str, list[PointSet]] = {name: [] for name in names.names}
    boreholes = [_boreholes(reader, table, journal, region, ground) for table in reader.tables(top, "boreholes")]
    warn_of_shared_holes(boreholes, journal)
    warn_of_twins(boreholes, journal)
    _gather_contacts(reader, gathered, boreholes, horizons, journal)
    adits = _adits(reader, top, names, journal, region, gathered)
    tell(progress, "read sections", 0.4)
    sections = read_sections(reader, top, names, journal, region, gathered)
    tell(progress, "read traces and picks", 0.7)
    for table in reader.tables(top, "traces"):
        gather(gathered, load_traces(reader.source(table, "[traces]", kind="traces"), ground, names, journal, region))
    for table in reader.tables(top, "picks"):
        kind = reader.get(table, "kind", str, "[picks]") or "point"
        picks = reader.source(table, "[picks]", ("kind", "horizon"), "picks")
        alone = reader.get(table, "horizon", str, "[picks]")
        gather(gathered, load_picks(picks, names, journal, kind=kind, region=region, alone=alone))
    for table in reader.tables(top, "horizon_columns"):
        source = reader.source(table, "[horizon_columns]", ("horizons",), "horizon columns")
        if stated := reader.get(table, "horizons", list, "[horizon_columns]"):
            source = replace(source, horizons=stated)
        gather(gathered, load_horizon_columns(source, names, journal, region))
    for table in reader.tables(top, "grids"):
        source = reader.source(table, "[grids]", ("horizon",), "grid")
        horizon_of = reader.get(table, "horizon", str, "[grids]") or source.path.stem
        gather(gathered, load_grid(source, horizon_of, names, journal))
    attitudes = [
        load_orientations(reader.source(table, "[orientations]", kind="orientations"), journal, region)
        for table in reader.tables(top, "orientations")
    ]

    order, faults = read_relations(reader, top, label, list(gathered))
    points, settings = {}, {}
    stated = {horizon.name: horizon for horizon in horizons}
    for name, sets in gathered.items():
        horizon = stated.get(name) or _Horizon(name, None, {}, FitSettings())
        settings[name] = horizon.settings
        points[name] = _with_accuracy(reader, PointSet.concatenate(sets), horizon, journal)
        steep = horizon.settings.frame in ("best-plane", "sections") or name in faults
        list_places(name, points[name], journal, horizon.settings.coincidence_distance, steep=steep)
    tell(progress, "read", 1.0)
    return Site(
        name=reader.get(label, "name", str, "[site]") or path.parent.name,
        horizons=points,
        settings=settings,
        boundary=boundary,
        ground=ground,
        holes=tuple(hole for campaign in boreholes for hole in campaign.holes) + adits,
        sections=sections,
        issues=tuple(journal.issues),
        counts=tuple(journal.counts),
        crs=crs,
        inputs=dict(journal.inputs),
        orientations=_joined(attitudes),
        order=order,
        faults=faults,
        boreholes=tuple(LoggedHoles(c.paths, c.ends, c.logs) for c in boreholes),
        title=title,
        datum=read_datum(reader, label),
    )


def _horizon(reader: Reader, table: dict[str, Any]) -> _Horizon:
    name = reader.need(table, "name", str, "[[horizon]]", message("io.write-name", 'Write name = "...".')).strip()
    where = message("io.horizon", "horizon '{name}'", name=name)
    if not name:
        raise reader.fail(
            message("io.horizon-empty-name", "A [[horizon]] has an empty name"),
            message("io.write-name", 'Write name = "...".'),
            "name",
        )
    reader.keys(table, HORIZON, where)
    rule = read_rule(reader, table, where)
    accuracy = reader.get(table, "accuracy", dict, where) or {}
    for kind in accuracy:
        if not reader.get(accuracy, kind, float, message("io.accuracy", "accuracy of {where}", where=where)) > 0:
            raise reader.fail(
                message("io.accuracy-of-key-not-positive", "accuracy of {where} must be above 0", where=where),
                message("io.give-standard-deviation", "Give one standard deviation in metres."),
                kind,
                accuracy[kind],
            )
    try:
        settings = FitSettings(**{key: table[key] for key in SETTINGS if key in table})
    except (SettingsError, TypeError) as error:
        raise reader.fail(
            message("io.key-and-error", "{where}: {error}", where=where, error=error),
            message("io.correct-site-file", "Correct it in the site file."),
        ) from None
    return _Horizon(name, rule, {kind: float(value) for kind, value in accuracy.items()}, settings)


def _site_area(
    reader: Reader, top: Mapping[str, Any], journal: Journal
) -> tuple[Floats | None, Ground | None, Region | None]:
    boundary = ground = region = None
    if "ground" in top:
        ground = load_ground(reader.source(top["ground"], "[ground]", kind="ground"), journal)
        region = grown_box(np.array([[ground.x[0], ground.y[0]], [ground.x[-1], ground.y[-1]]]))
    if "boundary" in top:
        boundary = load_boundary(reader.source(top["boundary"], "[boundary]", kind="boundary"), journal)
        if region is not None:
            _compare(reader, boundary, region)
        region = grown_box(boundary)
    return boundary, ground, region


def _compare(reader: Reader, boundary: Floats, ground: Region) -> None:
    place = place_in(boundary, ground)
    if place != "inside":
        x, y = boundary.mean(axis=0)
        swapped = place == "exchanged"
        raise reader.fail(
            message(
                "io.boundary-far-exchanged",
                "The boundary (around x = {x:.10g}, y = {y:.10g}) lies far off the ground's grid, and on it with x "
                "and y exchanged",
                x=x,
                y=y,
            )
            if swapped
            else message(
                "io.boundary-far-off",
                "The boundary (around x = {x:.10g}, y = {y:.10g}) lies far off the ground's grid",
                x=x,
                y=y,
            ),
            message("io.exchange-boundary", "Exchange x and y of the boundary.")
            if swapped
            else message("io.give-one-coordinate-system", "Give both in the same coordinates."),
            "boundary",
        )


def _boreholes(
    reader: Reader, table: Mapping[str, Any], journal: Journal, region: Region | None, ground: Ground | None
) -> Boreholes:
    where = "[boreholes]"
    reader.keys(table, ("collar", "survey", "intervals", "dip", "declination", "desurvey"), where)
    if "collar" not in table:
        raise reader.fail(
            message("io.collar-missing", "{where} has no 'collar'", where=where),
            message("io.write-collar", 'Write collar = "collar.csv".'),
            "collar",
        )
    dip = reader.get(table, "dip", str, where)
    if dip not in (None, "down-positive", "down-negative"):
        raise reader.fail(
            message("io.dip-sign-unknown", "The sign of the dips is unknown"),
            message("io.write-dip-sign", 'Write "down-positive" or "down-negative".'),
            "dip",
            dip,
        )
    method = reader.get(table, "desurvey", str, where) or METHODS[0]
    if method not in METHODS:
        raise reader.fail(
            message("io.desurvey-unknown", "The desurvey method is unknown"),
            message("io.write-names", "Write {names}.", names=" or ".join(METHODS)),
            "desurvey",
            method,
        )
    intervals = table.get("intervals", [])
    intervals = intervals if isinstance(intervals, list) else [intervals]
    return load_boreholes(
        reader.source(
            table["collar"],
            message("io.key-of-table", "{key} in {where}", key=Untranslated("collar"), where=where),
            kind="collar",
        ),
        reader.source(
            table["survey"],
            message("io.key-of-table", "{key} in {where}", key=Untranslated("survey"), where=where),
            kind="survey",
        )
        if "survey" in table
        else None,
        [
            reader.source(
                entry,
                message("io.key-of-table", "{key} in {where}", key=Untranslated("intervals"), where=where),
                kind="intervals",
            )
            for entry in intervals
        ],
        dip,
        journal,
        region,
        declination=reader.get(table, "declination", float, where),
        method="tangential" if method == "tangential" else "minimum-curvature",
        ground=ground,
    )


def _gather_contacts(
    reader: Reader,
    gathered: dict[str, list[PointSet]],
    boreholes: list[Boreholes],
    horizons: list[_Horizon],
    journal: Journal,
) -> None:
    for horizon in horizons:
        rule = horizon.rule
        if rule is None:
            continue
        logged = [campaign for campaign in boreholes if campaign.logs]
        if not logged:
            raise reader.fail(
                message(
                    "io.limit-without-intervals",
                    "horizon '{name}' is a limit of '{code}', but the site has no intervals",
                    name=horizon.name,
                    code=rule.label,
                ),
                message(
                    "io.add-intervals",
                    'Add intervals = ["lithology.csv"] to [boreholes], or remove top and base.',
                ),
                rule.limit,
            )
        # A code need not occur in every campaign; where it occurs in none the first one reports it.
        carrying = [c for c in logged if any(np.isin(log.code, rule.codes).any() for log in c.logs)] or logged[:1]
        gathered[horizon.name] += [load_rule(campaign, rule, journal) for campaign in carrying]


def _adits(
    reader: Reader,
    top: Mapping[str, Any],
    names: HorizonNames,
    journal: Journal,
    region: Region | None,
    gathered: dict[str, list[PointSet]],
) -> tuple[Hole, ...]:
    table = reader.get(top, "adits", dict, "the site file")
    if table is None:
        return ()
    reader.keys(table, ("path", "contacts"), "[adits]")
    if "path" not in table:
        raise reader.fail(
            message("io.adit-path-missing", "[adits] has no 'path'"),
            message("io.write-adit-path", 'Write path = "adits.csv".'),
            "path",
        )
    adits = load_adits(
        reader.source(
            table["path"],
            message("io.key-of-table", "{key} in {where}", key=Untranslated("path"), where="[adits]"),
            kind="adit path",
        ),
        journal,
        region,
    )
    if "contacts" in table:
        contacts = reader.source(
            table["contacts"],
            message("io.key-of-table", "{key} in {where}", key=Untranslated("contacts"), where="[adits]"),
            kind="adit contacts",
        )
        gather(gathered, load_adit_contacts(contacts, adits, names, journal))
    return adits


def _joined(sets: list[Orientations]) -> Orientations | None:
    if not sets:
        return None
    return Orientations(**{f.name: np.concatenate([getattr(s, f.name) for s in sets]) for f in fields(Orientations)})


def _holes_without_limit(rule: ContactRule, journal: Journal) -> int:
    """Return in how many holes the limit of a rule is not certain, in logs of which every row is used."""
    refused = {issue.file for issue in journal.issues if issue.severity == "error"}
    listed = (issue for issue in journal.issues if issue.reason.code == "io.contacts-uncertain")
    return sum(
        issue.reason.params["unseen"]
        for issue in listed
        if issue.file not in refused
        and (issue.reason.params["limit"], issue.reason.params["code"]) == (rule.limit, rule.label)
    )


def _with_accuracy(reader: Reader, points: PointSet, horizon: _Horizon, journal: Journal) -> PointSet:
    """Return the points with the site file's accuracy where their own file states none."""
    refused = [issue for issue in journal.issues if issue.severity == "error" and issue.row]
    unseen = 0 if horizon.rule is None or len(points) else _holes_without_limit(horizon.rule, journal)
    if horizon.rule is not None and unseen:
        raise reader.fail(
            message(
                "io.horizon-open-everywhere",
                "Horizon '{name}' has no point: the {limit} of {code} is certain in none of the holes with {code} "
                "({count})",
                name=horizon.name,
                limit=horizon.rule.limit,
                code=Untranslated(horizon.rule.label),
                count=unseen,
            ),
            message(
                "io.open-beds-have-no-limit",
                "A bed that is open at the hole's end has no base, one that starts at the collar no top: name another "
                "code, or remove its [[horizon]] table.",
            ),
            "name",
        )
    if not len(points) and refused:
        raise reader.fail(
            message(
                "io.horizon-without-usable-point",
                "Horizon '{name}' has no usable point; entries of the files that are not used: {count}, the first is "
                "{file}, row {row}: {reason}",
                name=horizon.name,
                count=len(refused),
                file=Untranslated(refused[0].file),
                row=refused[0].row,
                reason=refused[0].reason,
            ),
            message(
                "io.correct-listed-or-horizon",
                "Correct the listed entries, or the name or code of the horizon, or remove its [[horizon]] table.",
            ),
            "name",
        )
    if not len(points):
        raise reader.fail(
            message("io.horizon-without-point", "Horizon '{name}' has no point in any file", name=horizon.name),
            message("io.correct-or-remove-horizon", "Correct its name or code, or remove its [[horizon]] table."),
            "name",
        )
    accuracy = np.array(points.accuracy)
    kinds = sorted({*KINDS, *points.kind.tolist()})
    for kind, value in horizon.accuracy.items():
        if kind not in kinds:
            raise reader.fail(
                message(
                    "io.accuracy-unknown-kind",
                    "accuracy of horizon '{name}' names the kind '{kind}', which no point has",
                    name=horizon.name,
                    kind=Untranslated(kind),
                ),
                nearest_name(kind, kinds, message("io.known-kinds", "The kinds are {names}.", names=", ".join(kinds))),
                kind,
            )
        accuracy[(points.kind == kind) & np.isnan(accuracy)] = value
    return points.with_(accuracy=accuracy)
