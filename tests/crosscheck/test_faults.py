"""Faults from outside: killed processes, full disks, folders that vanish, files that change; old outputs stay whole."""

from __future__ import annotations

import os
import random
import resource
import shutil
import signal
import subprocess
import threading
import time
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from kiln import Kiln

SMALL = (
    '[shape.s]\nmaterial = "m"\n[shape.s.box]\nsize = [1, 2, 3]\n[material.m]\ncolor = "#80a0c0"\n',
    "tolerance = 0.01\n[curve.c.natural-spline]\npoints = [[0.1, 0], [0.3, 0.5], [0.2, 1]]\n[shape.s.revolve]\n"
    'profile = "c"\n[variant.wide.shape.s.revolve]\nangle = 180\n',
    '[parameters]\nn = 3\n[shape.s.sphere]\nradius = "= n / 10"\n[node.a]\nshape = "s"\nat = [0, "= n", 0]\n'
    "[assert]\nclosed = true\n",
)


def sphere(radius: float) -> str:
    return f"tolerance = 0.002\n[shape.s.sphere]\nradius = {radius}\n"


def start(kiln: Kiln, *arguments: str, before: Callable[[], None] | None = None) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [str(kiln.program), *arguments],
        cwd=kiln.folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=before,  # noqa: PLW1509 (one thread)
    )


def named(folder: Path) -> dict[str, bytes]:
    """Files under final names."""
    return {path.name: path.read_bytes() for path in sorted(folder.glob("*")) if not path.name.startswith(".")}


def both(kiln: Kiln) -> list[dict[str, bytes]]:
    """What two versions of one document bake into."""
    found = []
    for number, radius in enumerate((1.0, 1.5)):
        kiln.write(sphere(radius))
        assert kiln.run("bake", "model.toml", "--out", f"right{number}").returncode == 0
        found.append(named(kiln.folder / f"right{number}"))
    assert found[0] != found[1]
    return found


@pytest.mark.parametrize("number", range(len(SMALL)))
def test_documents_cut_off_at_every_byte(kiln: Kiln, number: int, tried: Callable[[str, int], None]) -> None:
    text = SMALL[number].encode()
    folder = kiln.folder / "specs"
    folder.mkdir()
    for end in range(len(text) + 1):
        (folder / f"cut{end:04}.toml").write_bytes(text[:end])
    done = kiln.run("bake", "specs", "--out", "out", "--no-report")
    assert done.returncode == 1
    assert "panicked" not in done.stderr
    assert "failed inside" not in done.stderr
    tried(f"cut-documents-{number}", len(text) + 1)
    whole = f"cut{len(text):04}.glb"
    assert (kiln.folder / "out" / whole).exists()
    assert all(path.read_bytes()[:4] == b"glTF" for path in (kiln.folder / "out").iterdir())


def test_killed_at_any_moment(kiln: Kiln, tried: Callable[[str, int], None]) -> None:
    versions = both(kiln)
    out = kiln.folder / "out"
    shutil.copytree(kiln.folder / "right0", out)
    rolls = random.Random(3)
    ended = {"killed": 0, "done": 0}
    # The time of a whole bake follows from how the bakes end, so that about half of them are killed on any machine.
    whole = 0.03
    for turn in range(200):
        kiln.write(sphere((1.0, 1.5)[turn % 2]))
        running = start(kiln, "bake", "model.toml", "--out", "out")
        time.sleep(rolls.uniform(0, whole))
        running.send_signal(signal.SIGKILL)
        running.communicate()
        killed = running.returncode < 0
        ended["killed" if killed else "done"] += 1
        whole *= 1.1 if killed else 0.9
        for name, found in named(out).items():
            assert found in [version[name] for version in versions], f"{name} is broken after turn {turn}"
    assert min(ended.values()) > 20, ended
    tried("bakes-to-kill", sum(ended.values()))
    kiln.write(sphere(1.5))
    assert kiln.run("bake", "model.toml", "--out", "out").returncode == 0
    assert named(out) == versions[1]


@pytest.mark.parametrize("room", [0, 100, 4000, 20_000, 40_000])
def test_no_room_for_an_output(kiln: Kiln, room: int) -> None:
    versions = both(kiln)
    shutil.copytree(kiln.folder / "right0", kiln.folder / "out")

    def limited() -> None:
        # Writing further then fails as it does on a full disk, with another number.
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))

    running = start(kiln, "bake", "model.toml", "--out", "out", before=limited)
    _, said = running.communicate(timeout=60)
    assert max(len(content) for content in versions[1].values()) > room
    assert running.returncode == 3, said
    assert b"cannot write" in said
    assert named(kiln.folder / "out") == versions[0]
    left = sorted(path.name for path in (kiln.folder / "out").iterdir())
    assert left == sorted(versions[0]), "temporary files are taken away"


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 64 kB, where the machine lets us have one."""
    place = tmp_path / "small"
    place.mkdir()
    made = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(place)], capture_output=True, check=False
    )
    if made.returncode != 0:
        pytest.skip("no small disk can be mounted here")
    yield place
    subprocess.run(["umount", str(place)], check=True)


def test_a_full_disk(kiln: Kiln, small_disk: Path) -> None:
    kiln.write("[shape.s.box]\nsize = [1, 1, 1]\n", "box")
    assert kiln.run("bake", "box.toml", "--out", str(small_disk)).returncode == 0
    before = named(small_disk)
    kiln.write(sphere(1).replace("0.002", "0.0002"), "box")
    done = kiln.run("bake", "box.toml", "--out", str(small_disk))
    assert done.returncode == 3
    assert "cannot write" in done.stderr
    assert named(small_disk) == before
    assert len(list(small_disk.iterdir())) == len(before)


@pytest.mark.skipif(os.geteuid() != 0, reason="needs another user, whom only root can become")
def test_a_folder_that_may_not_be_written(kiln: Kiln) -> None:
    kiln.write(sphere(1))
    out = kiln.folder / "out"
    out.mkdir(mode=0o755)
    for folder in [kiln.folder, *kiln.folder.parents]:
        if folder.stat().st_mode & 0o005 != 0o005:
            folder.chmod(folder.stat().st_mode | 0o005)

    def nobody() -> None:
        os.setgid(65534)
        os.setuid(65534)

    running = start(kiln, "bake", "model.toml", "--out", "out", before=nobody)
    _, said = running.communicate(timeout=60)
    assert running.returncode == 3, said
    assert b"permission denied" in said
    assert list(out.iterdir()) == []


def test_a_document_that_changes_while_it_is_baked(kiln: Kiln, tried: Callable[[str, int], None]) -> None:
    versions = both(kiln)
    stop = threading.Event()

    def change() -> None:
        texts = [sphere(1.0), sphere(1.5)]
        turn = 0
        while not stop.is_set():
            turn += 1
            # As editors save: a whole file under another name, then renamed.
            path = kiln.folder / "next.toml"
            path.write_text(texts[turn % 2], encoding="utf-8")
            path.rename(kiln.folder / "model.toml")

    changer = threading.Thread(target=change)
    changer.start()
    try:
        for _ in range(40):
            done = kiln.run("bake", "model.toml", "--out", "out", "--cache", "cache")
            assert done.returncode == 0, done.stderr
            assert named(kiln.folder / "out") in versions
    finally:
        stop.set()
        changer.join()
    tried("changing-documents", 40)


def test_an_output_folder_that_vanishes(kiln: Kiln) -> None:
    (kiln.folder / "specs").mkdir()
    for index in range(8):
        kiln.write(sphere(index + 1), f"specs/s{index}")
    stop = threading.Event()

    def remove() -> None:
        while not stop.is_set():
            shutil.rmtree(kiln.folder / "out", ignore_errors=True)

    remover = threading.Thread(target=remove)
    remover.start()
    try:
        for _ in range(15):
            done = kiln.run("bake", "specs", "--out", "out")
            assert done.returncode in (0, 3), done.stderr
            assert "panicked" not in done.stderr
    finally:
        stop.set()
        remover.join()
    assert kiln.run("bake", "specs", "--out", "out").returncode == 0
    assert len(named(kiln.folder / "out")) == 16
