"""The one JSON format of measurements and findings, shared by all checks.

A *measurement* is what one tool found in one file: `Measured`. A *finding* is one claim of a report held
against one measurement: `Finding`. Names of facts are the report's own (`boundary-edges`, `acmr`).
"""

from __future__ import annotations

import json
import sys
import traceback
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass
class Measured:
    """What one tool found in one file.

    `totals` are facts of the whole file, `shapes` those of each glTF mesh by its name, in the mesh's own
    coordinates, `nodes` world matrices by node name, column by column, `clips` the poses of each clip at the
    times that the report names, `reaches` for each clip and joint the distances from its targets, frame by frame,
    `drivers` for each clip and weight that follows a joint its angles and weights. `error` says why the tool could
    not measure; then nothing else is set.
    """

    tool: str
    version: str
    file: str
    totals: dict[str, Any] = field(default_factory=dict)
    shapes: dict[str, dict[str, Any]] = field(default_factory=dict)
    nodes: dict[str, list[float]] = field(default_factory=dict)
    clips: dict[str, list[dict[str, Any]]] = field(default_factory=dict)
    reaches: dict[str, dict[str, list[float]]] = field(default_factory=dict)
    drivers: dict[str, dict[str, dict[str, Any]]] = field(default_factory=dict)
    error: str | None = None


@dataclass
class Finding:
    """One claim held against one measurement.

    `place` is the fact's path in the report (`shapes.vase.volume`), `allowed` the largest difference that
    the tool's own rounding explains, `difference` what was seen (infinite when the two cannot be compared).
    """

    asset: str
    place: str
    tool: str
    claimed: Any
    found: Any
    difference: float
    allowed: float
    severity: str = "error"
    message: str = ""

    @property
    def holds(self) -> bool:
        """Whether the claim stands."""
        return self.difference <= self.allowed

    def as_json(self) -> dict[str, Any]:
        """The finding as it stands in `verify.json`."""
        return {**asdict(self), "holds": self.holds}


def run(tool: str, version: str, measure: Callable[[Path], Measured]) -> None:
    """The entry of every check: `OUT.json FILE...`; an exception in one file is that file's error."""
    out, *files = sys.argv[1:]
    found = [measured_or_error(tool, version, Path(file), measure) for file in files]
    Path(out).write_text(json.dumps([asdict(one) for one in found]), encoding="utf-8")


def measured_or_error(tool: str, version: str, file: Path, measure: Callable[[Path], Measured]) -> Measured:
    """`measure(file)`, with whatever it raises turned into the file's error."""
    try:
        return measure(file)
    except Exception as error:  # noqa: BLE001, RUF100 -- any failure of a tool is a finding, not a crash
        place = traceback.extract_tb(error.__traceback__)[-1]
        reason = f"{type(error).__name__}: {error} ({Path(place.filename).name}:{place.lineno})"
        return Measured(tool, version, str(file), error=reason)
