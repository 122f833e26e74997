"""What a VTK file says about its sizes, before anything is unpacked: a file of kilobytes may ask for terabytes."""

# SPDX-License-Identifier: GPL-3.0-or-later

import base64
import binascii
import re
from pathlib import Path
from typing import IO
from xml.parsers import expat

from pipeline.machine import free_memory
from pipeline.nouns.arrays import require

PER_BYTE = 100
"""Bytes of points and cells that a byte of a file may hold: compressed meshes have up to some thirty."""
ALWAYS = 256 * 2**20
"""Bytes that any file may hold."""
PER_CELL = 1_500
"""Bytes that a cell of a grid takes here until it is a mesh of faces."""
_HEADERS = {"UInt32": 4, "UInt64": 8}
_KINDS = {"UnstructuredGrid", "ImageData", "StructuredGrid", "RectilinearGrid"}
_NUMBER = re.compile(rb"^\s*(POINTS|CELLS|CELL_TYPES|DIMENSIONS)\s+(\d+)(?:\s+(\d+))?(?:\s+(\d+))?", re.MULTILINE)


def refuse_bomb(path: Path, declared: int) -> None:
    """Refuse what would unpack to far more than the file, or more than the machine has.

    Raises
    ------
    ValueError
    """
    most = min(max(ALWAYS, PER_BYTE * path.stat().st_size), free_memory())
    require(
        declared <= most,
        f"it says that it holds {declared} bytes, where {most} bytes of memory are the most that it may take",
    )


def check_xml(path: Path) -> None:
    """Look at the sizes that an XML file of VTK declares.

    Raises
    ------
    ValueError
        If they are out of proportion, if the file names other files, or is none of VTK's.
    """
    _Scan(path).refuse()


def check_legacy(path: Path) -> None:
    """Look at the sizes that a file of VTK's older kind declares.

    Raises
    ------
    ValueError
        If the file cannot hold what it says.
    """
    content = path.read_bytes()
    require(content.startswith(b"# vtk DataFile"), "it does not start with # vtk DataFile")
    for match in _NUMBER.finditer(content):
        sizes = [int(number) for number in match.groups()[1:] if number is not None]
        if match[1] == b"DIMENSIONS":
            grid = 1
            for size in sizes:
                grid *= size
            require(
                grid * PER_CELL <= free_memory(),
                f"its grid of {grid} points needs more memory than there is",
            )
        else:
            # a number takes a byte at least, and a blank
            require(max(sizes) <= len(content), f"it says {max(sizes)} {match[1].decode()}, more than it has bytes")


class _Scan:
    """One pass through the file, in which only tags and the first bytes of arrays are looked at."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.kind = ""
        self.compressed = False
        self.big = False
        self.header = 4
        self.bytes = 0
        self.cells = 0
        self._wanted = self._depth = 0
        self._encoding = ""
        self._text = ""
        self._offsets: list[int] = []
        parser = expat.ParserCreate()
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._data
        parser.EntityDeclHandler = self._entity
        try:
            with path.open("rb") as file:
                while chunk := file.read(2**20):
                    at = chunk.find(b"<AppendedData")
                    if at >= 0:
                        self._appended(parser, file, chunk, at)
                        break
                    parser.Parse(chunk)
        except expat.ExpatError as problem:
            raise ValueError(f"it is no XML: {problem}") from None

    def refuse(self) -> None:
        require(
            self.kind in _KINDS,
            f"it is VTK's {self.kind[:40]}, not a mesh: {_INSTEAD}" if self.kind else "it is no VTKFile",
        )
        refuse_bomb(self.path, self.bytes)
        memory = free_memory()
        require(self.cells * PER_CELL <= memory, f"its {self.cells} cells need more memory than there is")

    def _entity(self, *about: object) -> None:
        raise ValueError("it defines entities, which no mesh needs")

    def _start(self, name: str, about: dict[str, str]) -> None:
        if name == "VTKFile":
            self.kind = about.get("type", "")
            self.compressed = "compressor" in about
            self.big = about.get("byte_order") == "BigEndian"
            self.header = _HEADERS.get(about.get("header_type", "UInt32"), 4)
        elif name == "Piece":
            require("Source" not in about, "it names other files, which a mesh file may not")
            points, cells = (int(about.get(key, "0") or 0) for key in ("NumberOfPoints", "NumberOfCells"))
            require(points >= 0 and cells >= 0, "a piece has fewer than no points or cells")
            # coordinates of 4 bytes; a kind of a byte and an offset of 4
            self.bytes += 12 * points + 5 * cells
            self.cells += max(cells, _extent(about.get("Extent", "")))
        elif name in ("Points", "Cells"):
            self._wanted += 1
        elif name == "DataArray" and self._wanted:
            self._encoding = about.get("format", "")
            self._text = ""
            if self._encoding == "appended":
                self._offsets.append(int(about.get("offset", "0")))

    def _data(self, text: str) -> None:
        if self._encoding == "binary" and len(self._text) < 64:
            self._text += text.strip()

    def _end(self, name: str) -> None:
        if name in ("Points", "Cells"):
            self._wanted -= 1
        elif name == "DataArray" and self._wanted:
            if self._encoding == "binary" and self.compressed:
                self.bytes += self._unpacked(self._decoded(self._text[:64].encode("ascii", "replace")))
            self._encoding = ""

    def _appended(self, parser: "expat.XMLParserType", file: IO[bytes], chunk: bytes, at: int) -> None:
        """Look at the header of each array behind the underscore."""
        parser.Parse(chunk[:at])
        head = chunk[at:] + file.read(4096)
        start = head.find(b"_", head.find(b">"))
        raw = b'encoding="raw"' in head[: head.find(b">")]
        require(start > 0, "its appended data do not start")
        if not self.compressed:
            return
        begin = file.tell() - len(head) + start + 1
        for offset in self._offsets:
            file.seek(begin + max(offset, 0))
            found = file.read(64)
            self.bytes += self._unpacked(found if raw else self._decoded(found))

    @staticmethod
    def _decoded(text: bytes) -> bytes:
        try:
            return base64.b64decode(text[: len(text) // 4 * 4])
        except binascii.Error:
            return b""

    def _unpacked(self, header: bytes) -> int:
        """Bytes that compressed blocks hold: their number, the size of each, and that of the last."""
        order = "big" if self.big else "little"
        size = self.header
        blocks, each, last = (int.from_bytes(header[k * size : (k + 1) * size], order) for k in range(3))  # type: ignore[arg-type]
        return blocks * each if not last else max(blocks - 1, 0) * each + last


_INSTEAD = "take the .vtu, .vti, .vts, .vtr or .vtk that it is made of"


def _extent(text: str) -> int:
    """Points of a grid by its first and last index each way."""
    words = text.split()
    if len(words) != 6:
        return 0
    count = 1
    for low, high in zip(words[::2], words[1::2], strict=True):
        count *= max(int(high) - int(low) + 1, 0)
    return count
