"""Drives the built program: writes a spec, bakes it, reads back what it wrote."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from checks.document import Document

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

SECONDS = 120
# The system counts the memory of what had started a process as its own, before it became itself: a small one starts it.
STARTER = """
import os, sys
_, status, used = os.wait4(os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ), 0)
print(used.ru_maxrss)
sys.exit(os.waitstatus_to_exitcode(status))
"""


@dataclass(frozen=True)
class Baked:
    """One written asset."""

    path: Path
    report: dict[str, Any]
    document: Document

    def shape(self, name: str) -> dict[str, Any]:
        """The report's facts of one shape."""
        return self.report["shapes"][name]

    def mesh(self, name: str) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Merged points and triangles of one mesh."""
        return next(mesh for mesh in self.document.meshes if mesh.name == name).merged


@dataclass(frozen=True)
class Kiln:
    """The program and the project folder that it works in."""

    program: Path
    folder: Path

    def run(self, *arguments: str, seconds: float = SECONDS) -> subprocess.CompletedProcess[str]:
        """Run the program with the project folder as working directory."""
        return subprocess.run(
            [str(self.program), *arguments],
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=seconds,
            check=False,
        )

    def measured(self, *arguments: str, seconds: float = SECONDS) -> tuple[int, int, str]:
        """Run the program quietly: its exit code, the bytes of memory that it had at its most, and what it told."""
        line = [sys.executable, "-S", "-c", STARTER, str(self.program), *arguments, "--quiet"]
        done = subprocess.run(line, cwd=self.folder, capture_output=True, text=True, timeout=seconds, check=False)
        return done.returncode, int(done.stdout) * 1024, done.stderr

    def write(self, spec: str, name: str = "model") -> Path:
        """Write a spec; returns its path."""
        path = self.folder / f"{name}.toml"
        path.write_text(spec, encoding="utf-8")
        return path

    def bake(self, spec: str, *options: str, name: str = "model") -> Baked:
        """Bake a spec that must be right."""
        self.write(spec, name)
        done = self.run("bake", f"{name}.toml", "--out", "out", *options)
        assert done.returncode == 0, done.stdout + done.stderr
        return self.baked(name)

    def baked(self, name: str = "model") -> Baked:
        """What stands in the output folder under a name."""
        path = self.folder / "out" / f"{name}.glb"
        report = json.loads(path.with_name(f"{name}.report.json").read_text(encoding="utf-8"))
        return Baked(path, report, Document(path))

    def sample(self, *arguments: str, name: str = "model") -> dict[str, Any]:
        """Points and derivatives of a curve or shape of the spec written last."""
        done = self.run("sample", f"{name}.toml", *arguments)
        assert done.returncode == 0, done.stdout + done.stderr
        return json.loads(done.stdout)
