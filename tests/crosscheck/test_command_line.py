"""The program from outside: exit codes, refusals, and that hostile input leaves nothing behind."""

from __future__ import annotations

import base64
import gzip
import json
import os
import re
import shutil
import subprocess
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from inputs.picture import Picture

if TYPE_CHECKING:
    from kiln import Kiln

SPECS = Path(__file__).resolve().parents[2] / "specs"
BOX = "[shape.s.box]\nsize = [1, 1, 1]\n"


def written(kiln: Kiln) -> list[str]:
    """What stands in the output folder."""
    out = kiln.folder / "out"
    return sorted(str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()) if out.exists() else []


def assert_refused(kiln: Kiln, done: subprocess.CompletedProcess[str], *words: str) -> None:
    """An error of the spec or a file, said plainly, and nothing written."""
    said = done.stdout + done.stderr
    assert done.returncode in (1, 3), said
    for word in words:
        assert word in said, said
    assert "panicked" not in said
    assert "RUST_BACKTRACE" not in said
    assert written(kiln) == []


def test_exit_codes(kiln: Kiln) -> None:
    kiln.write(BOX)
    assert kiln.run("bake", "model.toml").returncode == 0
    assert kiln.run("check", "model.toml").returncode == 0
    kiln.write("[shape.s.box]\nsizes = [1, 1, 1]\n", "wrong")
    assert kiln.run("check", "wrong.toml").returncode == 1
    assert kiln.run("bake", "--no-such-flag").returncode == 2
    assert kiln.run("bake").returncode == 2
    assert kiln.run("bake", "none.toml").returncode == 3


def test_bake_writes_the_asset_and_its_report(kiln: Kiln) -> None:
    kiln.bake(BOX)
    assert written(kiln) == ["model.glb", "model.report.json"]


def test_no_report_writes_only_the_asset(kiln: Kiln) -> None:
    kiln.write(BOX)
    assert kiln.run("bake", "model.toml", "--out", "out", "--no-report").returncode == 0
    assert written(kiln) == ["model.glb"]


def test_folders_are_kept_below_the_output(kiln: Kiln) -> None:
    (kiln.folder / "specs" / "deep").mkdir(parents=True)
    kiln.write(BOX, "specs/deep/inner")
    kiln.write(BOX, "specs/outer")
    assert kiln.run("bake", "specs", "--out", "out", "--no-report").returncode == 0
    assert written(kiln) == ["deep/inner.glb", "outer.glb"]


def test_variants_bake_one_more_asset_each(kiln: Kiln) -> None:
    spec = "[parameters]\nh = 1.0\n[shape.s.box]\nsize = [1, '= h', 1]\n[variant.tall.parameters]\nh = 3.0\n"
    kiln.bake(spec)
    assert "model.tall.glb" in written(kiln)
    assert kiln.baked("model.tall").shape("s")["volume"] == pytest.approx(3)


def test_check_fails_where_a_file_is_not_what_is_baked(kiln: Kiln) -> None:
    kiln.write(BOX)
    absent = kiln.run("bake", "model.toml", "--out", "out", "--check")
    assert absent.returncode == 1
    assert "out/model.glb is not what is baked" in absent.stderr
    assert not (kiln.folder / "out").exists()
    kiln.bake(BOX)
    assert kiln.run("bake", "model.toml", "--out", "out", "--check").returncode == 0
    file = kiln.folder / "out" / "model.glb"
    file.write_bytes(file.read_bytes()[:-1] + b"x")
    old = file.read_bytes()
    done = kiln.run("bake", "model.toml", "--out", "out", "--check")
    assert (done.returncode, file.read_bytes()) == (1, old)
    assert "report.json" not in done.stderr


def test_depfile_is_read_by_make(kiln: Kiln) -> None:
    """Make bakes once, not again, and again after an included file with a space in its name has changed."""
    (kiln.folder / "common parts").mkdir()
    (kiln.folder / "common parts" / "clay.toml").write_text("[material.clay]\n")
    kiln.write('include = ["common parts/clay.toml"]\n[shape.s]\nmaterial = "clay"\n[shape.s.box]\nsize = [1, 1, 1]\n')
    bake = f"{kiln.program} bake model.toml --depfile out/model.d --quiet"
    rule = f"out/model.glb: model.toml\n\t{bake}\n-include out/model.d\n"
    (kiln.folder / "Makefile").write_text(rule)

    def made() -> bool:
        done = subprocess.run(["make", "out/model.glb"], cwd=kiln.folder, capture_output=True, text=True, check=True)
        return "up to date" not in done.stdout

    assert [made(), made()] == [True, False]
    later = time.time() + 10
    os.utime(kiln.folder / "common parts" / "clay.toml", (later, later))
    assert made()
    assert "common\\ parts/clay.toml" in (kiln.folder / "out" / "model.d").read_text()


def planned(kiln: Kiln) -> None:
    """A folder of two documents with an include, a variant and names that need escapes."""
    (kiln.folder / "specs" / "a b").mkdir(parents=True)
    kiln.write("[material.clay]\n", "specs/common $1")
    body = 'include = ["{}common $1.toml"]\n[shape.s]\nmaterial = "clay"\n[shape.s.box]\nsize = [1, 1, 1]\n'
    kiln.write(body.format("../"), "specs/a b/inner")
    kiln.write(body.format("") + "[variant.red.material.clay]\ncolor = '#ff0000'\n", "specs/outer")
    kiln.write(BOX, "specs/plain")


def test_plan_lists_what_a_bake_reads_and_writes(kiln: Kiln) -> None:
    planned(kiln)
    done = kiln.run("plan", "specs", "--profile", "core,web")
    assert done.returncode == 0, done.stderr
    assert not (kiln.folder / "out").exists()
    steps = {step["spec"]: step for step in json.loads(done.stdout)["steps"]}
    assert set(steps) == {"specs/a b/inner.toml", "specs/outer.toml", "specs/plain.toml"}
    assert sorted(steps["specs/outer.toml"]["inputs"]) == ["specs/common $1.toml", "specs/outer.toml"]
    for step in steps.values():
        command = step["command"]
        assert command[0] == "kiln"
        assert kiln.run(*command[1:]).returncode == 0
    made = sorted(f"out/{name}" for name in written(kiln))
    assert made == sorted(output for step in steps.values() for output in step["outputs"])
    kiln.write("[shape.s.box]\nsize = 3\n", "specs/wrong")
    assert kiln.run("plan", "specs").returncode == 1


def test_plan_is_built_by_make(kiln: Kiln) -> None:
    planned(kiln)
    (kiln.folder / "Makefile").write_text(kiln.run("plan", "specs", "--as", "make").stdout, encoding="utf-8")
    tools = kiln.folder / "tools"
    tools.mkdir()
    (tools / "kiln").symlink_to(kiln.program)
    path = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}"}

    def made() -> list[str]:
        done = subprocess.run(["make", "-j2"], cwd=kiln.folder, capture_output=True, text=True, check=True, env=path)
        return sorted(line for line in done.stdout.splitlines() if line.startswith("kiln "))

    assert len(made()) == 3
    assert len(written(kiln)) == 8
    assert made() == []
    later = time.time() + 10
    os.utime(kiln.folder / "specs" / "plain.toml", (later, later))
    assert [line.split()[2] for line in made()] == ["specs/plain.toml"]


def test_set_overrides_a_parameter(kiln: Kiln) -> None:
    spec = "[parameters]\nh = 1.0\n[shape.s.box]\nsize = [1, '= 2 * h', 1]\n"
    assert kiln.bake(spec, "--set", "h=0.3").shape("s")["volume"] == pytest.approx(0.6)


def test_all_errors_of_a_document_come_in_one_run(kiln: Kiln) -> None:
    kiln.write("[shape.a.box]\nsizes = [1, 1, 1]\n[shape.b.sphere]\nradius = -1\n[shape.c.revolve]\nprofile = 'p'\n")
    done = kiln.run("bake", "model.toml", "--out", "out")
    assert_refused(kiln, done, "sizes", "size", "radius", "profile", "model.toml:2:", "model.toml:4:")


def test_format_json_is_json(kiln: Kiln) -> None:
    kiln.write("[shape.a.box]\nsizes = [1, 1, 1]\n")
    done = kiln.run("check", "model.toml", "--format", "json")
    assert done.returncode == 1
    found = [json.loads(line) for line in done.stdout.splitlines() if line.strip()]
    assert "model.toml" in json.dumps(found)


def test_failed_assert_stops_the_asset(kiln: Kiln) -> None:
    kiln.write(f'{BOX}[assert]\n"shapes.s.triangles" = {{ at-most = 11 }}\n')
    assert_refused(kiln, kiln.run("bake", "model.toml", "--out", "out"), "model.toml:4:", "12")


def test_a_model_beyond_all_limits_is_refused_before_memory_is_taken(kiln: Kiln) -> None:
    kiln.write("tolerance = 1e-12\n[shape.s.sphere]\nradius = 1\n")
    assert_refused(kiln, kiln.run("bake", "model.toml", "--out", "out", seconds=20), "model.toml")


def test_output_folder_that_is_a_file(kiln: Kiln) -> None:
    kiln.write(BOX)
    (kiln.folder / "taken").write_text("here")
    done = kiln.run("bake", "model.toml", "--out", "taken")
    assert done.returncode == 3
    assert "taken" in done.stdout + done.stderr
    assert (kiln.folder / "taken").read_text() == "here"


def test_file_outside_the_project_is_refused(kiln: Kiln) -> None:
    kiln.write('[shape.s.import]\nfile = "../outside.obj"\n')
    assert_refused(kiln, kiln.run("bake", "model.toml", "--out", "out"), "../outside.obj")


def test_new_makes_a_spec_that_bakes(kiln: Kiln) -> None:
    assert kiln.run("new", "cup").returncode == 0
    (made,) = kiln.folder.rglob("*.toml")
    done = kiln.run("bake", str(made.relative_to(kiln.folder)), "--out", "out")
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_starter_is_a_good_document(kiln: Kiln) -> None:
    listed = [json.loads(line) for line in kiln.run("new", "--list", "--format", "json").stdout.splitlines()]
    starters = [one["starter"] for one in listed]
    assert {"vase", "mug", "landscape", "creature", "materials"} <= set(starters)
    for starter in starters:
        assert kiln.run("new", f"my-{starter}", "--from", starter).returncode == 0
        made = f"my-{starter}.toml"
        assert kiln.run("fmt", "--check", made).returncode == 0
        if starter == "materials":
            kiln.write(f'include = ["{made}"]\n[shape.s]\nmaterial = "oak"\n[shape.s.box]\nsize = [1, 1, 1]\n', "with")
            made = "with.toml"
        done = kiln.run("bake", made, "--out", "out")
        assert done.returncode == 0, done.stderr
        assert done.stderr == "", "a document to start from has no warnings"
    # The library of the gallery is the one that is written.
    library = (SPECS / "library" / "materials.toml").read_text(encoding="utf-8")
    made = (kiln.folder / "my-materials.toml").read_text(encoding="utf-8")
    assert made.replace("my-materials", "materials") == library
    unknown = kiln.run("new", "other", "--from", "castle")
    assert unknown.returncode == 2
    assert "landscape" in unknown.stderr
    assert not (kiln.folder / "other.toml").exists()


def test_a_draft_is_coarser_and_says_so(kiln: Kiln) -> None:
    """Eight times the tolerance: of a surface that bends in one direction about the square root of the triangles."""
    spec = (
        "tolerance = 1e-3\n[shape.s.sphere]\nradius = 1\n[assert]\ntriangles = { at-least = 2000 }\n[lod]\nlevels = 3\n"
    )
    good = kiln.bake(spec, "--cache", "kept")
    bytes_ = good.path.read_bytes()
    draft = kiln.bake(spec, "--cache", "kept", "--draft")
    facts = [one.shape("s") for one in (good, draft)]
    triangles = [one["triangles"] for one in facts]
    # A ball has as many triangles as its tolerance is small.
    assert 5 < triangles[0] / triangles[1] < 12
    bounds = [one["deviation"]["bound"] for one in facts]
    assert bounds[0] <= 1e-3 < bounds[1] <= 8e-3
    assert triangles[1] < 2000, "what is asserted of it does not hold of a draft"
    assert "lods" in good.report
    assert not draft.report.get("lods")
    # The cache does not take one for the other.
    assert kiln.bake(spec, "--cache", "kept").path.read_bytes() == bytes_


def test_explain_knows_every_code_that_check_says(kiln: Kiln) -> None:
    kiln.write("[shape.a.box]\nsizes = [1, 1, 1]\n")
    said = kiln.run("check", "model.toml").stderr
    code = said.partition("[")[2].partition("]")[0]
    done = kiln.run("explain", code)
    assert done.returncode == 0, code
    assert len(done.stdout) > 80


def test_inspect_describes_a_file(kiln: Kiln) -> None:
    kiln.bake(BOX)
    done = kiln.run("inspect", "out/model.glb")
    assert done.returncode == 0
    assert "12" in done.stdout


def test_schema_is_a_schema(kiln: Kiln) -> None:
    from jsonschema import Draft202012Validator

    Draft202012Validator.check_schema(json.loads(kiln.run("schema").stdout))


# Hostile files that are right, as far as Kiln reads them: what must come of them.
LOADABLE = {"utf8_bom.obj": 2, "binary_named_solid.stl": 1, "path_traversal.obj": 1}


@pytest.mark.cases
def test_hostile_models(kiln: Kiln, cases: Path) -> None:
    files = [*(cases / "hostile" / "obj").iterdir(), *(cases / "hostile" / "stl").iterdir()]
    assert len(files) == 12
    for file in sorted(files):
        shutil.copy(file, kiln.folder / file.name)
        kiln.write(f'[shape.s.import]\nfile = "{file.name}"\n')
        done = kiln.run("bake", "model.toml", "--out", "out", seconds=20)
        if file.name in LOADABLE:
            assert done.returncode == 0, f"{file.name}: {done.stdout}{done.stderr}"
            assert kiln.baked().shape("s")["triangles"] == LOADABLE[file.name]
            shutil.rmtree(kiln.folder / "out")
        else:
            assert_refused(kiln, done, file.name)


@pytest.mark.cases
def test_foreign_formats_are_refused_with_what_to_do(kiln: Kiln, cases: Path) -> None:
    files = list((cases / "hostile" / "gltf").iterdir())
    assert len(files) == 4
    for file in sorted(files):
        shutil.copy(file, kiln.folder / file.name)
        kiln.write(f'[shape.s.import]\nfile = "{file.name}"\n')
        assert_refused(kiln, kiln.run("bake", "model.toml", "--out", "out", seconds=20), file.name)
    (kiln.folder / "scene.blend").write_bytes(b"BLENDER-v405" + bytes(64))
    kiln.write('[shape.s.import]\nfile = "scene.blend"\n')
    assert_refused(kiln, kiln.run("bake", "model.toml", "--out", "out"), "scene.blend", "Export")


@pytest.mark.cases
def test_hostile_pictures(kiln: Kiln, cases: Path) -> None:
    files = sorted((cases / "hostile" / "png").iterdir())
    assert len(files) == 6
    for file in files:
        shutil.copy(file, kiln.folder / file.name)
        kiln.write(
            f'[shape.s]\nmaterial = "m"\n[shape.s.box]\nsize = [1, 1, 1]\n[material.m]\ncolor-texture = "{file.name}"\n'
        )
        assert_refused(kiln, kiln.run("bake", "model.toml", "--out", "out", seconds=20), file.name)


def test_picture_that_is_right_is_embedded(kiln: Kiln) -> None:
    Picture(2, 2, (1, 2, 3)).write(kiln.folder / "t.png")
    spec = '[shape.s]\nmaterial = "m"\n[shape.s.box]\nsize = [1, 1, 1]\n[material.m]\ncolor-texture = "t.png"\n'
    assert kiln.bake(spec).report["totals"]["images"] == 1


@pytest.mark.cases
def test_hostile_documents(kiln: Kiln, cases: Path) -> None:
    files = sorted((cases / "hostile" / "toml").iterdir())
    assert len(files) == 3
    for file in files:
        shutil.copy(file, kiln.folder / file.name)
        assert_refused(kiln, kiln.run("bake", file.name, "--out", "out", seconds=20), file.name)
        (kiln.folder / file.name).unlink()


@pytest.mark.cases
def test_every_invalid_document_of_the_toml_corpus_is_refused(kiln: Kiln, cases: Path) -> None:
    text = gzip.decompress((cases / "toml" / "toml_test_1.0.json.gz").read_bytes())
    corpus = {name: entry for name, entry in json.loads(text)["files"].items() if name.startswith("invalid/")}
    names = []
    for number, (name, entry) in enumerate(sorted(corpus.items())):
        if name.endswith(".toml"):
            names.append(f"i{number:04}.toml")
            (kiln.folder / names[-1]).write_bytes(base64.b64decode(entry["b64"]))
    assert len(names) > 240
    done = kiln.run("check", *names)
    said = done.stdout + done.stderr
    assert done.returncode in (1, 3)
    assert "panicked" not in said
    assert [name for name in names if name not in said] == []


def test_sample_times_a_curve_and_nothing_else(kiln: Kiln) -> None:
    kiln.write("[curve.ring.circle]\nradius = 1\n" + BOX)
    timed = kiln.run("sample", "model.toml", "--curve", "ring", "--count", "999", "--time")
    found = json.loads(timed.stdout)
    assert found.keys() == {"curve", "points", "nanoseconds"}
    assert found["points"] == 1000
    assert found["nanoseconds"] > 0
    for more in (["--at", "0.5"], ["--shape", "s"]):
        assert kiln.run("sample", "model.toml", "--curve", "ring", "--time", *more).returncode == 2
    assert kiln.run("sample", "model.toml", "--shape", "s", "--time").returncode == 2


def test_documents_are_formatted_and_mean_the_same(kiln: Kiln) -> None:
    loose = "# a box\n[ shape . s . box ]\nsize=[ 1,1 ,1, ]   # metres\n\n\n"
    path = kiln.write(loose)
    assert kiln.run("fmt", "--check", "model.toml").returncode == 1
    assert path.read_text(encoding="utf-8") == loose
    assert kiln.run("fmt", "model.toml").returncode == 0
    assert path.read_text(encoding="utf-8") == "# a box\n[shape.s.box]\nsize = [1, 1, 1]   # metres\n"
    assert kiln.run("fmt", "--check", ".").returncode == 0
    assert kiln.run("fmt", ".").stdout == ""
    assert kiln.run("check", "model.toml").returncode == 0


def test_a_stream_is_formatted(kiln: Kiln) -> None:
    line = [str(kiln.program), "fmt", "-"]
    done = subprocess.run(line, input=b"a=1#one\n", capture_output=True, check=False)
    assert (done.returncode, done.stdout) == (0, b"a = 1 #one\n")
    done = subprocess.run([*line, "--check"], input=b"a=1\n", capture_output=True, check=False)
    assert (done.returncode, done.stdout) == (1, b"")
    assert b"not formatted" in done.stderr


def test_what_is_no_document_is_not_formatted(kiln: Kiln) -> None:
    for text, word in ((b"a = [1, 2\n", b"K0"), (b"a = \xff\n", b"UTF-8"), (b"a={ b=1,\n }\n", b"K0")):
        path = kiln.folder / "model.toml"
        path.write_bytes(text)
        done = kiln.run("fmt", "model.toml")
        assert done.returncode == 1
        assert word.decode() in done.stderr
        assert path.read_bytes() == text
    assert kiln.run("fmt", "none.toml").returncode == 3


def test_hermetic_bakes_take_what_is_named_alone(kiln: Kiln, tmp_path_factory: pytest.TempPathFactory) -> None:
    # As a sandbox lays it out: links to files that lie elsewhere.
    real = tmp_path_factory.mktemp("real")
    (real / "common.toml").write_text('[material.m]\ncolor = "#ff0000"\n')
    (real / "box.toml").write_text(
        'include = ["common.toml"]\n[shape.s]\nmaterial = "m"\n[shape.s.box]\nsize = [1, 1, 1]\n'
    )
    inside = kiln.folder / "models"
    inside.mkdir()
    for name in ("common.toml", "box.toml"):
        (inside / name).symlink_to(real / name)
    refused = kiln.run("bake", "models/box.toml", "--out", "out", "--root", ".")
    assert refused.returncode == 3
    assert "outside" in refused.stderr
    kiln.write('roots = ["models"]\nprofiles = ["web"]\n[cache]\nfolder = "kept"\n', "kiln")
    words = ("models/box.toml", "--hermetic", "--out", "out", "--depfile", "made.d")
    done = subprocess.run(
        [str(kiln.program), "bake", *words],
        cwd=kiln.folder,
        env=os.environ | {"KILN_CACHE": str(kiln.folder / "kept")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in (kiln.folder / "out").iterdir()) == ["box.glb", "box.report.json"]
    assert not (kiln.folder / "kept").exists()
    assert json.loads((kiln.folder / "out" / "box.report.json").read_text())["spec"] == "models/box.toml"
    line = (kiln.folder / "made.d").read_text().splitlines()[0]
    assert line == "out/box.glb out/box.report.json: models/box.toml models/common.toml"
    # Paths of documents still lead nowhere out of the root, and a file that is not laid out is not read.
    (real / "box.toml").write_text('include = ["../../common.toml"]\n[shape.s.box]\nsize = [1, 1, 1]\n')
    assert "leads out of the project" in kiln.run("bake", *words[:4]).stderr
    assert kiln.run("bake", "--hermetic").returncode == 2
    assert kiln.run("bake", "kiln.toml", "--hermetic").returncode == 2
    assert kiln.run("bake", "none.toml", "--hermetic").returncode == 3


def test_manual_pages_are_written_for_every_command(kiln: Kiln) -> None:
    assert kiln.run("man", "pages").returncode == 0
    pages = {path.name for path in (kiln.folder / "pages").iterdir()}
    words = re.findall(r"^  ([a-z]+)  ", kiln.run("--help").stdout, flags=re.MULTILINE)
    assert len(words) > 15
    assert {f"kiln-{word}.1" for word in words if word != "help"} | {"kiln.1"} <= pages
    assert "\\-\\-profile" in (kiln.folder / "pages" / "kiln-bake.1").read_text()
