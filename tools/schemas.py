"""Write the JSON schema of every JSON that Vedette writes, from the types that it is written from:
``schemas.py FOLDER``.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import msgspec
from msgspec import inspect

from bench.cases import Result
from bench.compare import CompareReport
from bench.criteria import BenchReport
from bench.crowds import CrowdResult
from bench.decomposition import Shares
from bench.forecast import ForeseenResult
from bench.frames.trial import Trial
from bench.large.cases import LargeResult
from bench.latency import LatencyReport
from bench.monitoring import FieldRun
from bench.priority import ErrandResult
from bench.scale.report import ScaleReport
from bench.stonesoup.__main__ import StoneSoupReport
from bench.strangers import StrangersResult
from vedette.net.results import RobotSummary, TracksFound
from vedette.net.status import TeamStatus
from vedette.record.explore.summary import ExploreSummary
from vedette.record.merge.summary import MergeSummary
from vedette.record.monitor.summary import MonitorSummary
from vedette.record.own.summary import OwnSummary
from vedette.record.replay.summary import ReplaySummary
from vedette.record.search.summary import SearchSummary
from vedette.record.seek.summary import SeekSummary
from vedette.record.summary import Timing
from vedette.record.track.summary import TrackSummary
from vedette.study.store import RunFile

KINDS: Mapping[str, type] = {
    "explore-summary": ExploreSummary,
    "track-summary": TrackSummary,
    "search-summary": SearchSummary,
    "monitor-summary": MonitorSummary,
    "replay-summary": ReplaySummary,
    "merge": MergeSummary,
    "seek-summary": SeekSummary,
    "own-summary": OwnSummary,
    "timing": Timing,
    "status": TeamStatus,
    "robot-summary": RobotSummary,
    "tracks": TracksFound,
    "study-run": RunFile,
    "bench": BenchReport,
    "bench-compare": CompareReport,
    "bench-latency": LatencyReport,
    "bench-scale": ScaleReport,
    "bench-stonesoup": StoneSoupReport,
    "bench-mission": Result,
    "bench-crowd": CrowdResult,
    "bench-decomposition": Shares,
    "bench-large": LargeResult,
    "bench-monitoring": FieldRun,
    "bench-frames": Trial,
    "bench-forecast": ForeseenResult,
    "bench-priority": ErrandResult,
    "bench-strangers": StrangersResult,
}


def schema(kind: type) -> dict[str, Any]:
    """Return the schema of what `vedette.record.plain` makes of an object: all its fields, and no others."""
    (top,), parts = msgspec.json.schema_components((kind,), ref_template="#/$defs/{name}")
    for name, fields in _objects(inspect.type_info(kind)):
        _as_object(parts[name], fields)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **top, "$defs": parts}


def text(kind: type) -> str:
    """Return the file of a schema."""
    return json.dumps(schema(kind), indent=2, ensure_ascii=False) + "\n"


def write(folder: Path) -> None:
    """Write all schemas into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, kind in KINDS.items():
        (folder / f"{name}.json").write_text(text(kind), encoding="utf-8")


def _objects(info: inspect.Type) -> Iterator[tuple[str, list[str]]]:
    """Yield the classes in a type by name, each with its fields in order."""
    match info:
        case inspect.StructType() | inspect.DataclassType():
            kind = info.cls
            fields = kind.__struct_fields__ if inspect.is_struct_type(kind) else kind.__dataclass_fields__
            yield kind.__name__, list(fields)
            for field in info.fields:
                yield from _objects(field.type)
        case inspect.UnionType():
            for each in info.types:
                yield from _objects(each)
        case inspect.DictType():
            yield from _objects(info.value_type)
        case inspect.VarTupleType() | inspect.ListType():
            yield from _objects(info.item_type)


def _as_object(part: dict[str, Any], fields: list[str]) -> None:
    """Make a part say that all its fields are there, in order, and no others; arrays on the wire too."""
    if "prefixItems" in part:
        items = part["prefixItems"][-len(fields) :]  # a tag goes before them
        part.update(type="object", properties=dict(zip(fields, items, strict=True)))
        for word in ("prefixItems", "minItems", "maxItems", "items"):
            part.pop(word, None)
    part["properties"] = {name: _property(part["properties"][name]) for name in fields}
    part["required"] = fields
    part["additionalProperties"] = False


def _property(part: dict[str, Any]) -> dict[str, Any]:
    """Return a field's schema: it is always written, and ``\\Z`` is Python's alone."""
    written = {word: value for word, value in part.items() if word != "default"}
    if "pattern" in written:
        written["pattern"] = written["pattern"].replace(r"\Z", "$")
    return written


if __name__ == "__main__":
    write(Path(sys.argv[1]))
