"""The numbers of a section of gmsh's file one after the other, from text and from binary alike."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable, Iterator

import numpy as np

from pipeline.nouns.arrays import Floats, Ints, require

_SIZE, _INT, _DOUBLE = np.dtype("<u8"), np.dtype("<i4"), np.dtype("<f8")


class Numbers:
    """A section's content and how far it was read."""

    def __init__(self, content: bytes, binary: bool, name: str) -> None:
        self._name, self._binary, self._at = name, binary, 0
        self._bytes = content if binary else b""
        self._words = [] if binary else content.split()

    def count(self) -> int:
        """Give the number that a section of version 2 starts with, in text even where the rest is binary."""
        if not self._binary:
            return int(self._take(_INT, 1)[0])
        line, _, self._bytes = self._bytes.partition(b"\n")
        return self._bounded(int(line))

    def sizes(self, count: int) -> list[int]:
        """Give counts, unsigned integers of 8 bytes."""
        return [self._bounded(int(number)) for number in self._take(_SIZE, count)]

    def blocks(self, version: str) -> int:
        """Give how many blocks of nodes or elements follow, and pass by what stands beside it."""
        (count, _) = self.sizes(2)
        if version == "4.1":
            self._take(_SIZE, 2)  # the lowest and the highest tag
        return count

    def _bounded(self, count: int) -> int:
        # a count that lies would make huge arrays, or loop for good
        most = len(self._bytes) if self._binary else len(self._words)
        require(0 <= count <= most, f"${self._name} says {count} entries, more than it has")
        return count

    def _take(self, kind: "np.dtype[np.generic]", count: int) -> "np.ndarray[tuple[int], np.dtype[np.generic]]":
        if self._binary:
            end = self._at + count * kind.itemsize
            require(count >= 0 and end <= len(self._bytes), f"${self._name} ends too early")
            values = np.frombuffer(self._bytes, kind, count, self._at)
        else:
            end = self._at + count
            require(count >= 0 and end <= len(self._words), f"${self._name} ends too early")
            values = np.array(self._words[self._at : end], np.float64 if kind is _DOUBLE else np.int64)
        self._at = end
        return values

    def ints(self, kind: "np.dtype[np.generic]", count: int) -> Ints:
        """Give integers."""
        return self._take(kind, count).astype(np.int64)

    def numbered(self, count: int, columns: int) -> tuple[Ints, Floats]:
        """Give rows of an integer and so many floats."""
        if self._binary:
            kind = np.dtype([("number", _INT), ("values", _DOUBLE, columns)])
            require(count * kind.itemsize <= len(self._bytes) - self._at, f"${self._name} ends too early")
            rows = np.frombuffer(self._bytes, kind, count, self._at)
            self._at += count * kind.itemsize
            return rows["number"].astype(np.int64), rows["values"].astype(np.float64)
        table = self._take(_DOUBLE, count * (columns + 1)).astype(np.float64).reshape(count, columns + 1)
        return table[:, 0].astype(np.int64), table[:, 1:]

    def elements_2(self, count: int, corners: dict[int, int]) -> Iterator[tuple[int, Ints]]:
        """Give the elements of version 2 by kind: rows of the first tag (0 where there is none) and the corners."""
        found: dict[tuple[int, int], list[Ints]] = {}
        if self._binary:
            done = 0
            while done < count:
                kind, several, tags = self.ints(_INT, 3).tolist()
                width = 1 + tags + self._size(kind, corners)
                require(0 < several <= count - done and tags >= 0, f"${self._name} is damaged")
                rows = self.ints(_INT, several * width).reshape(several, width)
                found.setdefault((kind, tags), []).append(rows[:, 1:])
                done += several
        else:
            values = self.ints(_INT, len(self._words) - self._at)
            for kind, tags, places in _rows_of_text(values.tolist(), count, corners, self._size):
                found.setdefault((kind, tags), []).append(values[places])
        for (kind, tags), parts in found.items():
            rows = np.concatenate(parts)
            group = rows[:, :1] if tags else np.zeros((len(rows), 1), np.int64)
            yield kind, np.concatenate([group, rows[:, tags:]], axis=1)

    def _size(self, kind: int, corners: dict[int, int]) -> int:
        require(kind in corners, f"its elements are of gmsh's kind {kind}, which is not read")
        return corners[kind]

    def entity(self, dimension: int, version: str) -> tuple[int, list[int]]:
        """Give an entity's tag and its physical groups."""
        tag = int(self.ints(_INT, 1)[0])
        self._take(_DOUBLE, 3 if dimension == 0 and version == "4.1" else 6)
        physical = self.ints(_INT, self.sizes(1)[0]).tolist()
        if dimension:
            self._take(_INT, self.sizes(1)[0])
        return tag, physical

    def node_block(self, version: str) -> tuple[Ints, Floats]:
        """Give the nodes of one entity."""
        # 4.0 has tag and dimension, 4.1 dimension and tag
        first, second, parametric = self.ints(_INT, 3).tolist()
        (count,) = self.sizes(1)
        dimension = first if version == "4.1" else second
        require(parametric in (0, 1) and 0 <= dimension <= 3, f"${self._name} is damaged")
        columns = 3 + parametric * dimension
        if version != "4.1":
            numbers, values = self.numbered(count, columns)
        else:
            numbers = self.ints(_SIZE, count)
            values = self._take(_DOUBLE, count * columns).astype(np.float64).reshape(count, columns)
        return numbers, values[:, :3]

    def element_block(self, version: str, corners: dict[int, int]) -> tuple[int, int, int, Ints]:
        """Give the elements of one entity: dimension, tag, kind, and corners."""
        first, second, kind = self.ints(_INT, 3).tolist()
        dimension, tag = (first, second) if version == "4.1" else (second, first)
        (count,) = self.sizes(1)
        width = 1 + self._size(kind, corners)
        rows = self.ints(_SIZE if version == "4.1" else _INT, count * width).reshape(count, width)
        return dimension, tag, kind, rows[:, 1:]


def _rows_of_text(
    values: list[int], count: int, corners: dict[int, int], size: Callable[[int, dict[int, int]], int]
) -> Iterator[tuple[int, int, Ints]]:
    """Kind, number of tags and places of the tags and corners of elements that stand after each other."""
    starts: dict[tuple[int, int], list[int]] = {}
    at = 0
    for _ in range(count):
        require(at + 3 <= len(values), "$Elements ends too early")
        kind, tags = values[at + 1], values[at + 2]
        require(tags >= 0, "an element has fewer than no tags")
        starts.setdefault((kind, tags), []).append(at + 3)
        at += 3 + tags + size(kind, corners)
    require(at <= len(values), "$Elements ends too early")
    for (kind, tags), places in starts.items():
        yield kind, tags, np.array(places)[:, None] + np.arange(tags + corners[kind])
