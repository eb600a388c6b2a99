"""The cache from outside: the same bytes as a bake, whatever happens to its folder."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kiln import Kiln

ROOT = Path(__file__).resolve().parents[2]
COMMON = '[material.red]\ncolor = "#c03020"\n'
FOLDED = "[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\nfaces = [[0, 2, 1, 3]]\n"


def spec(index: int) -> str:
    """A document that includes another one."""
    return f'include = ["common.toml"]\n[shape.s]\nmaterial = "red"\n[shape.s.sphere]\nradius = {index + 1}\n'


def prepare(kiln: Kiln, count: int) -> None:
    (kiln.folder / "specs").mkdir()
    kiln.write(COMMON, "specs/common")
    for index in range(count):
        kiln.write(spec(index), f"specs/s{index}")


def bake(kiln: Kiln, *more: str) -> tuple[int, subprocess.CompletedProcess[str]]:
    """Bakes with the cache; how many documents were found in it."""
    done = kiln.run("bake", "specs", "--out", "out", "--cache", "cache", "--format", "json", "--verbose", *more)
    found = [json.loads(line) for line in done.stdout.splitlines()]
    hits = [entry["cache"]["hits"] for entry in found if "cache" in entry]
    return (hits[0] if hits else -1), done


def outputs(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def forget_documents(kiln: Kiln) -> None:
    """Takes out of the cache what is known of documents, and leaves what is known of shapes."""
    shutil.rmtree(kiln.folder / "cache" / "manifests")
    (kiln.folder / "cache" / "recent").unlink()


def objects(kiln: Kiln) -> list[Path]:
    return sorted(path for path in (kiln.folder / "cache" / "objects").rglob("*") if path.is_file())


def test_a_hit_gives_the_bytes_and_words_of_a_bake(kiln: Kiln) -> None:
    prepare(kiln, 4)
    kiln.write(FOLDED, "specs/folded")
    plain = kiln.run("bake", "specs", "--out", "plain", "--format", "json")
    assert plain.returncode == 0
    runs = []
    for expected in (0, 5):
        shutil.rmtree(kiln.folder / "out", ignore_errors=True)
        hits, done = bake(kiln)
        assert (hits, done.returncode) == (expected, 0), done.stderr
        assert outputs(kiln.folder / "out") == outputs(kiln.folder / "plain")
        runs.append([line for line in done.stdout.splitlines() if '"cache"' not in line and "skipped" not in line])
    # The warning of the folded face is told again, with its place.
    assert runs[0] == runs[1]
    assert any("K0831" in line and '"line":3' in line.replace(" ", "") for line in runs[1])
    words = [line.replace("plain/", "out/") for line in plain.stdout.splitlines()]
    assert words == runs[1]


def test_only_what_depends_on_a_change_is_baked_again(kiln: Kiln) -> None:
    prepare(kiln, 6)
    bake(kiln)
    stamps = {path: path.stat().st_mtime_ns for path in (kiln.folder / "out").rglob("*")}
    kiln.write(spec(7), "specs/s2")
    assert bake(kiln)[0] == 5
    changed = [path.name for path, stamp in stamps.items() if path.stat().st_mtime_ns != stamp]
    assert sorted(changed) == ["s2.glb", "s2.report.json"]
    # What was there before is found again, and what all include is a part of each.
    kiln.write(spec(2), "specs/s2")
    assert bake(kiln)[0] == 6
    kiln.write(COMMON.replace("c0", "d0"), "specs/common")
    assert bake(kiln)[0] == 0
    # Options are a part of the key too.
    assert bake(kiln, "--no-report")[0] == 0
    assert bake(kiln, "--no-report")[0] == 6
    assert bake(kiln, "--profile", "web")[0] == 0


def test_nothing_to_do_reads_one_file_for_all(kiln: Kiln) -> None:
    prepare(kiln, 3)
    assert bake(kiln)[0] == 0
    # What is known of single documents is not asked for, and is not needed while nothing changed and all is there.
    for folder in ("manifests", "objects"):
        shutil.move(kiln.folder / "cache" / folder, kiln.folder / folder)
    assert bake(kiln)[0] == 3
    # An output that is gone is: it cannot be had now, and is made again.
    (kiln.folder / "out" / "s1.glb").unlink()
    assert bake(kiln)[0] == 2
    # A broken file of all is none.
    recent = kiln.folder / "cache" / "recent"
    recent.write_bytes(recent.read_bytes()[:-1] + b"x")
    shutil.rmtree(kiln.folder / "cache" / "manifests")
    assert bake(kiln)[0] == 0
    assert bake(kiln)[0] == 3
    # And a change of any input is seen.
    kiln.write(COMMON.replace("#c03020", "#3020c0"), "specs/common")
    assert bake(kiln)[0] == 0


def test_a_file_that_appears_is_seen(kiln: Kiln) -> None:
    kiln.folder.joinpath("specs").mkdir()
    text = '[shape.s]\nmaterial = "m"\n[shape.s.box]\nsize = [1, 1, 1]\n[material.m]\ntexture = "missing.png"\n'
    kiln.write(text, "specs/s0")
    # A document that fails is not kept, and fails again.
    for _ in range(2):
        hits, done = bake(kiln)
        assert (hits, done.returncode) == (0, 1)


SOLID = """[parameters]
width = 1
[curve.outline.polyline]
points = [[0, 0], [0.5, 0], [0.6, 1], [0, 1]]
[shape.turned]
segments = [64, 8]
[shape.turned.revolve]
profile = "outline"
[shape.cut]
material = "clay"
[shape.cut.difference]
of = ["turned", "hole"]
[shape.hole]
segments = [48, 24]
[shape.hole.sphere]
radius = 0.4
center = [0.3, 0.5, 0]
[shape.other]
material = "clay"
[shape.other.union]
of = ["one", "two"]
[shape.one]
segments = [48, 24]
[shape.one.sphere]
radius = "= width"
[shape.two]
segments = [48, 24]
[shape.two.sphere]
radius = 1
center = [0.7, 0.1, 0.2]
[material.clay]
color = "#b5651d"
"""


def shapes(kiln: Kiln, *more: str) -> tuple[int, int]:
    """Bakes the solid with the cache: how many shapes were found, and how many were made and kept."""
    done = kiln.run("bake", "solid.toml", "--out", "out", "--cache", "cache", "--format", "json", "--verbose", *more)
    assert done.returncode == 0, done.stdout + done.stderr
    (found,) = [json.loads(line)["cache"] for line in done.stdout.splitlines() if '"cache"' in line]
    assert found["hits"] == 0
    return found["shapes"]["found"], found["shapes"]["kept"]


def test_a_shape_is_made_again_only_when_what_it_depends_on_changed(kiln: Kiln) -> None:
    def same_as_plain(*more: str) -> None:
        assert kiln.run("bake", "solid.toml", "--out", "plain", *more).returncode == 0
        assert outputs(kiln.folder / "out") == outputs(kiln.folder / "plain")

    kiln.write(SOLID, "solid")
    found, kept = shapes(kiln)
    assert found == 0
    assert kept >= 2
    same_as_plain()
    # Looks, names of nodes and profiles cut nothing again, nor do a definition before all others and another name.
    painted = SOLID.replace("#b5651d", "#336699").replace(
        "[parameters]", "[shape.ball.box]\nsize = [1, 1, 1]\n[parameters]"
    )
    painted = painted.replace("hole", "hollow")
    for text, options in ((painted, ()), (painted, ("--no-report",)), (SOLID, ("--profile", "bevy"))):
        kiln.write(text, "solid")
        shutil.rmtree(kiln.folder / "out")
        shutil.rmtree(kiln.folder / "plain")
        assert shapes(kiln, *options) == (2, 0)
        same_as_plain(*options)
    # A parameter and a curve make what uses them anew; the other solid is found.
    for text in (SOLID.replace("width = 1", "width = 1.1"), SOLID.replace("0.6, 1", "0.7, 1")):
        kiln.write(text, "solid")
        found, kept = shapes(kiln, "--profile", "core")
        assert found == 1
        assert kept >= 1
        same_as_plain("--profile", "core")
    stats = json.loads(kiln.run("cache", "stats", "--cache", "cache", "--format", "json").stdout)
    assert stats["shapes"] == len(kept_files(kiln))


def kept_files(kiln: Kiln) -> list[Path]:
    return sorted(path for path in (kiln.folder / "cache" / "shapes").rglob("*") if path.is_file())


def test_broken_shapes_are_made_again(kiln: Kiln) -> None:
    kiln.write(SOLID, "solid")
    shapes(kiln)
    right = outputs(kiln.folder / "out")
    rolls = random.Random(3)
    for turn in range(6):
        forget_documents(kiln)
        victim = rolls.choice(kept_files(kiln))
        whole = bytearray(victim.read_bytes())
        if turn % 2:
            whole[rolls.randrange(len(whole))] ^= 1 << rolls.randrange(8)
        victim.write_bytes(whole if turn % 2 else whole[: len(whole) // 2])
        shutil.rmtree(kiln.folder / "out")
        shapes(kiln)
        assert outputs(kiln.folder / "out") == right
    victim = kept_files(kiln)[0]
    victim.write_bytes(victim.read_bytes()[:-1])
    assert kiln.run("cache", "verify", "--cache", "cache").returncode == 1
    assert not victim.exists()


def test_kept_shapes_give_the_bytes_of_a_bake_over_the_gallery(kiln: Kiln) -> None:
    gallery = str(ROOT / "specs")

    def gallery_of(out: str, *more: str) -> dict[str, bytes]:
        done = kiln.run("bake", gallery, "--root", str(ROOT), "--out", out, "--quiet", *more, seconds=1200)
        assert done.returncode == 0, done.stderr
        return outputs(kiln.folder / out)

    plain = gallery_of("plain")
    assert gallery_of("cold", "--cache", "cache") == plain
    assert len(kept_files(kiln)) > 20
    # Without the manifests every document is baked, of the shapes that are kept.
    forget_documents(kiln)
    assert gallery_of("warm", "--cache", "cache") == plain


def test_a_clock_that_jumps_hides_no_change(kiln: Kiln) -> None:
    kiln.write(SOLID, "solid")
    file = kiln.folder / "solid.toml"
    for color in ("#b5651d", "#336699", "#112233"):
        file.write_text(SOLID.replace("#b5651d", color))
        # The same size, and a time that does not pass: of a clock far ahead, and of one that was set back.
        for moment in (4_000_000_000, 1_000):
            os.utime(file, (moment, moment))
            kiln.run("bake", "solid.toml", "--out", "out", "--cache", "cache")
            kiln.run("bake", "solid.toml", "--out", "plain")
            assert outputs(kiln.folder / "out") == outputs(kiln.folder / "plain")


def test_broken_objects_are_baked_again(kiln: Kiln) -> None:
    prepare(kiln, 3)
    bake(kiln)
    right = outputs(kiln.folder / "out")
    rolls = random.Random(5)
    for turn in range(24):
        victims = [
            path for path in (kiln.folder / "cache").rglob("*") if path.is_file() and path.name != "CACHEDIR.TAG"
        ]
        victim = rolls.choice(victims)
        whole = bytearray(victim.read_bytes())
        if turn % 3 == 0:
            victim.write_bytes(whole[: len(whole) // 2])
        elif turn % 3 == 1:
            whole[rolls.randrange(len(whole))] ^= 1 << rolls.randrange(8)
            victim.write_bytes(whole)
        else:
            victim.unlink()
        shutil.rmtree(kiln.folder / "out")
        hits, done = bake(kiln)
        assert done.returncode == 0, done.stderr
        # Without the file of all, what was broken of single documents before is met now.
        assert hits >= 2 or victim.name == "recent"
        assert outputs(kiln.folder / "out") == right
    assert bake(kiln)[0] == 3


def test_verify_takes_out_what_is_broken(kiln: Kiln) -> None:
    prepare(kiln, 2)
    bake(kiln)
    assert kiln.run("cache", "verify", "--cache", "cache").returncode == 0
    victim = objects(kiln)[0]
    victim.write_bytes(b"poison" + victim.read_bytes()[6:])
    done = kiln.run("cache", "verify", "--cache", "cache")
    assert done.returncode == 1
    assert "1 broken file is taken out" in done.stderr
    assert not victim.exists()
    assert kiln.run("cache", "verify", "--cache", "cache").returncode == 0
    stats = json.loads(kiln.run("cache", "stats", "--cache", "cache", "--format", "json").stdout)
    assert stats["documents"] == 2
    assert stats["objects"] == len(objects(kiln))
    assert kiln.run("cache", "clear", "--cache", "cache").returncode == 0
    assert objects(kiln) == []
    assert kiln.run("cache", "stats", "--cache", "none").returncode == 3
    assert kiln.run("cache", "stats").returncode == 2


def test_the_limit_holds_and_what_was_used_last_stays(kiln: Kiln) -> None:
    prepare(kiln, 5)
    bake(kiln)
    size = sum(path.stat().st_size for path in objects(kiln))
    # The first document is used, the others lie idle.
    long_ago = time.time() - 1000
    for path in (kiln.folder / "cache").rglob("*"):
        if path.is_file():
            os.utime(path, (long_ago, long_ago))
    shutil.rmtree(kiln.folder / "out")
    kiln.run("bake", "specs/s0.toml", "--out", "out", "--cache", "cache", "--root", ".")
    kiln.write(spec(9), "specs/s5")
    bake(kiln, "--cache-limit", f"{size // 2} B")
    assert sum(path.stat().st_size for path in objects(kiln)) <= size // 2
    # What is there is known all the same; what is gone is made again.
    assert bake(kiln)[0] == 6
    shutil.rmtree(kiln.folder / "out")
    assert 1 <= bake(kiln)[0] < 6


def test_a_folder_that_holds_other_things_is_left_alone(kiln: Kiln) -> None:
    prepare(kiln, 1)
    (kiln.folder / "cache").mkdir()
    (kiln.folder / "cache" / "letter.txt").write_text("dear all")
    hits, done = bake(kiln)
    assert (hits, done.returncode) == (-1, 0)
    assert "other things" in done.stdout
    assert kiln.run("cache", "clear", "--cache", "cache").returncode == 3
    assert (kiln.folder / "cache" / "letter.txt").read_text() == "dear all"


def test_a_folder_that_cannot_be_written_costs_a_warning(kiln: Kiln) -> None:
    prepare(kiln, 2)
    bake(kiln)
    shutil.rmtree(kiln.folder / "cache" / "objects")
    (kiln.folder / "cache" / "objects").write_text("no folder")
    kiln.write(spec(8), "specs/s0")
    hits, done = bake(kiln)
    assert (hits, done.returncode) == (1, 0)
    warnings = [line for line in done.stdout.splitlines() if "cannot be written" in line]
    assert len(warnings) == 1
    assert kiln.run("check", "specs").returncode == 0


def test_processes_that_are_killed_leave_nothing_wrong(kiln: Kiln) -> None:
    prepare(kiln, 12)
    plain = kiln.run("bake", "specs", "--out", "plain")
    assert plain.returncode == 0
    right = outputs(kiln.folder / "plain")
    rolls = random.Random(11)
    until = time.monotonic() + 6
    killed = 0
    while time.monotonic() < until:
        if rolls.random() < 0.3:
            shutil.rmtree(kiln.folder / "cache")
        running = [
            subprocess.Popen(
                [str(kiln.program), "bake", "specs", "--out", f"out{number}", "--cache", "cache", "--quiet"],
                cwd=kiln.folder,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            for number in range(2)
        ]
        time.sleep(rolls.uniform(0.0, 0.06))
        victim = rolls.choice(running)
        victim.send_signal(signal.SIGKILL)
        killed += 1
        for process in running:
            process.wait(timeout=60)
        assert bake(kiln)[1].returncode == 0
        assert outputs(kiln.folder / "out") == right
        shutil.rmtree(kiln.folder / "out")
    assert killed > 5
