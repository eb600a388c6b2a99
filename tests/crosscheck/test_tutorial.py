"""The tutorial says what its documents say, in steps that bake."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kiln import Kiln

ROOT = Path(__file__).resolve().parents[2]
STEPS = ROOT / "specs" / "tutorial"
TEXT = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")


def sections() -> dict[str, str]:
    """The text of each step, by its document."""
    parts = re.split(r"^## ", TEXT, flags=re.MULTILINE)[1:]
    found = {}
    for part in parts:
        (document,) = set(re.findall(r"^\[(\d-[a-z]+\.toml)\]", part, flags=re.MULTILINE))
        found[document] = part
    return found


def test_every_document_is_a_step_and_every_step_a_document() -> None:
    assert list(sections()) == sorted(path.name for path in STEPS.glob("?-*.toml"))


@pytest.mark.parametrize("document", sorted(path.name for path in STEPS.glob("?-*.toml")))
def test_what_a_step_shows_stands_in_its_document(document: str) -> None:
    whole = (STEPS / document).read_text(encoding="utf-8")
    blocks = re.findall(r"```toml\n(.*?)```", sections()[document], flags=re.DOTALL)
    assert blocks
    for block in blocks:
        assert block in whole


def test_the_steps_bake_and_say_what_is_shown(kiln: Kiln) -> None:
    for path in STEPS.glob("*.toml"):
        shutil.copy(path, kiln.folder)
    shown = re.findall(r"^\$ kiln (bake .*)\n(.*)$", TEXT, flags=re.MULTILINE)
    assert shown
    for command, line in shown:
        done = kiln.run(*command.split())
        assert done.returncode == 0, done.stderr
        assert done.stdout.splitlines()[0] == line
    for path in sorted(kiln.folder.glob("?-*.toml")):
        assert kiln.run("bake", path.name, "--out", "out").returncode == 0
