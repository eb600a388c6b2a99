"""trimesh: revolve and sweep of its creation module: `peer_trimesh.py CASE OUT.glb`."""

from __future__ import annotations

import math
import sys

import trimesh

from models import TUBE_RADIUS, TUBE_SEGMENTS, TURN_SEGMENTS, path, profile


def vase() -> trimesh.Trimesh:
    """The profile revolved."""
    return trimesh.creation.revolve(profile(), sections=TURN_SEGMENTS)


def sweep() -> trimesh.Trimesh:
    """A polygon swept along the path."""
    from shapely.geometry import Polygon

    turns = [2 * math.pi * i / TUBE_SEGMENTS for i in range(TUBE_SEGMENTS)]
    circle = Polygon([(TUBE_RADIUS * math.cos(a), TUBE_RADIUS * math.sin(a)) for a in turns])
    return trimesh.creation.sweep_polygon(circle, path())


if __name__ == "__main__":
    made = {"vase": vase, "sweep": sweep}[sys.argv[1]]()
    made.export(sys.argv[2], include_normals=True)
