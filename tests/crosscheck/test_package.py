"""What is published: the sources and the papers that go with them, and nothing else that lies about."""

from __future__ import annotations

import json
import subprocess
import tarfile
import urllib.request
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAPERS = {"CHANGELOG.md", "Cargo.lock", "Cargo.toml", "LICENSE-APACHE", "LICENSE-MIT", "README.md"}
MADE = {".cargo_vcs_info.json", "Cargo.toml.orig"}


def test_the_package_holds_the_sources_and_nothing_else() -> None:
    words = ["cargo", "package", "--list", "--allow-dirty", "--offline"]
    listed = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    sources = {path for path in listed if path.startswith("src/")}
    assert set(listed) - sources == PAPERS | MADE
    on_disk = {str(path.relative_to(ROOT)) for path in (ROOT / "src").rglob("*") if path.is_file()}
    assert sources == on_disk


def test_licenses_of_all_that_is_linked_are_at_hand(tmp_path: Path) -> None:
    out = tmp_path / "THIRD-PARTY.txt"
    script = ROOT / "scripts" / "licenses.py"
    done = subprocess.run(["python3", script, out], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    text = out.read_text(encoding="utf-8")
    for crate in ("blake3", "meshopt", "rustls", "glam"):
        assert f"\n{crate} " in text, crate
    assert text.count("=" * 80) > 100


def test_a_release_has_the_viewer_beside_the_program(program: Path, tmp_path: Path) -> None:
    """Unpacked where npm installed nothing, its pages show models by three.js; the repository holds no copy of that."""
    subprocess.run([ROOT / "scripts" / "package", program, "kiln-test"], cwd=tmp_path, check=True, timeout=300)
    elsewhere = tmp_path / "elsewhere"
    with tarfile.open(tmp_path / "kiln-test.tar.gz") as archive:
        archive.extractall(elsewhere, filter="data")
    folder = elsewhere / "kiln-test"
    there = {path.name for path in folder.iterdir()}
    assert {"THIRD-PARTY.txt", "README.md", "LICENSE-MIT", "man", "completions", "three", program.name} <= there
    assert "three.js authors" in (folder / "three" / "LICENSE").read_text(encoding="utf-8")
    (elsewhere / "box.toml").write_text("[shape.s.box]\nsize = [1, 1, 1]\n", encoding="utf-8")
    line = [folder / program.name, "--format", "json", "watch", "box.toml", "--port", "0"]
    with subprocess.Popen(line, cwd=elsewhere, stdout=subprocess.PIPE, text=True) as watch:
        try:
            assert watch.stdout is not None
            address = next(said["address"] for said in map(json.loads, watch.stdout) if "address" in said)
            read = lambda path: urllib.request.urlopen(f"{address}{path}", timeout=30).read()  # noqa: E731 -- used thrice
            assert b'data-viewer="three"' in read("")
            installed = (ROOT / "scripts" / "node_modules" / "three" / "build" / "three.module.js").read_bytes()
            assert read("three/build/three.module.js") == installed
            assert read("three/examples/jsm/loaders/GLTFLoader.js")
        finally:
            watch.kill()
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert "three.module.js" not in tracked
