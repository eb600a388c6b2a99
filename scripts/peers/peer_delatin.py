"""Ground within an error by pydelatin, as a binary glTF file: peer_delatin.py HEIGHTS.npy ERROR OUT.glb."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from pydelatin import Delatin


def main() -> None:
    """Triangulate and write."""
    heights, error, out = np.load(sys.argv[1]), float(sys.argv[2]), Path(sys.argv[3])
    made = Delatin(heights, max_error=error)
    points = np.asarray(made.vertices, "<f4").reshape(-1, 3)[:, [0, 2, 1]]
    corners = np.asarray(made.triangles, "<u4").reshape(-1)
    out.write_bytes(glb(np.ascontiguousarray(points), corners))


def glb(points: np.ndarray, corners: np.ndarray) -> bytes:
    """One mesh of points and triangles."""
    data = points.tobytes() + corners.tobytes()
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(data)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": points.nbytes, "target": 34962},
            {"buffer": 0, "byteOffset": points.nbytes, "byteLength": corners.nbytes, "target": 34963},
        ],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": len(points),
                "type": "VEC3",
                "min": points.min(0).tolist(),
                "max": points.max(0).tolist(),
            },
            {"bufferView": 1, "componentType": 5125, "count": len(corners), "type": "SCALAR"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = len(text).to_bytes(4, "little") + b"JSON" + text + len(data).to_bytes(4, "little") + b"BIN\0" + data
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks


if __name__ == "__main__":
    main()
