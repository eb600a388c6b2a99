"""The JSON Schema, by validators of other makers: every gallery spec holds, and a wrong one does not."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from jsonschema import Draft202012Validator

from conftest import ROOT

if TYPE_CHECKING:
    from kiln import Kiln

SPECS = sorted(path for path in (ROOT / "specs").rglob("*.toml"))
WRONG = [
    "[shape.s.box]\nsizes = [1, 1, 1]\n",
    "[shape.s.box]\nsize = 'big'\n",
    "[shape.s.sphere]\nradius = [1]\n",
    "[shape.s.revolve]\nprofile = 3\n",
    "[shapes.s.box]\nsize = [1, 1, 1]\n",
    "unit = 'mile'\n",
    "[material.m]\nmetallic = 'very'\n",
    "[curve.c.natural-spline]\npoints = 'many'\n",
]
TOMBI = Path(sys.executable).with_name("tombi")


@pytest.fixture
def validator(kiln: Kiln) -> Draft202012Validator:
    schema = json.loads(kiln.run("schema").stdout)
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def problems(validator: Draft202012Validator, document: dict[str, Any]) -> list[str]:
    return [f"{error.json_path}: {error.message[:200]}" for error in validator.iter_errors(document)]


def test_there_is_a_gallery() -> None:
    assert len(SPECS) >= 6


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
def test_gallery_spec_holds(validator: Draft202012Validator, path: Path) -> None:
    assert problems(validator, tomllib.loads(path.read_text(encoding="utf-8"))) == []


@pytest.mark.parametrize("spec", WRONG)
def test_wrong_spec_does_not_hold(validator: Draft202012Validator, kiln: Kiln, spec: str) -> None:
    assert problems(validator, tomllib.loads(spec)) != []
    kiln.write(spec)
    assert kiln.run("check", "model.toml").returncode == 1


def test_tombi_accepts_the_gallery_and_refuses_a_wrong_spec(kiln: Kiln) -> None:
    """The editors' checker, offline, with the schema named in its own configuration."""
    (kiln.folder / "schema.json").write_text(kiln.run("schema").stdout, encoding="utf-8")
    configuration = '[[schemas]]\npath = "schema.json"\ninclude = ["specs/*.toml"]\n'
    (kiln.folder / "tombi.toml").write_text(configuration, encoding="utf-8")
    folder = kiln.folder / "specs"
    folder.mkdir()
    (folder / "right.toml").write_text("[shape.s.box]\nsize = [1, 1, 1]\n", encoding="utf-8")
    for path in SPECS:
        shutil.copy(path, folder / path.name)
    good = tombi(kiln.folder, *[f"specs/{path.name}" for path in sorted(folder.iterdir())])
    assert good.returncode == 0, good.stdout + good.stderr
    for number, spec in enumerate(WRONG):
        (folder / f"wrong-{number}.toml").write_text(spec, encoding="utf-8")
        wrong = tombi(kiln.folder, f"specs/wrong-{number}.toml")
        assert wrong.returncode != 0, spec


def tombi(folder: Path, *files: str) -> subprocess.CompletedProcess[str]:
    """Run tombi's linter on files below a folder that holds its configuration."""
    line = [str(TOMBI), "lint", "--offline", *files]
    return subprocess.run(line, cwd=folder, capture_output=True, text=True, timeout=60, check=False)
