"""`bake --memory`, measured from outside: the most that the system gave to the whole process."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from kiln import Kiln

COUNT = 6
HEAVY = "[shape.s]\ntolerance = 0.00001\n[shape.s.sphere]\nradius = RADIUS\n"
LIGHT = "[shape.s.box]\nsize = [1, 1, 1]\n"
MEGABYTE = 1_000_000


def peak(kiln: Kiln, *words: str) -> int:
    """Bakes, and gives the bytes of memory that the process had at its most."""
    code, most, told = kiln.measured("bake", *words)
    assert code == 0, told
    return most


def outputs(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_heavy_documents_wait_for_one_another(kiln: Kiln) -> None:
    (kiln.folder / "specs").mkdir()
    for index in range(COUNT):
        kiln.write(HEAVY.replace("RADIUS", str(1 + index / 100)), f"specs/heavy{index}")
        kiln.write(LIGHT, f"specs/light{index}")
    own = peak(kiln, "specs/light0.toml", "--out", "light")
    one = peak(kiln, "specs/heavy0.toml", "--out", "one") - own
    jobs = ("specs", "--jobs", str(COUNT))
    free = peak(kiln, *jobs, "--out", "free") - own
    # Each is guessed at 97 MB, so two stand in 200 at one time.
    bound = peak(kiln, *jobs, "--memory", "200 MB", "--out", "bound") - own
    # The allocator keeps a little of what other threads gave back.
    assert bound < 240 * MEGABYTE, (own, one, free, bound)
    assert free > 1.5 * bound, (own, one, free, bound)
    # One alone is always baked, however little it is.
    least = peak(kiln, *jobs, "--memory", "1 MB", "--out", "least") - own
    assert least < free / 2, (own, one, free, least)
    assert outputs(kiln.folder / "free") == outputs(kiln.folder / "bound") == outputs(kiln.folder / "least")


def test_errors_are_told_in_order_whatever_waits(kiln: Kiln) -> None:
    (kiln.folder / "specs").mkdir()
    for index in range(8):
        kiln.write(LIGHT if index % 2 else "[shape.s.box]\nsize = [1, -1, 1]\n", f"specs/s{index}")
    plain = kiln.run("bake", "specs", "--out", "out", "--format", "json")
    held = kiln.run("bake", "specs", "--out", "out", "--format", "json", "--memory", "2 MB", "--jobs", "3")
    assert (held.returncode, held.stdout) == (plain.returncode, plain.stdout) and held.returncode == 1
    assert kiln.run("bake", "specs", "--memory", "lots").returncode == 2
