"""Every recipe of the cookbook is a document that bakes as it stands there, formatted and without a warning."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kiln import Kiln

TEXT = (Path(__file__).resolve().parents[2] / "docs" / "cookbook.md").read_text(encoding="utf-8")
RECIPES = re.findall(r"^## (.*?)$.*?```toml\n(.*?)```", TEXT, flags=re.MULTILINE | re.DOTALL)


def test_every_section_is_a_recipe() -> None:
    assert [title for title, _ in RECIPES] == re.findall(r"^## (.*)$", TEXT, flags=re.MULTILINE)
    assert len(RECIPES) >= 10


@pytest.mark.parametrize(("title", "text"), RECIPES, ids=[title.replace(" ", "-") for title, _ in RECIPES])
def test_a_recipe_bakes(kiln: Kiln, title: str, text: str) -> None:
    kiln.write(text)
    formatted = kiln.run("fmt", "--check", "model.toml")
    assert formatted.returncode == 0, f"{title}: {formatted.stdout}{formatted.stderr}"
    done = kiln.run("bake", "model.toml", "--out", "out")
    assert (done.returncode, done.stderr) == (0, ""), f"{title}: {done.stderr}"
