#!/usr/bin/env python3
"""Compares what independent tools compute from every written .glb with the report beside it.

    scripts/verify.py out                      every NAME.glb under out/ with its NAME.report.json
    scripts/verify.py --pictures out           also draws each asset, by Blender (slow: Cycles on the CPU) and by kiln
    scripts/verify.py --no-report FILE.glb     only shows what the tools find in files of other makers

Writes verify.json and verify.html into the first folder named. Exit code 0: every claim holds; 1: some
claim does not, a tool is missing or failed, or a report is missing; 2: usage. Needs scripts/setup.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from checks import page, tools
from checks.compare import compare, failure

if TYPE_CHECKING:
    from checks.finding import Finding, Measured

PICTURE_WIDTH = 640
VIEW = "31.8,23.8"
"""The direction of Blender's pictures, as `kiln render` says it."""


def main() -> int:
    """Verify what the command line names; returns the exit code."""
    options = arguments()
    files = find(options.paths)
    if not files:
        print(f"verify: no .glb file in {' '.join(map(str, options.paths))}", file=sys.stderr)
        return 2
    measured = tools.measure([path for path, _ in files], jobs=options.jobs)
    if options.no_report:
        return show_measured(measured)
    findings = {name: judge(path, name, measured[path]) for path, name in files}
    folder = options.paths[0] if options.paths[0].is_dir() else options.paths[0].parent
    pictures = draw(folder, files, options.kiln) if options.pictures else {}
    page.write(folder / "verify.html", findings, pictures)
    write_json(folder / "verify.json", findings, measured)
    return show_findings(findings, {name: measured[path] for path, name in files}, folder)


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog=Path(sys.argv[0]).name, description=__doc__.split("\n\n")[0])
    parser.add_argument("paths", nargs="+", type=Path, metavar="OUT", help="folders of baked assets, or .glb files")
    parser.add_argument("--no-report", action="store_true", help="only show what the tools find")
    parser.add_argument("--pictures", action="store_true", help="draw each asset with Blender and with kiln")
    kiln = os.environ.get("KILN_BIN") or shutil.which("kiln") or "kiln"
    parser.add_argument("--kiln", default=kiln, metavar="PROGRAM", help="kiln itself [default: KILN_BIN, else on PATH]")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="tools run at one time")
    options = parser.parse_args()
    for path in options.paths:
        if not path.exists():
            parser.error(f"{path} does not exist")
    options.paths = [path.resolve() for path in options.paths]
    return options


def find(paths: list[Path]) -> list[tuple[Path, str]]:
    """The files to verify with their display names, sorted, each once."""
    found: dict[Path, str] = {}
    for path in paths:
        if path.is_dir():
            found.update((file, str(file.relative_to(path).with_suffix(""))) for file in path.rglob("*.glb"))
        else:
            found[path] = path.stem
    return sorted(found.items())


def judge(path: Path, name: str, measured: list[Measured]) -> list[Finding]:
    """The findings for one file."""
    report = path.with_name(f"{path.stem}.report.json")
    try:
        claims = json.loads(report.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return [failure(name, "report", f"{report.name} does not stand beside {path.name}")]
    except ValueError as error:
        return [failure(name, "report", f"{report.name} is not JSON: {error}")]
    return compare(name, claims, measured)


def draw(folder: Path, files: list[tuple[Path, str]], kiln: str) -> dict[str, dict[str, Path]]:
    """Draw each file by kiln and by Blender; returns the pictures by name and drawer, relative to `folder`."""
    pictures = {}
    for path, name in files:
        target = folder / "pictures" / Path(name).parent
        line = [str(tools.PYTHON), "-m", "checks.pictures", str(target), str(PICTURE_WIDTH), str(path)]
        subprocess.run(line, cwd=tools.SCRIPTS, stdout=subprocess.DEVNULL, check=True)
        own = target / f"{path.stem}.kiln.png"
        size = f"{PICTURE_WIDTH}x{PICTURE_WIDTH * 3 // 4}"
        line = [kiln, "render", str(path), "-o", str(own), "--view", VIEW, "--size", size]
        subprocess.run(line, stdout=subprocess.DEVNULL, check=True)
        blender = Path("pictures") / f"{name}.png"
        pictures[name] = {"kiln": own.relative_to(folder), "Blender": blender}
    return pictures


def write_json(target: Path, findings: dict[str, list[Finding]], measured: dict[Path, list[Measured]]) -> None:
    """Write every finding, in the one format, with the versions of the tools."""
    versions = {one.tool: one.version for found in measured.values() for one in found if one.version}
    everything = [finding.as_json() for found in findings.values() for finding in found]
    for one in everything:
        one["difference"] = one["difference"] if math.isfinite(one["difference"]) else None
    text = json.dumps({"tools": versions, "findings": everything}, indent=1)
    target.write_text(text + "\n", encoding="utf-8")


def show_findings(findings: dict[str, list[Finding]], measured: dict[str, list[Measured]], folder: Path) -> int:
    """Print the table, then each disagreement; returns the exit code."""
    rows = [["asset", "triangles", "bytes", *tools.TOOLS, "report"]]
    rows += [row(name, found, measured[name]) for name, found in findings.items()]
    print_table(rows)
    errors = 0
    for finding in (f for found in findings.values() for f in found if not f.holds):
        errors += finding.severity == "error"
        print(describe(finding))
    total = sum(map(len, findings.values()))
    print(f"verify: {len(findings)} assets, {total} comparisons, {errors} disagreements; {folder}/verify.html")
    return 1 if errors else 0


def row(name: str, findings: list[Finding], measured: list[Measured]) -> list[str]:
    """One asset: counts, then for each tool how many claims it confirmed or how many it denies."""
    totals = {key: value for one in measured for key, value in one.totals.items()}
    cells = [name, str(totals.get("triangles", "-")), str(totals.get("bytes", "-"))]
    for tool in (*tools.TOOLS, "report"):
        own = [f for f in findings if f.tool == tool]
        wrong = sum(not f.holds and f.severity == "error" for f in own)
        cells.append(f"{wrong} WRONG" if wrong else f"{len(own)} ok")
    return cells


def describe(finding: Finding) -> str:
    """One disagreement in a line."""
    head = f"{finding.severity}: {finding.asset}: {finding.place or finding.tool}: "
    if finding.message:
        return f"{head}{finding.tool}: {finding.message}"
    found, claimed = page.shown(finding.found), page.shown(finding.claimed)
    allowed = f" (difference {finding.difference:.3g}, allowed {finding.allowed:.3g})" if finding.allowed else ""
    return f"{head}{finding.tool} finds {found}, the report says {claimed}{allowed}"


def show_measured(measured: dict[Path, list[Measured]]) -> int:
    """Print what the tools found, one line for each file, tool and shape; returns the exit code."""
    failed = False
    for path, found in measured.items():
        for one in found:
            failed |= one.error is not None
            print(f"{path.name}: {one.tool}: {one.error or facts(one.totals)}")
            for name, shape in one.shapes.items():
                print(f"  {name}: {facts(shape)}")
    return 1 if failed else 0


def facts(values: dict[str, Any]) -> str:
    """Measured facts in one line."""
    return ", ".join(f"{name} {page.shown(value)}" for name, value in values.items())


def print_table(rows: list[list[str]]) -> None:
    """Print rows in columns, the first one to the left, the others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for cells in rows:
        first, *rest = (cell.rjust(width) for cell, width in zip(cells, widths, strict=True))
        print("  ".join([cells[0].ljust(len(first)), *rest]).rstrip())


if __name__ == "__main__":
    sys.exit(main())
