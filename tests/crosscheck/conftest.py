"""Fixtures of the cross-checks: the built program, a folder to bake in, the real-data cases.

`KILN_BIN` names the program (default: the release build, then the debug build). `KILN_CASES` names the folder
of real files that are not ours to keep in the tree; tests that need it are counted as not run without it.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
sys.path.insert(0, str(Path(__file__).parent))

if TYPE_CHECKING:
    from collections.abc import Callable

from kiln import Kiln  # noqa: E402 -- after the path is set


def pytest_configure(config: pytest.Config) -> None:
    """Name the marker of tests on real files."""
    config.addinivalue_line("markers", "cases: needs the real files in KILN_CASES")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skip the tests on real files where there are none."""
    if cases_folder() is None:
        for item in items:
            if "cases" in item.keywords:
                item.add_marker(pytest.mark.skip(reason="KILN_CASES is not set"))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many real files went untested."""
    skipped = terminalreporter.stats.get("skipped", [])
    unread = sum("KILN_CASES" in str(report.longrepr) for report in skipped)
    if unread:
        terminalreporter.write_line(f"{unread} tests on real files were not run: KILN_CASES is not set")


def cases_folder() -> Path | None:
    """The folder of real files, if there is one."""
    folder = os.environ.get("KILN_CASES")
    return Path(folder).resolve() if folder and Path(folder).is_dir() else None


@pytest.fixture(scope="session")
def cases() -> Path:
    """The folder of real files."""
    folder = cases_folder()
    assert folder is not None
    return folder


@pytest.fixture(scope="session")
def program() -> Path:
    """The built program; a missing one is a failure, never a skip."""
    named = os.environ.get("KILN_BIN")
    candidates = [Path(named)] if named else [ROOT / "target" / kind / "kiln" for kind in ("release", "debug")]
    found = next((path for path in candidates if path.is_file()), None)
    if found is None:
        pytest.fail(f"kiln is not built: looked for {', '.join(map(str, candidates))}")
    return found.resolve()


@pytest.fixture(scope="session")
def tried() -> Callable[[str, int], None]:
    """Keep how many of something a test tried, for the table of `scripts/trust.py`."""
    named = os.environ.get("KILN_COUNTS")

    def keep(what: str, count: int) -> None:
        if named:
            Path(named).mkdir(parents=True, exist_ok=True)
            (Path(named) / what).write_text(f"{count}\n", encoding="utf-8")

    return keep


@pytest.fixture
def kiln(program: Path, tmp_path: Path) -> Kiln:
    """The program with a fresh project folder."""
    return Kiln(program, tmp_path)
