"""`kiln diff` against closed forms: facts, distances with their accuracy, pictures, pages and git revisions."""

from __future__ import annotations

import base64
import io
import json
import re
import subprocess
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

if TYPE_CHECKING:
    from kiln import Kiln

BOX = "[shape.s.box]\nsize = [1, 1, 1]\n"
BALL = "tolerance = 1e-3\n[shape.s.sphere]\nradius = "
PAIR = "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.box]\nsize = [1, {height}, 1]\ncenter = [2, 0, 0]\n"


def compared(kiln: Kiln, one: str, other: str, *options: str) -> tuple[int, dict[str, Any]]:
    """Exit code and what is told."""
    done = kiln.run("diff", one, other, "--format", "json", *options)
    assert done.stdout, done.stderr
    return done.returncode, json.loads(done.stdout)


def test_the_same_bytes_are_the_same(kiln: Kiln) -> None:
    kiln.write(BOX, "a")
    kiln.write(f"# with a comment\n{BOX}", "b")
    code, found = compared(kiln, "a.toml", "b.toml")
    assert code == 0
    assert found["same"]
    assert found["changes"] == []
    assert found["distance"] == {"at-least": 0, "at-most": 0}
    assert "the same bytes" in kiln.run("diff", "a.toml", "b.toml").stdout
    kiln.bake(BOX, name="b")
    assert compared(kiln, "a.toml", "out/b.glb")[0] == 0


@pytest.mark.parametrize(
    ("one", "other", "exact", "size"),
    [
        (BOX, BOX.replace("[1, 1, 1]", "[1.5, 1, 1]"), 0.25, 2.1),
        # The corner of the larger box is as far from the smaller one's as its faces are in all three.
        (BOX, BOX.replace("[1, 1, 1]", "[3, 3, 3]"), np.sqrt(3), 5.2),
        (f"{BALL}1\n", f"{BALL}1.25\n", 0.25, 4.4),
    ],
)
def test_the_distance_is_that_of_closed_forms(kiln: Kiln, one: str, other: str, exact: float, size: float) -> None:
    kiln.write(one, "a")
    kiln.write(other, "b")
    code, found = compared(kiln, "a.toml", "b.toml")
    assert code == 1
    least, most = found["distance"]["at-least"], found["distance"]["at-most"]
    # Balls are made of triangles within 1e-3.
    assert least - 2e-3 <= exact <= most + 2e-3
    assert most - least <= 1.001e-3 * size
    assert compared(kiln, "b.toml", "a.toml")[1]["distance"] == found["distance"]


def test_facts_that_changed_are_told(kiln: Kiln) -> None:
    kiln.write(BOX, "a")
    kiln.bake(BOX.replace("[1, 1, 1]", "[2, 1, 1]"), name="b")
    code, found = compared(kiln, "a.toml", "out/b.glb")
    changes = {change["fact"]: (change["before"], change["after"]) for change in found["changes"]}
    assert code == 1
    assert changes["meshes.s.volume"] == (1, 2)
    assert "blake3" in changes
    assert "meshes.s.triangles" not in changes
    assert "meshes.s.volume: 1.0 -> 2.0" in kiln.run("diff", "a.toml", "out/b.glb").stdout


def test_what_changed_is_colored_and_the_rest_is_gray(kiln: Kiln) -> None:
    kiln.write(PAIR.format(height=1), "a")
    kiln.write(PAIR.format(height=2), "b")
    code, _ = compared(kiln, "a.toml", "b.toml", "-o", "diff.png", "--size", "200", "--view", "top")
    assert code == 1
    picture = np.asarray(Image.open(kiln.folder / "diff.png"))[:, :, :3].astype(int)
    for left in (0, 208):
        half = picture[:200, left : left + 200]
        colorful = half.max(axis=2) - half.min(axis=2) > 20
        ground = (half == [0xE6, 0xE8, 0xEC]).all(axis=2)
        columns = np.flatnonzero(~ground.all(axis=0))
        first, second = np.split(columns, np.flatnonzero(np.diff(columns) > 1) + 1)
        assert not colorful[:, first].any()
        assert colorful[:, second].any()


def test_a_page_holds_all(kiln: Kiln) -> None:
    kiln.write(BOX, "a&b")
    kiln.write(BOX.replace("[1, 1, 1]", "[2, 1, 1]"), "c")
    assert kiln.run("diff", "a&b.toml", "c.toml", "-o", "diff.html", "--size", "100").returncode == 1
    page = (kiln.folder / "diff.html").read_text(encoding="utf-8")
    assert "a&amp;b.toml &rarr; c.toml" in page
    assert "<td>meshes.s.volume<td>1.0<td>2.0" in page
    data = re.search(r"data:image/png;base64,([^\"]*)", page)
    assert data
    assert Image.open(io.BytesIO(base64.b64decode(data[1], validate=True))).size[1] == 100


def test_revisions_are_read_with_all_that_they_include(kiln: Kiln) -> None:
    def git(*words: str) -> None:
        names = ["-c", "user.name=a", "-c", "user.email=a@b", "-c", "init.defaultBranch=main"]
        subprocess.run(["git", *names, *words], cwd=kiln.folder, check=True, capture_output=True)

    (kiln.folder / "sub").mkdir()
    kiln.write("[parameters]\nsize = 1\n", "size")
    kiln.write('include = ["../size.toml"]\n[shape.s.box]\nsize = ["= size", 1, 1]\n', "sub/model")
    git("init")
    git("add", ".")
    git("commit", "-m", "first")
    kiln.write("[parameters]\nsize = 2\n", "size")
    code, found = compared(kiln, "HEAD:sub/model.toml", "sub/model.toml")
    assert code == 1
    assert found["distance"]["at-least"] == pytest.approx(0.5, abs=2e-3)
    assert compared(kiln, "HEAD:sub/model.toml", "HEAD:sub/model.toml")[0] == 0
    for wrong in ("HEAD:none.toml", "nowhere:sub/model.toml", "--help:sub/model.toml", "HEAD:../x.toml", "HEAD:"):
        done = kiln.run("diff", "--", wrong, "sub/model.toml")
        assert done.returncode == 3, done.stdout + done.stderr
        assert "cannot be compared" in done.stderr


def test_what_cannot_be_compared_is_said(kiln: Kiln) -> None:
    kiln.write(BOX, "a")
    kiln.write(BOX.replace("size", "sise"), "broken")
    (kiln.folder / "bad.glb").write_bytes(b"glTF")
    for other in ("broken.toml", "none.toml", "none.glb", "bad.glb"):
        done = kiln.run("diff", "a.toml", other)
        assert done.returncode == 3
        assert "panicked" not in done.stderr
    assert kiln.run("diff", "a.toml", "a.toml", "-o", "x.txt").returncode == 2
