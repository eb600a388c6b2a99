"""Times whole processes: wall clock, processor time and peak memory of each run."""

from __future__ import annotations

import os
import statistics
import subprocess
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path


@dataclass
class Runs:
    """All runs of one command line."""

    name: str
    command: list[str]
    output: Path
    wall: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)
    peak: int = 0
    failure: str | None = None

    @property
    def median(self) -> float:
        """The median of the wall clock, in seconds."""
        return statistics.median(self.wall)

    def once(self, log: Path, folder: Path) -> None:
        """Run the command once and note what it took; a failure stops further runs of this command."""
        if self.failure is not None:
            return
        self.clear()
        with log.open("wb") as out:
            started = time.perf_counter()
            try:
                process = subprocess.Popen(
                    self.command, cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT
                )
            except FileNotFoundError as error:
                self.failure = f"{error.filename} is missing; run scripts/setup --peers"
                return
            _, status, usage = os.wait4(process.pid, 0)
            self.wall.append(time.perf_counter() - started)
            process.returncode = os.waitstatus_to_exitcode(status)
        self.cpu.append(usage.ru_utime + usage.ru_stime)
        self.peak = max(self.peak, usage.ru_maxrss * 1024)
        if process.returncode != 0:
            last = log.read_text(errors="replace").strip().splitlines()[-1:]
            self.failure = f"exit code {process.returncode}: {' '.join(last)}"

    def clear(self) -> None:
        """Remove what an earlier run wrote: to replace a file makes some file systems flush the new one first."""
        for old in self.output.parent.glob(f"{self.output.stem}.*"):
            if old.is_file():
                old.unlink()


def together(entries: Iterable[Runs], rounds: int, folder: Path, tell: Callable[[str], None]) -> None:
    """Run all commands in turn, `rounds` times, so that a slow spell of the machine falls on all of them."""
    entries = list(entries)
    for number in range(rounds):
        for entry in entries:
            tell(f"round {number + 1} of {rounds}: {entry.name}")
            entry.once(folder / "last.log", folder)
