"""The file's clips played by numpy from its bytes, as the glTF specification has it, at the times a report names."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial.transform import Rotation

from checks.document import Document, local_matrix

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray


def asked(path: Path) -> dict[str, Any]:
    """The clips of the report beside a file: what to play, and when. None of its answers are used."""
    report = path.with_name(f"{path.stem}.report.json")
    return json.loads(report.read_text(encoding="utf-8")).get("clips", {}) if report.exists() else {}


def questions(path: Path, what: str) -> Iterator[tuple[str, dict[str, Any], dict[str, Any], Stage]]:
    """Each clip of the report that asks so, with its name, as it stands in the file, and the file to play it."""
    told = {name: clip for name, clip in asked(path).items() if clip.get(what)}
    if not told:
        return
    stage = Stage(Document(path))
    named = {one.get("name", ""): one for one in stage.document.json.get("animations", [])}
    for name, clip in told.items():
        if name in named:
            yield name, clip, named[name], stage


def clips(path: Path) -> dict[str, list[dict[str, Any]]]:
    """The poses of every clip that the report names."""
    return {
        name: [stage.pose(animation, pose) for pose in clip["poses"]]
        for name, clip, animation, stage in questions(path, "poses")
    }


def reaches(path: Path) -> dict[str, dict[str, list[float]]]:
    """For each clip and joint that reaches something the distances from its places, frame by frame."""
    return {
        name: {joint: stage.distances(animation, joint, task) for joint, task in clip["reaches"].items()}
        for name, clip, animation, stage in questions(path, "reaches")
    }


def drivers(path: Path) -> dict[str, dict[str, dict[str, Any]]]:
    """For each clip and weight that follows a joint the angles and weights at the times told, and how far it is off."""
    return {
        name: {of: stage.driven(animation, task, clip["duration"]) for of, task in clip["drivers"].items()}
        for name, clip, animation, stage in questions(path, "drivers")
    }


class Stage:
    """A file that can be played."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.nodes = document.json["nodes"]
        self.parents: dict[int, int] = {
            child: index for index, node in enumerate(self.nodes) for child in node.get("children", [])
        }
        self.names = {node.get("name", ""): index for index, node in enumerate(self.nodes)}

    def pose(self, animation: dict[str, Any], question: dict[str, Any]) -> dict[str, Any]:
        """The scene at a time."""
        time = question["time"]
        locals_ = [dict(node) for node in self.nodes]
        weights = {index: self.rest_weights(node) for index, node in enumerate(self.nodes)}
        properties = {}
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            if channel["target"]["path"] == "pointer":
                pointer = channel["target"]["extensions"]["KHR_animation_pointer"]["pointer"]
                value = self.sample(sampler, "pointer", time)
                self.check_pointer(pointer, len(value))
                properties[pointer] = value.tolist()
                continue
            value = self.sample(sampler, channel["target"]["path"], time)
            if channel["target"]["path"] == "weights":
                weights[channel["target"]["node"]] = value
                continue
            locals_[channel["target"]["node"]][channel["target"]["path"]] = value.tolist()
        worlds = [self.world(index, locals_) for index in range(len(self.nodes))]
        vertices = {
            name: self.moved(name, [v["vertex"] for v in told], (worlds, weights))
            for name, told in question["vertices"].items()
        }
        nodes = {name: worlds[self.names[name]].T.ravel().tolist() for name in question["nodes"] if name in self.names}
        return {"time": time, "nodes": nodes, "vertices": vertices, "properties": properties}

    def check_pointer(self, pointer: str, width: int) -> None:
        """That a pointer leads to an object of the document, and its last name to a property of so many numbers."""
        *way, last = pointer.split("/")[1:]
        found: Any = self.document.json
        for name in way:
            found = found[int(name)] if isinstance(found, list) else found[name]
        held = found.get(last)
        wanted = 1 if isinstance(held, (int, float)) else len(held) if held is not None else width
        if not isinstance(found, dict) or wanted != width:
            message = f"{pointer} has {wanted} numbers, and its channel {width}"
            raise ValueError(message)

    def distances(self, animation: dict[str, Any], joint: str, task: dict[str, Any]) -> list[float]:
        """How far a point of a joint is from its place in each frame."""
        found = []
        for frame in task["frames"]:
            pose = self.pose(animation, {"time": frame["time"], "nodes": [joint], "vertices": {}})
            matrix = np.array(pose["nodes"][joint]).reshape(4, 4).T
            place = matrix @ np.array([*task["point"], 1.0])
            found.append(float(np.linalg.norm(place[:3] - frame["target"])))
        return found

    def driven(self, animation: dict[str, Any], task: dict[str, Any], duration: float) -> dict[str, Any]:
        """A weight beside the angle of the joint that drives it."""
        joint, shows = self.names[task["joint"]], self.names[task["node"]]
        rest = Rotation.from_quat(self.nodes[joint].get("rotation", [0, 0, 0, 1]))
        samplers = {
            (one["target"].get("node"), one["target"]["path"]): animation["samplers"][one["sampler"]]
            for one in animation["channels"]
        }

        def angle(time: float) -> float:
            turning = samplers.get((joint, "rotation"))
            if turning is None:
                return 0.0
            turned = rest.inv() * Rotation.from_quat(self.sample(turning, "rotation", time))
            # Limits are those of the swing about x, then about z, then of the twist about the bone.
            return float(turned.as_euler("XZY", degrees=True)["xzy".index(task["axis"])])

        def weight(time: float) -> float:
            moving = samplers.get((shows, "weights"))
            weights = self.rest_weights(self.nodes[shows]) if moving is None else self.sample(moving, "weights", time)
            return float(weights[task["target"]])

        def wanted(time: float) -> float:
            return float(np.clip((angle(time) - task["from"]) / (task["to"] - task["from"]), 0.0, 1.0))

        told = [frame["time"] for frame in task["frames"]]
        return {
            "angles": [angle(time) for time in told],
            "weights": [weight(time) for time in told],
            "worst": max(abs(weight(time) - wanted(time)) for time in np.linspace(0.0, duration, 65)),
        }

    def world(self, index: int, locals_: list[dict[str, Any]]) -> NDArray[np.float64]:
        """A node's matrix in the scene."""
        matrix = local_matrix(locals_[index])
        while (parent := self.parents.get(index)) is not None:
            matrix = local_matrix(locals_[parent]) @ matrix
            index = parent
        return matrix

    def sample(self, sampler: dict[str, Any], path: str, time: float) -> NDArray[np.float64]:
        """A sampler's value: appendix C of the specification."""
        times = self.document.accessor(sampler["input"]).astype(float).ravel()
        values = self.document.accessor(sampler["output"]).astype(float)
        if path == "weights":
            values = values.reshape(len(times), -1)
        key = int(np.searchsorted(times, time, side="right")) - 1
        if key < 0:
            return values[0]
        if key + 1 == len(times) or sampler.get("interpolation", "LINEAR") == "STEP":
            return values[key]
        share = (time - times[key]) / (times[key + 1] - times[key])
        start, end = values[key], values[key + 1]
        if path != "rotation":
            return start + (end - start) * share
        dot = float(np.dot(start, end))
        angle = np.arccos(min(abs(dot), 1.0))
        if angle < 1e-6:
            mixed = start * (1 - share) + np.copysign(1.0, dot) * end * share
        else:
            mixed = (
                np.sin(angle * (1 - share)) * start + np.copysign(1.0, dot) * np.sin(angle * share) * end
            ) / np.sin(angle)
        return mixed / np.linalg.norm(mixed)

    def rest_weights(self, node: dict[str, Any]) -> NDArray[np.float64]:
        """The weights of what a node shows where nothing moves them."""
        targets = self.document.meshes[node["mesh"]].targets if "mesh" in node else []
        return np.array([target.weight for target in targets])

    def moved(
        self,
        mesh: str,
        vertices: list[int],
        scene: tuple[list[NDArray[np.float64]], dict[int, NDArray[np.float64]]],
    ) -> list[list[float]]:
        """Where vertices of a mesh are that joints carry or weights move, at the first node that shows it."""
        worlds, weights = scene
        index = next(i for i, one in enumerate(self.document.json["meshes"]) if one.get("name") == mesh)
        shows = next(i for i, one in enumerate(self.nodes) if one.get("mesh") == index)
        node = self.nodes[shows]
        attributes = self.document.meshes[index].surfaces[0].attributes
        places = attributes["POSITION"][vertices].astype(float)
        for target, weight in zip(self.document.meshes[index].targets, weights[shows], strict=True):
            places = places + weight * target.attributes["POSITION"][vertices]
        points = np.concatenate([places, np.ones((len(vertices), 1))], axis=1)
        if "skin" not in node:
            return (points @ worlds[shows].T)[:, :3].tolist()
        skin = self.document.json["skins"][node["skin"]]
        binds = self.document.accessor(skin["inverseBindMatrices"]).astype(float).reshape(-1, 4, 4).transpose(0, 2, 1)
        maps = np.array([worlds[joint] @ bind for joint, bind in zip(skin["joints"], binds, strict=True)])
        joints = attributes["JOINTS_0"][vertices].astype(int)
        weights = attributes["WEIGHTS_0"][vertices].astype(float) / 255.0
        return np.einsum("vi,vijk,vk->vj", weights, maps[joints], points)[:, :3].tolist()


def weight_faults(document: Document) -> int:
    """Vertices whose written weights do not sum to exactly 255, or that name a joint with no weight."""
    faults = 0
    for mesh in document.meshes:
        for primitive in mesh.surfaces:
            if "WEIGHTS_0" in primitive.attributes:
                weights = primitive.attributes["WEIGHTS_0"].astype(int)
                joints = primitive.attributes["JOINTS_0"].astype(int)
                faults += int((weights.sum(axis=1) != 255).sum()) + int(((weights == 0) & (joints != 0)).sum())
    return faults
