"""The Python package: built as a wheel, installed into an environment of its own without network, and used there."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kiln import Kiln

ROOT = Path(__file__).resolve().parents[2]
SPEC = """[parameters]
height = 1
[shape.s]
material = "red"
[shape.s.box]
size = [1, "= height", 2]
[material.red]
color = "#c03020"
[variant.tall.parameters]
height = 3
"""


def wheel(project: Path, folder: Path) -> Path:
    """The wheel of a project, built with what is installed."""
    words = ["wheel", "--quiet", "--no-deps", "--no-index", "--no-build-isolation", "--wheel-dir", str(folder)]
    subprocess.run([sys.executable, "-m", "pip", *words, str(project)], check=True)
    (built,) = folder.glob("*.whl")
    return built


def installed(built: Path, folder: Path) -> Path:
    """The interpreter of a new environment that has a wheel and nothing else."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    python = folder / "bin" / "python"
    words = ["install", "--quiet", "--no-deps", "--no-index", str(built)]
    subprocess.run([sys.executable, "-m", "pip", "--python", str(python), *words], check=True)
    return python


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An interpreter with the package."""
    folder = tmp_path_factory.mktemp("python")
    return installed(wheel(ROOT / "python", folder), folder / "environment")


def run(python: Path, kiln: Kiln, script: str, **environment: str) -> str:
    """What a script prints that runs beside the documents."""
    done = subprocess.run(
        [str(python), "-c", textwrap.dedent(script)],
        cwd=kiln.folder,
        env=os.environ | {"KILN": str(kiln.program)} | environment,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_documents_are_baked(python: Path, kiln: Kiln) -> None:
    kiln.write(SPEC, "chest")
    said = run(
        python,
        kiln,
        """
        import kiln
        baked = kiln.bake("chest.toml", out="built", set={"height": 2.5}, profile=["core", "web"])
        assert [(one.variant, one.profile) for one in baked] == [
            (None, "core"), (None, "web"), ("tall", "core"), ("tall", "web")], baked
        first = baked[0]
        assert (first.spec, first.triangles, first.bytes) == ("chest.toml", 12, first.path.stat().st_size)
        low, high = (first.report["totals"]["bounds"][end] for end in ("min", "max"))
        print(high[1] - low[1], baked.warnings)
        """,
    )
    assert said == "2.5 []\n"
    assert (kiln.folder / "built" / "chest.tall.glb").is_file()


def test_a_project_is_baked_in_its_folder(python: Path, kiln: Kiln) -> None:
    (kiln.folder / "game" / "specs").mkdir(parents=True)
    kiln.write(SPEC, "game/specs/chest")
    kiln.write('roots = ["specs"]\nout = "built"\n', "game/kiln")
    script = 'import kiln\nprint(*sorted(str(one.path) for one in kiln.bake(directory="game")))'
    assert run(python, kiln, script) == "game/built/chest.glb game/built/chest.tall.glb\n"


def test_what_is_wrong_is_data(python: Path, kiln: Kiln) -> None:
    kiln.write(SPEC, "good")
    kiln.write("[shape.s.box]\nsize = [1, -1, 1]\n", "bad")
    run(
        python,
        kiln,
        """
        import kiln
        try:
            kiln.bake("good.toml", "bad.toml", out="built")
        except kiln.BakeError as error:
            (one,) = error.diagnostics
            assert error.of_documents and [asset.spec for asset in error.assets] == ["good.toml"] * 2
            assert (one.file, one.line, one.severity, one.code[0]) == ("bad.toml", 2, "error", "K"), one
            assert str(error).startswith("bad.toml:2:"), str(error)
        else:
            raise AssertionError("it went well")
        assert [one.line for one in kiln.check("bad.toml")] == [2]
        assert kiln.check("good.toml") == []
        try:
            kiln.bake("none.toml", out="built")
        except kiln.BakeError as error:
            assert not error.of_documents and "none.toml" in str(error)
        else:
            raise AssertionError("it went well")
        """,
    )


def test_a_missing_program_is_told(python: Path, kiln: Kiln) -> None:
    script = """
    import kiln
    try:
        kiln.bake("x.toml")
    except FileNotFoundError as error:
        print(error)
    """
    said = run(python, kiln, script, KILN="no-such-program")
    assert said.startswith("no-such-program is not found: install it")


def test_the_package_is_a_blender_extension(python: Path, tmp_path: Path) -> None:
    assert python.is_file()
    with zipfile.ZipFile(wheel(ROOT / "python", tmp_path)) as built:
        assert {"kiln/__init__.py", "kiln/blender.py", "kiln/blender_manifest.toml"} <= set(built.namelist())


BLENDER = """
import sys
sys.path.insert(0, PYTHON)
import bpy, kiln, pathlib
from kiln.blender import SPEC
kiln.register()
bpy.ops.wm.read_homefile(use_empty=True)
bake = bpy.ops.import_scene.kiln
mine = bpy.data.meshes.new("mine")  # not used by anything, and not to be lost
assert bake(filepath="chest.toml", parameters="height=2.5") == {"FINISHED"}
(chest,) = bpy.context.scene.objects
assert chest[SPEC] == str(pathlib.Path("chest.toml").resolve())
assert [round(side, 6) for side in chest.dimensions] == [1, 2, 2.5], chest.dimensions  # Blender's z is up
assert bake(filepath="chest.toml", variant="tall") == {"FINISHED"}
(chest,) = bpy.context.scene.objects
assert round(chest.dimensions.z, 6) == 3, chest.dimensions
assert len(bpy.data.meshes) == 2 and len(bpy.data.materials) == 1
assert bake(filepath="chest.toml", replace=False) == {"FINISHED"}
assert len(bpy.context.scene.objects) == 2
for wrong, words in (({"filepath": "bad.toml"}, "bad.toml:2:"),
                     ({"filepath": "chest.toml", "variant": "x"}, "no variant `x`"),
                     ({"filepath": "chest.toml", "parameters": "height"}, "write parameters as"),
                     ({"filepath": "chest.toml", "program": "/none"}, "is not found")):
    try:
        bake(**wrong)
    except RuntimeError as error:
        assert words in str(error), error
    else:
        raise AssertionError(wrong)
assert len(bpy.context.scene.objects) == 2
kiln.unregister()
assert not hasattr(bpy.types, "IMPORT_SCENE_OT_kiln")
"""


def test_blender_bakes_and_imports(kiln: Kiln) -> None:
    kiln.write(SPEC, "chest")
    kiln.write("[shape.s.box]\nsize = [1, -1, 1]\n", "bad")
    run(Path(sys.executable), kiln, BLENDER.replace("PYTHON", repr(str(ROOT / "python"))))


def test_baked_files_are_verified_by_an_installed_package(kiln: Kiln, tmp_path: Path) -> None:
    kiln.write(SPEC, "chest")
    assert kiln.run("bake", "chest.toml", "--out", "out").returncode == 0
    environment = tmp_path / "environment"
    python = installed(wheel(ROOT / "scripts", tmp_path), environment)
    (package,) = environment.glob("lib/python*/site-packages/kiln_verify")
    # What `pip` and `kiln-verify --install` fetch is here already.
    (package / "node_modules").symlink_to(ROOT / "scripts" / "node_modules")
    (own,) = (Path(path) for path in sys.path if path.endswith("site-packages"))
    found = os.environ | {"PYTHONPATH": str(own), "PATH": f"{python.parent}:{os.environ['PATH']}"}

    def verify(*words: str) -> subprocess.CompletedProcess[str]:
        line = [str(kiln.program), "verify", *words]
        return subprocess.run(line, cwd=kiln.folder, env=found, capture_output=True, text=True, check=False)

    done = verify("out", "--jobs", "2")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "verify: 2 assets" in done.stdout
    assert (kiln.folder / "out" / "verify.json").is_file()
    report = kiln.folder / "out" / "chest.report.json"
    report.write_text(report.read_text().replace('"triangles": 12', '"triangles": 13'))
    done = verify("out")
    assert done.returncode == 1
    assert "the report says 13" in done.stdout
    assert verify("nothing").returncode == 2


def test_where_the_package_is_missing_its_installation_is_told(kiln: Kiln) -> None:
    nowhere = {"PATH": str(kiln.folder)}
    line = [str(kiln.program), "verify", "out"]
    done = subprocess.run(line, cwd=kiln.folder, env=nowhere, capture_output=True, text=True, check=False)
    assert done.returncode == 3
    assert "pip install kiln-verify" in done.stderr
