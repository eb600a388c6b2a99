#!/usr/bin/env python3
"""Makes docs/trust.md, the table of what tried to break the program, from what the tests counted.

    scripts/trust.py                   from what .ci/run left in target/counts, target/ci and out
    scripts/trust.py --fuzz FILE       with the counts of `scripts/fuzz --json FILE` as well
    scripts/trust.py --mutants FILE    with the outcomes.json of cargo-mutants as well
    scripts/trust.py --check           change nothing; exit code 1 where docs/trust.md claims more than was counted

Counts stand in docs/trust.json too. What did not run keeps the count of the run before.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
COUNTS = ROOT / "target" / "counts"
IDENTICAL = ROOT / "target" / "ci" / "identical-assets"
VERIFIED = ROOT / "out" / "verify.json"
KEPT = ROOT / "docs" / "trust.json"
PAGE = ROOT / "docs" / "trust.md"


@dataclass(frozen=True)
class Row:
    """A line of the table: what is counted, and the test that counts it. A name may end in `*`: all that begin so."""

    names: tuple[str, ...]
    what: str
    shown: str

    def of(self, counts: dict[str, int]) -> list[str]:
        """Its names among what was counted."""
        return [name for name in counts if any(fnmatchcase(name, own) for own in self.names)]


ROWS = (
    Row(
        ("cases-of-language", "cases-of-bake"),
        "documents with something wrong, each with the messages that it must give",
        "`tests/language/cases`, `tests/bake/cases`",
    ),
    Row(
        ("damaged-documents",),
        "gallery documents with random damage: refused with a place, or baked whole and within their bounds",
        "`tests/bake/mutation.rs` (`KILN_ROUNDS` for more)",
    ),
    Row(
        ("random-documents",),
        "random documents by the schema: refused, or right by an independent reader and the same bytes twice",
        "`test_random_documents.py`",
    ),
    Row(
        tuple(f"cut-documents-{number}" for number in range(3)),
        "documents cut off at every byte",
        "`test_faults.py`",
    ),
    Row(("hostile-files",), "files made to do harm: bombs, lies about sizes, cycles", "`tests/bake/hostile.rs`"),
    Row(("broken-files",), "broken and odd files of other makers", "`tests/bake/hostile.rs`"),
    Row(
        ("damaged-gltf-files", "damaged-scenes", "damaged-packed-files", "damaged-optimized-files"),
        "binary files cut off or with a changed bit: read, or refused with a reason",
        "`import_gltf.rs`, `refusals.rs`, `profiles.rs`, `repack.rs`",
    ),
    Row(
        ("limits-*",),
        "bakes of growing documents: memory measured from outside stays below its limit and 64 MB",
        "`test_limits.py`",
    ),
    Row(
        ("refused-*",),
        "documents that ask for too much of one resource, refused before memory is taken",
        "`test_limits.py`",
    ),
    Row(
        ("bakes-to-kill",),
        "bakes that are killed at a random moment: outputs are old or new, never torn",
        "`test_faults.py`",
    ),
    Row(("changing-documents",), "bakes of a document that changes meanwhile", "`test_faults.py`"),
    Row(("real-models",), "real files of other makers tried", "`test_real_models.py`"),
    Row(("real-models-baked",), "of them baked, and right by every tool", "`test_real_models.py`"),
    Row(("real-models-optimized",), "of them through `kiln optimize`", "`test_real_models.py`"),
    Row(("gallery-assets",), "files of the gallery that five independent tools confirm", "`scripts/verify.py`"),
    Row(("gallery-comparisons",), "claims of their reports compared", "`scripts/verify.py`"),
    Row(
        ("identical-assets",),
        "assets of the gallery, byte-identical by 1 and 2 threads, with optimization and without",
        "`.ci/run`",
    ),
)


def main() -> int:
    """Merge counts, then write the page or compare it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fuzz", type=Path, metavar="FILE", help="what scripts/fuzz counted")
    parser.add_argument("--mutants", type=Path, metavar="FILE", help="what cargo-mutants found")
    parser.add_argument("--check", action="store_true", help="compare, and change nothing")
    options = parser.parse_args()
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
    found = merged(kept, options)
    if options.check:
        return compare(kept, found)
    KEPT.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    PAGE.write_text(text(found), encoding="utf-8")
    return 0


def merged(kept: dict[str, Any], options: argparse.Namespace) -> dict[str, Any]:
    """What was kept with what was counted now."""
    counts = dict(kept.get("counts", {}))
    if COUNTS.is_dir():
        counts |= {path.name: int(path.read_text(encoding="utf-8")) for path in sorted(COUNTS.iterdir())}
    if VERIFIED.exists():
        findings = json.loads(VERIFIED.read_text(encoding="utf-8"))["findings"]
        counts["gallery-assets"] = len({finding["asset"] for finding in findings})
        counts["gallery-comparisons"] = len(findings)
    if IDENTICAL.exists():
        counts[IDENTICAL.name] = int(IDENTICAL.read_text(encoding="utf-8"))
    stray = sorted(set(counts) - {name for row in ROWS for name in row.of(counts)})
    if stray:
        sys.exit(f"trust: no line of the table has {', '.join(stray)}")
    found = {"counts": counts, "fuzz": kept.get("fuzz", []), "mutants": kept.get("mutants")}
    if options.fuzz:
        found["fuzz"] = [
            {key: run[key] for key in ("target", "executions", "covered", "seconds", "failed")}
            for run in json.loads(options.fuzz.read_text(encoding="utf-8"))
        ]
    if options.mutants:
        found["mutants"] = mutants(json.loads(options.mutants.read_text(encoding="utf-8")))
    return found


def mutants(outcomes: dict[str, Any]) -> dict[str, Any]:
    """The counts of cargo-mutants, and the mutants that no test saw."""
    missed = [one["scenario"]["Mutant"]["name"] for one in outcomes["outcomes"] if one["summary"] == "MissedMutant"]
    counts = {key: outcomes[key] for key in ("total_mutants", "caught", "missed", "timeout", "unviable")}
    return counts | {"survivors": sorted(missed)}


def compare(kept: dict[str, Any], found: dict[str, Any]) -> int:
    """Tell where the page claims more than was counted, or is not what was kept."""
    less = [
        f"{name}: {before} written, {found['counts'][name]} counted"
        for name, before in sorted(kept.get("counts", {}).items())
        if found["counts"][name] < before
    ]
    counts = kept.get("counts", {})
    missing = [name for row in ROWS for name in row.names if not any(fnmatchcase(own, name) for own in counts)]
    if not less and not missing and PAGE.exists() and PAGE.read_text(encoding="utf-8") == text(kept):
        return 0
    print("\n".join(less + [f"{name}: never counted" for name in missing]), file=sys.stderr)
    print("trust: run scripts/trust.py and commit docs/trust.md and docs/trust.json", file=sys.stderr)
    return 1


def text(found: dict[str, Any]) -> str:
    """The page."""
    counts = found["counts"]
    lines = [
        "# What tried to break it",
        "",
        "Made by `scripts/trust.py` from what the tests counted. All of it ran without a crash, a hang, a wrong claim",
        "or a torn file: a finding fails the test, becomes a regression test, and is mended.",
        "",
        "| count | what | where |",
        "| ---: | --- | --- |",
    ]
    lines += [
        f"| {sum(counts[name] for name in row.of(counts))} | {row.what} | {row.shown} |"
        for row in ROWS
        if row.of(counts)
    ]
    if found["fuzz"]:
        lines += [
            "",
            "## Fuzzing",
            "",
            "Coverage-guided, by `scripts/fuzz`; the last run. Documents are whole gallery documents, so they are few.",
            "",
            "| target | executions | edges covered | seconds | findings |",
            "| --- | ---: | ---: | ---: | --- |",
        ]
        for run in found["fuzz"]:
            cells = [
                run["target"],
                run["executions"],
                run["covered"],
                run["seconds"],
                "one" if run["failed"] else "none",
            ]
            lines.append(f"| {' | '.join(map(str, cells))} |")
    if found["mutants"]:
        seen = found["mutants"]
        lines += [
            "",
            "## Mutants",
            "",
            f"Of {seen['total_mutants']} changes to the code, {seen['caught']} made a test fail, {seen['timeout']} "
            f"never ended, {seen['unviable']} did not compile, and {seen['missed']} were not seen:",
            "",
            *(f"- `{name}`" for name in seen["survivors"]),
        ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main())
