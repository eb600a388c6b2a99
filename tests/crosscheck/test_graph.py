"""The graph of a document's definitions: what it says must be what the text says, read by other code."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from kiln import Kiln

ROOT = Path(__file__).resolve().parents[2]
SPEC = """[curve.outline.polyline]
points = [[0, 0], [1, 0], [1, 2], [0, 2]]

[shape.body]
tolerance = 0.00001
[shape.body.sphere]
radius = 1

[shape.lid]
material = "red"
[shape.lid.revolve]
profile = "outline"

[shape.whole.union]
of = ["body", "lid"]

[material.red]
color = "#c03020"

[material.unused]
color = "#000000"

[node.top]
shape = "whole"
"""


def graph(kiln: Kiln, *more: str) -> dict[str, Any]:
    """The graph as data, with the definitions by their names."""
    done = kiln.run("graph", "model.toml", "--as", "json", *more)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    found["definitions"] = {one.pop("definition"): one for one in found["definitions"]}
    return found


def test_every_definition_stands_there_with_what_it_uses(kiln: Kiln) -> None:
    text = kiln.write(SPEC).read_text()
    found = graph(kiln)["definitions"]
    parsed = tomllib.loads(text)
    assert set(found) == {f"{family}.{name}" for family, entries in parsed.items() for name in entries}
    uses = {
        "shape.lid": {"curve.outline", "material.red"},
        "shape.whole": {"shape.body", "shape.lid"},
        "node.top": {"shape.whole"},
    }
    assert {name: set(one["uses"]) for name, one in found.items() if one["uses"]} == uses
    lines = text.splitlines()
    for name, one in found.items():
        assert lines[one["line"] - 1].startswith(f"[{name}"), name
    assert [name for name, one in found.items() if one["shown"]] == []


def test_shapes_say_what_they_took(kiln: Kiln) -> None:
    kiln.write(SPEC)
    cold = graph(kiln, "--cache", "kept")
    shapes = {name: one for name, one in cold["definitions"].items() if name.startswith("shape.")}
    assert all(one["milliseconds"] > 0 and one["bytes"] > 0 for one in shapes.values())
    # What a shape is made from counts in its time.
    parts = shapes["shape.body"]["milliseconds"] + shapes["shape.lid"]["milliseconds"]
    assert shapes["shape.whole"]["milliseconds"] >= parts * 0.999
    assert shapes["shape.whole"]["cache"] == "kept"
    assert all(one["cache"] is None for name, one in cold["definitions"].items() if name not in shapes)
    # Triangles of the whole are those that are written.
    assert kiln.run("bake", "model.toml", "--out", "out").returncode == 0
    baked = kiln.baked()
    assert shapes["shape.whole"]["triangles"] == baked.report["totals"]["triangles"]
    assert [(one["file"], one["bytes"]) for one in cold["assets"]] == [("model.glb", baked.path.stat().st_size)]
    # The second time it is found, and its parts are not asked for.
    warm = graph(kiln, "--cache", "kept")["definitions"]
    assert (warm["shape.whole"]["cache"], warm["shape.body"]["cache"]) == ("found", None)
    assert graph(kiln, "--no-cache")["definitions"]["shape.whole"]["cache"] == "made"


def test_other_parameters_and_the_project_are_heard(kiln: Kiln) -> None:
    kiln.write('[parameters]\ncount = 8\n[shape.s]\nsegments = ["= count", 4]\n[shape.s.sphere]\nradius = 1\n')
    base = graph(kiln)["definitions"]["shape.s"]
    assert base["shown"]
    more = graph(kiln, "--set", "count=16")["definitions"]["shape.s"]
    assert more["triangles"] == 2 * base["triangles"]
    kiln.write('roots = ["."]\nprofiles = ["web"]\n[parameters]\ncount = 16\n', "kiln")
    found = graph(kiln)
    assert found["definitions"]["shape.s"]["triangles"] == more["triangles"]
    assert [one["file"] for one in found["assets"]] == ["model.web.glb"]


def test_it_is_written_for_graphviz(kiln: Kiln) -> None:
    kiln.write(SPEC)
    done = kiln.run("graph", "model.toml")
    assert done.returncode == 0
    lines = {line.strip() for line in done.stdout.splitlines()}
    assert {'"shape.body" -> "shape.whole"', '"curve.outline" -> "shape.lid"', '"node.top" -> "model.glb"'} <= lines
    assert sum("[label" in line for line in lines) == 8  # seven definitions and a file


def test_what_is_wrong_is_told(kiln: Kiln) -> None:
    kiln.write("[shape.s.box]\nsize = [1, -1, 1]\n")
    done = kiln.run("graph", "model.toml")
    assert (done.returncode, done.stdout) == (1, "")
    assert "model.toml:2" in done.stderr
    assert kiln.run("graph", "none.toml").returncode == 3


# Some hold nothing but what others include.
SHOWN = [path for path in sorted(ROOT.glob("specs/*/*.toml")) if "[shape." in path.read_text(encoding="utf-8")]


@pytest.mark.parametrize("path", SHOWN[::12], ids=lambda path: path.stem)
def test_documents_of_the_gallery_have_one(kiln: Kiln, path: Path) -> None:
    done = kiln.run("graph", str(path), "--root", str(ROOT / "specs"), "--as", "json")
    assert done.returncode == 0, done.stderr
    definitions = json.loads(done.stdout)["definitions"]
    names = {one["definition"] for one in definitions}
    assert names >= {used for one in definitions for used in one["uses"]}
    shown = {one["definition"] for one in definitions if one["shown"] or one["definition"].startswith("node.")}
    assert shown or not names
