"""What asks for too much is refused with the limit that it passes, and memory measured from outside stays below it.

A document may take what `memory` says and 64 MB beside it: the program itself, and what its allocator keeps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

if TYPE_CHECKING:
    from collections.abc import Callable

    from kiln import Kiln

MEGABYTE = 1_000_000
BESIDE = 64 * MEGABYTE
LIMIT = 96 * MEGABYTE
BOX = "[shape.s.box]\nsize = [1, 1, 1]\n"
BALL = "[shape.a.sphere]\nradius = 1\n"
MAP = "[map.m.noise]\nseed = 1\nhills = [4, 4]\ncolumns = {0}\nrows = {0}\n"


def baked(kiln: Kiln, text: str) -> tuple[int, int, str]:
    """Exit code, bytes of memory at the most, and what was told."""
    kiln.write(text)
    return kiln.measured("bake", "model.toml", "--out", "out", seconds=300)


# What grows without end as a number grows: (its document, numbers from little to far too much).
GROWING: dict[str, tuple[Callable[[float], str], list[float]]] = {
    "surface": (lambda t: f"[shape.s]\ntolerance = {t}\n[shape.s.sphere]\nradius = 1\n", [1e-4, 1e-5, 2e-6, 1e-8]),
    "sweep": (
        lambda t: (
            f"[shape.s]\ntolerance = {t}\n[shape.s.sweep]\nprofile = {{ circle = {{ radius = 0.1 }} }}\n"
            "path = { spline = { points = [[0, 0, 0], [1, 1, 0], [2, 0, 1]] } }\n"
        ),
        [1e-5, 1e-6, 1e-8],
    ),
    "formula": (
        lambda t: (
            f"[shape.s]\ntolerance = {t}\n[shape.s.parametric]\nx = '= u'\ny = '= sin(u * 360) * sin(v * 360)'\n"
            "z = '= v'\nu = [0, 1]\nv = [0, 1]\n"
        ),
        [1e-4, 1e-5, 1e-7],
    ),
    "field": (
        lambda t: f"[shape.s]\ntolerance = {t}\n[shape.s.implicit]\nfield = {{ sphere = {{ radius = 1 }} }}\n",
        [3e-4, 6e-5, 1e-8],
    ),
    "distance": (
        lambda t: (
            f"tolerance = {t}\n[field.f.shape]\nof = 'a'\n[shape.s.implicit]\nfield = 'f'\n"
            "[shape.a.torus]\nradius = 1\ntube-radius = 0.3\n[node.n]\nshape = 's'\n"
        ),
        [1e-2, 1e-4, 1e-8],
    ),
    "solid": (
        lambda t: (
            f"tolerance = {t}\n[shape.s.difference]\nof = ['a', 'b']\n{BALL}[shape.b]\nat = [0.5, 0, 0]\n"
            "[shape.b.sphere]\nradius = 1\n"
        ),
        [1e-3, 2e-4, 1e-4, 1e-6],
    ),
    "hull": (lambda t: f"tolerance = {t}\n[shape.s.hull]\nof = ['a']\n{BALL}", [1e-4, 3e-5, 1e-6]),
    "round": (
        lambda t: f"[shape.s]\ntolerance = {t}\n[shape.s.minkowski-round]\nof = 'a'\nradius = 0.1\n{BALL}",
        [3e-2, 1e-3, 3e-5, 1e-7],
    ),
    "bend": (
        lambda t: (
            f"[shape.s]\ntolerance = {t}\n[shape.s.twist]\nof = 'a'\nangle = 90\n[shape.a.box]\nsize = [1, 4, 1]\n"
        ),
        [1e-4, 3e-5, 1e-5, 1e-7],
    ),
    "displacement": (
        lambda t: (
            "[map.m.formula]\nf = '= 0.3'\ncolumns = 65\nrows = 65\n"
            f"[shape.s]\ntolerance = {t}\n[shape.s.displace]\nof = 'a'\nmap = 'm'\nrange = [0, 0.2]\n{BALL}"
        ),
        [1e-3, 1e-4, 3e-5, 1e-7],
    ),
    "map": (
        lambda n: (
            f"{MAP.format(int(n))}[shape.s]\ntolerance = 0.01\n[shape.s.height-map]\nmap = 'm'\nsize = [4, 4]\n"
            "range = [0, 1]\nclose = 'base'\nbase = -1\n"
        ),
        [513, 2049, 8193, 1e6],
    ),
    "cage": (
        lambda n: f"[shape.s.subdivide]\ncage = 'a'\nlevels = {int(n)}\n[shape.a.box]\nsize = [1, 1, 1]\n",
        [5, 7, 8, 12],
    ),
    "copies": (
        lambda n: (
            f"[shape.s.array]\nof = 'a'\ncount = [{int(n)}, 1, 1]\noffset = [3, 0, 0]\n[shape.a]\ntolerance = 0.001\n"
            "[shape.a.sphere]\nradius = 1\n"
        ),
        [16, 100, 400, 1e6],
    ),
    "levels": (
        lambda t: f"[lod]\nlevels = 4\n[shape.s]\ntolerance = {t}\n[shape.s.sphere]\nradius = 1\n",
        [1e-4, 1e-5, 1e-7],
    ),
}


@pytest.mark.parametrize("kind", GROWING)
def test_memory_stays_below_its_limit(kiln: Kiln, kind: str, tried: Callable[[str, int], None]) -> None:
    """What is made takes no more than it may, and what would take more is refused before it is taken."""
    document, numbers = GROWING[kind]
    own = baked(kiln, BOX)[1]
    codes = []
    for number in numbers:
        code, peak, told = baked(kiln, f"{document(number)}[limits]\nmemory = {LIMIT}\n")
        assert peak < own + LIMIT + BESIDE, (number, peak, told)
        assert code in (0, 1), told
        assert code == 0 or "K0901" in told, told
        codes.append(code)
    assert codes[0] == 0, "the least is made"
    assert codes[-1] == 1, "the most is refused"
    tried(f"limits-{kind}", len(numbers))


# What is refused at once: (its document, the words of the refusal).
REFUSED = {
    "triangles": (f"[limits]\ntriangles = 1000\n[shape.a]\ntolerance = 1e-4\n{BALL}", "K0901"),
    "vertices": (f"[limits]\nvertices = 100\n[shape.a]\ntolerance = 1e-2\n{BALL}", "K0901"),
    "steps": (
        "[limits]\nsteps = 1000\n[curve.c.polyline]\npoints = { count = 5000, each = '= [i, sin(i), 0]' }\n"
        "[shape.s.sweep]\npath = 'c'\nprofile = { circle = { radius = 0.1 } }\n",
        "K0407",
    ),
    "steps of a map": (
        f"{MAP.format(501)}[shape.s.height-map]\nmap = 'm'\nsize = [1, 1]\n[limits]\nsteps = 100000\n",
        "K0901",
    ),
    "pixels": (
        f"[limits]\nimage-pixels = 1000\n{MAP.format(33)}[shape.s.height-map]\nmap = 'm'\nsize = [1, 1]\n",
        "K0901",
    ),
    "copies of copies": (
        "".join(f"[shape.g{i}.group]\nof = ['g{i + 1}', 'g{i + 1}']\n" for i in range(40))
        + "[shape.g40.box]\nsize = [1, 1, 1]\n[node.n]\nshape = 'g0'\n",
        "K0901",
    ),
    "list": (
        "[curve.c.polyline]\npoints = { count = 1000000000, each = '= [i, sin(i), 0]' }\n"
        "[shape.s.sweep]\npath = 'c'\nprofile = { circle = { radius = 0.1 } }\n",
        "K0407",
    ),
    "brackets": ("[shape.s.box]\nsize = '= [1, 1, " + "(" * 2000 + "1" + ")" * 2000 + "]'\n", "K0407"),
    "long expression": ("[shape.s.box]\nsize = '= [1, 1, " + " + ".join(["1"] * 100000) + "]'\n", "K0407"),
    "parameters": (
        "[parameters]\n" + "".join(f"p{i} = '= p{i + 1}'\n" for i in range(3000)) + f"p3000 = 1\n{BOX}",
        "K0407",
    ),
    "arrays": ("x = " + "[" * 100000 + "]" * 100000, "K0006"),
    "tables": ("x = " + "{ a = " * 50000 + "1" + " }" * 50000, "K0006"),
    "dotted key": ("[" + ".".join(["a"] * 50000) + "]", "K0005"),
    "shapes": (
        "".join(f"[shape.g{i}.group]\nof = ['g{i + 1}']\n" for i in range(3000))
        + "[shape.g3000.box]\nsize = [1, 1, 1]\n[node.n]\nshape = 'g0'\n",
        "K0006",
    ),
    "nodes": (
        BOX + "".join(f"[node.n{i}]\nparent = 'n{i + 1}'\n" for i in range(3000)) + "[node.n3000]\nshape = 's'\n",
        "K0006",
    ),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_too_much_of_each_resource_is_refused(kiln: Kiln, kind: str, tried: Callable[[str, int], None]) -> None:
    text, code = REFUSED[kind]
    own = baked(kiln, BOX)[1]
    status, peak, told = baked(kiln, text)
    assert status == 1, told
    assert code in told, told[:1000]
    assert peak < own + BESIDE
    tried(f"refused-{kind.replace(' ', '-')}", 1)


def test_includes_without_end_are_refused(kiln: Kiln, tried: Callable[[str, int], None]) -> None:
    own = baked(kiln, BOX)[1]
    for number in range(200):
        kiln.write(f"include = ['part{number + 1}.toml']\n", f"part{number}")
    kiln.write(BOX, "part200")
    status, peak, told = baked(kiln, "include = ['part0.toml']\n")
    assert status == 1, told
    assert "K0006" in told, told[:1000]
    assert peak < own + BESIDE
    tried("refused-includes", 1)


def test_a_picture_of_many_pixels_is_refused_before_it_is_unpacked(
    kiln: Kiln, tried: Callable[[str, int], None]
) -> None:
    """Four hundred million pixels of one color are a file of half a megabyte."""
    Image.MAX_IMAGE_PIXELS = None
    Image.fromarray(np.zeros((20000, 20000), np.uint8)).save(kiln.folder / "flat.png")
    own = baked(kiln, BOX)[1]
    texture = "[shape.s]\nmaterial = 'm'\n[shape.s.box]\nsize = [1, 1, 1]\n[material.m]\ncolor-texture = 'flat.png'\n"
    ground = "[map.m.image]\nfile = 'flat.png'\n[shape.s.height-map]\nmap = 'm'\nsize = [1, 1]\n"
    small = f"[limits]\nmemory = {LIMIT}\n"
    Image.fromarray(np.zeros((5000, 5000), np.uint8)).save(kiln.folder / "less.png")
    for text in (texture, ground, small + texture.replace("flat", "less"), small + ground.replace("flat", "less")):
        status, peak, told = baked(kiln, text)
        assert status == 1, told
        assert "pixels" in told or "samples" in told, told
        assert peak < own + BESIDE
    tried("refused-pictures", 4)
