"""The JSON Schema of the results: ``geofit/report/result.schema.json`` from the dataclasses that are written.

``python tools/schema.py`` writes it; with ``--check`` nothing is written: it fails where the file is out of date.
"""

from __future__ import annotations

import argparse
import json
import sys
import types
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from geofit.bodies.accuracy import BodyAccuracy
from geofit.bodies.data import BodyIssue
from geofit.bodies.simulate import BodyVolumes
from geofit.cad.solid import SolidReadBack
from geofit.data.messages import Message
from geofit.data.prediction import LeftOutBody
from geofit.data.verdict import Lamp
from geofit.pores.table import BeforeAfter
from geofit.report.accuracy_report import AccuracyReport, HorizonReport, InputFile, RejectedRow
from geofit.report.schema import SCHEMA_FILE, VERSION, ErrorReport

SIMPLE = {str: "string", int: "integer", float: "number", bool: "boolean", type(None): "null"}
ANYTHING: dict[str, Any] = {}
MESSAGE = {
    "type": "object",
    "description": "A sentence: stable code, severity, English text, parameters.",
    "properties": {
        "code": {"type": "string"},
        "severity": {"enum": ["info", "warning", "error"]},
        "text": {"type": "string"},
        "params": {"type": "object"},
    },
    "required": ["code", "severity", "text", "params"],
    "additionalProperties": False,
}


class Schema:
    """Collects the definitions of dataclasses."""

    def __init__(self) -> None:
        self.defs: dict[str, Any] = {"Message": MESSAGE}

    def of(self, kind: Any) -> dict[str, Any]:
        """Return the schema of a type."""
        if kind is Message:
            return {"$ref": "#/$defs/Message"}
        if kind in SIMPLE:
            # Not a number and infinities are written as null.
            return {"type": ["number", "null"]} if kind is float else {"type": SIMPLE[kind]}
        if is_dataclass(kind):
            return self.define(kind)
        origin, args = get_origin(kind), get_args(kind)
        if origin is Literal:
            return {"enum": list(args)}
        if origin in (Union, types.UnionType):
            return {"anyOf": [self.of(arg) for arg in args]}
        if origin is tuple and len(args) == 2 and args[1] is Ellipsis:
            return {"type": "array", "items": self.of(args[0])}
        if origin is tuple:
            return {
                "type": "array",
                "prefixItems": [self.of(arg) for arg in args],
                "minItems": len(args),
                "items": False,
            }
        if origin is np.ndarray:
            return {"type": "array"}
        if origin is not None and issubclass(origin, Mapping):
            return {"type": "object", "additionalProperties": self.of(args[1])}
        return ANYTHING

    def define(self, kind: Any, *, without: tuple[str, ...] = ()) -> dict[str, Any]:
        """Return a reference to the definition of a dataclass, closed against other keys."""
        name = kind.__name__
        if name not in self.defs:
            self.defs[name] = {}
            self.defs[name] = self.object(kind, without=without)
        return {"$ref": f"#/$defs/{name}", "unevaluatedProperties": False}

    def object(self, kind: Any, *, without: tuple[str, ...] = ()) -> dict[str, Any]:
        """Return the schema of the fields of a dataclass."""
        hints = get_type_hints(kind)
        properties = {f.name: self.of(hints[f.name]) for f in fields(kind) if f.name not in without}
        return {
            "type": "object",
            "description": " ".join((kind.__doc__ or "").split("\n\n")[0].split()),
            "properties": properties,
            "required": list(properties),
        }


def schema() -> dict[str, Any]:
    """Return the schema of all documents."""
    s = Schema()
    report, horizon = s.define(AccuracyReport)["$ref"], s.define(HorizonReport)["$ref"]
    numbers = {"type": "object", "additionalProperties": {"type": "number"}}
    words = {"type": "object", "additionalProperties": {"type": "string"}}
    messages = {"type": "object", "additionalProperties": s.of(Message)}
    body = s.define(BodyAccuracy, without=("residuals", "patch"))["$ref"]
    volumes = s.define(BodyVolumes, without=("values",))
    pores = s.define(BeforeAfter)["$ref"]
    origin = {
        "site": {"type": "string"},
        "crs": {"type": "string"},
        "inputs": {"type": "array", "items": s.of(InputFile)},
        "rejected": {"type": "array", "items": s.of(RejectedRow)},
        "versions": words,
        "seconds": numbers,
    }
    of_body = {
        "body": {"type": "string"},
        "verdict": {"enum": ["PASS", "WARNING", "FAIL"]},
        "lamps": s.of(tuple[Lamp, ...]),
        "left_out": s.of(LeftOutBody | None),
        "settings": {"type": "object"},
        "volumes": volumes,
        "read_back": s.of(SolidReadBack),
        "issues": {"type": "array", "items": s.of(BodyIssue)},
        "version": {"type": "string"},
    }
    of_pores = {
        "shape": {"type": "array", "items": {"type": "integer"}, "minItems": 3, "maxItems": 3},
        "voxel": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
        "porosity": {"type": "number"},
        "maximal_balls": {"type": ["integer", "null"]},
        **{key: {"type": "integer"} for key in ("pores", "throats", "dropped_pores")},
        "network_permeability": {"type": "array", "items": {"type": ["number", "null"]}, "minItems": 3, "maxItems": 3},
        "messages": {"type": "array", "items": {"$ref": "#/$defs/Message"}},
        "mean_coordination": {"type": "number"},
        "percolates": {"type": "array", "items": {"type": "boolean"}},
        "settings": {"type": "object"},
        "version": {"type": "string"},
    }
    files = {"type": "array", "items": {"type": "string"}}
    documents = [
        _document("report", report, {}, {"out": {"type": "string"}}),
        _document("horizon", horizon, origin, {}),
        _document("failure", None, {"failures": messages, "versions": words}, {"out": {"type": "string"}}),
        _document("error", s.define(ErrorReport)["$ref"], {}, {}),
        _document("body", body, of_body, {"files": files}),
        _document("pores", pores, of_pores, {"files": files}),
        _document("pore-network", None, of_pores, {"files": files}),
    ]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "geofit results",
        "description": "NAME.json, report.json and the output of --json. Lengths are metres, angles degrees.",
        "oneOf": documents,
        "$defs": dict(sorted(s.defs.items())),
    }


def _document(kind: str, result: str | None, more: dict[str, Any], optional: dict[str, Any]) -> dict[str, Any]:
    properties = {"schema_version": {"const": VERSION}, "kind": {"const": kind}, **more}
    made: dict[str, Any] = {
        "title": kind,
        "type": "object",
        "properties": {**properties, **optional},
        "required": list(properties),
        "unevaluatedProperties": False,
    }
    return made if result is None else {**made, "allOf": [{"$ref": result}]}


def main() -> int:
    """Write the schema, or check it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing, fail if the file is out of date")
    text = json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"
    if not parser.parse_args().check:
        SCHEMA_FILE.write_text(text, encoding="utf-8")
        return 0
    if SCHEMA_FILE.is_file() and SCHEMA_FILE.read_text(encoding="utf-8") == text:
        return 0
    print(f"{SCHEMA_FILE.name} is out of date; run python tools/schema.py", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
