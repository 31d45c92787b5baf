"""A package for a course's own system: what names its parts is as the standard has it; the same lessons, the same
bytes."""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace
from xml.etree import ElementTree

import pytest

from app.cli import main
from app.export.course import manifest, package
from app.export.lesson import lesson_page
from app.lessons.reading import parse

HEAD = '+++\ntitle = "<Öl> & \\"Wasser\\""\ngoals = ["see"]\n+++\n\nBegin.\n'
READ = parse(HEAD + "\n## Explain: Only read\n\nNothing is asked.\n", "10-read")
LESSONS = [READ, replace(READ, name="11 zwei&drei", fingerprint="f" * 64)]
IMS, ADL = "{http://www.imsproject.org/xsd/imscp_rootv1p1p2}", "{http://www.adlnet.org/xsd/adlcp_rootv1p2}"


def silent(part, what):
    """Nobody looks at the progress."""


@pytest.fixture(scope="module")
def archive():
    made = package(LESSONS, 1, silent)
    assert made == package(LESSONS, 1, silent)
    with zipfile.ZipFile(io.BytesIO(made)) as files:
        yield files


def test_the_manifest_names_every_page_as_the_standard_has_it(archive):
    root = ElementTree.fromstring(archive.read("imsmanifest.xml"))
    assert root.tag == f"{IMS}manifest"
    assert [part.tag for part in root] == [f"{IMS}{name}" for name in ("metadata", "organizations", "resources")]
    said = {part.tag: part.text for part in root[0]}
    assert said == {f"{IMS}schema": "ADL SCORM", f"{IMS}schemaversion": "1.2"}
    (organization,), resources = root[1], {one.get("identifier"): one for one in root[2]}
    assert root[1].get("default") == organization.get("identifier")
    assert organization[0].tag == f"{IMS}title"
    items = organization.findall(f"{IMS}item")
    assert [item.find(f"{IMS}title").text for item in items] == ['<Öl> & "Wasser"'] * 2
    pages = [resources[item.get("identifierref")] for item in items]
    assert [(one.get("type"), one.get(f"{ADL}scormtype")) for one in pages] == [("webcontent", "sco")] * 2
    assert [one.get("href") for one in pages] == ["10-read.html", "11%20zwei%26drei.html"]
    assert all(one.find(f"{IMS}file").get("href") == one.get("href") for one in pages)
    assert archive.namelist() == ["imsmanifest.xml", "10-read.html", "11 zwei&drei.html"]
    identifiers = [one.get("identifier") for one in root.iter() if one.get("identifier")]
    assert len(set(identifiers)) == len(identifiers) and all(
        name[0].isalpha() and not set(name) & set(" &/:") for name in identifiers)


def test_a_lesson_that_has_changed_is_another_package():
    one, other = (manifest([replace(READ, fingerprint=letter * 64)]) for letter in "ab")
    assert "mpm-lab-10-read-aaaaaaaaaaaa" in one and "mpm-lab-10-read-bbbbbbbbbbbb" in other


def test_only_a_package_speaks_to_a_system(archive):
    page = archive.read("10-read.html").decode()
    plain = lesson_page(READ, 1, silent)
    assert "LMSInitialize" in page and "LMSInitialize" not in plain
    assert page.partition("<script>")[0] == plain.partition("<script>")[0], "as strict a policy, and the same page"


def test_several_lessons_are_packed_once_each(capsys, monkeypatch, tmp_path):
    asked = []
    monkeypatch.setattr("app.export.course.package", lambda lessons, *others, core: asked.extend(lessons) or b"PK")
    assert main(["export", "1", "04", "1", "--scorm", "--quiet", "--out", str(tmp_path / "a.zip")]) == 0
    assert [lesson.name for lesson in asked] == ["01-one-step", "04-grid-crossing"]
    assert (tmp_path / "a.zip").read_bytes() == b"PK"
