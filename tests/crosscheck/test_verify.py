"""verify.py itself: a right report passes, and a wrong number in any claim is caught."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

import made
from checks import tools
from checks.compare import compare
from checks.finding import Measured

if TYPE_CHECKING:
    from kiln import Kiln

VERIFY = Path(__file__).resolve().parents[2] / "scripts" / "verify.py"
# Claims that nothing measures: names, and what a claim only sets the scale of.
UNMEASURED = {"kiln", "asset", "kind", "tolerance"}


@pytest.fixture(scope="module")
def right(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], list[Measured], Path]:
    path = made.write(tmp_path_factory.mktemp("made"))
    report = json.loads(path.with_name("made.report.json").read_text(encoding="utf-8"))
    return report, tools.measure([path])[path], path


def errors(report: dict[str, Any], measured: list[Measured]) -> list[str]:
    return [f"{f.tool} {f.place} {f.message}" for f in compare("made", report, measured) if not f.holds]


def wrong(value: Any) -> Any:
    """A value near the right one, but wrong."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return value * 1.001 if abs(value) > 0.1 else value + 0.01
    return value + "0"


def test_right_report_passes(right: tuple[dict[str, Any], list[Measured], Path]) -> None:
    report, measured, _ = right
    assert errors(report, measured) == []


def test_every_tool_confirms_something(right: tuple[dict[str, Any], list[Measured], Path]) -> None:
    report, measured, _ = right
    assert {f.tool for f in compare("made", report, measured)} >= set(tools.TOOLS)


def test_each_wrong_claim_is_caught(right: tuple[dict[str, Any], list[Measured], Path]) -> None:
    report, measured, _ = right
    missed = []
    for path in made.paths(report):
        if path[-1] in UNMEASURED or path[-2:] in (("deviation", "measured"), ("file", "name")):
            continue
        if path[0] == "nodes" and path[2] in ("parent", "mesh"):
            continue
        if path[-2:] == ("deviation", "bound"):
            wrong_report = made.changed(report, path, lambda bound: bound * 3)
        else:
            wrong_report = made.changed(report, path, wrong)
        if not errors(wrong_report, measured):
            missed.append(path)
    assert missed == []


def test_each_missing_claim_is_caught(right: tuple[dict[str, Any], list[Measured], Path]) -> None:
    report, measured, _ = right
    for name in report["shapes"]["ring"]:
        shorter = json.loads(json.dumps(report))
        del shorter["shapes"]["ring"][name]
        assert any(name in line for line in errors(shorter, measured)), name


def test_measured_deviation_beyond_the_bound_is_caught(
    right: tuple[dict[str, Any], list[Measured], Path],
) -> None:
    report, measured, _ = right
    path = ("shapes", "ring", "deviation", "measured")
    assert errors(made.changed(report, path, lambda _: 0.006), measured) != []


def test_a_missing_shape_is_caught(right: tuple[dict[str, Any], list[Measured], Path]) -> None:
    report, measured, _ = right
    shapes = {"crate": report["shapes"]["crate"]}
    assert errors({**report, "shapes": shapes}, measured) != []


def test_a_tool_that_fails_is_a_failure(right: tuple[dict[str, Any], list[Measured], Path]) -> None:
    report, measured, _ = right
    broken = [*measured[:-1], Measured("validator", "", "made.glb", error="exit code 139")]
    assert errors(report, broken) == ["validator  exit code 139"]


def test_a_missing_tool_is_a_failure(
    right: tuple[dict[str, Any], list[Measured], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tools, "PYTHON", Path("no-such-python"))
    (found,) = tools.measure_with("trimesh", [right[2]])
    assert found.error == "cannot start: no-such-python is missing; run scripts/setup"


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    line = [sys.executable, str(VERIFY), *arguments]
    return subprocess.run(line, capture_output=True, text=True, check=False)


def test_command_line_passes_a_right_report_and_writes_its_pages(tmp_path: Path) -> None:
    made.write(tmp_path)
    done = run(str(tmp_path))
    assert done.returncode == 0, done.stdout + done.stderr
    written = json.loads((tmp_path / "verify.json").read_text(encoding="utf-8"))
    assert set(written["tools"]) == set(tools.TOOLS)
    assert all(finding["holds"] for finding in written["findings"])
    assert "made" in (tmp_path / "verify.html").read_text(encoding="utf-8")


def test_command_line_names_the_wrong_claim(tmp_path: Path) -> None:
    path = made.write(tmp_path).with_name("made.report.json")
    report = json.loads(path.read_text(encoding="utf-8"))
    right = report["shapes"]["crate"]["volume"]
    path.write_text(json.dumps(made.changed(report, ("shapes", "crate", "volume"), lambda _: 1.25)))
    done = run(str(tmp_path))
    assert done.returncode == 1
    assert f"shapes.crate.volume: trimesh finds {right:.7g}, the report says 1.25" in done.stdout


def test_a_missing_report_is_a_failure(tmp_path: Path) -> None:
    made.write(tmp_path).with_name("made.report.json").unlink()
    done = run(str(tmp_path))
    assert done.returncode == 1
    assert "made.report.json does not stand beside made.glb" in done.stdout


def test_a_truncated_file_is_a_failure(tmp_path: Path) -> None:
    path = made.write(tmp_path)
    path.write_bytes(path.read_bytes()[:-100])
    done = run(str(tmp_path))
    assert done.returncode == 1
    assert "error: made" in done.stdout


def test_no_file_is_a_usage_error(tmp_path: Path) -> None:
    assert run(str(tmp_path)).returncode == 2
    assert run().returncode == 2
    assert run(str(tmp_path / "none")).returncode == 2


def test_the_page_has_the_pictures_of_both_drawers(kiln: Kiln) -> None:
    # A lopsided model: a wrong view would show another outline.
    spec = (
        "[shape.arm.box]\nsize = [3, 0.4, 0.6]\n"
        "[shape.post]\nat = [-1.2, 1, 0.4]\n[shape.post.cylinder]\nradius = 0.2\nheight = 2\n"
    )
    kiln.bake(spec)
    folder = kiln.folder / "out"
    line = [sys.executable, str(VERIFY), "--pictures", "--kiln", str(kiln.program), str(folder)]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    text = (folder / "verify.html").read_text(encoding="utf-8")
    shown = re.findall(r'<img src="([^"]+)"', text)
    assert shown == ["pictures/model.kiln.png", "pictures/model.png"]
    own, blender = (Image.open(folder / name).convert("RGB") for name in shown)
    assert own.size == blender.size == (640, 480)
    # Both look from the same side: the post stands on the same side of the middle, higher than wide.
    background = np.asarray(own)[0, 0].astype(int)
    rows, columns = np.nonzero(np.abs(np.asarray(own).astype(int) - background).sum(axis=2) > 40)
    upper = columns[rows < rows.min() + (rows.max() - rows.min()) // 4]
    assert upper.mean() < columns.mean() - 50
