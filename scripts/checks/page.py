"""The verification page: one static HTML file with every claim, what each tool found, and pictures."""

from __future__ import annotations

import html
import json
import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from checks.finding import Finding

STYLE = """
body { font: 14px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 70rem; padding: 0 1rem;
  color: #1d2327 }
h1 { font-size: 1.5rem } h2 { font-size: 1.15rem; margin-top: 2.5rem }
table { border-collapse: collapse; width: 100% } th, td { text-align: left; padding: .2rem .6rem .2rem 0;
  border-bottom: 1px solid #e2e5e8; vertical-align: top; font-variant-numeric: tabular-nums }
td.value { font-family: ui-monospace, monospace; font-size: 12px; overflow-wrap: anywhere }
.pictures { display: flex; gap: 1rem } figure { flex: 1; max-width: 32rem; margin: .5rem 0 }
figcaption { color: #667 } img { width: 100%; border-radius: 4px }
.fails { background: #fde8e8 } .warns { background: #fff6dc } .quiet { color: #667 }
"""


def write(target: Path, findings: dict[str, list[Finding]], pictures: dict[str, dict[str, Path]]) -> None:
    """Write the page; picture addresses are relative to it."""
    wrong = sum(not f.holds and f.severity == "error" for found in findings.values() for f in found)
    total = sum(map(len, findings.values()))
    verdict = f"{len(findings)} assets, {total} comparisons, {wrong} disagreements"
    sections = [section(asset, found, pictures.get(asset, {})) for asset, found in findings.items()]
    target.write_text(
        "<!doctype html>\n<html lang=en><meta charset=utf-8><title>Kiln verification</title>"
        f"<style>{STYLE}</style>\n<h1>Kiln verification</h1>\n<p>{verdict}</p>\n" + "\n".join(sections) + "\n</html>\n",
        encoding="utf-8",
    )


def section(asset: str, findings: list[Finding], pictures: dict[str, Path]) -> str:
    """One asset: its pictures and the table of its findings, the failing ones first."""
    name = html.escape(asset)
    images = "".join(
        f'<figure><img src="{html.escape(picture.as_posix())}" alt="{name}"><figcaption>{drawer}</figcaption></figure>'
        for drawer, picture in pictures.items()
    )
    rows = "\n".join(row(f) for f in sorted(findings, key=lambda f: f.holds))
    return (
        f"<h2>{name}</h2>\n<div class=pictures>{images}</div>\n<table>\n<tr><th>fact<th>tool<th>claimed<th>found"
        f"<th>difference<th>allowed</tr>\n{rows}\n</table>"
    )


def row(finding: Finding) -> str:
    """One comparison."""
    kind = "" if finding.holds else f' class="{"fails" if finding.severity == "error" else "warns"}"'
    cells = [
        f"<td>{html.escape(finding.place)}",
        f'<td class="quiet">{html.escape(finding.tool)}',
        f'<td class="value">{html.escape(shown(finding.claimed))}',
        f'<td class="value">{html.escape(finding.message or shown(finding.found))}',
        f'<td class="value">{finding.difference:.2g}' if math.isfinite(finding.difference) else "<td>-",
        f'<td class="value">{finding.allowed:.2g}',
    ]
    return f"<tr{kind}>{''.join(cells)}</tr>"


def shown(value: Any) -> str:
    """A value in few characters."""
    if isinstance(value, float):
        return f"{value:.7g}"
    if isinstance(value, list):
        return "[" + ", ".join(map(shown, value)) + "]"
    if isinstance(value, dict):
        return ", ".join(f"{key} {shown(item)}" for key, item in value.items())
    return value if isinstance(value, str) else json.dumps(value)
