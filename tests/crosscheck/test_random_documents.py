"""Random documents by the schema: refused with a diagnostic, or baked into files that are right, twice the same."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING

import random_documents

from checks import compare, written

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from kiln import Kiln

COUNT = 250
SEED = 20


def digests(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.iterdir())}


def test_random_documents_are_refused_or_right(kiln: Kiln, tried: Callable[[str, int], None]) -> None:
    random_documents.write(kiln.folder / "specs", COUNT, SEED)
    done = kiln.run("bake", "specs", "--out", "out", "--format", "json", seconds=600)
    said = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.returncode == 1
    assert "panicked" not in done.stderr
    errors = [entry["diagnostic"] for entry in said if entry.get("diagnostic", {}).get("severity") == "error"]
    # An error without a code is one of the program.
    assert [error for error in errors if not error.get("code")] == []
    assert all(error["message"] and "NaN" not in error["message"] for error in errors)
    baked = sorted((kiln.folder / "out").glob("*.glb"))
    tried("random-documents", COUNT)
    assert len(baked) >= COUNT // 8, "too few of them are sound for this to mean much"
    wrong = []
    for path in baked:
        report = json.loads(path.with_name(path.name.replace(".glb", ".report.json")).read_text(encoding="utf-8"))
        findings = compare.compare(path.stem, report, [written.measure(path)])
        # One tool alone measures here; what it did not look at is no matter.
        wrong += [finding for finding in findings if finding.tool == "written" and not finding.holds]
    assert wrong == []
    again = kiln.run("bake", "specs", "--out", "again", "--jobs", "1", seconds=600)
    assert again.returncode == 1
    assert digests(kiln.folder / "again") == digests(kiln.folder / "out")
