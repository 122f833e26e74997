"""Where numba keeps what it compiled: found before numba is loaded, or a job without a home would end there."""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
from pathlib import Path

_CACHE = "NUMBA_CACHE_DIR"


def make_room() -> None:
    """Give numba a folder for this process alone where it could write neither beside its sources nor into the home.

    Never a folder that others could have put something into: numba runs what it finds in its cache.
    """
    if _CACHE in os.environ or os.access(Path(__file__).parent / "geometry", os.W_OK):
        return
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser())
    while not home.exists():
        home = home.parent
    if os.access(home, os.W_OK):
        return
    import atexit
    import contextlib

    from pipeline.scratch import scratch_folder

    kept = contextlib.ExitStack()
    os.environ[_CACHE] = str(kept.enter_context(scratch_folder("numba")))
    atexit.register(kept.close)
