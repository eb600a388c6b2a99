"""Claims of a report held against what the tools measured.

A claim that a tool measures must hold within what that tool's own rounding explains; a claim that must be
there and is missing, or that no tool could measure, is a finding too. Lengths are in meters.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from checks.finding import Finding, Measured

if TYPE_CHECKING:
    from collections.abc import Iterator

Facts = dict[str, Any]

# Relative error of a sum over the mesh. trimesh and numpy sum doubles; MeshLab returns single precision
# areas; Blender stores single precision and computes areas and volumes in it.
PRECISION = {"written": 1e-9, "trimesh": 1e-9, "meshlab": 1e-6, "blender": 1e-5, "three": 1e-6}
# Coordinates are written in single precision and only ever copied or turned by a node's matrix.
ANGLE = 1e-3  # degrees
COORDINATE = 1e-6

# Tools that play clips, and how far their poses may be from the report's, in sizes of the model.
PLAYERS = {"written", "three", "blender"}
POSED = 1e-4

COUNTS = {
    "primitives", "triangles", "vertices", "points", "closed", "manifold", "components", "euler", "genus",
    "boundary-edges", "boundary-loops", "crowded-edges", "misoriented-edges", "degenerate-triangles", "meshes",
    "nodes", "materials", "images",
    "draw-calls", "drawn-triangles", "segments", "drawn-segments", "drawn-vertices", "bytes", "blake3",
    "lines.curves", "lines.closed-curves", "lines.segments", "lines.vertices",
}  # fmt: skip
MEASURES = {"bounds", "area", "volume", "acmr", "atvr", "lines.length", "lines.bounds"}
REQUIRED_OF_LINES = (
    "lines.curves", "lines.closed-curves", "lines.segments", "lines.vertices", "lines.length", "lines.bounds",
)  # fmt: skip
# What a shape without triangles has none of, so that no tool speaks about it.
OF_SURFACES = {"area", "volume", "centroid", "inertia", "genus", "boundary-loops"}
REQUIRED_OF_SHAPE = (
    "primitives", "triangles", "vertices", "points", "bounds", "area", "volume", "centroid", "inertia",
    "inertia-of", "closed", "manifold", "components", "euler", "genus", "boundary-edges", "boundary-loops",
    "crowded-edges", "misoriented-edges", "degenerate-triangles", "acmr", "atvr", "deviation",
)  # fmt: skip
REQUIRED_OF_TOTALS = (
    "meshes", "primitives", "triangles", "vertices", "materials", "images", "nodes", "draw-calls",
    "drawn-triangles", "bounds",
)  # fmt: skip
# What a profile may require, and the findings of the validator that cannot be helped: it does not know the extension,
# counts the buffer of compressed bytes as unused where all views are compressed, and the accessors of joined vertices.
PROFILES = {
    "core": [],
    "quantized": ["KHR_mesh_quantization"],
    "web": ["KHR_mesh_quantization", "EXT_meshopt_compression"],
    "verify": [],
    "bevy": [],
    "godot": [],
    "unreal": [],
    "unity": ["KHR_mesh_quantization"],
    "three": ["KHR_mesh_quantization"],
    "babylon": ["KHR_mesh_quantization"],
    "blender": [],
}
EXPECTED = {
    "web": ("UNSUPPORTED_EXTENSION at /extensionsUsed", "UNUSED_OBJECT at /buffers/0:"),
    "verify": ("UNSUPPORTED_EXTENSION at /extensionsUsed", "UNUSED_OBJECT at /accessors/"),
}
# The validator does not know the extension of levels of detail either, nor that it uses nodes.
OF_LEVELS = ("UNSUPPORTED_EXTENSION at /extensionsUsed", "UNUSED_OBJECT at /nodes/")
# Coordinates of a lightmap wait for the picture that an engine bakes, and have those of textures before them.
OF_LIGHTMAPS = re.compile(r"UNUSED_OBJECT at /meshes/\d+/primitives/\d+/attributes/TEXCOORD_[01]:")
# The validator knows the extension of properties that change and says that it does not look at all of it.
OF_PROPERTIES = "INCOMPLETE_EXTENSION_SUPPORT at /animations/"
# Shine along a direction needs tangents, and readers that make their own make them of texture coordinates: the
# validator looks for a texture alone.
OF_ANISOTROPY = re.compile(
    r"UNUSED_(MESH_TANGENT|OBJECT) at /meshes/\d+/primitives/\d+/attributes/T(ANGENT|EXCOORD_0):"
)
# Copies that are drawn at once: it knows neither the extension nor that it uses accessors.
INSTANCES = "EXT_mesh_gpu_instancing"
INSTANCED = ("web", "unity", "three", "babylon", "blender")
OF_INSTANCES = ("UNSUPPORTED_EXTENSION at /extensions", "UNUSED_OBJECT at /accessors/")
# It says of pictures beside a `.glb` that they are beside it.
OF_PICTURES = "URI_GLB at /images/"
# What a level of detail has in common with the finest.
LIKE_THE_FINEST = ("closed", "manifold", "components", "euler")
# Directions of bytes are of unit length within what rounding three of them takes, on an octahedron or not.
BYTE_DIRECTION = 0.013
# Every file must hold these whatever the report says. A normal of unit length in single precision is
# off by about 1e-7 a component.
REPEATS = "repeated-triangles"
COLLAPSED = "collapsed-triangles"
# Tools that split a mesh into its primitives count the vertices that several share once for each: all of them, or
# those that the primitive uses. No report says these numbers: they are counted in the file, and the tools are held
# against that.
DRAWN = "drawn-vertices"
SEPARATE = "separate-vertices"
DEMANDS = {
    "validator-errors": 0,
    "validator-warnings": 0,
    "validator-infos": 0,
    "required-extensions": [],
    "weight-faults": 0,
    "unused-vertices": 0,
    "largest-normal-error": 1e-6,
}


@dataclass(frozen=True)
class Scale:
    """The sizes that rounding errors of one shape grow with."""

    reach: float
    area: float
    volume: float
    length: float

    @classmethod
    def of(cls, claims: Facts) -> Scale:
        """The scale of a shape from its claimed bounds, area and volume."""
        return cls(
            reach=max(map(abs, flat(claims.get("bounds", {}))), default=0.0),
            area=abs(number(claims.get("area"))),
            volume=abs(number(claims.get("volume"))),
            length=abs(number(claims.get("lines.length"))),
        )

    def allowed(self, fact: str, tool: str) -> float:
        """The largest difference in `fact` that `tool`'s rounding explains.

        Volumes are sums of tetrahedra to the origin, so they lose digits with area times reach.
        """
        precision = PRECISION.get(tool, 0.0)
        volume_error = precision * (self.volume + self.area * self.reach)
        return {
            "bounds": COORDINATE * self.reach,
            "lines.bounds": COORDINATE * self.reach,
            "lines.length": precision * self.length,
            "area": precision * self.area,
            "volume": volume_error,
            "closed-volume": volume_error,
            "solid-centroid": precision * self.reach + volume_error * self.reach / (self.volume or 1.0),
            "surface-centroid": precision * self.reach,
            "solid-inertia": volume_error * self.reach**2,
            "surface-inertia": precision * self.area * self.reach**2,
            "acmr": 1e-6,
            "atvr": 1e-6,
        }.get(fact, 0.0)


def compare(asset: str, report: Facts, measured: list[Measured]) -> list[Finding]:
    """Every finding for one asset."""
    report = {**report, "shapes": by_mesh({n: with_lines(shape) for n, shape in report.get("shapes", {}).items()})}
    findings = list(missing(asset, report))
    claimed = with_counted(report["shapes"], measured)
    for one in measured:
        if one.error is not None:
            findings.append(failure(asset, one.tool, one.error))
            continue
        totals = {"segments": 0, "drawn-segments": 0, **report.get("totals", {}), **report.get("file", {})}
        for other in measured:
            totals |= {fact: value for fact, value in other.totals.items() if fact == DRAWN}
        profile = report.get("profile", "core")
        findings += facts(asset, ("totals", profile), totals, one.tool, expected(report, one.totals))
        findings += shapes(asset, (claimed, profile, set(report.get("colliders", {})) - set(claimed)), one)
        findings += nodes(asset, report, one)
        findings += clips(asset, report, one)
        findings += levels(asset, report, one)
        findings += colliders(asset, report, one)
    findings += deviations(asset, report.get("shapes", {}))
    return findings + list(unmeasured(asset, report, findings))


def expected(report: Facts, totals: Facts) -> Facts:
    """The totals without what the validator must say of a profile, levels, properties, lightmaps and looks."""
    known = EXPECTED.get(report.get("profile", "core"), ())
    if any(len(chain) > 1 for chain in report.get("lods", {}).values()):
        known += OF_LEVELS
    if any(clip.get("properties") for clip in report.get("clips", {}).values()):
        known += (OF_PROPERTIES,)
    if report["file"].get("pictures"):
        known += (OF_PICTURES,)
    if INSTANCES in report["file"].get("used-extensions", []):
        known += OF_INSTANCES
    told = totals.get("validator-messages", [])
    left = [message for message in told if not message.startswith(known)]
    if any(shape.get("lightmap") for shape in report["shapes"].values()):
        left = [message for message in left if not OF_LIGHTMAPS.match(message)]
    if "KHR_materials_anisotropy" in report["file"].get("used-extensions", []):
        left = [message for message in left if not OF_ANISOTROPY.match(message)]
    dropped = len(told) - len(left)
    if not dropped:
        return totals
    return {**totals, "validator-messages": left, "validator-infos": totals["validator-infos"] - dropped}


def by_mesh(shapes: dict[str, Facts]) -> dict[str, Facts]:
    """The claims by the names of meshes: what nodes show with several materials is a mesh for each."""
    return {name: claims for own, claims in shapes.items() for name in claims.get("meshes", [own])}


def with_lines(claims: Facts) -> Facts:
    """The claims, those about lines and about states beside the others."""
    states = {
        f"morphs.{name}.{fact}": value
        for name, state in claims.get("morphs", {}).items()
        for fact, value in state.items()
    }
    return {**claims, **{f"lines.{fact}": value for fact, value in (claims.get("lines") or {}).items()}, **states}


def with_counted(claimed: dict[str, Facts], measured: list[Measured]) -> dict[str, Facts]:
    """The claims, with what is counted in the file alone.

    These are triangles that lie on another one or have two corners in one place, which Blender's import drops, and
    vertices by primitive.
    """
    counted: dict[str, Facts] = {name: {REPEATS: 0, COLLAPSED: 0} for name in claimed}
    for one in measured:
        for name in set(claimed) & set(one.shapes):
            found = one.shapes[name]
            counted[name] |= {fact: found[fact] for fact in (REPEATS, COLLAPSED, DRAWN, SEPARATE) if fact in found}
    return {name: {**claims, **counted[name]} for name, claims in claimed.items()}


def shapes(asset: str, told: tuple[dict[str, Facts], str, set[str]], one: Measured) -> Iterator[Finding]:
    """The findings of one tool about the shapes of a file of a profile; both sides must name the same ones.

    Meshes that are bodies for physics are no shapes.
    """
    claimed, profile, bodies = told
    if one.shapes:
        names, found = sorted(claimed), sorted(set(one.shapes) - bodies)
        yield Finding(asset, "shapes", one.tool, names, found, differs(names, found), 0.0)
    for name in sorted(set(claimed) & set(one.shapes)):
        yield from facts(asset, (f"shapes.{name}", profile), claimed[name], one.tool, one.shapes[name])


def nodes(asset: str, report: Facts, one: Measured) -> Iterator[Finding]:
    """The world matrices of one tool; every node of the report must be found."""
    reach = max(map(abs, flat(report.get("totals", {}).get("bounds", {}))), default=0.0)
    for node in report.get("nodes", []) if one.nodes else []:
        found, name = one.nodes.get(node["name"]), node["name"]
        allowed = COORDINATE * max(reach, 1.0)
        if node.get("joint") and one.tool == "blender":
            allowed *= 10.0  # bones are chains of single precision matrices there
        yield Finding(asset, f"nodes.{name}", one.tool, node["matrix"], found, differs(node["matrix"], found), allowed)


def clips(asset: str, report: Facts, one: Measured) -> Iterator[Finding]:
    """The poses of one tool that plays clips.

    Each of them must be found, within a ten thousandth of the model's size. A player that turns along straight
    lines between keys is held to the bound of the clip besides, which promises both ways.
    """
    if one.tool not in PLAYERS:
        return
    for name, clip in report.get("clips", {}).items():
        if one.tool == "written":
            yield from reaches(asset, (name, clip), one)
            yield from drivers(asset, (name, clip), one)
        box = clip["bounds"]
        size = math.dist(box["min"], box["max"])
        allowed = POSED * size + (2.0 * clip["bound"] if one.tool == "blender" else 0.0)
        found = one.clips.get(name, [])
        if len(found) != len(clip["poses"]):
            yield failure(asset, one.tool, f"plays {len(found)} of {len(clip['poses'])} poses", f"clips.{name}")
            continue
        for claim, other in zip(clip["poses"], found, strict=True):
            place = f"clips.{name}.{claim['time']:.3f}"
            for node, matrix in claim["nodes"].items():
                seen = other["nodes"].get(node)
                yield Finding(asset, f"{place}.{node}", one.tool, matrix, seen, turned(matrix, seen, size), allowed)
            for mesh, vertices in claim["vertices"].items():
                told = [vertex["at"] for vertex in vertices]
                seen = other["vertices"].get(mesh)
                yield Finding(asset, f"{place}.{mesh}", one.tool, told, seen, differs(told, seen), allowed)
            # Other players have no numbers of what only changes, or do not know the extension.
            for pointer, numbers in claim.get("properties", {}).items() if one.tool == "written" else ():
                seen, near = other["properties"].get(pointer), COORDINATE * max(1.0, *map(abs, numbers))
                yield Finding(asset, f"{place}{pointer}", one.tool, numbers, seen, differs(numbers, seen), near)


def reaches(asset: str, named: tuple[str, Facts], one: Measured) -> Iterator[Finding]:
    """How near joints come to their targets, in each frame and at worst."""
    name, clip = named
    for joint, task in clip.get("reaches", {}).items():
        place = f"clips.{name}.reaches.{joint}"
        told = [frame["distance"] for frame in task["frames"]]
        found = one.reaches.get(name, {}).get(joint)
        yield Finding(asset, place, one.tool, told, found, differs(told, found), COORDINATE)
        worst = max(found or [math.inf])
        yield Finding(
            asset, f"{place}.worst", one.tool, task["worst"], worst, differs(task["worst"], worst), COORDINATE
        )


def drivers(asset: str, named: tuple[str, Facts], one: Measured) -> Iterator[Finding]:
    """How weights follow the angles of the joints that drive them."""
    name, clip = named
    for of, task in clip.get("drivers", {}).items():
        place, found = f"clips.{name}.drivers.{of}", one.drivers.get(name, {}).get(of, {})
        for fact, allowed in (("angle", ANGLE), ("weight", COORDINATE)):
            told, seen = [frame[fact] for frame in task["frames"]], found.get(f"{fact}s")
            yield Finding(asset, f"{place}.{fact}", one.tool, told, seen, differs(told, seen), allowed)
        # An angle that is off by so much moves the weight by its part of the way.
        allowed = COORDINATE + ANGLE / abs(task["to"] - task["from"])
        told, seen = task["worst"], found.get("worst")
        yield Finding(asset, f"{place}.worst", one.tool, told, seen, differs(told, seen), allowed)


def levels(asset: str, report: Facts, one: Measured) -> Iterator[Finding]:
    """Levels of detail, each beside the one before and the finest.

    It has fewer triangles, is closed where the finest is, in as many parts with as many holes, has no border where that
    has none, is no further from it than both may be from the surface, and nothing of it is lost.
    """
    for name, chain in report.get("lods", {}).items():
        if not all(level["mesh"] in one.shapes for level in chain):
            continue
        finest = one.shapes[chain[0]["mesh"]]
        for before, level in pairwise(chain):
            place, found = f"lods.{name}.{level['level']}", one.shapes[level["mesh"]]
            same = [(fact, finest[fact]) for fact in LIKE_THE_FINEST if fact in found]
            if "boundary-edges" in found and finest["boundary-edges"] == 0:
                same.append(("boundary-edges", 0))
            for fact, told in [("triangles", level["triangles"]), *same]:
                if fact in found:
                    seen = found[fact]
                    yield Finding(asset, f"{place}.{fact}", one.tool, told, seen, differs(told, seen), 0.0)
            # The error bounds how far a level is from its surfaces. Where two of them meet in an edge both may be off,
            # and a corner may be cut off; what is further away is lost.
            told = 2.0 * (chain[0]["error"] + level["error"])
            for fact in ("level-distance", "level-lost"):
                if fact in found:
                    seen = found[fact]
                    yield Finding(asset, f"{place}.error", one.tool, told, seen, max(0.0, seen - told), 1e-6 * told)
            if drawn(level) >= drawn(before):
                yield failure(asset, "report", f"has no fewer triangles than level {before['level']}", place)


def colliders(asset: str, report: Facts, one: Measured) -> Iterator[Finding]:
    """Bodies for physics that stand in extras: their volumes, and that they hold what they stand for."""
    found = one.totals.get("colliders", {})
    for name, claim in report.get("colliders", {}).items():
        if name not in found:
            continue
        seen, place = found[name], f"colliders.{name}"
        volume = abs(claim["volume"])
        gap = abs(claim["volume"] - seen["volume"])
        yield Finding(asset, f"{place}.volume", one.tool, claim["volume"], seen["volume"], gap, 1e-5 * volume)
        for fact, told in (("vertices", claim.get("vertices")), ("parts", claim.get("parts")), ("convex", True)):
            if fact in seen:
                yield Finding(asset, f"{place}.{fact}", one.tool, told, seen[fact], differs(told, seen[fact]), 0.0)
        if claim["of"] in seen["outside"]:
            # Both are in single precision.
            allowed = max(2.0 * claim["outside"], 1e-6 * max(1.0, volume ** (1 / 3)))
            away = seen["outside"][claim["of"]]
            yield Finding(asset, f"{place}.outside", one.tool, claim["outside"], away, away, allowed)


def drawn(level: Facts) -> int:
    """Triangles and segments of a level of detail."""
    return level["triangles"] + level.get("segments", 0)


def turned(claimed: list[float], found: list[float] | None, size: float) -> float:
    """How far apart two places are: the origins, and axes that reach a tenth of the model's size as it is scaled."""
    if found is None:
        return math.inf
    scale = max(1.0, *(math.hypot(*claimed[start : start + 3]) for start in (0, 4, 8)))
    axes = max(abs(a - b) for a, b in zip(claimed[:12], found[:12], strict=True)) / scale
    return max(axes * size / 10.0, *(abs(a - b) for a, b in zip(claimed[12:15], found[12:15], strict=True)))


def facts(asset: str, at: tuple[str, str], claims: Facts, tool: str, measured: Facts) -> Iterator[Finding]:
    """The findings about one shape or about the totals, of a file of a profile."""
    place, profile = at
    scale = Scale.of(claims)
    for fact, found in measured.items():
        if fact.rpartition(".")[2] in DEMANDS:
            yield demand(asset, (f"{place}.{fact}", profile), tool, found, measured)
        elif fact == "self-intersections":
            yield from intersections(asset, place, claims, tool, found)
        elif (claim := claim_for(fact, claims)) is not None:
            name, claimed = claim
            allowed = scale.allowed(fact.removeprefix("proper-"), tool)
            if fact.startswith("morphs.") and fact.endswith((".bounds", ".furthest")):
                allowed = scale.allowed("bounds", tool)
            yield Finding(asset, f"{place}.{name}", tool, claimed, found, differs(claimed, found), allowed)


def claim_for(fact: str, claims: Facts) -> tuple[str, Any] | None:
    """The claim that a tool's fact speaks about, or None where it speaks about none.

    `proper-` facts are Blender's, whose import drops collapsed triangles and repeated ones. `solid-`,
    `surface-`, `closed-` and `manifold-` facts meet a claim about such a shape only. `edge-manifold` is half of
    what `manifold` claims.
    """
    kind, _, rest = fact.partition("-")
    if fact == "edge-manifold":
        return ("manifold", True) if claims.get("manifold") else None
    if kind == "proper":
        return proper(rest, claims)
    if kind in ("solid", "surface") and rest in ("centroid", "inertia"):
        return (rest, claims.get(rest)) if claims.get("inertia-of") == kind else None
    if kind in ("closed", "manifold") and rest:
        return (rest, claims.get(rest)) if claims.get(kind) else None
    known = fact in COUNTS or fact in MEASURES or (kind.startswith("morphs.") and fact in claims)
    return (fact, claims[fact]) if known and fact in claims else None


def proper(fact: str, claims: Facts) -> tuple[str, Any] | None:
    """The claim for a mesh that lost its collapsed triangles; none where it lost more than the count tells."""
    collapsed = claims.get(COLLAPSED, 0)
    if claims.get(REPEATS):
        return None
    if fact == "triangles":
        return fact, claims.get(fact, 0) - collapsed
    return claim_for(fact, claims) if collapsed == 0 else None


def demand(asset: str, at: tuple[str, str], tool: str, found: Any, measured: Facts) -> Finding:
    """A finding about what every file of a profile must hold."""
    place, profile = at
    fact = place.rpartition(".")[2]
    wanted = DEMANDS[fact]
    if fact == "required-extensions":
        wanted = PROFILES.get(profile, [])
        found = [one for one in found if one != INSTANCES or profile not in INSTANCED]
    elif fact == "largest-normal-error" and PROFILES.get(profile):
        # A state of a morph adds two vectors that are rounded each.
        wanted = BYTE_DIRECTION * (2 if ".morphs." in place else 1)
    if isinstance(wanted, float):
        return Finding(asset, place, tool, 0.0, found, found, wanted)
    message = "; ".join(measured.get("validator-messages", [])) if found != wanted else ""
    return Finding(asset, place, tool, wanted, found, differs(wanted, found), 0.0, message=message)


def intersections(asset: str, place: str, claims: Facts, tool: str, found: int) -> Iterator[Finding]:
    """A warning when a shape claimed closed has faces that cut each other: it bounds no solid there."""
    if claims.get("closed") and found:
        message = f"{found} triangles of a closed shape cut one another"
        place = f"{place}.self-intersections"
        yield Finding(asset, place, tool, 0, found, float(found), 0.0, severity="warning", message=message)


def missing(asset: str, report: Facts) -> Iterator[Finding]:
    """A finding for each claim that every report must make."""
    demands = [("totals", REQUIRED_OF_TOTALS, report.get("totals", {}))]
    demands += [("file", ("name", "bytes", "blake3"), report.get("file", {}))]
    demands += [(f"shapes.{name}", required(claims), claims) for name, claims in report.get("shapes", {}).items()]
    if not report.get("shapes"):
        yield failure(asset, "report", "the report names no shape")
    for place, wanted, claims in demands:
        for fact in wanted:
            if fact not in claims:
                yield failure(asset, "report", f"`{place}.{fact}` is missing", f"{place}.{fact}")


def required(claims: Facts) -> tuple[str, ...]:
    """What a shape must claim."""
    return REQUIRED_OF_SHAPE + (REQUIRED_OF_LINES if "lines" in claims else ())


def deviations(asset: str, claimed: dict[str, Facts]) -> Iterator[Finding]:
    """The report against itself: the bound is within the tolerance, the measured within the bound."""
    for name, claims in claimed.items():
        deviation = claims.get("deviation") or {}
        for lower, upper in (("bound", "tolerance"), ("measured", "bound")):
            low, high = deviation.get(lower), deviation.get(upper)
            if low is not None and high is not None:
                place = f"shapes.{name}.deviation.{lower}"
                yield Finding(asset, place, "report", high, low, max(0.0, low - high), 1e-9 * abs(high))


def unmeasured(asset: str, report: Facts, findings: list[Finding]) -> Iterator[Finding]:
    """A finding for each claim that no tool spoke about, so that no number passes unread.

    Volume, genus and boundary loops mean something on manifold shapes only; the tools keep silent on others.
    """
    spoken = {finding.place for finding in findings if finding.tool != "report"}
    for name, claims in report.get("shapes", {}).items():
        silent = {"inertia-of", "deviation"}
        if not claims.get("manifold"):
            silent |= {"volume", "genus", "boundary-loops"}
        if not claims.get("triangles"):
            silent |= OF_SURFACES
        for fact in required(claims):
            place = f"shapes.{name}.{fact}"
            if fact in claims and fact not in silent and place not in spoken:
                yield failure(asset, "report", f"no tool measured `{place}`", place)


def failure(asset: str, tool: str, message: str, place: str = "") -> Finding:
    """A finding that says why nothing could be compared."""
    return Finding(asset, place, tool, None, None, math.inf, 0.0, message=message)


def differs(claimed: Any, found: Any) -> float:
    """The largest difference between two values of the same form; infinite when the forms differ."""
    left, right = flat(claimed), flat(found)
    if is_numbers(left) and is_numbers(right) and len(left) == len(right):
        if form(claimed) != form(found):
            return math.inf
        return max((distance(a, b) for a, b in zip(left, right, strict=True)), default=0.0)
    return 0.0 if claimed == found else math.inf


def distance(a: float, b: float) -> float:
    """|a - b|, infinite where it is not a number."""
    gap = abs(a - b)
    return gap if math.isfinite(gap) else math.inf


def flat(value: Any) -> list[Any]:
    """The leaves of nested lists and tables, tables in the order of their keys."""
    if isinstance(value, dict):
        return [leaf for key in sorted(value) for leaf in flat(value[key])]
    if isinstance(value, list):
        return [leaf for item in value for leaf in flat(item)]
    return [value]


def form(value: Any) -> Any:
    """The nesting of a value without its leaves."""
    if isinstance(value, dict):
        return {key: form(item) for key, item in value.items()}
    return [form(item) for item in value] if isinstance(value, list) else None


def is_numbers(values: list[Any]) -> bool:
    """Whether all values are numbers; truth values are not."""
    return all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)


def number(value: Any) -> float:
    """A number, or zero for anything else."""
    return float(value) if is_numbers([value]) else 0.0
