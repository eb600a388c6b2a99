"""Weights by heat beside Blender's automatic weights, and beside a dense solution of the same equations."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from checks import played

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Baked, Kiln

SPECS = Path(__file__).resolve().parents[2] / "specs"
CHARACTERS = ["motion/gecko", "motion/fish", "tutorial/6-walker"]
NEAR = 0.05


def bake(kiln: Kiln, file: str) -> Baked:
    """A gallery document with weights by heat, and no smoothing after."""
    folder = SPECS / Path(file).parent
    for other in folder.glob("*.toml"):
        shutil.copy(other, kiln.folder)
    lines = (folder / f"{Path(file).name}.toml").read_text(encoding="utf-8").splitlines()
    at = next(number for number, line in enumerate(lines) if line.startswith("[skin."))
    head, rest = lines[: at + 1], [line for line in lines[at + 1 :] if not line.startswith(("smoothing", "weights ="))]
    return kiln.bake("\n".join([*head, 'weights = "heat"', *rest]))


def bones(baked: Baked, spec: Path) -> tuple[list[str], NDArray[np.float64], NDArray[np.float64]]:
    """Names, heads and tails of the skin's joints: a tail is where a child is, or as the document says."""
    stage = played.Stage(baked.document)
    nodes, skin = baked.document.json["nodes"], baked.document.json["skins"][0]
    world = [stage.world(index, nodes) for index in range(len(nodes))]
    written = next(iter(tomllib.loads(spec.read_text(encoding="utf-8"))["skeleton"].values()))
    tails = {name: joint["tail"] for name, joint in written.get("joint", {}).items()}
    for name, chain in written.get("chain", {}).items():
        tails |= {f"{name}-{number}": tail for number, tail in enumerate(chain.get("points", [])[1:], 1)}
    names = [nodes[joint]["name"] for joint in skin["joints"]]
    heads, ends = [], []
    for joint, name in zip(skin["joints"], names, strict=True):
        heads.append(world[joint][:3, 3])
        children = [world[child][:3, 3] for child in nodes[joint].get("children", [])]
        mirrored = tails.get(name.replace("right", "left"))
        if name in tails:
            ends.append(np.array(tails[name], float))
        elif mirrored is not None:
            ends.append(np.array(mirrored, float) * [-1, 1, 1])
        elif children:
            ends.append(children[0])
        else:
            ends.append(np.array(LAST[name]))
    return names, np.array(heads), np.array(ends)


LAST = {"spine-6": [0.22, 0.006, 0.0]}
"""Ends of chains along curves."""


def written(baked: Baked, joints: int) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Points of the skinned mesh, merged where they are equal, their triangles, their weights."""
    mesh = next(one for one in baked.document.meshes if any("JOINTS_0" in p.attributes for p in one.primitives))
    points, triangles, weights = [], [], []
    start = 0
    for part in mesh.primitives:
        points.append(part.attributes["POSITION"].astype(float))
        triangles.append(part.triangles + start)
        start += len(points[-1])
        rows = np.zeros((len(points[-1]), joints))
        shares = part.attributes["WEIGHTS_0"].astype(float)
        for k in range(4):
            np.add.at(rows, (np.arange(len(rows)), part.attributes["JOINTS_0"][:, k]), shares[:, k])
        weights.append(rows / rows.sum(1, keepdims=True))
    merged, first, back = np.unique(np.concatenate(points), axis=0, return_index=True, return_inverse=True)
    corners = back.reshape(-1)[np.concatenate(triangles)]
    corners = corners[(corners != np.roll(corners, 1, axis=1)).all(1)]
    return merged, corners, np.concatenate(weights)[first]


@pytest.mark.parametrize("file", CHARACTERS)
def test_heat_is_near_automatic_weights(kiln: Kiln, file: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The mean over points and bones of the difference, where both are of sum 1."""
    baked = bake(kiln, file)
    names, heads, tails = bones(baked, SPECS / f"{file}.toml")
    points, triangles, ours = written(baked, len(names))
    source, target = kiln.folder / "in.npz", kiln.folder / "out.npz"
    np.savez(source, points=points, triangles=triangles, heads=heads, tails=tails)
    script = Path(__file__).with_name("blender_weights.py")
    subprocess.run([sys.executable, str(script), str(source), str(target)], check=True, capture_output=True)
    theirs = np.load(target)["weights"]
    carried = theirs.sum(1) > 0
    assert carried.mean() > 0.99
    apart = np.abs(ours - theirs)[carried]
    used = (np.maximum(ours, theirs) > 0)[carried]
    with capsys.disabled():
        sys.stdout.write(
            f"\n{file}: {len(points)} points, {len(names)} bones; mean difference {apart.mean():.4f} over all weights, "
            f"{apart[used].mean():.4f} over those that are not 0\n"
        )
    assert apart[used].mean() < NEAR
