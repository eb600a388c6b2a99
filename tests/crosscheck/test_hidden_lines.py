"""Line drawings of the whole gallery against a z-buffer that shares no code with them.

A sample of an edge must be drawn as seen where nothing stands before it in any of the nine pixels around it, and as
hidden where in all of them something else stands well before it. Other samples decide nothing.
"""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import cKDTree

from checks.document import Document

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Kiln

ROOT = Path(__file__).resolve().parents[2]
SIZE = 500
FREE = 0.06
AZIMUTH, ELEVATION = np.radians([35.0, 22.0])
# A line with another this near decides nothing, pixels.
CROWDED = 1.5
# Files of drawings have two digits.
ON = 0.03
# Lines are looked for by places on them so far from each other, pixels.
STEP = 0.3
# Depths, in pixels: what is nearer by less does not stand before a sample; what hides it is nearer by so much, for a
# surface that comes towards the eye beside its own edge is not.
TOUCHING, BEFORE = 0.02, 6.0
SAMPLES = 3000


@dataclass
class Picture:
    """Triangles as they are seen: corners in pixels and depth, with the numbers of their points."""

    corners: NDArray[np.float64]
    points: NDArray[np.int64]

    @classmethod
    def of(cls, document: Document) -> Picture:
        """What a file shows at rest, by a camera that has all of it in its picture."""
        clouds, triangles = [np.zeros((0, 3))], [np.zeros((0, 3), np.int64)]
        lines = [np.zeros((0, 3))]
        for mesh, world in document.instances:
            shown = document.meshes[mesh]
            places = shown.positions
            for target in shown.targets:
                if target.weight and len(target.attributes["POSITION"]) == len(places):
                    places = places + target.weight * target.attributes["POSITION"]
            triangles.append(shown.triangles + sum(map(len, clouds)))
            clouds.append(places @ world[:3, :3].T + world[:3, 3])
            lines.append(shown.lines.positions @ world[:3, :3].T + world[:3, 3])
        points, numbers = np.unique(np.concatenate(clouds), axis=0, return_inverse=True)
        numbers = numbers.reshape(-1)[np.concatenate(triangles)]
        back = np.array([np.sin(AZIMUTH) * np.cos(ELEVATION), np.sin(ELEVATION), np.cos(AZIMUTH) * np.cos(ELEVATION)])
        right = np.array([np.cos(AZIMUTH), 0.0, -np.sin(AZIMUTH)])
        axes = np.stack([right, np.cross(back, right), back], axis=1)
        all_ = np.concatenate([points, *lines]) @ axes
        low, high = all_.min(axis=0), all_.max(axis=0)
        scale = (SIZE * (1 - 2 * FREE) / (high - low)[:2]).min()
        own = (points @ axes - (low + high) / 2) * scale
        own = np.stack([own[:, 0] + SIZE / 2, SIZE / 2 - own[:, 1], -own[:, 2]], axis=1)
        whole = (numbers != np.roll(numbers, 1, axis=1)).all(axis=1)
        return cls(own[numbers[whole]], numbers[whole])

    @cached_property
    def fragments(self) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.int64]]:
        """Pixel, depth and triangle of each middle of a pixel that a triangle covers."""
        flat = self.corners[:, :, :2]
        low = np.ceil(flat.min(axis=1) - 0.5).astype(int)
        span = (np.floor(flat.max(axis=1) - 0.5).astype(int) - low + 1).max(axis=1)
        found = []
        for size in (1, 2, 4, 8, 16):
            own = np.flatnonzero((span > size // 2) & (span <= size))
            steps = [(dx, dy) for dy in range(size) for dx in range(size)]
            found += [self.covered(own, low[own] + step) for step in steps]
        # Large ones by themselves.
        for one in np.flatnonzero(span > 16):
            rows, columns = np.mgrid[0 : span[one], 0 : span[one]]
            pixels = low[one] + np.stack([columns.ravel(), rows.ravel()], axis=1)
            found.append(self.covered(np.full(len(pixels), one), pixels))
        pixel, depth, name = (np.concatenate(part) for part in zip(*found, strict=True))
        return pixel, depth, name

    def covered(self, names: NDArray[np.int64], pixels: NDArray[np.int64]) -> tuple[NDArray[Any], ...]:
        """Those of the pixels, one for each triangle, that it covers."""
        a, b, c = (self.corners[names, k] for k in range(3))
        at = pixels + 0.5
        side = lambda p, q: (q[:, 0] - p[:, 0]) * (at[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (at[:, 0] - p[:, 0])  # noqa: E731
        shares = np.stack([side(b, c), side(c, a), side(a, b)], axis=1)
        area = shares.sum(axis=1)
        inside = np.abs(area) > 1e-12
        shares = shares / np.where(inside, area, 1.0)[:, None]
        inside &= (shares >= -1e-9).all(axis=1) & ((pixels >= 0) & (pixels < SIZE)).all(axis=1)
        depth = (shares * np.stack([a[:, 2], b[:, 2], c[:, 2]], axis=1)).sum(axis=1)
        return pixels[inside, 1] * SIZE + pixels[inside, 0], depth[inside], names[inside]

    @cached_property
    def buffer(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Of each pixel the nearest depth and its triangle; -1 where there is none."""
        pixel, depth, name = self.fragments
        order = np.lexsort((depth, pixel))
        first = order[np.flatnonzero(np.diff(pixel[order], prepend=-1))]
        depths, names = np.full(SIZE * SIZE, np.inf), np.full(SIZE * SIZE, -1)
        depths[pixel[first]], names[pixel[first]] = depth[first], name[first]
        return depths, names

    @cached_property
    def edges(self) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.bool_]]:
        """Edges that a drawing may show: their points, their ends, and whether it must: outlines and rims."""
        sides = np.concatenate([self.points[:, [k, (k + 1) % 3]] for k in range(3)])
        ends = np.concatenate([self.corners[:, [k, (k + 1) % 3]] for k in range(3)])
        names = np.tile(np.arange(len(self.points)), 3)
        keys, first, inverse, counts = np.unique(
            np.sort(sides, axis=1), axis=0, return_index=True, return_inverse=True, return_counts=True
        )
        inverse = inverse.reshape(-1)
        normals = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        order = np.argsort(inverse, kind="stable")
        starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
        one, other = names[order[starts]], names[order[np.minimum(starts + 1, len(order) - 1)]]
        pair = counts == 2
        cosine = (normals[one] * normals[other]).sum(axis=1)
        # Edge-on triangles face nowhere.
        turned = (normals[one, 2] * normals[other, 2] < 0) & (np.abs(normals[[one, other], 2]).min(axis=0) > 1e-6)
        must = ~pair | turned
        shown = must | (pair & (cosine < 0.8))
        return keys[shown], ends[first][shown], must[shown]


@dataclass
class Drawing:
    """The lines of a file: its pieces, the line of each, and of each line whether it is dashed."""

    pieces: NDArray[np.float64]
    line: NDArray[np.int64]
    dashed: NDArray[np.bool_]

    @classmethod
    def of(cls, text: str) -> Drawing:
        """The lines of an SVG file."""
        pieces, line, dashed = [np.zeros((0, 2, 2))], [], []
        for group, body in re.findall(r'<g class="([a-z ]+)"[^>]*>\n(.*?)</g>', text, flags=re.DOTALL):
            for path in re.findall(r'<path d="([^"]*)"', body):
                corners = np.array([float(number) for number in re.findall(r"-?[\d.]+", path)]).reshape(-1, 2)
                if path.endswith("Z"):
                    corners = np.concatenate([corners, corners[:1]])
                pieces.append(np.stack([corners[:-1], corners[1:]], axis=1))
                line += [len(dashed)] * (len(corners) - 1)
                dashed.append("hidden" in group)
        return cls(np.concatenate(pieces), np.array(line, int), np.array(dashed, bool))

    def nearest(self, at: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.bool_]]:
        """For each place how far the nearest line is, which, and whether no other is near."""
        start, along = self.pieces[:, 0], self.pieces[:, 1] - self.pieces[:, 0]
        steps = (np.linalg.norm(along, axis=1) / STEP).astype(int) + 2
        piece = np.repeat(np.arange(len(steps)), steps)
        share = (np.arange(len(piece)) - np.repeat(np.cumsum(steps) - steps, steps)) / np.repeat(steps - 1, steps)
        tree = cKDTree(start[piece] + share[:, None] * along[piece])
        away, line = np.full(len(at), np.inf), np.zeros(len(at), int)
        alone = np.ones(len(at), bool)
        for number, near in enumerate(tree.query_ball_point(at, CROWDED + STEP)):
            own = np.unique(piece[near])
            t = ((at[number] - start[own]) * along[own]).sum(axis=1) / np.maximum((along[own] ** 2).sum(axis=1), 1e-12)
            far = np.linalg.norm(start[own] + t.clip(0, 1)[:, None] * along[own] - at[number], axis=1)
            if len(own):
                away[number], line[number] = far.min(), self.line[own[far.argmin()]]
                alone[number] = len(set(self.line[own[far < CROWDED]].tolist())) <= 1
        return away, line, alone


def compared(picture: Picture, text: str) -> tuple[int, int, int, int]:
    """How many samples must be seen, must be hidden, are drawn so, and are of edges that are missing."""
    drawing = Drawing.of(text)
    points, ends, must = picture.edges
    long = np.linalg.norm((ends[:, 1] - ends[:, 0])[:, :2], axis=1)
    kept = np.flatnonzero(long > 1.0)
    counts = np.ceil(long[kept] / 4).astype(int)
    edge = np.repeat(kept, counts)
    step = np.arange(len(edge)) - np.repeat(np.cumsum(counts) - counts, counts)
    share = (step + 0.5) / np.repeat(counts, counts)
    if len(edge) > SAMPLES:
        chosen = np.sort(np.random.default_rng(7).choice(len(edge), SAMPLES, replace=False))
        edge, share = edge[chosen], share[chosen]
    at = ends[edge, 0] + share[:, None] * (ends[edge, 1] - ends[edge, 0])
    away, line, alone = drawing.nearest(at[:, :2])
    missing = int((alone & must[edge] & (away > 1.0)).sum())
    own = alone & (away <= ON)
    # The nine pixels around it.
    depths, names = picture.buffer
    column, row = (np.floor(at[:, k]).astype(int) for k in (0, 1))
    around = [
        (row + dy).clip(0, SIZE - 1) * SIZE + (column + dx).clip(0, SIZE - 1) for dy in (-1, 0, 1) for dx in (-1, 0, 1)
    ]
    pixels = np.stack(around, axis=1)
    depth, name = depths[pixels], names[pixels]
    corners = np.where(name[:, :, None] >= 0, picture.points[name], -1)
    shared = (corners[:, :, :, None] == points[edge][:, None, None, :]).any(axis=2).sum(axis=2)
    # Its own triangles do not stand before it; one at its end may, and may come towards the eye as well.
    seen = ((shared == 2) | (depth >= at[:, 2:] - TOUCHING)).all(axis=1)
    hidden = ((shared == 0) & (depth < at[:, 2:] - BEFORE)).all(axis=1)
    dash = drawing.dashed[line]
    right = (own & seen & ~dash) | (own & hidden & dash)
    return int((own & seen).sum()), int((own & hidden).sum()), int(right.sum()), missing


def test_lines_are_seen_and_hidden_as_by_a_z_buffer(kiln: Kiln) -> None:
    shutil.copytree(ROOT / "specs", kiln.folder / "specs")
    done = kiln.run("bake", "specs", "--out", "out", "--no-report", "--profile", "core", seconds=1200)
    assert done.returncode == 0, done.stderr
    files = sorted((kiln.folder / "out").rglob("*.glb"))
    assert len(files) > 100
    table = {}
    for file in files:
        words = ["--orthographic", "--view", "35,22", "--size", str(SIZE), "-o", "lines.svg", "--quiet"]
        done = kiln.run("render", str(file), *words)
        assert done.returncode == 0, done.stderr
        picture = Picture.of(Document(file))
        if len(picture.points):
            table[file.stem] = compared(picture, (kiln.folder / "lines.svg").read_text(encoding="utf-8"))
    seen, hidden, right, missing = (sum(column) for column in zip(*table.values(), strict=True))
    worst = sorted(table.items(), key=lambda one: one[1][2] - one[1][0] - one[1][1] - one[1][3])[:8]
    assert seen > 20_000, seen
    assert hidden > 5_000, hidden
    assert right >= 0.999 * (seen + hidden), worst
    assert missing <= 0.001 * (seen + hidden), worst
