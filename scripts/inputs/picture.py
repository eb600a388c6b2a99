"""A small drawing surface: antialiased strokes, discs and boxes on 8-bit RGB, and a PNG writer."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

Color = tuple[int, int, int]
Point = tuple[float, float]
SIGNATURE = b"\x89PNG\r\n\x1a\n"


class Picture:
    """Pixels in rows from the top; coordinates in pixels, x to the right, y down."""

    def __init__(self, width: int, height: int, color: Color) -> None:
        self.width, self.height = width, height
        self.pixels = bytearray(bytes(color) * (width * height))

    def blend(self, x: int, y: int, color: Color, cover: float) -> None:
        """Lay `color` over one pixel, `cover` of it from 0 to 1; outside the picture nothing happens."""
        if cover <= 0.0 or not (0 <= x < self.width and 0 <= y < self.height):
            return
        at, cover = 3 * (y * self.width + x), min(cover, 1.0)
        for channel in range(3):
            below = self.pixels[at + channel]
            self.pixels[at + channel] = int(below + (color[channel] - below) * cover + 0.5)

    def fill(self, low: Point, high: Point, color: Color, distance: Callable[[float, float], float]) -> None:
        """Paint where `distance(x, y)` is negative, within the box from low to high; edges are smooth."""
        for y in range(int(low[1]) - 2, int(high[1]) + 3):
            for x in range(int(low[0]) - 2, int(high[0]) + 3):
                self.blend(x, y, color, 0.5 - distance(x + 0.5, y + 0.5))

    def box(self, low: Point, high: Point, color: Color) -> None:
        """A filled box with sides along the axes."""
        self.fill(low, high, color, lambda x, y: max(low[0] - x, x - high[0], low[1] - y, y - high[1]))

    def disc(self, center: Point, radius: float, color: Color) -> None:
        """A filled circle."""
        low = (center[0] - radius, center[1] - radius)
        high = (center[0] + radius, center[1] + radius)
        self.fill(low, high, color, lambda x, y: length(x - center[0], y - center[1]) - radius)

    def line(self, start: Point, end: Point, width: float, color: Color) -> None:
        """A stroke with round ends."""
        low = (min(start[0], end[0]) - width, min(start[1], end[1]) - width)
        high = (max(start[0], end[0]) + width, max(start[1], end[1]) + width)
        self.fill(low, high, color, lambda x, y: to_segment((x, y), start, end) - width / 2)

    def write(self, path: Path) -> None:
        """Write the PNG, unless the file already holds these pixels.

        Two builds of zlib may pack the same pixels into different bytes; what is committed stays.
        """
        rows = b"".join(b"\0" + self.pixels[3 * self.width * y : 3 * self.width * (y + 1)] for y in range(self.height))
        if path.exists() and same_rows(path.read_bytes(), rows):
            return
        header = struct.pack(">IIBBBBB", self.width, self.height, 8, 2, 0, 0, 0)
        path.write_bytes(
            SIGNATURE
            + chunk(b"IHDR", header)
            + chunk(b"IDAT", zlib.compress(filtered(rows, self.width), 9))
            + chunk(b"IEND", b"")
        )


def length(x: float, y: float) -> float:
    """The length of a plane vector."""
    return (x * x + y * y) ** 0.5


def to_segment(point: Point, start: Point, end: Point) -> float:
    """The distance from a point to a segment."""
    along = (end[0] - start[0], end[1] - start[1])
    offset = (point[0] - start[0], point[1] - start[1])
    square = along[0] * along[0] + along[1] * along[1]
    t = 0.0
    if square > 0.0:
        t = min(1.0, max(0.0, (offset[0] * along[0] + offset[1] * along[1]) / square))
    return length(offset[0] - t * along[0], offset[1] - t * along[1])


def chunk(kind: bytes, data: bytes) -> bytes:
    """One PNG chunk with its length and checksum."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def filtered(rows: bytes, width: int) -> bytes:
    """Every row as differences to the row above (PNG filter 2), which packs flat areas and grain well."""
    stride = 3 * width + 1
    out = bytearray()
    above = bytes(stride)
    for start in range(0, len(rows), stride):
        row = rows[start : start + stride]
        out.append(2)
        out += bytes((a - b) & 0xFF for a, b in zip(row[1:], above[1:], strict=True))
        above = row
    return bytes(out)


def same_rows(png: bytes, rows: bytes) -> bool:
    """Whether a PNG written here before holds the same rows."""
    at = png.find(b"IDAT")
    size = struct.unpack(">I", png[at - 4 : at])[0]
    packed = zlib.decompress(png[at + 4 : at + 4 + size])
    stride = 3 * struct.unpack(">I", png[16:20])[0] + 1
    return packed == filtered(rows, stride // 3)
