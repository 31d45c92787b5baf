"""Reader of VTK's files that name others: .pvd, with the moments of a run, .pvtu and .pvtp, with pieces of one."""

from pathlib import Path, PurePosixPath
from typing import IO

from solvers.judging.vtk_common import NotVTK, make_xml_parser, xml_errors_named
from solvers.untrusted import number_parsing
from solvers.untrusted.quoting import FileError, quote

#: By ending: the type that the file states, the elements that name files, and their attribute with the name.
ELEMENTS = {".pvd": ("Collection", "DataSet", "file"), ".pvtu": ("PUnstructuredGrid", "Piece", "Source"),
            ".pvtp": ("PPolyData", "Piece", "Source")}
MOST_FILES, LONGEST = 10_000, 10_000_000  # files, and bytes


def read_references(path: str, file: IO[bytes], kind: str) -> list[tuple[str, float | None]]:
    """Returns the paths of the files that an open file of this ``kind`` names, each with its time in s or None. They
    must be in its folder or below. Raises FileError otherwise, NotVTK for a file that is none of its kind."""
    type_name, element, attribute = ELEMENTS[kind]
    found: list[tuple[str, float | None]] = []

    def start_element(tag: str, attributes: dict[str, str]) -> None:
        if tag == "VTKFile" and attributes.get("type") != type_name:
            raise NotVTK(f"no {type_name}")
        if tag == element:
            name = PurePosixPath(attributes.get(attribute, "").replace("\\", "/"))
            if name.is_absolute() or ".." in name.parts or ":" in str(name) or not name.suffix:
                raise FileError(path, "names the file {name}; give one in its own folder or below", quote(name))
            time = attributes.get("timestep", "")
            found.append((str(Path(path).parent / name),
                          number_parsing.parse_float(time) if number_parsing.is_number(time) else None))
            if len(found) > MOST_FILES:
                raise FileError(path, "names more than {most:,} files; give fewer", MOST_FILES)

    parser = make_xml_parser(NotVTK("a document type or an entity"))
    parser.StartElementHandler = start_element
    with xml_errors_named():
        parser.Parse(file.read(LONGEST), True)
    if not found:
        raise NotVTK("no files that it names")
    return found
