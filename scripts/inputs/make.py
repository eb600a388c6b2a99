"""Writes every input of the gallery: `python scripts/inputs/make.py [FOLDER]`."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from inputs import beetle, bird, caterpillar, crate, label, lamp, plate, windmill

SPECS = Path(__file__).resolve().parents[2] / "specs" / "inputs"


def main() -> None:
    """Write the files that are not there yet or differ."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else SPECS
    folder.mkdir(parents=True, exist_ok=True)
    label.draw().write(folder / "label.png")
    color, normal = crate.draw()
    color.write(folder / "crate-color.png")
    normal.write(folder / "crate-normal.png")
    (folder / "bird.obj").write_text(bird.obj(), encoding="utf-8")
    (folder / "caterpillar.md2").write_bytes(caterpillar.md2())
    (folder / "beetle.md3").write_bytes(beetle.md3())
    (folder / "windmill.3ds").write_bytes(windmill.studio())
    (folder / "plate.dxf").write_text(plate.dxf(), encoding="utf-8")
    (folder / "lamp.md5mesh").write_text(lamp.md5mesh(), encoding="utf-8")
    (folder / "lamp-bow.md5anim").write_text(lamp.md5anim(), encoding="utf-8")
    caterpillar.draw().write(folder / "caterpillar.png")


if __name__ == "__main__":
    main()
