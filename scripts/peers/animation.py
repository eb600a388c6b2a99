"""The parts of the bench about clips: `reach`, `keys` and `motion`.

`reach`: a chain of seven joints with limits follows a moving place for a minute at 60 frames a second. What Kiln takes
is the whole bake less that of a clip of one frame; Blender times its bake of the same chain itself. `keys`: what
gltfpack's default resampling makes of files of others is measured against them, and Kiln bakes the same clips at the
tolerance at which its vertices are as near. `motion`: time over vertices, frames and joints.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from checks.document import Document, local_matrix
from peers.growth import exponent
from peers.process import Runs, together

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

JOINTS, FRAMES, RATE = 7, 3600, 60
PACE = (1.3, 0.9, 1.7)  # radians a second along x, y and z
LIMITS = ((-70.0, 70.0), (-30.0, 30.0), (-50.0, 50.0))

FILES = ("Fox.glb", "CesiumMan.glb")
TIMES_A_SECOND = 240  # eight times as dense as what gltfpack keeps
ROUNDS = 6

VERTICES = (8_000, 32_000, 128_000, 512_000)
SECONDS_LONG = (8, 32, 128, 512)
CHAINS = (8, 32, 128, 250)


# Inverse kinematics.


def rest() -> Array:
    """Ends of the bones, a bent meter in the plane x = 0: a chain that is straight bends nowhere first."""
    angles = np.radians(np.linspace(-20.0, 40.0, JOINTS))
    steps = np.stack([np.zeros(JOINTS), np.cos(angles), np.sin(angles)], axis=-1) / JOINTS
    return np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])


def places(times: Array) -> Array:
    """Where the tip shall be; within reach at all times."""
    waves = np.sin(np.outer(times, PACE))
    return np.array([0.0, 0.62, 0.35]) + np.array([0.35, 0.12, 0.2]) * waves


def reaching(kiln: Path, folder: Path, name: str, duration: float) -> Runs:
    """The chain in a clip, without a report."""
    ends = rest().tolist()
    spec = "[shape.tip.box]\nsize = [0.05, 0.05, 0.05]\n"
    for number in range(JOINTS):
        parent = f'parent = "j{number - 1}"' if number else f"head = {ends[0]}"
        ranges = ", ".join(f"{axis} = {list(own)}" for axis, own in zip("xyz", LIMITS, strict=True))
        spec += f"[skeleton.s.joint.j{number}]\n{parent}\ntail = {ends[number + 1]}\nlimits = {{ {ranges} }}\n"
    spec += '[skin.k]\nshape = "tip"\nskeleton = "s"\nweights = "rigid"\njoints = ["j0"]\n'
    # As `places`, whose angles are radians.
    pace = [f"sin({float(np.degrees(rate))!r} * t)" for rate in PACE]
    formula = [f"= 0.35 * {pace[0]}", f"= 0.62 + 0.12 * {pace[1]}", f"= 0.35 + 0.2 * {pace[2]}"]
    spec += f"[clip.c]\nduration = {duration}\n"
    spec += f'[[clip.c.reach]]\njoint = "j{JOINTS - 1}"\nformula = {json.dumps(formula)}\n'
    (folder / f"{name}.toml").write_text(spec, encoding="utf-8")
    out = folder / name
    return Runs(f"Kiln, {name}", [str(kiln), "bake", f"{name}.toml", "--out", str(out), "--quiet"], out / f"{name}.glb")


def reach(kiln: Path, peer: list[str], folder: Path, runs: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """Solves a second, and how far the tip is from its place at most."""
    duration = FRAMES / RATE
    ends = rest()
    times = np.arange(FRAMES + 1) / RATE
    np.savez(folder / "chain.npz", heads=ends[:-1], tails=ends[1:], limits=[LIMITS] * JOINTS, places=places(times))
    long, short = reaching(kiln, folder, "reach", duration), reaching(kiln, folder, "still", 1 / RATE)
    out = folder / "blender-chain.npz"
    blender = Runs("Blender", [*peer, str(folder / "chain.npz"), str(out)], out)
    together([long, short, blender], runs, folder, tell)
    rows: list[dict[str, Any]] = []
    failure = long.failure or short.failure
    own: dict[str, Any] = {"tool": "Kiln", "failure": failure}
    if failure is None:
        alone = max(long.median - short.median, 1e-9)
        report = json.loads(long.output.with_suffix(".report.json").read_text(encoding="utf-8"))
        frames = next(iter(report["clips"]["c"]["reaches"].values()))["frames"]
        furthest = max(frame["distance"] for frame in frames)
        own |= {"seconds": long.median, "solves": (FRAMES + 1) / alone, "furthest": furthest}
    rows.append(own)
    other: dict[str, Any] = {"tool": "Blender", "failure": blender.failure}
    if blender.failure is None:
        found = np.load(out)
        solves = (FRAMES + 1) / float(found["seconds"])
        other |= {"seconds": blender.median, "solves": solves, "furthest": float(found["distances"].max())}
        if failure is None:
            own["times-blender"] = own["solves"] / solves
    return {"rows": [*rows, other]}


# Reduction of keys.


class Player:
    """A file's first skin in motion, at many times at once."""

    def __init__(self, path: Path) -> None:
        self.document = Document(path)
        self.json = self.document.json
        self.nodes = self.json["nodes"]
        self.parents = {child: index for index, node in enumerate(self.nodes) for child in node.get("children", [])}
        skin = self.json["skins"][0]
        self.joints: list[int] = skin["joints"]
        back = self.document.accessor(skin["inverseBindMatrices"]).astype(float)
        self.back = back.reshape(-1, 4, 4).transpose(0, 2, 1)
        # Where the mesh stands as it is bound: what a tool may have applied to it is told apart from motion.
        self.bound = self.worlds({}, np.zeros(1))[self.joints[0]][0] @ self.back[0]

    def clips(self) -> dict[str, dict[str, Any]]:
        """The animations by name."""
        return {one.get("name", ""): one for one in self.json.get("animations", [])}

    def values(self, index: int) -> Array:
        """An accessor's numbers; whole ones that are normalized are shares."""
        found = self.document.accessor(index)
        if self.json["accessors"][index].get("normalized"):
            return np.maximum(found.astype(float) / np.iinfo(found.dtype).max, -1.0)
        return found.astype(float)

    def keys(self, clip: dict[str, Any]) -> int:
        """Keys of all channels that move a node."""
        used = [clip["samplers"][channel["sampler"]] for channel in clip["channels"]]
        return sum(self.json["accessors"][sampler["input"]]["count"] for sampler in used)

    def sampled(self, sampler: dict[str, Any], turns: bool, times: Array) -> Array:
        """A sampler's values at times: appendix C of the specification, steps and straight ways."""
        own, values = self.values(sampler["input"]).ravel(), self.values(sampler["output"])
        if len(own) == 1:
            return np.repeat(values[:1], len(times), axis=0)
        key = np.clip(np.searchsorted(own, times, side="right") - 1, 0, len(own) - 2)
        share = np.clip((times - own[key]) / (own[key + 1] - own[key]), 0.0, 1.0)[:, None]
        if sampler.get("interpolation", "LINEAR") == "STEP":
            return np.where(share < 1.0, values[key], values[key + 1])
        start, end = values[key], values[key + 1]
        if not turns:
            return start + (end - start) * share
        dot = np.sum(start * end, axis=1, keepdims=True)
        end, angle = np.where(dot < 0, -end, end), np.arccos(np.clip(np.abs(dot), 0.0, 1.0))
        small = angle < 1e-6
        sine = np.where(small, 1.0, np.sin(angle))
        first = np.where(small, 1 - share, np.sin(angle * (1 - share)) / sine)
        second = np.where(small, share, np.sin(angle * share) / sine)
        mixed = first * start + second * end
        return mixed / np.linalg.norm(mixed, axis=1, keepdims=True)

    def worlds(self, clip: dict[str, Any], times: Array) -> dict[int, Array]:
        """For each node its matrices in the scene."""
        moved: dict[int, dict[str, Array]] = {}
        for channel in clip.get("channels", []):
            path, node = channel["target"]["path"], channel["target"]["node"]
            values = self.sampled(clip["samplers"][channel["sampler"]], path == "rotation", times)
            moved.setdefault(node, {})[path] = values
        locals_ = {index: matrices(node, moved.get(index, {}), len(times)) for index, node in enumerate(self.nodes)}
        found: dict[int, Array] = {}

        def world(index: int) -> Array:
            if index not in found:
                parent = self.parents.get(index)
                found[index] = locals_[index] if parent is None else world(parent) @ locals_[index]
            return found[index]

        for index in locals_:
            world(index)
        return found

    def carried(self, clip: dict[str, Any], times: Array) -> dict[str, Array]:
        """For each joint, by its plain name, what it does to a point of the scene as it is bound."""
        worlds, home = self.worlds(clip, times), np.linalg.inv(self.bound)
        return {
            plain(self.nodes[joint]["name"]): worlds[joint] @ back @ home
            for joint, back in zip(self.joints, self.back, strict=True)
        }


def plain(name: str) -> str:
    """A name without what tools change in it."""
    return "".join(letter for letter in name.lower() if letter.isalnum())


def matrices(node: dict[str, Any], moved: dict[str, Array], count: int) -> Array:
    """A node's own matrices."""
    if not moved:
        return np.repeat(local_matrix(node)[None], count, axis=0)
    rest_of = {"translation": [0, 0, 0], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]}
    given = {path: moved.get(path, np.repeat([node.get(path, none)], count, axis=0)) for path, none in rest_of.items()}
    x, y, z, w = (given["rotation"][:, k] for k in range(4))
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    ).transpose(2, 0, 1)
    found = np.repeat(np.eye(4)[None], count, axis=0)
    found[:, :3, :3] = turn * given["scale"][:, None, :]
    found[:, :3, 3] = given["translation"]
    return found


def apart(source: Player, other: Player, names: dict[str, str]) -> float:
    """How far a skinned vertex of the source is from where another file moves it, in all clips."""
    node = next(node for node in source.nodes if "skin" in node)
    primitives = source.json["meshes"][node["mesh"]]["primitives"]
    parts: dict[str, list[Array]] = {"POSITION": [], "JOINTS_0": [], "WEIGHTS_0": []}
    for primitive in primitives:
        for kind, found in parts.items():
            found.append(source.values(primitive["attributes"][kind]))
    points, joints, weights = (np.concatenate(found) for found in parts.values())
    points = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ source.bound.T
    weights = weights / weights.sum(axis=1, keepdims=True)
    order = [plain(source.nodes[joint]["name"]) for joint in source.joints]
    worst = 0.0
    for name, clip in source.clips().items():
        last = max(float(source.values(sampler["input"]).max()) for sampler in clip["samplers"])
        times = np.linspace(0.0, last, int(last * TIMES_A_SECOND) + 1)
        exact, found = source.carried(clip, times), other.carried(other.clips()[names[name]], times)
        gaps = np.array([found[joint] - exact[joint] for joint in order])
        for moment in range(len(times)):
            each = gaps[:, moment, :3][joints.astype(int)]
            ways = np.einsum("vj,vjab,vb->va", weights, each, points)
            worst = max(worst, float(np.linalg.norm(ways, axis=1).max()))
    return worst


def keys(kiln: Path, gltfpack: Path, folder: Path, tell: Callable[[str], None]) -> dict[str, Any]:
    """Keys of both tools at the same measured error."""
    cases = Path(os.environ.get("KILN_CASES", "cases")) / "gltf"
    rows = []
    for file in FILES:
        tell(f"keys of {file}")
        row: dict[str, Any] = {"file": file, "failure": None}
        rows.append(row)
        try:
            row |= of_file(kiln, gltfpack, cases / file, folder)
        except (OSError, subprocess.SubprocessError) as error:
            row["failure"] = str(error)
    return {"rows": rows}


def of_file(kiln: Path, gltfpack: Path, path: Path, folder: Path) -> dict[str, Any]:
    """One file: gltfpack first, then Kiln at the greatest tolerance that is as near."""
    source = Player(path)
    shutil.copyfile(path, folder / path.name)
    packed = folder / f"packed-{path.name}"
    run([str(gltfpack), "-i", str(path), "-o", str(packed), "-noq", "-kn"], folder)
    peer = Player(packed)
    same = {name: name for name in source.clips()}
    allowed = apart(source, peer, same)
    row: dict[str, Any] = {
        "source": total(source),
        "gltfpack": total(peer),
        "gltfpack-error": allowed,
    }
    tolerance = allowed
    for _ in range(ROUNDS):
        made = baked(kiln, source, path.name, tolerance, folder)
        found = apart(source, made, {name: f"c{number}" for number, name in enumerate(source.clips())})
        if found <= allowed and ("kiln" not in row or total(made) <= row["kiln"]):
            row |= {"kiln": total(made), "kiln-error": found, "tolerance": tolerance}
        if 0.98 * allowed <= found <= allowed:
            break
        tolerance *= 0.99 * allowed / found
    if "kiln" in row:
        row["of-gltfpack"] = row["kiln"] / row["gltfpack"]
    else:
        row["failure"] = "no tolerance was found at which vertices are as near"
    return row


def total(player: Player) -> int:
    """Keys of all clips."""
    return sum(player.keys(clip) for clip in player.clips().values())


def baked(kiln: Path, source: Player, file: str, tolerance: float, folder: Path) -> Player:
    """The file once more by Kiln."""
    spec = f'[shape.m.import]\nfile = "{file}"\n[skeleton.s.import]\nfile = "{file}"\n'
    spec += '[skin.k]\nshape = "m"\nskeleton = "s"\nweights = "imported"\n'
    for number, name in enumerate(source.clips()):
        spec += f'[clip.c{number}]\ntolerance = {tolerance!r}\n[clip.c{number}.import]\nfile = "{file}"\n'
        spec += f"animation = {json.dumps(name)}\n" if name else ""
    (folder / "keys.toml").write_text(spec, encoding="utf-8")
    run([str(kiln), "bake", "keys.toml", "--out", "keys", "--quiet", "--no-report"], folder)
    return Player(folder / "keys" / "keys.glb")


def run(line: list[str], folder: Path) -> None:
    """A command that must succeed."""
    done = subprocess.run(line, cwd=folder, capture_output=True, text=True, timeout=600, check=False)
    if done.returncode != 0:
        message = f"{line[0]}: exit code {done.returncode}: {(done.stderr or done.stdout).strip()[-300:]}"
        raise subprocess.SubprocessError(message)


# Growth.


def growth(kiln: Path, folder: Path, runs: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """Whole bakes of a tube that sways, as its vertices, its frames and its joints grow, and the exponents."""
    rows = []
    for axis, sizes in (("vertices", VERTICES), ("frames", SECONDS_LONG), ("joints", CHAINS)):
        measured: list[tuple[float, float]] = []
        for size in sizes:
            own = {"vertices": 8_000, "frames": 8, "joints": 8, axis: size}
            entry = swaying(kiln, folder, f"sway-{axis}-{size}", own)
            together([entry], runs, folder, tell)
            shown = size * RATE if axis == "frames" else size
            row: dict[str, Any] = {"axis": axis, "size": shown, "failure": entry.failure}
            if entry.failure is None:
                row |= {"seconds": entry.median, "peak": entry.peak}
                measured.append((shown, entry.median))
            rows.append(row)
        if len(measured) >= 2:
            rows[-1]["exponent"] = exponent(measured[-2:])
    return {"rows": rows}


def swaying(kiln: Path, folder: Path, name: str, size: dict[str, int]) -> Runs:
    """A tube of so many vertices, in which a chain of joints waves for so many seconds."""
    around = 40
    share, turn = np.meshgrid(
        np.linspace(-2.0, 2.0, size["vertices"] // around), np.arange(around) * (2 * np.pi / around), indexing="ij"
    )
    points = np.stack([0.1 * np.cos(turn), share, -0.1 * np.sin(turn)], axis=-1).reshape(-1, 3)
    first = np.arange(len(points) - around)
    after = first - first % around + (first + 1) % around
    faces = np.stack([first, after, after + around, first + around], axis=-1) + 1
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    lines += [f"f {a} {b} {c} {d}" for a, b, c, d in faces.tolist()]
    (folder / f"{name}.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
    spec = f"""[shape.tube.import]
file = "{name}.obj"
[skeleton.s.chain.c]
radius = 0.15
falloff = 0.3
points = {[[0.0, 4.0 * k / size["joints"] - 2.0, 0.0] for k in range(size["joints"] + 1)]}
[skin.k]
shape = "tube"
skeleton = "s"
[clip.c]
duration = {size["frames"]}
[[clip.c.track]]
chain = "c"
path = "rotation"
axis = [1, 0, 0]
formula = "= {40.0 / size["joints"]!r} * sin(200 * t + 300 * u)"
"""
    (folder / f"{name}.toml").write_text(spec, encoding="utf-8")
    out = folder / name
    line = [str(kiln), "bake", f"{name}.toml", "--out", str(out), "--quiet", "--no-report"]
    return Runs(f"Kiln, {name}", line, out / f"{name}.glb")
