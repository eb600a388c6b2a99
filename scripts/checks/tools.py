"""Runs each tool in its own process over all files.

bpy and pymeshlab bring libraries that break one another in one process, and any of them may crash on a bad
file: a batch that dies is run again file by file, so that only the culprit carries the error.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from checks.finding import Measured

SCRIPTS = Path(__file__).resolve().parent.parent
PYTHON = SCRIPTS.parent / ".venv" / "bin" / "python"
PYTHON_TOOLS = ("written", "trimesh", "meshlab", "blender")
NODE_TOOLS = ("validator", "three")
TOOLS = PYTHON_TOOLS + NODE_TOOLS
SECONDS_A_BATCH = 1800


def measure(files: list[Path], tools: tuple[str, ...] = TOOLS, jobs: int = 2) -> dict[Path, list[Measured]]:
    """What every tool found in every file, `jobs` tools at a time."""
    with ThreadPoolExecutor(jobs) as pool:
        batches = list(pool.map(lambda tool: measure_with(tool, files), tools))
    return {file: [batch[i] for batch in batches] for i, file in enumerate(files)}


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
