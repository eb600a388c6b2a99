"""The page of `kiln gallery` in a real browser, served as plain files."""

from __future__ import annotations

import functools
import http.server
import json
import shutil
import subprocess
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

if TYPE_CHECKING:
    from kiln import Kiln

ROOT = Path(__file__).resolve().parents[2]
THREE = ROOT / "scripts" / "node_modules" / "three"
SPECS = ["solids/mug", "table/wine-glass", "lofted/rowboat"]


class Quiet(http.server.SimpleHTTPRequestHandler):
    """A server of plain files that says nothing."""

    def log_message(self, *_: Any) -> None:
        """Say nothing."""


def made(kiln: Kiln, *options: str) -> Path:
    """A gallery of some specs, and of a document that is wrong."""
    for spec in SPECS:
        target = kiln.folder / "specs" / f"{spec}.toml"
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / "specs" / f"{spec}.toml", target)
    done = kiln.run("gallery", "specs", "-o", "site", *options)
    assert done.returncode == 0, done.stderr
    return kiln.folder / "site"


def seen(site: Path, picture: Path) -> dict[str, Any]:
    """What a browser sees of a page."""
    handler = functools.partial(Quiet, directory=str(site))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_address[1]}/index.html"
        line = ["node", str(Path(__file__).with_name("galleried.mjs")), address, str(picture)]
        done = subprocess.run(line, capture_output=True, text=True, timeout=120, check=False)
        server.shutdown()
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_every_model_has_a_picture_and_is_shown_by_the_viewer(kiln: Kiln) -> None:
    site, picture = made(kiln, "--three", str(THREE)), kiln.folder / "viewer.png"
    found = seen(site, picture)
    assert found["complaints"] == []
    names = sorted(SPECS)
    assert found["names"] == names
    assert found["pictures"] == [480] * 3
    assert found["shown"] == [f"models/{name}.glb" for name in names[:2]]
    pixels = np.asarray(Image.open(picture).convert("RGB"))
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 100
    # The files are those that are baked, and the text is that of the document.
    baked = kiln.run("bake", "specs/solids/mug.toml", "--out", "out")
    assert baked.returncode == 0
    assert (site / "models/solids/mug.glb").read_bytes() == (kiln.folder / "out/mug.glb").read_bytes()
    page = (site / "index.html").read_text(encoding="utf-8")
    assert "[shape." in page
    assert "triangles" in page


def test_without_three_there_are_pictures(kiln: Kiln) -> None:
    site = made(kiln)
    found = seen(site, kiln.folder / "none.png")
    assert found["complaints"] == []
    assert found["pictures"] == [480] * 3
    assert not found["viewer"]
    first = {path: path.read_bytes() for path in site.rglob("*") if path.is_file()}
    made(kiln)
    assert first == {path: path.read_bytes() for path in site.rglob("*") if path.is_file()}


def test_what_is_wrong_is_said_and_the_rest_is_shown(kiln: Kiln) -> None:
    kiln.write("# A <b>box</b> & more\n[shape.s.box]\nsize = [1, 1, 1]\n", "good")
    kiln.write("[shape.s.box]\nsise = [1, 1, 1]\n", "wrong")
    done = kiln.run("gallery", "good.toml", "wrong.toml", "-o", "site")
    assert done.returncode == 1
    assert "sise" in done.stderr
    page = (kiln.folder / "site" / "index.html").read_text(encoding="utf-8")
    assert "<p>A &lt;b&gt;box&lt;/b&gt; &amp; more</p>" in page
    assert "wrong" not in page
    assert kiln.run("gallery", "none.toml").returncode == 3


def test_the_whole_gallery(kiln: Kiln) -> None:
    """The project's own: every document is there, each with its picture, and nothing complains."""
    shutil.copytree(ROOT / "specs", kiln.folder / "specs")
    done = kiln.run("gallery", "specs", "-o", "site", "--three", str(THREE), seconds=1200)
    assert done.returncode == 0, done.stderr
    found = seen(kiln.folder / "site", kiln.folder / "viewer.png")
    assert found["complaints"] == []
    tables = [path for path in (ROOT / "specs").rglob("*.toml") if "[shape." in path.read_text(encoding="utf-8")]
    assert set(found["names"]) >= {str(path.relative_to(ROOT / "specs").with_suffix("")) for path in tables}
    assert found["pictures"] == [480] * len(found["names"])
    assert len(found["names"]) > 100
