"""Drives the built program: writes a spec, bakes it, reads back what it wrote."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from checks.document import Document

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

SECONDS = 120


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
