"""The rule of Bazel, run by Bazel itself in its sandbox: declared inputs alone, the same bytes anywhere."""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kiln import Kiln

ROOT = Path(__file__).resolve().parents[2]
BAZEL = ROOT / "scripts" / "node_modules" / "@bazel" / "bazel-linux_x64" / "bazel-2.1.0-linux-x86_64"
COMMON = '[material.red]\ncolor = "#c03020"\n'
CHEST = """include = ["../common.toml"]
[parameters]
height = 1
[shape.s]
material = "red"
[shape.s.sphere]
radius = "= height"
[variant.tall.parameters]
height = 3
"""
BUILD = """load("@kiln_rules//:defs.bzl", "kiln_asset")
kiln_asset(
    name = "chest",
    spec = "specs/chest.toml",
    deps = DEPS,
    kiln = "//tools:kiln",
    parameters = {"height": "0.6"},
    variants = ["tall"],
    profiles = ["core", "web"],
)
kiln_asset(
    name = "plain",
    spec = "plain.toml",
    kiln = "//tools:kiln",
    reports = False,
)
"""


@dataclass(frozen=True)
class Workspace:
    """A workspace of Bazel, and where Bazel works."""

    folder: Path
    root: Path

    def build(self, target: str, *options: str) -> subprocess.CompletedProcess[str]:
        """Builds a target."""
        start = [str(BAZEL), "--batch", "--nohome_rc", "--nosystem_rc", f"--output_user_root={self.root}"]
        words = ["build", "--spawn_strategy=sandboxed", "--color=no", "--curses=no", "--subcommands", *options]
        return subprocess.run(
            [*start, *words, target], cwd=self.folder, capture_output=True, text=True, timeout=300, check=False
        )

    def outputs(self) -> dict[str, bytes]:
        """What was built, by the path below `bazel-bin`."""
        top = self.folder / "bazel-bin"
        return {str(path.relative_to(top)): path.read_bytes() for path in sorted(top.rglob("*")) if path.is_file()}


def workspace(folder: Path, kiln: Kiln, root: Path, deps: str = '["common.toml"]') -> Workspace:
    """A workspace with two documents and the program."""
    (folder / "models" / "specs").mkdir(parents=True)
    (folder / "tools").mkdir()
    (folder / "tools" / "kiln").symlink_to(kiln.program)
    (folder / "tools" / "BUILD").write_text('exports_files(["kiln"], visibility = ["//visibility:public"])\n')
    rules = f'local_repository(name = "kiln_rules", path = "{ROOT / "bazel"}")\n'
    (folder / "WORKSPACE").write_text(f'workspace(name = "game")\n{rules}')
    (folder / "models" / "BUILD").write_text(BUILD.replace("DEPS", deps))
    (folder / "models" / "common.toml").write_text(COMMON)
    (folder / "models" / "specs" / "chest.toml").write_text(CHEST)
    (folder / "models" / "plain.toml").write_text("[shape.s.box]\nsize = [1, 1, 1]\n")
    # What is not declared must change nothing: a project above, and beside.
    (folder / "kiln.toml").write_text('roots = ["models"]\nprofiles = ["quantized"]\n')
    return Workspace(folder, root)


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where Bazel unpacks itself, once."""
    if not BAZEL.is_file():
        pytest.fail("there is no Bazel: run scripts/setup")
    BAZEL.chmod(0o755)
    return tmp_path_factory.mktemp("bazel")


def test_bazel_bakes_what_kiln_bakes(kiln: Kiln, root: Path) -> None:
    here = workspace(kiln.folder / "one", kiln, root)
    done = here.build("//models:all")
    assert done.returncode == 0, done.stderr
    built = here.outputs()
    names = [f"chest{variant}{profile}" for variant in ("", ".tall") for profile in ("", ".web")]
    expected = {f"models/specs/{name}{end}" for name in names for end in (".glb", ".report.json")}
    assert set(built) == expected | {"models/plain.glb"}
    # The same as by hand, from the root of the workspace.
    by_hand = replace(kiln, folder=here.folder)
    words = ("--set", "height=0.6", "--profile", "core,web", "--out", "../plain", "--hermetic")
    assert by_hand.run("bake", "models/specs/chest.toml", *words).returncode == 0
    plain = kiln.folder / "plain"
    assert {path.name: path.read_bytes() for path in plain.iterdir()} == {
        name.rsplit("/", 1)[1]: data for name, data in built.items() if "chest" in name
    }
    # No path of a command is absolute.
    commands = re.findall(r"exec env - \\\n(.*)\)", done.stderr)
    assert len(commands) == 2
    assert not [command for command in commands if " /" in command or "=/" in command]
    # Nothing is left to do, and then only what depends on the change.
    assert "SUBCOMMAND" not in here.build("//models:all").stderr
    (here.folder / "models" / "common.toml").write_text(COMMON.replace("#c03020", "#3020c0"))
    again = here.build("//models:all")
    assert again.returncode == 0
    assert re.findall(r"action 'Baking (.*?)'", again.stderr) == ["models/specs/chest.toml"]
    assert here.outputs()["models/plain.glb"] == built["models/plain.glb"]
    assert here.outputs()["models/specs/chest.glb"] != built["models/specs/chest.glb"]


def test_another_checkout_takes_the_bytes_of_the_shared_cache(kiln: Kiln, root: Path) -> None:
    cache = f"--disk_cache={kiln.folder / 'cache'}"
    one = workspace(kiln.folder / "one", kiln, root)
    assert one.build("//models:all", cache).returncode == 0
    two = workspace(kiln.folder / "elsewhere" / "two", kiln, root)
    done = two.build("//models:all", cache)
    assert done.returncode == 0, done.stderr
    assert "2 remote cache hit" in done.stderr, done.stderr
    assert two.outputs() == one.outputs()
    # And without a cache it bakes the same.
    three = workspace(kiln.folder / "third", kiln, root)
    assert three.build("//models:all").returncode == 0
    assert three.outputs() == one.outputs()


def test_what_is_not_declared_is_not_read(kiln: Kiln, root: Path) -> None:
    here = workspace(kiln.folder / "one", kiln, root, deps="[]")
    done = here.build("//models:chest")
    assert done.returncode != 0
    assert '"../common.toml" does not exist' in done.stderr, done.stderr
    assert "models/specs/chest.toml:1:" in done.stderr
