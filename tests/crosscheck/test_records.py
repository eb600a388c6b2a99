"""What is recorded for services that show it: SARIF, JUnit, annotations, and the parts that machines share."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kiln import Kiln

BOX = "[shape.s.box]\nsize = [1, 1, 1]\n"
WRONG = '[shape.s.box]\nsize = [1, 1, 1]\n"höhe" = 3\n'
TWICE = "[shape.s.sphere]\nradius = 1\n[shape.s.box]\nsize = [1, 1, 1]\n"
FOLDED = "[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\nfaces = [[0, 2, 1, 3]]\n"


def prepare(kiln: Kiln) -> None:
    (kiln.folder / "specs" / "a & b").mkdir(parents=True)
    kiln.write(BOX, "specs/good")
    kiln.write(WRONG, "specs/a & b/wrong")
    kiln.write(TWICE, "specs/twice")
    kiln.write(FOLDED, "specs/folded")


def text_under(kiln: Kiln, region: dict[str, int], path: str) -> str:
    """The text of a region of one line; columns count characters."""
    assert region["startLine"] == region["endLine"]
    line = (kiln.folder / path).read_text(encoding="utf-8").splitlines()[region["startLine"] - 1]
    return line[region["startColumn"] - 1 : region["endColumn"] - 1]


@pytest.mark.parametrize("command", ["bake", "check"])
def test_sarif_names_rule_place_and_level(kiln: Kiln, command: str) -> None:
    prepare(kiln)
    assert kiln.run(command, "specs", "--sarif", "found/log.sarif").returncode == 1
    log = json.loads((kiln.folder / "found" / "log.sarif").read_text(encoding="utf-8"))
    assert log["version"] == "2.1.0"
    (run,) = log["runs"]
    rules = {rule["id"] for rule in run["tool"]["driver"]["rules"]}
    results = {result["ruleId"]: result for result in run["results"]}
    assert set(results) == rules
    unknown = results["K0101"]
    assert unknown["level"] == "error"
    place = unknown["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"] == "specs/a%20%26%20b/wrong.toml"
    assert text_under(kiln, place["region"], "specs/a & b/wrong.toml") == '"höhe"'
    assert results["K0831"]["level"] == "warning"
    related = [result for result in run["results"] if "relatedLocations" in result]
    assert all(place["message"]["text"] for result in related for place in result["relatedLocations"])
    again = kiln.run(command, "specs", "--sarif", "again.sarif")
    assert again.returncode == 1
    assert (kiln.folder / "again.sarif").read_bytes() == (kiln.folder / "found" / "log.sarif").read_bytes()


def test_junit_counts_documents_and_failures(kiln: Kiln) -> None:
    prepare(kiln)
    assert kiln.run("check", "specs", "--junit", "junit.xml").returncode == 1
    suite = ET.parse(kiln.folder / "junit.xml").getroot().find("testsuite")
    assert suite is not None
    cases = {case.get("name"): case for case in suite.findall("testcase")}
    assert set(cases) == {f"specs/{name}.toml" for name in ("good", "a & b/wrong", "twice", "folded")}
    assert (suite.get("tests"), suite.get("failures")) == ("4", "2")
    failure = cases["specs/a & b/wrong.toml"].find("failure")
    assert failure is not None
    assert "höhe" in (failure.text or "")
    assert len(cases["specs/good.toml"]) == 0
    assert "K0831" in (cases["specs/folded.toml"].findtext("system-err") or "")


def test_annotations_stand_in_the_output(kiln: Kiln) -> None:
    prepare(kiln)
    done = kiln.run("check", "specs", "--format", "github")
    assert done.returncode == 1
    lines = [line for line in done.stdout.splitlines() if line.startswith("::")]
    (unknown,) = [line for line in lines if "title=K0101" in line]
    assert unknown.startswith("::error file=specs/a & b/wrong.toml,line=3,endLine=3,col=1,endColumn=7,title=K0101::")
    assert any(line.startswith("::warning file=specs/folded.toml") for line in lines)
    assert "K0101" in done.stderr


def test_a_record_that_cannot_be_written_fails(kiln: Kiln) -> None:
    kiln.write(BOX)
    (kiln.folder / "file").write_text("no folder")
    done = kiln.run("check", "model.toml", "--junit", "file/junit.xml")
    assert done.returncode == 3
    assert "cannot write" in done.stderr


def test_shards_are_all_documents_once(kiln: Kiln) -> None:
    (kiln.folder / "specs").mkdir()
    for index in range(11):
        kiln.write(BOX, f"specs/s{index}")
    baked: list[str] = []
    for part in (1, 2, 3):
        out = f"out{part}"
        assert kiln.run("bake", "specs", "--no-report", "--out", out, "--shard", f"{part}/3").returncode == 0
        found = sorted(path.name for path in (kiln.folder / out).iterdir())
        assert len(found) in (3, 4)
        baked += found
    assert sorted(baked) == sorted(f"s{index}.glb" for index in range(11))
    for wrong in ("0/3", "4/3", "x", "1/0"):
        assert kiln.run("bake", "specs", "--shard", wrong).returncode == 2
    # More machines than documents: some have nothing to do.
    kiln.write(BOX)
    assert kiln.run("bake", "model.toml", "--shard", "2/2").returncode == 0
