"""The child process that fTetWild runs in: the only import of pytetwild.

A crash in its C++ code ends this process and not the user's, and it leaves files in its working folder.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import ctypes
import json
import sys
from pathlib import Path

import numpy as np

INPUT, OUTPUT = "input.npz", "output.npz"


def main(folder: Path) -> None:
    """Mesh what ``input.npz`` in the folder holds, and leave ``output.npz`` beside it."""
    if sys.platform == "linux":
        _flush_each_line()
    import pytetwild

    with np.load(folder / INPUT, allow_pickle=False) as content:
        points, triangles = content["points"], content["triangles"]
        options = json.loads(str(content["options"]))
        background = {name: content[name] for name in content.files if name.startswith("bg_")}
    mesh_points, tets = pytetwild.tetrahedralize(points, triangles, **options, **background)
    side = folder / f"side-{OUTPUT}"
    np.savez(side, points=mesh_points, tets=tets)
    side.rename(folder / OUTPUT)


def _flush_each_line() -> None:
    """Let fTetWild's C++ output reach its log line by line, since progress is read from there."""
    library = ctypes.CDLL(None)
    line_buffered = 1  # _IOLBF of setvbuf(3)
    library.setvbuf(ctypes.c_void_p.in_dll(library, "stdout"), None, line_buffered, ctypes.c_size_t(0))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
