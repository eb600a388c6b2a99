"""Caches that machines share: an HTTP server of this test's own, and an object store that speaks S3."""

from __future__ import annotations

import hashlib
import hmac
import json
import os
import shutil
import socket
import subprocess
import threading
import time
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kiln import Kiln

SECRET = "Bearer of-bad-news"


@pytest.fixture(autouse=True)
def built_with_remote(kiln: Kiln) -> None:
    """Shared caches are a feature of the build."""
    kiln.write("[shape.s.box]\nsize = [1, 1, 1]\n", "probe")
    done = kiln.run("bake", "probe.toml", "--out", "probed", "--cache", "probing", "--remote-cache", "nowhere")
    (kiln.folder / "probe.toml").unlink()
    if "feature `remote`" in done.stderr:
        pytest.fail("the program is built without shared caches: cargo build --features remote")


@dataclass
class Server:
    """What a server keeps, and how it misbehaves."""

    kept: dict[str, bytes] = field(default_factory=dict)
    asked: list[tuple[str, str, str | None]] = field(default_factory=list)
    status: int | None = None
    delay: float = 0
    failures: int = 0
    url: str = ""


@pytest.fixture
def server() -> Iterator[Server]:
    """A server on loopback that stores what is put, as Bazel's remote caches do."""
    state = Server()

    class Handler(BaseHTTPRequestHandler):
        def answer(self, status: int, body: bytes = b"") -> None:
            self.send_response(status)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def misbehaves(self) -> bool:
            state.asked.append((self.command, self.path, self.headers.get("Authorization")))
            time.sleep(state.delay)
            if state.failures > 0:
                state.failures -= 1
                self.answer(503)
                return True
            if state.status is not None:
                self.answer(state.status)
                return True
            return False

        def do_GET(self) -> None:
            if self.misbehaves():
                return
            body = state.kept.get(self.path.split("?")[0])
            self.answer(404) if body is None else self.answer(200, body)

        def do_PUT(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            if not self.misbehaves():
                state.kept[self.path.split("?")[0]] = body
                self.answer(201)

        def log_message(self, *_: object) -> None:
            pass

    http = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    http.daemon_threads = True
    threading.Thread(target=http.serve_forever, daemon=True).start()
    state.url = f"http://127.0.0.1:{http.server_address[1]}/bucket"
    yield state
    http.shutdown()
    http.server_close()


SPEC = """[shape.s]
material = "red"
[shape.s.union]
of = ["a", "b"]
[shape.a]
segments = [48, 24]
[shape.a.sphere]
radius = RADIUS
[shape.b]
segments = [48, 24]
[shape.b.sphere]
radius = 1
center = [0.5, 0.2, 0]
[material.red]
color = "#c03020"
"""
COUNT = 3


def prepare(kiln: Kiln) -> dict[str, bytes]:
    """Writes the documents; what a bake without any cache makes of them."""
    (kiln.folder / "specs").mkdir()
    for index in range(COUNT):
        kiln.write(SPEC.replace("RADIUS", str(1 + index / 4)), f"specs/s{index}")
    assert kiln.run("bake", "specs", "--out", "plain").returncode == 0
    return outputs(kiln.folder / "plain")


def outputs(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def bake(kiln: Kiln, machine: str, *more: str, **environment: str) -> tuple[dict[str, int], list[str]]:
    """Bakes as a machine with a folder of its own; what was found, and the warnings."""
    shutil.rmtree(kiln.folder / "out", ignore_errors=True)
    arguments = ["bake", "specs", "--out", "out", "--cache", machine, "--format", "json", "--verbose", *more]
    clean = {name: value for name, value in os.environ.items() if not name.upper().endswith("_PROXY")}
    done = subprocess.run(
        [str(kiln.program), *arguments],
        cwd=kiln.folder,
        env=clean | environment,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    (found,) = [line["cache"] for line in lines if "cache" in line]
    warnings = [line["diagnostic"]["message"] for line in lines if "diagnostic" in line]
    everything = done.stdout + done.stderr
    assert "of-bad-news" not in everything
    assert "Signature" not in everything
    return {"hits": found["hits"], **found["shapes"]}, warnings


def test_another_machine_finds_what_one_baked(kiln: Kiln, server: Server) -> None:
    right = prepare(kiln)
    # Who only reads stores nothing.
    found, warnings = bake(kiln, "reader", "--remote-cache", server.url)
    assert (found["hits"], found["found"], warnings) == (0, 0, [])
    # Solids are kept in the folder, and so is an operand that took as long to make as to read.
    assert found["kept"] >= COUNT
    assert server.kept == {}
    found, warnings = bake(kiln, "one", "--remote-cache", server.url, "--remote-cache-write")
    assert (found["hits"], warnings) == (0, [])
    assert {path.split("/")[2] for path in server.kept} == {"ac", "cas"}
    assert bake(kiln, "two", "--remote-cache", server.url) == ({"hits": COUNT, "found": 0, "kept": 0}, [])
    assert outputs(kiln.folder / "out") == right
    # Now it is in the folder, and nobody is asked.
    server.asked.clear()
    assert bake(kiln, "two", "--remote-cache", server.url)[0]["hits"] == COUNT
    assert server.asked == []
    # Another color finds the shapes.
    for index in range(COUNT):
        path = kiln.folder / "specs" / f"s{index}.toml"
        path.write_text(path.read_text().replace("#c03020", "#3020c0"))
    assert bake(kiln, "three", KILN_REMOTE_CACHE=server.url)[0] == {"hits": 0, "found": COUNT, "kept": 0}
    assert bake(kiln, "four")[0]["found"] == 0


def test_a_project_names_a_shared_cache_and_gives_no_secret_away(kiln: Kiln, server: Server) -> None:
    prepare(kiln)
    remote = f'[cache.remote]\nurl = "{server.url}"\nwrite = true\ntimeout = 5\n'
    kiln.write('roots = ["specs"]\n' + remote, "kiln")
    assert bake(kiln, "one", KILN_REMOTE_AUTHORIZATION=SECRET)[1] == []
    assert len(server.kept) > 2 * COUNT
    assert {authorization for _, _, authorization in server.asked} == {None}
    # Who names the server himself is told to it.
    server.asked.clear()
    bake(kiln, "two", "--remote-cache", server.url, KILN_REMOTE_AUTHORIZATION=SECRET)
    assert {authorization for _, _, authorization in server.asked} == {SECRET}
    # `--no-cache` asks nobody.
    server.asked.clear()
    assert kiln.run("bake", "--no-cache").returncode == 0
    assert server.asked == []


@pytest.mark.parametrize("harm", ["cut", "flipped", "swapped", "empty"])
def test_what_is_broken_on_the_server_is_ignored(kiln: Kiln, server: Server, harm: str) -> None:
    right = prepare(kiln)
    bake(kiln, "one", "--remote-cache", server.url, "--remote-cache-write")
    whole = dict(server.kept)
    bodies = list(whole.values())
    for index, (path, body) in enumerate(whole.items()):
        server.kept[path] = {
            "cut": body[: len(body) // 2],
            "flipped": body[:-1] + bytes([body[-1] ^ 1]),
            "swapped": bodies[index - 1],
            "empty": b"",
        }[harm]
    found, warnings = bake(kiln, "two", "--remote-cache", server.url)
    assert (found["hits"], found["found"]) == (0, 0)
    assert outputs(kiln.folder / "out") == right
    (warning,) = warnings
    assert "broken entries of the shared cache" in warning
    # Objects alone: the manifests are right, and lead to what is not.
    server.kept = {path: body[::-1] if "/cas/" in path else body for path, body in whole.items()}
    assert bake(kiln, "three", "--remote-cache", server.url)[0]["hits"] == 0
    assert outputs(kiln.folder / "out") == right


def test_a_server_that_fails_for_a_moment_is_asked_again(kiln: Kiln, server: Server) -> None:
    prepare(kiln)
    bake(kiln, "one", "--remote-cache", server.url, "--remote-cache-write")
    server.failures = 2
    assert bake(kiln, "two", "--remote-cache", server.url, "--jobs", "1") == (
        {"hits": COUNT, "found": 0, "kept": 0},
        [],
    )


@pytest.mark.parametrize(("status", "words"), [(500, "status 500"), (403, "it refuses (status 403)"), (302, "302")])
def test_a_server_that_refuses_is_left_alone_with_one_warning(
    kiln: Kiln, server: Server, status: int, words: str
) -> None:
    right = prepare(kiln)
    server.status = status
    found, warnings = bake(kiln, "one", "--remote-cache", server.url, "--remote-cache-write", "--jobs", "1")
    assert found["hits"] == 0
    assert outputs(kiln.folder / "out") == right
    (warning,) = warnings
    assert warning.startswith(f"the shared cache {server.url} is left alone: ")
    assert words in warning
    assert len(server.asked) <= 3
    # What was baked is in the folder.
    assert bake(kiln, "one")[0]["hits"] == COUNT


def test_a_slow_server_costs_one_timeout(kiln: Kiln, server: Server) -> None:
    right = prepare(kiln)
    server.delay = 30
    start = time.monotonic()
    _, warnings = bake(kiln, "one", "--remote-cache", server.url, "--remote-cache-timeout", "0.5")
    assert time.monotonic() - start < 25
    assert outputs(kiln.folder / "out") == right
    assert [warning.endswith("it is too slow") for warning in warnings] == [True]


def test_a_server_that_dies_during_a_bake_stops_nothing(kiln: Kiln) -> None:
    right = prepare(kiln)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]

        def die() -> None:
            # The first request is cut off in the middle of its answer, and then nobody listens.
            connection, _ = listener.accept()
            connection.recv(4096)
            connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 100000\r\n\r\nhalf of")
            listener.close()
            connection.close()

        killer = threading.Thread(target=die, daemon=True)
        killer.start()
        _, warnings = bake(kiln, "one", "--remote-cache", f"http://127.0.0.1:{port}", "--remote-cache-write")
        killer.join(timeout=20)
    assert outputs(kiln.folder / "out") == right
    (warning,) = warnings
    assert "is left alone" in warning


def test_what_is_no_address_is_told(kiln: Kiln) -> None:
    prepare(kiln)
    for url, words in (("ftp://x/y", "is no address"), ("http://me:of-bad-news@x/", "holds no password")):
        _, warnings = bake(kiln, "one", "--remote-cache", url)
        (warning,) = warnings
        assert words in warning
    done = kiln.run("bake", "specs", "--remote-cache", "http://127.0.0.1:9/")
    assert done.returncode == 0
    assert "needs a folder" in done.stderr


@pytest.fixture
def store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """An object store on loopback, with a bucket `bucket` and one user."""
    folder = tmp_path_factory.mktemp("store")
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    program = Path(__file__).resolve().parents[2] / "scripts" / "node_modules" / "s3rver" / "bin" / "s3rver.js"
    if not program.is_file():
        pytest.fail("there is no s3rver: run scripts/setup")
    process = subprocess.Popen(
        ["node", program, "-d", folder, "-a", "127.0.0.1", "-p", str(port), "--configure-bucket", "bucket", "-s"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        until = time.monotonic() + 30
        while True:
            try:
                socket.create_connection(("127.0.0.1", port), timeout=1).close()
                break
            except OSError:
                assert process.poll() is None, "the store did not start"
                assert time.monotonic() < until, "the store does not answer"
                time.sleep(0.1)
        yield f"http://127.0.0.1:{port}"
    finally:
        process.kill()
        process.wait()


def test_an_object_store_is_a_shared_cache(kiln: Kiln, store: str, tmp_path: Path) -> None:
    right = prepare(kiln)
    environment = {
        "AWS_ENDPOINT_URL_S3": store,
        "AWS_ACCESS_KEY_ID": "S3RVER",
        "AWS_SECRET_ACCESS_KEY": "S3RVER",
        "AWS_REGION": "eu-central-1",
    }
    arguments = ("--remote-cache", "s3://bucket/kiln/one", "--remote-cache-write")
    found, warnings = bake(kiln, "one", *arguments, **environment)
    assert (found["hits"], warnings) == (0, [])
    # Keys from the file of the AWS tools.
    (tmp_path / "keys").write_text("[bucket]\naws_access_key_id = S3RVER\naws_secret_access_key = S3RVER\n")
    of_file = {
        "AWS_ENDPOINT_URL": store,
        "AWS_SHARED_CREDENTIALS_FILE": str(tmp_path / "keys"),
        "AWS_PROFILE": "bucket",
    }
    assert bake(kiln, "two", *arguments, **of_file) == ({"hits": COUNT, "found": 0, "kept": 0}, [])
    assert outputs(kiln.folder / "out") == right
    # Nobody is refused, and told without what he said.
    wrong = environment | {"AWS_ACCESS_KEY_ID": "nobody", "AWS_SECRET_ACCESS_KEY": "of-bad-news"}
    _, warnings = bake(kiln, "three", *arguments, **wrong)
    (warning,) = warnings
    assert warning.startswith("the shared cache s3://bucket/kiln/one is left alone: it refuses (status 403)")
    assert outputs(kiln.folder / "out") == right


def signature(method: str, url: str, host: str, secret: str) -> str:
    """The signature that a presigned address must have. Source: AWS Signature Version 4, "Authenticating Requests"."""
    path, query = url.split("?")
    pairs = [pair for pair in query.split("&") if not pair.startswith("X-Amz-Signature=")]
    values = {name: unquote(value) for name, value in (pair.split("=") for pair in pairs)}
    assert values["X-Amz-SignedHeaders"] == "host"
    canonical = "\n".join([method, path, "&".join(sorted(pairs)), f"host:{host}\n", "host", "UNSIGNED-PAYLOAD"])
    scope = values["X-Amz-Credential"].split("/", 1)[1]
    digest = hashlib.sha256(canonical.encode()).hexdigest()
    text = "\n".join([values["X-Amz-Algorithm"], values["X-Amz-Date"], scope, digest])
    key = f"AWS4{secret}".encode()
    for part in [*scope.split("/"), text]:
        key = hmac.new(key, part.encode(), hashlib.sha256).digest()
    return key.hex()


def test_addresses_of_a_store_are_signed(kiln: Kiln, server: Server) -> None:
    right = prepare(kiln)
    endpoint = server.url.removesuffix("/bucket")
    environment = {"AWS_ENDPOINT_URL_S3": endpoint, "AWS_REGION": "eu-central-1", "AWS_ACCESS_KEY_ID": "someone"}
    environment["AWS_SECRET_ACCESS_KEY"] = "of-bad-news/+="
    arguments = ("--remote-cache", "s3://bucket/kiln", "--remote-cache-write")
    assert bake(kiln, "one", *arguments, **environment)[1] == []
    assert bake(kiln, "two", *arguments, **environment)[0]["hits"] == COUNT
    assert outputs(kiln.folder / "out") == right
    assert {method for method, _, _ in server.asked} == {"GET", "PUT"}
    for method, url, _ in server.asked:
        assert url.startswith(("/bucket/kiln/ac/", "/bucket/kiln/cas/"))
        sent = url.split("X-Amz-Signature=")[1].split("&")[0]
        assert sent == signature(method, url, endpoint.removeprefix("http://"), "of-bad-news/+=")
    # Without keys nothing is signed: a store may be open to all.
    server.asked.clear()
    nobody = {"AWS_ENDPOINT_URL_S3": endpoint, "AWS_SHARED_CREDENTIALS_FILE": "/nowhere"}
    assert bake(kiln, "three", "--remote-cache", "s3://bucket/kiln", **nobody)[0]["hits"] == COUNT
    assert all("?" not in url for _, url, _ in server.asked)
