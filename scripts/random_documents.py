"""Random documents, written by the schema of the language alone: every kind, nested, with numbers of all sizes.

    scripts/random_documents.py --count 1000 --seed 7 --out FOLDER     writes documents and bakes none

Most are refused, for the schema does not say what fits together; all of them must be refused with a diagnostic or baked
into files that are right. The same seed gives the same documents.
"""

from __future__ import annotations

import argparse
import json
import random
import re
from pathlib import Path
from typing import Any

SCHEMA = Path(__file__).resolve().parent.parent / "docs" / "kiln.schema.json"

# Kinds that read files, which a random name does not find.
FILES = {"import", "image", "raw", "svg", "motion-import"}

# Numbers that people write, and some that they do not.
USUAL = [1.0, 0.5, 2.0, 0.25, 3.0, 0.1, 1.5, 0.3, 30.0, 90.0, -0.5, -1.0, 0.0]
UNUSUAL = [1e-9, -1e-9, 1e-4, 1e4, -1e5, 1e9, 0.333333333333, 1e-300, 1e30, 7.0, 17.0, 360.0]

# What random definitions can refer to.
SOUND = """
[curve.round.circle]
radius = 0.5
[curve.path.natural-spline]
points = [[0.2, 0, 0], [0.5, 0.4, 0], [0.3, 1, 0]]
[curve.line.polyline]
points = [[0.1, 0], [0.4, 0.3], [0.2, 0.9]]
[material.plain]
color = "#8a5c33"
[field.ball.sphere]
radius = 0.6
[map.hills.noise]
seed = 4
[shape.block.box]
size = [1, 0.5, 0.75]
[shape.pebble.sphere]
radius = 0.4
[shape.sheet.patches]
degree = 1
control = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0.3]]]
"""
NAMES = {
    "curve": ["round", "path", "line"],
    "shape": ["block", "pebble", "sheet"],
    "material": ["plain"],
    "field": ["ball"],
    "map": ["hills"],
}
# Fields that hold nothing but a name.
WORDS = {
    "material": "material",
    "of": "shape",
    "shape": "shape",
    "curve": "curve",
    "profile": "curve",
    "curves": "curve",
}

DEEPEST = 7


class Writer:
    """Writes documents by a schema."""

    def __init__(self, schema: dict[str, Any], seed: int) -> None:
        """The same seed writes the same documents."""
        self.schema = schema
        self.rolls = random.Random(seed)

    def document(self) -> str:
        """A document of one to four random definitions, at least one of them a shape, beside sound ones."""
        sections = [
            "shape",
            *(name for name in ("curve", "material", "field", "map", "node") if self.rolls.random() < 0.1),
        ]
        lines = [f"tolerance = {self.rolls.choice([0.1, 0.02, 0.005, 1.0])}", "limits = { triangles = 200000 }", SOUND]
        for section in sections:
            entry = self.schema["properties"][section]
            value = self.value(entry.get("additionalProperties", entry), 0, section)
            lines.append(f"[{section}.random]")
            lines += [f"{key(field)} = {toml(item)}" for field, item in value.items()]
        return "\n".join(lines) + "\n"

    def value(self, schema: dict[str, Any], depth: int, field: str) -> Any:
        """Something that a schema allows."""
        if "$ref" in schema:
            return self.value(self.schema["$defs"][schema["$ref"].rsplit("/", 1)[1]], depth, field)
        if "enum" in schema:
            return self.rolls.choice(schema["enum"])
        if "const" in schema:
            return schema["const"]
        if "anyOf" in schema:
            return self.choice(schema["anyOf"], depth, field)
        kinds = schema.get("type", "string")
        kinds = [kinds] if isinstance(kinds, str) else [kind for kind in kinds if kind != "null"]
        if "array" in kinds:
            return self.array(schema, depth, field)
        if "properties" in schema or ("additionalProperties" in schema and "object" in kinds):
            return self.table(schema, depth)
        if "integer" in kinds or "number" in kinds:
            return self.number(schema, whole="number" not in kinds)
        if "boolean" in kinds:
            return self.rolls.random() < 0.5
        return self.text(schema, field)

    def choice(self, choices: list[dict[str, Any]], depth: int, field: str) -> Any:
        """One of several; names of what is defined where tables of a section are among them."""
        choices = [choice for choice in choices if choice.get("pattern") != "^= "] or choices
        tables = [choice["$ref"].rsplit("/", 1)[1] for choice in choices if "$ref" in choice]
        section = next((name for name in tables if name in NAMES), None)
        simple = [choice for choice in choices if "$ref" not in choice]
        # Below, names end what would nest without end.
        if section and simple and self.rolls.random() < (0.5 if depth < DEEPEST else 1.0):
            return self.rolls.choice(NAMES[section])
        if section:
            simple = []
        return self.value(self.rolls.choice(simple if depth >= DEEPEST and simple else choices), depth, field)

    def array(self, schema: dict[str, Any], depth: int, field: str) -> list[Any]:
        """A few items."""
        fewest = schema.get("minItems", 0)
        most = min(schema.get("maxItems", fewest + 4), fewest + 4)
        fewest = min(max(fewest, self.rolls.choice([1, 2, 3, 3])), most)
        count = self.rolls.randint(fewest, max(fewest, most))
        if "prefixItems" in schema:
            return [self.value(item, depth + 1, field) for item in schema["prefixItems"]]
        items = schema.get("items", {"type": "number"})
        return [self.value(items, depth + 1, field) for _ in range(count)]

    def table(self, schema: dict[str, Any], depth: int) -> dict[str, Any]:
        """Required fields, some others, and one of the kinds where there are kinds."""
        fields = schema.get("properties", {})
        wanted = list(schema.get("required", []))
        kinds = [one["required"][0] for one in schema.get("oneOf", []) if "required" in one]
        if schema.get("maxProperties") == 1:
            kinds = list(fields)
        if kinds:
            wanted.append(self.rolls.choice([kind for kind in kinds if kind not in FILES] or kinds))
        for field in fields:
            if field not in wanted and field not in kinds and field not in FILES and self.rolls.random() < 0.15:
                wanted.append(field)
        made = {field: self.value(fields[field], depth + 1, field) for field in wanted if field in fields}
        if isinstance(schema.get("additionalProperties"), dict):
            for name in ("one", "two")[: self.rolls.randint(1, 2)]:
                made[name] = self.value(schema["additionalProperties"], depth + 1, name)
        return made

    def number(self, schema: dict[str, Any], *, whole: bool) -> float | int:
        """A number within bounds."""
        low = schema.get("minimum", schema.get("exclusiveMinimum"))
        high = schema.get("maximum", schema.get("exclusiveMaximum"))
        number = self.rolls.choice(USUAL if self.rolls.random() < 0.97 else UNUSUAL)
        if self.rolls.random() < 0.3:
            number = round(self.rolls.uniform(-2, 2), 3)
        if low is not None and number <= low:
            number = low if "minimum" in schema and self.rolls.random() < 0.3 else low + abs(number) + 0.5
        if high is not None and number > high:
            number = high
        return int(min(max(number, -1e9), 1e9)) if whole else float(number)

    def text(self, schema: dict[str, Any], field: str) -> str:
        """A name, a formula, or what a pattern asks for."""
        pattern = schema.get("pattern", "")
        if "#" in pattern:
            return "#8a5c33"
        if pattern.startswith("^= "):
            return "= " + self.rolls.choice(["0.5", "1 + 2", "sin(30)", "2 ^ 3 / 7", "0.3 * x", "u * 0.01", "t"])
        if self.rolls.random() < 0.03:
            return "nothing"
        return self.rolls.choice(NAMES[WORDS.get(field, self.rolls.choice(list(NAMES)))])


def key(name: str) -> str:
    """A key of TOML."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else json.dumps(name)


def toml(value: Any) -> str:
    """A value of TOML, on one line."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key(name)} = {toml(item)}" for name, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value)


def write(folder: Path, count: int, seed: int) -> list[Path]:
    """Writes documents into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    writer = Writer(json.loads(SCHEMA.read_text(encoding="utf-8")), seed)
    paths = []
    for index in range(count):
        path = folder / f"d{index:05}.toml"
        path.write_text(writer.document(), encoding="utf-8")
        paths.append(path)
    return paths


def main() -> None:
    """Writes documents."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    write(arguments.out, arguments.count, arguments.seed)


if __name__ == "__main__":
    main()
