#!/usr/bin/env python3
"""Writes the licenses of everything that a built program holds, and fails where one may not be passed on.

    scripts/licenses.py THIRD-PARTY.txt                    for the host, with shared caches
    scripts/licenses.py THIRD-PARTY.txt --target TRIPLE    for another platform

Every crate that is linked stands there with its version, its license expression and the texts of its package. Exit
code 0: all of them may be passed on; 1: some may not, or have no text. Reads what `cargo metadata` tells; needs the
packages of Cargo.lock, as a build does.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
ALLOWED = {
    "0BSD", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "BSL-1.0", "CC0-1.0", "CDLA-Permissive-2.0", "ISC", "MIT",
    "MIT-0", "MPL-2.0", "Unicode-3.0", "Unlicense", "Zlib",
}  # fmt: skip
TEXTS = re.compile(r"(?i)^(licen[sc]e|copying|unlicense|notice|copyright)")
OWN_TEXTS = {"MIT": "LICENSE-MIT", "Apache-2.0": "LICENSE-APACHE"}  # the same words, but for the names of authors


def main() -> int:
    """Write the file that the command line names; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--target", help="the platform")
    options = parser.parse_args()
    parts, wrong = [], []
    for package in linked(metadata(options.target or host())):
        name = f"{package['name']} {package['version']}"
        expression = package["license"] or ""
        if not allowed(expression):
            wrong.append(f"{name}: {expression or 'no license'} may not be passed on")
        texts = license_texts(package)
        if not texts:
            wrong.append(f"{name}: its package holds no text of {expression}")
        parts.append("\n\n".join([f"{'=' * 80}\n{name}\n{expression}", *texts]))
    for line in wrong:
        print(f"licenses: {line}", file=sys.stderr)
    options.out.write_text("\n\n".join(parts) + "\n", encoding="utf-8")
    print(f"licenses: {len(parts)} packages, {len(wrong)} faults; {options.out}")
    return 1 if wrong else 0


def host() -> str:
    """The platform that this runs on."""
    said = subprocess.run(["rustc", "-vV"], capture_output=True, text=True, check=True).stdout
    return re.search(r"^host: (.*)$", said, re.MULTILINE)[1]


def metadata(target: str) -> dict[str, Any]:
    """The packages of a build and how they depend on one another."""
    words = [
        "cargo",
        "metadata",
        "--locked",
        "--format-version",
        "1",
        "--features",
        "remote",
        "--filter-platform",
        target,
    ]
    return json.loads(subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout)


def linked(found: dict[str, Any]) -> list[dict[str, Any]]:
    """The packages that are linked, without our own: what it needs to run, and what that needs."""
    nodes = {node["id"]: node for node in found["resolve"]["nodes"]}
    waiting, seen = [found["resolve"]["root"]], set()
    while waiting:
        one = waiting.pop()
        if one not in seen:
            seen.add(one)
            needed = (way for way in nodes[one]["deps"] if any(kind["kind"] is None for kind in way["dep_kinds"]))
            waiting.extend(way["pkg"] for way in needed)
    seen.remove(found["resolve"]["root"])
    packages = [package for package in found["packages"] if package["id"] in seen]
    return sorted(packages, key=lambda package: (package["name"], package["version"]))


def allowed(expression: str) -> bool:
    """Whether a license expression leaves a choice that is allowed. Source: SPDX Specification 3.0, annex B."""
    tokens = re.findall(r"[()]|[A-Za-z0-9.+-]+", expression.replace("/", " OR "))
    if not tokens:
        return False
    words = {"(": "(", ")": ")", "AND": "and", "OR": "or"}
    exceptions = {place + 1 for place, token in enumerate(tokens) if token == "WITH"}
    rule = [
        words.get(token, str(token in ALLOWED))
        for place, token in enumerate(tokens)
        if token != "WITH" and place not in exceptions
    ]
    return bool(eval(" ".join(rule), {"__builtins__": {}}))  # words of the table above alone


def license_texts(package: dict[str, Any]) -> list[str]:
    """The texts in a package; where it has none, those of ours that are the same."""
    folder = Path(package["manifest_path"]).parent
    names = {path for path in folder.iterdir() if path.is_file() and TEXTS.match(path.name)}
    if package.get("license_file"):
        names.add(folder / package["license_file"])
    texts = [path.read_text(encoding="utf-8", errors="replace").strip() for path in sorted(names)]
    if texts:
        return texts
    authors = ", ".join(package["authors"]) or "its authors"
    for name, own in OWN_TEXTS.items():
        if name in package["license"]:
            return [
                re.sub(
                    r"(?m)^Copyright.*$", f"Copyright (c) {authors}", (ROOT / own).read_text(encoding="utf-8")
                ).strip()
            ]
    return []


if __name__ == "__main__":
    sys.exit(main())
