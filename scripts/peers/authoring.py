"""The `authoring` part of the bench: a first picture of large files beside Blender's, and how soon an editor is told.

Blender draws one sample a pixel, without its denoiser; Kiln sixteen, with shadows. The editor opens a document of a
thousand lines, and after each change of one number waits for what is wrong with it.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import time
from typing import TYPE_CHECKING, Any

from peers import packing
from peers.process import Runs, together

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

SIZE = 1024
LINES = 1000
CHANGES = 40


def measure(kiln: Path, blender: list[str], folder: Path, runs: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """Pictures of each input by both, in turn, then the editor."""
    rows: list[dict[str, Any]] = []
    for case, make in (("terrain", packing.terrain), ("surface", packing.surface)):
        source = folder / f"{case}.in.glb"
        make(source)
        own, other = folder / f"{case}-kiln.png", folder / f"{case}-blender.png"
        entries = [
            Runs("Kiln", [str(kiln), "render", str(source), "-o", str(own), "--size", str(SIZE), "--quiet"], own),
            Runs("Blender", [*blender, str(source), str(other), str(SIZE)], other),
        ]
        together(entries, runs, folder, tell)
        base = entries[0].median if entries[0].failure is None else None
        for entry in entries:
            good = entry.failure is None
            rows.append(
                {
                    "work": f"picture of the {case}, a million triangles",
                    "tool": entry.name,
                    "failure": entry.failure,
                    "seconds": entry.median if good else None,
                    "times-kiln": entry.median / base if good and base else None,
                }
            )
    tell("typing")
    rows.append(typing(kiln, folder))
    return {"rows": rows}


def document(radius: float) -> str:
    """A document of a thousand lines: forms of all sorts, and one number that changes."""
    lines = ["tolerance = 0.01", "[material.clay]", 'color = "#a06040"', "[shape.first]", 'material = "clay"']
    lines += ["[shape.first.sphere]", f"radius = {radius}"]
    number = 0
    while len(lines) < LINES - 5:
        number += 1
        lines += [
            f"[curve.c{number}.natural-spline]",
            f"points = [[0.1, 0], [{0.3 + number / 1000}, 0.5], [0.2, 1]]",
            f"[shape.s{number}]",
            'material = "clay"',
            f"at = [{number}, 0, 0]",
            f"[shape.s{number}.revolve]",
            f'profile = "c{number}"',
        ]
    return "\n".join(lines) + "\n"


def typing(kiln: Path, folder: Path) -> dict[str, Any]:
    """The median time from a change to what is told of it."""
    path = folder / "long.toml"
    path.write_text(document(1.0), encoding="utf-8")
    server = subprocess.Popen([str(kiln), "lsp"], cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def send(method: str, params: dict[str, Any], number: int | None = None) -> None:
        message = {"jsonrpc": "2.0", "method": method, "params": params}
        body = json.dumps(message | ({"id": number} if number is not None else {})).encode()
        server.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        server.stdin.flush()

    def hear(wanted: Callable[[dict[str, Any]], bool]) -> None:
        while True:
            length = 0
            while (line := server.stdout.readline().strip()) != b"":
                name, _, value = line.partition(b":")
                length = int(value) if name.lower() == b"content-length" else length
            if wanted(json.loads(server.stdout.read(length))):
                return

    uri, took = path.as_uri(), []
    try:
        send("initialize", {"processId": None, "rootUri": folder.as_uri(), "capabilities": {}}, 1)
        hear(lambda message: message.get("id") == 1)
        send("initialized", {})
        item = {"uri": uri, "languageId": "toml", "version": 0, "text": document(1.0)}
        send("textDocument/didOpen", {"textDocument": item})
        hear(lambda message: message.get("method") == "textDocument/publishDiagnostics")
        for change in range(1, CHANGES + 1):
            # Every second text has an error, so what is told changes each time.
            text = document(1.0 + change if change % 2 else -1.0)
            started = time.perf_counter()
            send(
                "textDocument/didChange",
                {"textDocument": {"uri": uri, "version": change}, "contentChanges": [{"text": text}]},
            )
            hear(
                lambda message, change=change: (
                    message.get("method") == "textDocument/publishDiagnostics"
                    and message["params"].get("version", change) == change
                )
            )
            took.append(time.perf_counter() - started)
    finally:
        server.kill()
        server.wait()
    return {
        "work": f"an editor is told of a change in {LINES} lines, median of {CHANGES}",
        "tool": "Kiln",
        "failure": None,
        "seconds": statistics.median(took),
        "times-kiln": None,
    }
