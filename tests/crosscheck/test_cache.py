"""The cache from outside: the same bytes as a bake, whatever happens to its folder."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from kiln import Kiln

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


def test_a_file_that_appears_is_seen(kiln: Kiln) -> None:
    kiln.folder.joinpath("specs").mkdir()
    text = '[shape.s]\nmaterial = "m"\n[shape.s.box]\nsize = [1, 1, 1]\n[material.m]\ntexture = "missing.png"\n'
    kiln.write(text, "specs/s0")
    # A document that fails is not kept, and fails again.
    for _ in range(2):
        hits, done = bake(kiln)
        assert (hits, done.returncode) == (0, 1)


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
        assert hits >= 2
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
    assert (hits, done.returncode) == (0, 0)
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
