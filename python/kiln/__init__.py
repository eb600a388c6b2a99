"""Bakes model specs into glTF from Python: a thin layer on what the command `kiln` prints as JSON.

    import kiln
    for asset in kiln.bake("specs", out="built", set={"height": 0.3}):
        print(asset.path, asset.triangles)

Promise: what is wrong with a document is raised as data, with the text that a person reads; the program runs once for
each call, and no output is half-written. Not promised: that the program is installed. It is the one named, else the one
of the variable `KILN`, else `kiln` of the search path.

The folder of this package is a Blender extension too, with the operator "Bake with Kiln" (see `blender`).
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

__all__ = ["Asset", "BakeError", "Diagnostic", "bake", "check", "find_program", "register", "unregister"]

ERRORS_IN_DOCUMENTS = 1  # the exit code; other failures are of files and of usage


@dataclass(frozen=True)
class Diagnostic:
    """What is said of a document, or of a file; lines and columns count from 1, and are missing without a place."""

    severity: str
    message: str
    code: str | None = None
    file: str | None = None
    line: int | None = None
    column: int | None = None
    help: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, item: Mapping[str, Any]) -> Diagnostic:
        """The diagnostic of an object that the program printed."""
        said = item.get("help") or []
        help_lines = (said,) if isinstance(said, str) else tuple(said)
        places = {name: item.get(name) for name in ("code", "file", "line", "column")}
        return cls(item["severity"], item["message"], help=help_lines, notes=tuple(item.get("notes") or ()), **places)

    def __str__(self) -> str:
        code = f"[{self.code}]" if self.code else ""
        place = f"{self.file}:{self.line}:{self.column}: " if self.file else ""
        return "\n".join([f"{place}{self.severity}{code}: {self.message}", *(f"  help: {line}" for line in self.help)])


@dataclass(frozen=True)
class Asset:
    """A baked file. `facts` is all that the program tells of it."""

    path: Path
    facts: Mapping[str, Any]

    @property
    def spec(self) -> str:
        """The document that it was made of, from the root of the project."""
        return self.facts["spec"]

    @property
    def variant(self) -> str | None:
        """The variant of the document that it shows, if it is one."""
        return self.facts["variant"]

    @property
    def profile(self) -> str:
        """For whom it is: `core`, `web` and so on."""
        return self.facts["profile"]

    @property
    def bytes(self) -> int:
        """Its size."""
        return self.facts["bytes"]

    @property
    def triangles(self) -> int | None:
        """How many triangles it has; none where no report was asked for."""
        return self.facts["triangles"]

    @property
    def report(self) -> dict[str, Any]:
        """The report beside it."""
        text = self.path.with_name(f"{self.path.stem}.report.json").read_text(encoding="utf-8")
        return json.loads(text)


class BakeError(Exception):
    """A bake that did not go well. Assets that did are written, and named in `assets`."""

    def __init__(self, code: int, diagnostics: list[Diagnostic], assets: list[Asset], said: str) -> None:
        self.code = code
        self.diagnostics = diagnostics
        self.assets = assets
        errors = [str(one) for one in diagnostics if one.severity == "error"]
        super().__init__("\n".join(errors) or said.strip() or f"kiln ended with exit code {code}")

    @property
    def of_documents(self) -> bool:
        """Whether documents are wrong, and not files or arguments."""
        return self.code == ERRORS_IN_DOCUMENTS


class Baked(list[Asset]):
    """The assets of a bake, in the order of documents; `warnings` is what a person should know of them."""

    def __init__(self, assets: Iterable[Asset], warnings: list[Diagnostic]) -> None:
        super().__init__(assets)
        self.warnings = warnings


def find_program(named: str | os.PathLike[str] | None = None) -> str:
    """The program that is run; `FileNotFoundError` tells where it was looked for."""
    wanted = os.fspath(named) if named else os.environ.get("KILN") or "kiln"
    found = shutil.which(wanted)
    if found is None:
        message = f"{wanted} is not found: install it with `cargo install kiln`, or name it in the variable KILN"
        raise FileNotFoundError(message)
    return found


def bake(
    *paths: str | os.PathLike[str],
    out: str | os.PathLike[str] | None = None,
    set: Mapping[str, float | bool | str] | None = None,  # noqa: A002 -- the option's name
    profile: Iterable[str] = (),
    options: Iterable[str] = (),
    directory: str | os.PathLike[str] | None = None,
    program: str | os.PathLike[str] | None = None,
) -> Baked:
    """Bakes documents, folders of them, or (without paths) the project of the directory's `kiln.toml`.

    `set` gives parameters, `profile` says for whom files are, `options` are further words of the command line
    (`kiln bake --help`), and `directory` is where it runs, the working directory when it is not given. Raises
    `BakeError` where a document is wrong or a file cannot be written.
    """
    words = ["bake", *(word for one in profile for word in ("--profile", one))]
    words += ["--out", os.fspath(out)] if out is not None else []
    return run([*words, *settings(set), *options, "--", *map(os.fspath, paths)], directory, program)


def check(
    *paths: str | os.PathLike[str],
    options: Iterable[str] = (),
    directory: str | os.PathLike[str] | None = None,
    program: str | os.PathLike[str] | None = None,
) -> list[Diagnostic]:
    """Everything that is wrong with documents, and what a person should know; nothing is written."""
    try:
        return run(["check", *options, "--", *map(os.fspath, paths)], directory, program).warnings
    except BakeError as error:
        if not error.of_documents:
            raise
        return error.diagnostics


def settings(given: Mapping[str, float | bool | str] | None) -> list[str]:
    """Parameters as words of the command line."""
    texts = {name: str(value).lower() if isinstance(value, bool) else value for name, value in (given or {}).items()}
    return [word for name, text in texts.items() for word in ("--set", f"{name}={text}")]


def run(words: list[str], directory: str | os.PathLike[str] | None, program: str | os.PathLike[str] | None) -> Baked:
    """Runs the program, and reads what it prints."""
    folder = Path(directory) if directory is not None else Path()
    done = subprocess.run(
        [find_program(program), "--format", "json", *words],
        cwd=folder,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    objects = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    assets = [Asset(folder / one["asset"], one) for one in objects if "asset" in one]
    diagnostics = [Diagnostic.of(one["diagnostic"]) for one in objects if "diagnostic" in one]
    if done.returncode != 0:
        raise BakeError(done.returncode, diagnostics, assets, done.stderr)
    return Baked(assets, diagnostics)


def register() -> None:
    """Puts the operator into Blender."""
    from . import blender

    blender.register()


def unregister() -> None:
    """Takes the operator out of Blender."""
    from . import blender

    blender.unregister()
