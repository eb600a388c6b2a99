"""What is published: the sources and the papers that go with them, and nothing else that lies about."""

from __future__ import annotations

import subprocess
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
