"""Ctrl-C, SIGTERM and a closed terminal end a command: cleanly, with one sentence, and with the code shells expect.

Python raises its KeyboardInterrupt once, and where that happens inside a callback of a library written in C, as while
numba compiles, the exception is thrown away and the command goes on. Here it is raised again until it has arrived.
While a compiled module is loaded it waits: VTK's do not expect an exception then, and the process crashed.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import signal
import sys
from collections.abc import Iterator
from types import FrameType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

_NAMES = ("SIGINT", "SIGTERM", "SIGHUP")
_WORDS = {"SIGINT": "Ctrl-C", "SIGHUP": "the end of its terminal"}
_AGAIN = 0.1  # seconds until an interruption that was thrown away is raised again


class Interrupted(KeyboardInterrupt):
    """Raised at whatever the command is doing when it is asked to end."""


@contextlib.contextmanager
def interruptible() -> Iterator[None]:
    """End the process in order when it is asked to end within the block, and as it would when asked after it.

    For the whole of a command: what comes behind the block is Python's own end, which takes its time where large
    libraries are loaded, and all has been said and done.

    Raises
    ------
    SystemExit
        With 128 and the signal's number: 130 after Ctrl-C, 143 after SIGTERM.
    """
    kept = sys.unraisablehook
    sys.unraisablehook = _without_interruptions
    # one that is ignored, as nohup has it, stays ignored
    numbers = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]
    heard = [number for number in numbers if signal.getsignal(number) != signal.SIG_IGN]
    afterwards = signal.SIG_IGN
    asked: list[int] = []

    def interrupt(number: int, frame: FrameType | None) -> None:
        asked.append(number)
        _raise_again(True)
        if not _loading(frame):
            raise Interrupted

    try:
        for number in heard:
            signal.signal(number, interrupt)
        yield
    except (KeyboardInterrupt, Exception) as ended:
        if not asked and not isinstance(ended, KeyboardInterrupt):
            raise
        # a library may have made another error of it, as pydantic does while it builds its schemas
        # a second one ends the process on the spot
        afterwards = signal.SIG_DFL
        for each in heard:
            signal.signal(each, afterwards)
        number = asked[0] if asked else signal.SIGINT
        name = signal.Signals(number).name
        # who closed the terminal does not read this
        with contextlib.suppress(OSError, ValueError):
            sys.stderr.write(
                f"stopped by {_WORDS.get(name, name)}; finished stages are kept, and the same command continues\n"
            )
            sys.stderr.flush()
        raise SystemExit(128 + number) from None
    finally:
        for each in heard:
            signal.signal(each, afterwards)
        _raise_again(False)
        sys.unraisablehook = kept


def _raise_again(wanted: bool) -> None:
    """Raise an interruption again and again until it arrives, or end that."""
    if not hasattr(signal, "setitimer"):
        return

    def again(alarm: int, frame: FrameType | None) -> None:
        # in a block that cleans up after it, it has arrived, and must let that block end
        if not _arrived() and not _loading(frame):
            raise Interrupted

    signal.setitimer(signal.ITIMER_REAL, *((_AGAIN, _AGAIN) if wanted else (0.0, 0.0)))
    signal.signal(signal.SIGALRM, again if wanted else signal.SIG_DFL)


def _loading(frame: FrameType | None) -> bool:
    """Whether a compiled module is being loaded, and an interruption can be raised again once it is."""
    while frame is not None and hasattr(signal, "setitimer"):
        if frame.f_code.co_qualname.startswith("ExtensionFileLoader."):
            return True
        frame = frame.f_back
    return False


def _arrived() -> bool:
    handled = sys.exception()
    while handled is not None:
        if isinstance(handled, Interrupted):
            return True
        handled = handled.__context__
    return False


def _without_interruptions(thrown_away: "UnraisableHookArgs") -> None:
    if not isinstance(thrown_away.exc_value, Interrupted):
        sys.__unraisablehook__(thrown_away)
