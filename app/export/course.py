"""Lessons as a package for a course's own system: SCORM 1.2, an archive with a page a lesson and what names them."""

import hashlib
import io
import re
import zipfile
from collections.abc import Mapping, Sequence
from urllib.parse import quote
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from app.export.lesson import COUNTS, lesson_page
from app.export.page import IN_A_COURSE, Progress
from app.lessons.lesson import Lesson

SPACES = {"xmlns": "http://www.imsproject.org/xsd/imscp_rootv1p1p2",
          "xmlns:adlcp": "http://www.adlnet.org/xsd/adlcp_rootv1p2"}
LONGEST_TITLE = 200  # letters of a title that every system takes
WRITTEN = (1980, 1, 1, 0, 0, 0)  # the archive's clock: the same lessons, the same bytes


def package(lessons: Sequence[Lesson], processes: int, on_progress: Progress,
            counts: Mapping[str, int] = COUNTS, core: bool = False) -> bytes:
    """The archive of lessons, each a part of its own that is opened, scored and completed by itself; it begins with the
    ``core`` alone where that is asked for."""
    pages = {}
    for number, lesson in enumerate(lessons):
        def so_far(part: float, what: str, number: int = number) -> None:
            on_progress((number + part) / len(lessons), what)

        pages[_file(lesson)] = lesson_page(lesson, processes, so_far, counts, core, IN_A_COURSE)
    return _archive({"imsmanifest.xml": manifest(lessons), **pages})


def manifest(lessons: Sequence[Lesson]) -> str:
    """What a system reads first: the parts in their order, and the page of each. Identifiers are made of a lesson's
    name and fingerprint, so that a lesson that has changed is another one."""
    keys = [_key(lesson) for lesson in lessons]
    whole = keys[0] if len(keys) == 1 else hashlib.sha256(" ".join(keys).encode()).hexdigest()[:24]
    root = Element("manifest", {"identifier": f"mpm-lab-{whole}", "version": "1.0", **SPACES})
    metadata = SubElement(root, "metadata")
    SubElement(metadata, "schema").text = "ADL SCORM"
    SubElement(metadata, "schemaversion").text = "1.2"
    organizations = SubElement(root, "organizations", {"default": "lessons"})
    organization = SubElement(organizations, "organization", {"identifier": "lessons"})
    SubElement(organization, "title").text = _title(lessons[0]) if len(lessons) == 1 else "mpm-lab"
    resources = SubElement(root, "resources")
    for lesson in lessons:
        key = _key(lesson)
        item = SubElement(organization, "item", {"identifier": f"item-{key}", "identifierref": f"page-{key}"})
        SubElement(item, "title").text = _title(lesson)
        resource = SubElement(resources, "resource", {"identifier": f"page-{key}", "type": "webcontent",
                                                      "adlcp:scormtype": "sco", "href": quote(_file(lesson))})
        SubElement(resource, "file", {"href": quote(_file(lesson))})
    indent(root)
    return tostring(root, encoding="unicode", xml_declaration=True).replace("'", '"', 4) + "\n"


def _key(lesson: Lesson) -> str:
    return re.sub(r"[^\w.-]", "-", f"{lesson.name}-{lesson.fingerprint[:12]}")


def _title(lesson: Lesson) -> str:
    """Its title, without letters that XML cannot have."""
    return "".join(letter for letter in lesson.title if letter.isprintable())[:LONGEST_TITLE]


def _file(lesson: Lesson) -> str:
    return f"{lesson.name}.html"


def _archive(texts: Mapping[str, str]) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in texts.items():
            entry = zipfile.ZipInfo(name, WRITTEN)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, text.encode())
    return made.getvalue()
