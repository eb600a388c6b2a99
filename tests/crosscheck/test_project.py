"""`kiln.toml`: what a project says, what the command line says instead, and what is wrong with either."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from checks.document import Document

if TYPE_CHECKING:
    from pathlib import Path

    from kiln import Kiln

BOX = '[parameters]\nsize = 1\n[shape.s.box]\nsize = ["= size", 1, 1]\n'
PLAIN = "[shape.s.box]\nsize = [1, 1, 1]\n"
PROJECT = """roots = ["specs", "more/lamp.toml"]
out = "built"
profiles = ["core", "web"]

[parameters]
size = 3

[cache]
folder = "kept"
limit = "50 MB"
"""


def prepare(kiln: Kiln, project: str = PROJECT) -> None:
    for path, text in (("specs/chess/pawn", BOX), ("specs/vase", PLAIN), ("more/lamp", PLAIN), ("more/no", "x = [")):
        (kiln.folder / path).parent.mkdir(parents=True, exist_ok=True)
        kiln.write(text, path)
    kiln.write(project, "kiln")


def names(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*.glb"))


def width(path: Path) -> float:
    (mesh,) = Document(path).meshes
    return float(mesh.merged[0][:, 0].max() - mesh.merged[0][:, 0].min())


def test_a_project_is_baked_without_arguments_from_anywhere_in_it(kiln: Kiln) -> None:
    prepare(kiln)
    expected = [f"{name}{end}.glb" for name in ("chess/pawn", "lamp", "vase") for end in ("", ".web")]
    for folder in (kiln.folder, kiln.folder / "specs" / "chess"):
        inside = type(kiln)(kiln.program, folder)
        done = inside.run("bake", "--verbose", "--format", "json")
        assert done.returncode == 0, done.stdout + done.stderr
        assert names(kiln.folder / "built") == sorted(expected)
        assert width(kiln.folder / "built" / "chess" / "pawn.glb") == 3
        assert not (folder / "out").exists()
    hits = [json.loads(line)["cache"]["hits"] for line in done.stdout.splitlines() if '"cache"' in line]
    assert hits == [3]
    assert kiln.run("cache", "stats").stdout.startswith("kept holds 3 documents")
    assert kiln.run("check").returncode == 0
    # From elsewhere the file is named.
    outside = type(kiln)(kiln.program, kiln.folder.parent)
    assert outside.run("bake", f"{kiln.folder.name}/kiln.toml", "--check").returncode == 0


def test_what_the_command_line_says_wins(kiln: Kiln) -> None:
    prepare(kiln)
    done = kiln.run("bake", "specs/chess/pawn.toml", "--set", "size=2", "--profile", "core", "--no-cache")
    assert done.returncode == 0, done.stdout + done.stderr
    # A single document has the place of the project.
    assert names(kiln.folder / "built") == ["chess/pawn.glb"]
    assert width(kiln.folder / "built" / "chess" / "pawn.glb") == 2
    assert not (kiln.folder / "kept").exists()
    done = kiln.run("bake", "specs/chess/pawn.toml", "--out", "flat", "--profile", "core", "--cache", "own")
    assert done.returncode == 0, done.stdout + done.stderr
    assert names(kiln.folder / "flat") == ["pawn.glb"]
    assert (kiln.folder / "own" / "CACHEDIR.TAG").is_file()


def test_plans_and_dependencies_name_the_project_file(kiln: Kiln) -> None:
    prepare(kiln)
    steps = json.loads(kiln.run("plan").stdout)["steps"]
    assert [step["spec"] for step in steps] == ["specs/chess/pawn.toml", "specs/vase.toml", "more/lamp.toml"]
    assert steps[0]["inputs"] == ["specs/chess/pawn.toml", "kiln.toml"]
    assert steps[0]["outputs"][0] == "built/chess/pawn.glb"
    for step in steps:
        assert kiln.run(*step["command"][1:]).returncode == 0
        assert all((kiln.folder / output).is_file() for output in step["outputs"])
    done = kiln.run("bake", "--depfile", "deps")
    assert done.returncode == 0
    assert "more/lamp.toml kiln.toml" in (kiln.folder / "deps").read_text()


def test_without_a_project_a_bake_needs_documents(kiln: Kiln) -> None:
    done = kiln.run("bake")
    assert done.returncode == 2
    assert "no kiln.toml here or above" in done.stderr
    assert "roots" in done.stderr


@pytest.mark.parametrize(
    ("text", "code", "place", "words"),
    [
        ('rots = ["specs"]\n', "K0101", (1, 1), "did you mean `roots`?"),
        ("roots = 3\n", "K0201", (1, 9), "`roots` must be an array"),
        ("roots = []\n", "K0202", (1, 9), "at least 1 item"),
        ('roots = ["specs"]\nprofiles = ["webb"]\n', "K0205", (2, 13), 'did you mean "web"?'),
        ('roots = ["specs"]\n[cache]\nlimit = "9 apples"\n', "K", (3, 9), "no size of memory"),
        ('roots = ["spec"]\n', "K0001", (1, 10), '"spec" does not exist'),
        ('roots = ["../other"]\n', "K0003", (1, 10), "leads out of the project"),
        ('roots = ["/etc"]\n', "K0003", (1, 10), "absolute"),
        ('roots = ["empty"]\n', "K1030", (1, 10), 'no document (.toml) in "empty"'),
        ('roots = ["specs", "specs/chess"]\n', "K1031", (1, 19), "lies in another root"),
        ('roots = ["specs/chess", "specs"]\n', "K1031", (1, 25), "holds another root"),
        ('roots = ["specs", "specs/."]\n', "K1031", (1, 19), "is named twice"),
        ('roots = ["specs", "twin"]\n', "K1032", (1, 19), "would both be written to Vase.glb"),
        ('roots = ["outside"]\n', "K0003", (1, 10), "leads out of the project"),
        ('roots = ["specs"]\n[parameters]\nsize = { a = 1 }\n', "K0201", (3, 8), "must be a number, true or false"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(
    kiln: Kiln, tmp_path_factory: pytest.TempPathFactory, text: str, code: str, place: tuple[int, int], words: str
) -> None:
    prepare(kiln, text)
    (kiln.folder / "empty").mkdir()
    (kiln.folder / "twin").mkdir()
    kiln.write(PLAIN, "twin/Vase")
    (kiln.folder / "outside").symlink_to(tmp_path_factory.mktemp("outside"))
    done = kiln.run("bake", "--format", "json")
    assert done.returncode == 1, done.stdout + done.stderr
    (found,) = [json.loads(line)["diagnostic"] for line in done.stdout.splitlines()]
    assert found["code"].startswith(code), found
    label = found["labels"][0]
    assert (label["file"], label["line"], label["column"]) == ("kiln.toml", *place)
    assert words in json.dumps(found).replace("\\", "").replace('"', '"'), found
    assert not (kiln.folder / "out").exists()
    assert kiln.run("fmt", "--check", "kiln.toml").returncode in (0, 1)


def test_parameters_go_to_documents_that_have_them(kiln: Kiln) -> None:
    prepare(kiln, 'roots = ["specs"]\n[parameters]\nsize = "wide"\n')
    done = kiln.run("bake")
    assert done.returncode == 1
    assert "kiln.toml:3 sets `size`" in done.stderr
    # The document without it is baked all the same.
    assert names(kiln.folder / "out") == ["vase.glb"]
    kiln.write('roots = ["specs"]\n[parameters]\nsise = 2\n[cache]\nfolder = ".kiln"\n', "kiln")
    for _ in range(2):
        done = kiln.run("bake")
        assert done.returncode == 0, done.stderr
        assert "K1033" in done.stderr
        assert "did you mean `size`?" in done.stderr


def test_files_of_variants_and_of_documents_do_not_meet(kiln: Kiln) -> None:
    prepare(kiln, 'roots = ["specs"]\n')
    kiln.write(PLAIN + "[variant.tall.shape.s]\nscale = [1, 2, 1]\n", "specs/vase")
    kiln.write(PLAIN, "specs/vase.tall")
    done = kiln.run("bake")
    assert done.returncode == 1
    assert "specs/vase.toml would be written to out/vase.tall.glb, which belongs to vase.tall.toml" in done.stderr
    assert names(kiln.folder / "out") == ["chess/pawn.glb", "vase.glb", "vase.tall.glb"]
    assert width(kiln.folder / "out" / "vase.tall.glb") == 1


def test_a_link_out_of_the_root_is_told_and_stops_no_other(
    kiln: Kiln, tmp_path_factory: pytest.TempPathFactory
) -> None:
    prepare(kiln, 'roots = ["specs"]\n')
    secret = tmp_path_factory.mktemp("secret") / "secret.toml"
    secret.write_text(PLAIN)
    (kiln.folder / "specs" / "link.toml").symlink_to(secret)
    (kiln.folder / "specs" / "inner.toml").symlink_to(kiln.folder / "specs" / "vase.toml")
    (kiln.folder / "specs" / "loop").symlink_to(kiln.folder / "specs")
    done = kiln.run("bake")
    assert done.returncode == 1
    assert "K0003" in done.stderr
    assert '"specs/link.toml" leads out of the project' in done.stderr
    assert names(kiln.folder / "out") == ["chess/pawn.glb", "inner.glb", "vase.glb"]


def test_commands_on_one_document_hear_the_project(kiln: Kiln) -> None:
    prepare(kiln)
    # `sample` and `render` give what `bake` would: the parameter is the project's, and the command line wins.
    curve = '[parameters]\nsize = 1\n[curve.c.circle]\nradius = "= size"\n[shape.s.wire]\ncurves = ["c"]\n'
    kiln.write(curve, "specs/ring")
    for more, radius in (((), 3), (("--set", "size=5"), 5)):
        done = kiln.run("sample", "specs/ring.toml", "--curve", "c", "--at", "0", *more)
        assert done.returncode == 0, done.stderr
        (point,) = json.loads(done.stdout)["samples"]
        assert abs(point["point"][0]) == radius
    pictures = {}
    for name, more in (("plain", ()), ("three", ("--set", "size=3")), ("one", ("--set", "size=1"))):
        done = kiln.run("render", "specs/chess/pawn.toml", "--out", f"{name}.png", "--size", "64", *more)
        assert done.returncode == 0, done.stderr
        pictures[name] = (kiln.folder / f"{name}.png").read_bytes()
    assert pictures["plain"] == pictures["three"] != pictures["one"]
    # A document may read all of the project.
    (kiln.folder / "specs" / "chess" / "low.toml").write_text('include = ["../../more/base.toml"]\n' + PLAIN)
    kiln.write("[material.m]\n", "more/base")
    inside = type(kiln)(kiln.program, kiln.folder / "specs" / "chess")
    assert inside.run("render", "low.toml", "--out", "low.png", "--size", "64").returncode == 0
    # A broken project file is told, and a .glb file needs none.
    kiln.write("roots = 3\n", "kiln")
    done = kiln.run("render", "specs/vase.toml", "--out", "vase.png")
    assert done.returncode == 1
    assert "kiln.toml:1" in done.stderr


def test_a_project_raises_and_lowers_limits(kiln: Kiln) -> None:
    sphere = "[limits]\ntriangles = LIMIT\n[shape.s]\nsegments = [64, 32]\n[shape.s.sphere]\nradius = 1\n"
    prepare(kiln, 'roots = ["specs"]\n')
    kiln.write(sphere.replace("LIMIT", "60_000_000"), "specs/vase")
    done = kiln.run("bake")
    assert done.returncode == 1
    assert "a document can only lower `triangles`: 60000000 is above 50000000" in done.stderr
    project = 'roots = ["specs"]\n[cache]\nfolder = "kept"\n[limits]\n'
    kiln.write(project + "triangles = 80_000_000\n", "kiln")
    for words in (("bake",), ("check",), ("render", "specs/vase.toml", "--out", "x.png", "--size", "32")):
        done = kiln.run(*words)
        assert done.returncode == 0, done.stderr
    # What was baked before is not found under other limits.
    kiln.write(project + "triangles = 1000\n", "kiln")
    done = kiln.run("bake", "specs/vase.toml")
    assert "60000000 is above 1000" in done.stderr
    kiln.write(sphere.replace("LIMIT", "900"), "specs/vase")
    done = kiln.run("bake", "specs/vase.toml")
    assert done.returncode == 1
    assert "900" in done.stderr
    for wrong in ('triangles = "many"', "vertices = 0", "recursion = 100", 'memory = "8 pounds"'):
        kiln.write(project + wrong + "\n", "kiln")
        done = kiln.run("bake")
        assert done.returncode == 1
        assert "kiln.toml:5" in done.stderr, done.stderr
