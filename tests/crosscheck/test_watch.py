"""The page of `kiln watch` in a real browser, and its server against all that may be sent to it."""

from __future__ import annotations

import concurrent.futures
import http.client
import json
import os
import re
import shutil
import socket
import struct
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kiln import Kiln

ROOT = Path(__file__).resolve().parents[2]
THREE = ROOT / "scripts" / "node_modules" / "three"
BOX = "[shape.s.box]\nsize = [1, 1, 1]\n"
SECONDS = 30
ARM = """[shape.s.box]
size = [0.2, 1, 0.2]
[node.s]
shape = "s"
[skeleton.bones.joint.upper]
head = [0, -1, 0]
tail = [0, 0, 0]
[skeleton.bones.joint.forearm]
parent = "upper"
tail = [0, 1, 0]
limits = { x = [0, 140], y = [0, 0], z = [0, 0] }
[[clip.curl.track]]
joint = "forearm"
path = "rotation"
axis = "x"
between = "cubic"
keys = [{ at = 0, value = 0, slope = 0 }, { at = 1.2, value = 100, slope = 0 }, { at = 2.4, value = 0, slope = 0 }]
"""


@pytest.fixture(scope="module", params=["three.js", "pictures"])
def seen(request: pytest.FixtureRequest, program: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What a browser saw while files changed: with three.js, and without it."""
    viewer = str(THREE) if request.param == "three.js" else "-"
    script = Path(__file__).with_name("watched.mjs")
    line = ["node", str(script), str(program), str(tmp_path_factory.mktemp("watch")), viewer, str(ROOT / "specs")]
    done = subprocess.run(line, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return {"viewer": request.param, **json.loads(done.stdout)}


def test_the_page_complains_of_nothing(seen: dict[str, Any]) -> None:
    assert seen["complaints"] == []


def test_a_document_that_failed_at_first_is_shown_once_it_is_mended(seen: dict[str, Any]) -> None:
    assert "K0005" in seen["first"]["said"]
    assert "cup.toml:2" in seen["first"]["said"]
    assert seen["first"]["title"].startswith("(!)")
    assert seen["recovered"]["hidden"]


def test_an_edit_changes_the_picture_and_the_camera_stays(seen: dict[str, Any]) -> None:
    assert len({seen["recovered"]["picture"], seen["dragged"], seen["edited"]}) == 3
    # The first text again, saved by rename: the picture of it from where the camera was dragged to.
    assert seen["renamed"] == seen["dragged"]


def test_a_broken_edit_is_told_in_its_place_and_the_model_stays(seen: dict[str, Any]) -> None:
    broken = seen["broken"]
    assert "unknown field `radus`" in broken["said"]
    assert broken["place"] == "7"
    assert "the last good model is shown" in broken["status"]
    assert broken["picture"] == seen["dragged"]
    assert seen["mended"] == seen["dragged"]


def test_included_documents_and_pictures_are_watched(seen: dict[str, Any]) -> None:
    assert seen["included"] != seen["dragged"]
    assert "spots.png" in seen["imageGone"]["said"]
    assert "does not exist" in seen["imageGone"]["said"]
    assert "K0501" in seen["cycle"]["said"]
    assert "cup.toml" in seen["deleted"]["said"]
    assert {seen[key]["picture"] for key in ("imageGone", "cycle", "deleted")} == {seen["included"]}
    assert seen["back"] == seen["included"]


def test_clips_are_scrubbed_and_played(seen: dict[str, Any]) -> None:
    assert len(seen["clips"]) == 2
    assert seen["duration"] > 0
    early, late, again = seen["scrubbed"]
    assert len({seen["rest"], early, late}) == 3
    assert again == early
    assert seen["kept"] == early
    assert seen["played"]


def test_joints_are_told_with_their_limits(seen: dict[str, Any]) -> None:
    assert {row[1] for row in seen["limits"]} == {"-35° to 35°", "-10° to 10°", "-5° to 5°"}
    rows = [(float(angle.rstrip("°")), float(most.split()[-1].rstrip("°"))) for _, most, angle in seen["limits"]]
    assert any(angle != 0 for angle, _ in rows)
    assert all(abs(angle) <= most for angle, most in rows)


def test_measures_are_shown_as_colors(seen: dict[str, Any]) -> None:
    heats = seen["heats"]
    assert heats["list"][:3] == ["(materials)", "deviation", "curvature"]
    shown = [heats[name]["picture"] for name in ("curvature", "deviation", "(materials)")]
    assert len(set(shown)) == 3
    # It has no texture: the page says so, and shows the materials.
    assert "no texels" in heats["texel-density"]["note"]
    assert heats["texel-density"]["picture"] == heats["(materials)"]["picture"]
    if seen["viewer"] == "three.js":
        assert any(name.startswith("weights:") for name in heats["list"])
        assert re.match(r"curvature, 1/m: violet 0 to yellow \d", heats["curvature"]["note"])
        assert heats["(materials)"]["note"] == ""


def test_levels_of_detail_are_shown(seen: dict[str, Any]) -> None:
    levels = seen["levels"]
    assert levels["list"] == ["0", "1", "2", "3"]
    finest, second, coarsest, again = levels["pictures"]
    assert len({finest, second, coarsest}) == 3
    assert again == finest
    assert len({*levels["heats"], *levels["pictures"]}) == 5
    if seen["viewer"] == "three.js":
        assert re.match(r"level of detail: violet 0 to yellow 3", levels["note"])


def test_switches_change_the_picture(seen: dict[str, Any]) -> None:
    expected = {"wireframe", "normals", "joints"} if seen["viewer"] == "three.js" else {"normals"}
    assert set(seen["switches"]) == expected
    assert len({*seen["switches"].values(), seen["scrubbed"][0]}) == len(expected) + 1


def test_a_click_leads_to_the_line_of_the_part(seen: dict[str, Any]) -> None:
    if seen["viewer"] == "three.js":
        assert seen["pickedMiddle"] == {"note": "cup.toml:6", "line": "[shape.bowl.sphere]"}
        assert seen["pickedTop"] == {"note": "cup.toml:8", "line": "[shape.foot.box]"}


def test_latency_is_told(seen: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    """Figures for a person; what they are is the machine's."""
    if seen["viewer"] == "three.js":
        for name, marks in seen["latency"].items():
            assert all(0 < bytes_ <= drawn for bytes_, drawn in marks)
            arrived, drawn = (sorted(column)[len(column) // 2] for column in zip(*marks, strict=True))
            told = f"{name}: {arrived:.0f} ms from a save to new bytes in the page, {drawn:.0f} ms to their picture"
            with capsys.disabled():
                sys.stdout.write(f"\nwatch: {told}\n")


@dataclass(frozen=True)
class Watched:
    """A running watch."""

    process: subprocess.Popen[str]
    port: int
    said: list[dict[str, Any]]

    def raw(self, text: bytes) -> bytes:
        """The whole answer to some bytes."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=SECONDS) as connection:
            connection.sendall(text)
            connection.shutdown(socket.SHUT_WR)
            answer = b""
            while part := connection.recv(65536):
                answer += part
            return answer

    def get(self, path: str, **headers: str) -> tuple[int, bytes]:
        """Status and body of a request."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=SECONDS)
        connection.putrequest("GET", path, skip_host="Host" in headers)
        for name, value in headers.items():
            connection.putheader(name.replace("_", "-"), value)
        connection.endheaders()
        answer = connection.getresponse()
        body = answer.read()
        connection.close()
        return answer.status, body

    def state(self, revision: int = 1) -> dict[str, Any]:
        """What the page is told, from a bake on."""
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            state = json.loads(self.get("/state")[1])
            if state["revision"] >= revision:
                return state
            time.sleep(0.01)
        pytest.fail(f"no bake {revision}")

    def answers(self) -> bool:
        """Whether it still does its work."""
        return self.get("/")[0] == 200 and self.process.poll() is None


def start(kiln: Kiln, *options: str) -> Watched:
    """Start a watch of model.toml."""
    line = [str(kiln.program), "--format", "json", "watch", "model.toml", *options]
    process = subprocess.Popen(line, cwd=kiln.folder, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    said: list[dict[str, Any]] = []
    while not (said and "address" in said[-1]):
        said.append(json.loads(process.stdout.readline()))
    return Watched(process, urlsplit(said[-1]["address"]).port or 0, said)


@pytest.fixture
def watched(kiln: Kiln) -> Iterator[Watched]:
    """A watch of a box."""
    kiln.write(BOX)
    one = start(kiln, "--port", "0", "--three", str(THREE))
    one.state()
    yield one
    one.process.kill()


def test_the_bytes_are_those_that_are_baked(kiln: Kiln, watched: Watched) -> None:
    baked = kiln.bake(BOX)
    (asset,) = watched.state()["assets"]
    assert watched.get(f"/asset?key={asset['key']}") == (200, baked.path.read_bytes())
    assert watched.get("/asset?key=0")[0] == 204


def test_angles_of_joints_are_those_of_the_clip(kiln: Kiln) -> None:
    """A cubic from 0 to 100 degrees and back, without slope where it turns: halfway it is at 50."""
    kiln.write(ARM)
    one = start(kiln, "--port", "0")
    try:
        (asset,) = one.state()["assets"]
        (joint,) = asset["joints"]
        assert (joint["name"], joint["ranges"]) == ("forearm", [[0, 140], [0, 0], [0, 0]])
        for moment, expected in (("", 0), ("&clip=0&time=0.6", 50), ("&clip=0&time=1.2", 100), ("&clip=7&time=1.2", 0)):
            status, body = one.get(f"/joints?key={asset['key']}{moment}")
            assert status == 200
            (found,) = json.loads(body)
            assert [axis["axis"] for axis in found["axes"]] == ["x", "y", "z"]
            angles = [axis["angle"] for axis in found["axes"]]
            # Keys keep the motion to its tolerance, a millimeter over a bone of a meter.
            assert angles == pytest.approx([expected, 0, 0], abs=0.1)
            assert all(axis["within"] for axis in found["axes"])
        assert one.get("/joints?key=0")[0] == 204
    finally:
        one.process.kill()


def test_only_loopback_is_listened_on(watched: Watched) -> None:
    table = Path(f"/proc/{watched.process.pid}/net/tcp").read_text(encoding="ascii").splitlines()[1:]
    rows = [row.split() for row in table]
    listening = [row[1] for row in rows if row[3] == "0A" and int(row[1].split(":")[1], 16) == watched.port]
    assert listening == [f"0100007F:{watched.port:04X}"]


@pytest.mark.parametrize("host", ["evil.test", "evil.test:{port}", "127.0.0.1:1", "localhost.evil.test:{port}", ""])
def test_other_hosts_are_refused(watched: Watched, host: str) -> None:
    assert watched.get("/state", Host=host.format(port=watched.port))[0] == 403
    assert watched.get("/state", Host=f"localhost:{watched.port}")[0] == 200


def test_other_sites_are_refused(watched: Watched) -> None:
    assert watched.get("/state", Origin="http://evil.test")[0] == 403
    assert watched.get("/state", Sec_Fetch_Site="cross-site")[0] == 403
    assert watched.get("/state", Sec_Fetch_Site="same-origin")[0] == 200


@pytest.mark.parametrize(
    "path",
    [
        "/model.toml",
        "/../model.toml",
        "/three/../../../etc/passwd",
        "/three/build/../package.json",
        "/three/build/..%2fpackage.json",
        "/three/package.json",
        "/three//etc/passwd",
        "/three/build/./three.module.js",
        "/page/../page/page.js",
        "//etc/passwd",
        "/page/%2e%2e/page.js",
        "/three/",
        "/three/build",
    ],
)
def test_no_file_outside_is_served(watched: Watched, path: str) -> None:
    answer = watched.raw(f"GET {path} HTTP/1.1\r\nHost: localhost:{watched.port}\r\nConnection: close\r\n\r\n".encode())
    assert answer.startswith(b"HTTP/1.1 404 "), answer[:200]
    assert b"root:" not in answer


def test_malformed_requests_harm_nothing(watched: Watched) -> None:
    host = f"Host: localhost:{watched.port}\r\n".encode()
    bad = {
        b"": b"",
        b"\r\n\r\n": b"",
        b"GET / HTTP/1.1\r\n": b"",
        b"\x00\xff\xfe\r\n\r\n": b"400",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03": b"400",
        b"GET\r\n\r\n": b"400",
        b"GET / HTTP/2.0\r\n" + host + b"\r\n": b"400",
        b"GET / HTTP/1.1\r\n\r\n": b"400",
        b"GET / HTTP/1.1\r\n" + host + host + b"\r\n": b"400",
        b"GET / HTTP/1.1\r\n" + host + b"A b: c\r\n\r\n": b"400",
        b"POST / HTTP/1.1\r\n" + host + b"Content-Length: 5\r\n\r\nhello": b"405",
        b"GET / HTTP/1.1\r\n" + host + b"Content-Length: 99999999999999\r\n\r\n": b"413",
        b"GET / HTTP/1.1\r\n" + host + b"Transfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n": b"413",
        b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\n" + host + b"\r\n": b"431",
        b"GET / HTTP/1.1\r\n" + host + b"A: b\r\n" * 1000 + b"\r\n": b"431",
    }
    for text, status in bad.items():
        answer = watched.raw(text)
        assert answer[9:12] == status, (text[:60], answer[:60])
    for query in ("", "key=", "key=0&width=1&height=1", "key=%00", "&&&=", "key=a&key=b"):
        for path in ("frame", "place", "asset"):
            assert watched.get(f"/{path}?{query}")[0] == 204
    (asset,) = watched.state()["assets"]
    for query in (
        "azimuth=nan&elevation=0",
        "azimuth=0&elevation=91",
        "azimuth=inf&elevation=0",
        "azimuth=0&elevation=0",
    ):
        for size in ("", "&width=0&height=5", "&width=99999&height=99999", "&width=-1&height=1"):
            assert watched.get(f"/frame?key={asset['key']}&{query}{size}")[0] == 400
    for corners in ("mesh=0&a=0&b=1", "mesh=9&a=0&b=1&c=2", "mesh=0&a=-1&b=1&c=2"):
        assert watched.get(f"/place?key={asset['key']}&{corners}")[0] == 204
    assert watched.answers()


def test_several_requests_come_on_one_connection(watched: Watched) -> None:
    one = f"GET /favicon.ico HTTP/1.1\r\nHost: localhost:{watched.port}\r\n\r\n".encode()
    assert watched.raw(one * 3).count(b"HTTP/1.1 204 ") == 3


def test_ten_clients_hear_of_each_bake(kiln: Kiln, watched: Watched) -> None:
    """Each keeps a stream open, as a page does, while a slow one and one that never reads stand beside them."""
    slow = socket.create_connection(("127.0.0.1", watched.port))
    slow.sendall(b"GET / HT")
    deaf = socket.create_connection(("127.0.0.1", watched.port))
    deaf.sendall(f"GET /news HTTP/1.1\r\nHost: localhost:{watched.port}\r\n\r\n".encode())

    def listen(_: int) -> list[int]:
        connection = http.client.HTTPConnection("127.0.0.1", watched.port, timeout=SECONDS)
        connection.request("GET", "/news")
        stream = connection.getresponse()
        revisions: list[int] = []
        while not revisions or revisions[-1] < 4:
            text = stream.readline()
            if text.startswith(b"data: "):
                revisions.append(json.loads(text[6:])["revision"])
        connection.close()
        return revisions

    with concurrent.futures.ThreadPoolExecutor(10) as pool:
        heard = pool.map(listen, range(10))
        for revision in range(2, 5):
            kiln.write(BOX.replace("1, 1, 1", f"1, 1, {revision}"))
            watched.state(revision)
        assert all(one == sorted(set(one)) and one[-1] == 4 for one in heard)
    assert watched.answers()
    slow.close()
    deaf.close()


def test_a_page_that_is_closed_in_the_middle_of_a_bake(kiln: Kiln, watched: Watched) -> None:
    """It goes away while it waits for a bake, or while it takes the bytes of one, without a word: others get both."""

    def asked(path: str) -> socket.socket:
        connection = socket.create_connection(("127.0.0.1", watched.port), timeout=SECONDS)
        connection.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost:{watched.port}\r\n\r\n".encode())
        assert connection.recv(16).startswith(b"HTTP/1.1 200")
        # What is closed so tells the other side that it broke off, not that it is done.
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        return connection

    page = asked("/news")
    kiln.write("[shape.s]\nsegments = [900, 600]\n[shape.s.torus]\nradius = 1\ntube-radius = 0.3\n")
    time.sleep(0.1)
    assert json.loads(watched.get("/state")[1])["revision"] == 1, "it is still being baked"
    page.close()
    state = watched.state(2)
    assert state["good"]
    path = f"/asset?key={state['assets'][0]['key']}"
    for _ in range(3):
        asked(path).close()
    status, body = watched.get(path)
    assert (status, body[:4]) == (200, b"glTF")
    kiln.write(BOX)
    assert watched.state(3)["good"]
    assert watched.answers()


def test_nothing_is_done_while_nothing_changes(kiln: Kiln, watched: Watched) -> None:
    """Neither for files beside the document, nor for a page that listens: under two hundredths of one core."""
    listener = http.client.HTTPConnection("127.0.0.1", watched.port, timeout=SECONDS)
    listener.request("GET", "/news")
    stream = listener.getresponse()
    assert stream.readline().startswith(b"data: ")

    def ticks() -> int:
        fields = Path(f"/proc/{watched.process.pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
        return int(fields[11]) + int(fields[12])

    before, start = ticks(), time.monotonic()
    for turn in range(10):
        (kiln.folder / "beside.txt").write_text(str(turn), encoding="utf-8")
        (kiln.folder / "model.toml").read_text(encoding="utf-8")
        time.sleep(0.2)
    used = (ticks() - before) / os.sysconf("SC_CLK_TCK")
    assert used <= 0.02 * (time.monotonic() - start) + 0.01
    assert watched.state()["revision"] == 1
    listener.close()


def test_a_port_in_use_is_told_and_another_taken(kiln: Kiln, watched: Watched) -> None:
    other = start(kiln, "--port", str(watched.port))
    try:
        assert f"port {watched.port} is in use" in other.said[0]["note"]
        assert other.port != watched.port
        assert other.state()["good"]
    finally:
        other.process.kill()


def test_a_folder_that_is_moved_away_and_comes_back(kiln: Kiln) -> None:
    parts = kiln.folder / "parts"
    parts.mkdir()
    kiln.write("[material.m]\ncolor = '#112233'\n", "parts/looks")
    kiln.write(f"include = ['parts/looks.toml']\n{BOX}")
    one = start(kiln, "--port", "0", "--out", "baked")
    try:
        assert one.state()["good"]
        assert (kiln.folder / "baked" / "model.glb").is_file()
        parts.rename(kiln.folder / "elsewhere")
        assert not one.state(2)["good"]
        shutil.copytree(kiln.folder / "elsewhere", parts)
        revision = next(revision for revision in range(3, 9) if one.state(revision)["good"])
        kiln.write("[material.m]\ncolour = 1\n", "elsewhere/looks")
        kiln.write("[material.m]\ncolour = 2\n", "parts/looks")
        assert "colour" in one.state(revision + 1)["rendered"]
    finally:
        one.process.kill()


def test_what_cannot_be_watched_is_said(kiln: Kiln) -> None:
    assert kiln.run("watch", "none.toml").returncode == 3
    kiln.write(BOX)
    wrong = kiln.run("watch", "model.toml", "--three", ".")
    assert wrong.returncode == 2
    assert "three.js" in wrong.stderr
