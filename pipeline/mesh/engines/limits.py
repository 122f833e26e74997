"""How long an engine may take."""

# SPDX-License-Identifier: GPL-3.0-or-later

import time

from pipeline.errors import StageError
from pipeline.progress import Progress


def within(seconds: float, who: str, advice: str, progress: Progress) -> Progress:
    """Let progress be told for so long, and end the work with an error when it is told of afterwards.

    Parameters
    ----------
    seconds : float [s]
        Wall time from now.
    who : str
        What is ended.
    advice : str
        What to do, as the end of a message.
    progress : Progress
        Who is told.

    Returns
    -------
    Progress
        Raises StageError once the time is over.
    """
    end = time.monotonic() + seconds
    doing = "starting"

    def told(what: str, done: float | None = None) -> None:
        nonlocal doing
        if time.monotonic() > end:
            raise StageError(f"{who} was ended after {seconds:.3g} s, the limit, while {doing}; {advice}")
        doing = what
        progress(what, done)

    return told
