"""Runs each tool in its own process over all files.

bpy and pymeshlab bring libraries that break one another in one process, and any of them may crash on a bad
file: a batch that dies is run again file by file, so that only the culprit carries the error.

Most tools read floats alone. A file that requires an extension is unpacked for them by other code than ours; three.js
and the validator take it as it is shipped, and the validator the unpacked one besides.
"""

from __future__ import annotations

import json
import shutil
import struct
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from blake3 import blake3

from checks.document import split
from checks.finding import Measured

SCRIPTS = Path(__file__).resolve().parent.parent
OWN = SCRIPTS.parent / ".venv" / "bin" / "python"
PYTHON = OWN if OWN.exists() else Path(sys.executable)  # an installed package has the environment that it runs in
PYTHON_TOOLS = ("written", "trimesh", "meshlab", "blender")
NODE_TOOLS = ("validator", "three")
TOOLS = PYTHON_TOOLS + NODE_TOOLS
UNPACKED = "unpacked"  # the validator on what other code than ours made plain
SECONDS_A_BATCH = 1800


def measure(files: list[Path], tools: tuple[str, ...] = TOOLS, jobs: int = 2) -> dict[Path, list[Measured]]:
    """What every tool found in every file, `jobs` tools at a time."""
    with tempfile.TemporaryDirectory() as folder:
        plain = unpacked(files, Path(folder))
        tasks = [(tool, [file if tool in NODE_TOOLS else plain.get(file, file) for file in files]) for tool in tools]
        tasks.append(("validator", list(plain.values())))
        with ThreadPoolExecutor(jobs) as pool:
            *batches, again = pool.map(lambda task: measure_with(*task) if task[1] else [], tasks)
        found = {file: [batch[i] for batch in batches] for i, file in enumerate(files)}
        for file, one in zip(plain, again, strict=True):
            one.tool = UNPACKED
            as_shipped(file, found[file])
            found[file].append(one)
    return found


def unpacked(files: list[Path], folder: Path) -> dict[Path, Path]:
    """For each file that requires an extension one that does not, with its report beside it."""
    packed = [file for file in files if file.suffix == ".glb" and required_extensions(file)]
    plain = {}
    for number, file in enumerate(packed):
        own = folder / str(number)
        own.mkdir()
        subprocess.run(["node", "checks/unpack.mjs", str(own), str(file)], cwd=SCRIPTS, check=True)
        report = file.with_name(f"{file.stem}.report.json")
        if report.exists():
            shutil.copy(report, own)
        plain[file] = own / file.name
    return plain


def as_shipped(file: Path, found: list[Measured]) -> None:
    """Facts of the file itself, which was measured unpacked."""
    data = file.read_bytes()
    for one in found:
        if one.tool == "written" and one.error is None:
            one.totals |= {"bytes": len(data), "blake3": blake3(data).hexdigest()}
            one.totals["required-extensions"] = required_extensions(file)
            one.totals["used-extensions"] = split(data)[0].get("extensionsUsed", [])


def required_extensions(file: Path) -> list[str]:
    """What the file cannot be read without; of a broken file nothing, each tool says what is wrong with it."""
    try:
        return split(file.read_bytes())[0].get("extensionsRequired", [])
    except (ValueError, struct.error):
        return []


def measure_with(tool: str, files: list[Path]) -> list[Measured]:
    """What one tool found, one entry for each file in order."""
    found, reason = run(tool, files)
    if found is not None:
        return found
    if len(files) == 1:
        return [Measured(tool, "", str(files[0]), error=reason)]
    return [one for file in files for one in measure_with(tool, [file])]


def run(tool: str, files: list[Path]) -> tuple[list[Measured] | None, str]:
    """One process; (None, why) when it did not finish."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "measured.json"
        line = [*command(tool), str(out), *map(str, files)]
        try:
            done = subprocess.run(
                line, cwd=SCRIPTS, capture_output=True, text=True, timeout=SECONDS_A_BATCH, check=False
            )
        except FileNotFoundError as error:
            return None, f"cannot start: {error.filename} is missing; run scripts/setup"
        except subprocess.TimeoutExpired:
            return None, f"did not finish in {SECONDS_A_BATCH} s"
        if done.returncode != 0 or not out.exists():
            last = (done.stderr.strip().splitlines() or [""])[-1]
            return None, f"exit code {done.returncode}: {last}"
        return [Measured(**one) for one in json.loads(out.read_text(encoding="utf-8"))], ""


def command(tool: str) -> list[str]:
    """How a tool is started in the scripts folder."""
    if tool in NODE_TOOLS:
        return ["node", f"checks/{tool}.mjs"]
    return [str(PYTHON), "-m", f"checks.{tool}"]
