"""Contacts from interval logs: the top or the base of a code."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.given import arguments_checked
from geofit.data.logs import LoggedHoles
from geofit.data.messages import Message, Untranslated, message, plural_message
from geofit.data.points import PointSet
from geofit.data.site import ImportIssue
from geofit.io.boreholes import DEPTH_TOLERANCE, Boreholes, IntervalLog
from geofit.io.contact_rules import ContactRule, Limit, code_key, simplified
from geofit.io.hints import nearest_name
from geofit.io.journal import Journal

__all__ = ["Contacts", "Limit", "load_contacts", "load_rule", "take_contacts"]

#: So much of a hole below the last interval of its log is its end all the same, metres and as a share of its depth: the
#: depth of a hole is rounded, or was planned.
REST, REST_SHARE = 0.5, 0.02


@dataclass(frozen=True, eq=False)
class Contacts:
    """Points of one contact, kind "borehole", with what was found on the way."""

    points: PointSet
    issues: tuple[ImportIssue, ...]


@arguments_checked
def take_contacts(boreholes: Boreholes, *, top: str | None = None, base: str | None = None) -> Contacts:
    """Return where the holes cross the top or the base of a code.

    Neighbouring intervals of the code count as one. A hole gives one contact: the uppermost top, the lowest
    base; further ones are listed. The top of a code that starts at the collar, and the base of one that is
    open at the hole's end, are not seen by the hole and give no contact.

    Parameters
    ----------
    boreholes : Boreholes
        From :func:`geofit.io.read_boreholes`.
    top, base : str
        The code; give one of the two.

    Returns
    -------
    Contacts
        Points with their holes and rows, and what was listed.

    Raises
    ------
    InputError
        If neither or both are given, or no interval has the code.

    Notes
    -----
    Rules: ``docs/site_file.md``, "Boreholes".
    """
    if (top is None) == (base is None):
        raise InputError(
            message("io.top-and-base-unclear", "Both or neither of top and base are given"),
            message("io.give-code", "Give the code of one of them."),
        )
    journal = Journal()
    limit: Limit = "top" if top is not None else "base"
    points = load_contacts(boreholes, top or base or "", limit, journal)
    return Contacts(points, tuple(journal.issues))


def load_contacts(boreholes: Boreholes, code: str, limit: Limit, journal: Journal) -> PointSet:
    """Take contacts; the journal receives what is found."""
    return load_rule(boreholes, ContactRule((code,), limit), journal)


def load_rule(boreholes: Boreholes | LoggedHoles, rule: ContactRule, journal: Journal) -> PointSet:
    """Take the contacts of a rule; the journal receives what is found."""
    carrying = [log for log in boreholes.logs if np.isin(log.code, rule.codes).any()]
    codes = sorted({str(c) for log in boreholes.logs for c in np.unique(log.code)})
    if not codes:
        raise InputError(
            message("io.no-interval-usable", "None of the intervals can be used"),
            message("io.correct-listed", "Correct the listed entries."),
            file=", ".join(log.file for log in boreholes.logs) or None,
        )
    if not carrying:
        code = rule.codes[0]
        raise InputError(
            message(
                "io.code-not-logged",
                "No interval has the code '{code}'; the codes are {names}",
                code=Untranslated(code),
                names=", ".join(codes[:40]),
            ),
            nearest_name(code, codes, message("data.name-one", "Name one of them.")),
            file=", ".join(log.file for log in boreholes.logs) or None,
        )
    for code in (one for one in rule.codes if one not in codes):
        journal.add(
            "warning",
            carrying[0].file,
            message(
                "io.rule-code-not-logged",
                "No interval has the code '{code}', which counts as one bed with {others}",
                code=Untranslated(code),
                others=", ".join(one for one in rule.codes if one in codes),
            ),
            nearest_name(code, codes, message("data.name-one", "Name one of them.")),
            value=code,
        )
    _warn_of_case(rule, codes, carrying[0].file, journal)
    found = []
    for log in carrying:
        plain = simplified(log, rule)
        thin = sorted(set(log.hole[np.isin(log.code, rule.codes)].tolist()) - set(plain.hole[plain.code == rule.label]))
        if thin:
            journal.add(
                "note",
                log.file,
                message(
                    "io.beds-too-thin",
                    "{limit} of {code}: every bed is thinner than {thinner:g} m in holes ({count}): {holes}",
                    limit=rule.limit,
                    code=rule.label,
                    thinner=rule.thinner,
                    count=len(thin),
                    holes=", ".join(thin),
                ),
                value=rule.label,
            )
        found.append(_contacts_of(boreholes, plain, rule, journal))
    _warn_of_two_logs(found, rule, journal)
    return PointSet.concatenate(found)


def _warn_of_two_logs(found: Sequence[PointSet], rule: ContactRule, journal: Journal) -> None:
    """Warn of holes that have the contact in two interval tables, at two depths."""
    for k, later in enumerate(found):
        for earlier in found[:k]:
            before = {str(hole): xyz for hole, xyz in zip(earlier.hole, earlier.xyz, strict=True)}
            apart = np.array([
                np.linalg.norm(xyz - before[hole]) if hole in before else 0.0
                for hole, xyz in zip(later.hole.tolist(), later.xyz, strict=True)
            ])  # fmt: skip
            two = np.flatnonzero(apart > DEPTH_TOLERANCE)
            if not two.size:
                continue
            worst = int(np.argmax(apart))
            journal.add(
                "warning",
                later.labels["file"].word(worst),
                plural_message(
                    "io.contact-in-two-logs",
                    "{limit} of {code}: {count} hole has the contact in {file} too, at another depth: {hole}, "
                    "{distance:.2f} m away; both are used",
                    "{limit} of {code}: {count} holes have the contact in {file} too, at other depths, the most in "
                    "{hole}, {distance:.2f} m away; both are used",
                    limit=rule.limit,
                    code=Untranslated(rule.label),
                    count=len(two),
                    file=Untranslated(earlier.labels["file"].word(0)),
                    hole=Untranslated(later.hole[worst]),
                    distance=float(apart[worst]),
                ),
                message("io.keep-one-log", "Keep one log of each hole, or give the codes of one table other names."),
                row=int(later.row[worst]),
                value=rule.label,
            )


def _warn_of_case(rule: ContactRule, codes: Sequence[str], file: str, journal: Journal) -> None:
    """Warn of codes that differ from those of the rule in case, marks or look-alike letters only: they are not used."""
    stated = {code_key(code) for code in rule.codes}
    alike = [code for code in codes if code_key(code) in stated and code not in rule.codes]
    if not alike:
        return
    both = "[" + ", ".join(f'"{code}"' for code in (*rule.codes, *alike)) + "]"
    journal.add(
        "warning",
        file,
        message(
            "io.code-differs-in-case",
            "The codes {names} differ from {code} only in case, marks or look-alike letters (Cyrillic), and do "
            "not count as it",
            names=", ".join(alike),
            code=Untranslated(rule.label),
        ),
        message(
            "io.list-codes-of-one-bed",
            "If they are one bed, write {limit} = {codes}.",
            limit=Untranslated(rule.limit),
            codes=Untranslated(both),
        ),
        value=alike[0],
    )


def _contacts_of(boreholes: Boreholes | LoggedHoles, log: IntervalLog, rule: ContactRule, journal: Journal) -> PointSet:
    code, limit = rule.label, rule.limit
    found: list[tuple[str, float, int]] = []
    unseen: list[str] = []
    for group in np.split(np.arange(len(log.hole)), np.flatnonzero(log.hole[1:] != log.hole[:-1]) + 1):
        if not (log.code[group] == code).any():
            continue
        hole = str(log.hole[group[0]])
        depth, row = _limit_in_hole(log, group, rule, boreholes.ends[hole], journal)
        if row:
            found.append((hole, depth, row))
        else:
            unseen.append(hole)
    if unseen:
        why = (
            message("io.bed-starts-at-collar", "starts at the collar")
            if limit == "top"
            else message("io.bed-open-at-end", "is open at the hole's end")
        )
        journal.add(
            "note",
            log.file,
            message(
                "io.contacts-uncertain",
                "{limit} of {code}: contacts: {count}; no certain contact (the code {why}, or its "
                "limit is contradicted) in holes ({unseen}): {holes}",
                limit=limit,
                code=code,
                count=len(found),
                why=why,
                unseen=len(unseen),
                holes=", ".join(unseen),
            ),
            value=code,
        )
    if not found:
        return PointSet(np.empty((0, 3)))
    return PointSet(
        np.concatenate([boreholes.paths[hole].at(depth) for hole, depth, _ in found]),
        kind="borehole",
        hole=[hole for hole, _, _ in found],
        row=[row for _, _, row in found],
        file=log.file,
    )


def _limit_in_hole(
    log: IntervalLog, group: NDArray[np.int64], rule: ContactRule, end: float, journal: Journal
) -> tuple[float, int]:
    """Return depth and row of the contact of one hole; row 0 where the hole does not see it."""
    code, limit = rule.label, rule.limit
    runs = _runs(log, group, code)
    run = runs[0 if rule.first else -1]
    depth, row = (log.top[run[0]], log.row[run[0]]) if limit == "top" else (log.base[run[1]], log.row[run[1]])
    hole, row = str(log.hole[group[0]]), int(row)

    def warn(reason: Message, remedy: Message) -> None:
        journal.add(
            "warning",
            log.file,
            message("io.hole-and-reason", "Hole {hole}: {reason}", hole=hole, reason=reason),
            remedy,
            row=row,
            value=code,
        )

    if len(runs) > 1 and rule.occurrence is None:
        which = (
            message("io.uppermost-top", "uppermost top") if limit == "top" else message("io.lowest-base", "lowest base")
        )
        warn(
            message(
                "io.code-repeats",
                "{code} occurs {count} times; the {which} at {depth:g} m is taken",
                code=code,
                count=len(runs),
                which=which,
                depth=depth,
            ),
            message("io.give-repeats-codes", "Give the repeats codes of their own."),
        )
    tolerance = DEPTH_TOLERANCE
    other = group[log.code[group] != code]
    if ((log.top[other] < depth - tolerance) & (log.base[other] > depth + tolerance)).any():
        warn(
            message(
                "io.limit-inside-interval",
                "the {limit} of {code} at {depth:g} m lies inside another interval and is not used",
                limit=limit,
                code=code,
                depth=depth,
            ),
            message("io.remove-overlap", "Remove the overlap."),
        )
        return depth, 0
    if limit == "top":
        above = log.base[other][log.base[other] <= depth + tolerance]
        if depth <= tolerance:
            return depth, 0
        gap = depth - float(above.max(initial=0.0))
    else:
        below = log.top[other][log.top[other] >= depth - tolerance]
        # A log that ends a little above its hole ends with it: nothing shows that its last unit does, too.
        rest = tolerance if len(below) else max(REST, REST_SHARE * end)
        if depth >= end - rest or (log.ended is not None and log.ended[run[1]]):
            return depth, 0
        gap = float(below.min(initial=end)) - depth
    if gap > tolerance:
        side = "above" if limit == "top" else "below"
        warn(
            message(
                "io.gap-in-log",
                "nothing is logged for {gap:.2f} m {side} the {limit} of {code} at {depth:g} m",
                gap=gap,
                side=side,
                limit=limit,
                code=code,
                depth=depth,
            ),
            message("io.complete-log", "Complete the log."),
        )
    return depth, row


def _runs(log: IntervalLog, group: NDArray[np.int64], code: str) -> list[tuple[int, int]]:
    """Return first and last index of each run of intervals of a code that touch each other."""
    runs: list[tuple[int, int]] = []
    for i in map(int, group[log.code[group] == code]):
        if runs and log.top[i] <= log.base[runs[-1][1]] + DEPTH_TOLERANCE:
            first, last = runs[-1]
            runs[-1] = (first, i if log.base[i] > log.base[last] else last)
        else:
            runs.append((i, i))
    return runs
