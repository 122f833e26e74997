"""A page as PDF, printed by a browser that is installed; nothing else sets a page as its reader sees it."""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
import shutil
import subprocess
from pathlib import Path

from pipeline import child_process
from pipeline.errors import StageError
from pipeline.scratch import scratch_folder
from pipeline.writing import write_whole

_BROWSERS = (
    "chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "microsoft-edge",
    "microsoft-edge-stable", "msedge", "brave-browser",
)  # fmt: skip
_ELSEWHERE = (
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    "/Applications/Microsoft Edge.app/Contents/MacOS/Microsoft Edge",
    "C:/Program Files/Google/Chrome/Application/chrome.exe",
    "C:/Program Files (x86)/Microsoft/Edge/Application/msedge.exe",
)
_FLAGS = (
    "--headless", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync", "--no-pdf-header-footer",
    "--disable-background-networking", "--disable-component-update", "--disable-extensions",
)  # fmt: skip
_TIME_LIMIT = 180.0  # seconds; a page of ten pictures takes three


def browser() -> str:
    """Give the browser that prints.

    Raises
    ------
    StageError
        If there is none.
    """
    found = next((path for name in _BROWSERS if (path := shutil.which(name))), None)
    found = found or next((path for path in _ELSEWHERE if Path(path).is_file()), None)
    if found is None:
        raise StageError(
            "no browser that prints a PDF is installed: install Chromium, Chrome or Edge (on Debian, apt-get install "
            "chromium), or open the page in any browser and print it"
        )
    return found


def print_page(page: Path, pdf: Path) -> None:
    """Print a page.

    Parameters
    ----------
    page : Path
        The page (.html).
    pdf : Path
        The file to write; its folder is made if it is not there.

    Raises
    ------
    StageError
        If there is no browser, or it does not print.
    """
    program = browser()
    # a browser refuses to run for root inside its sandbox; the page has no script
    flags = [*_FLAGS, "--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else [*_FLAGS]
    with scratch_folder("pdf") as folder:
        made, log = folder / "page.pdf", folder / "log"
        command = [program, *flags, f"--user-data-dir={folder / 'profile'}", f"--print-to-pdf={made}"]
        with child_process.started([*command, page.resolve().as_uri()], folder, log, scratch=[folder]) as child:
            try:
                child.wait(_TIME_LIMIT)
            except subprocess.TimeoutExpired:
                raise StageError(f"{program} did not print {page} within {_TIME_LIMIT:.0f} s") from None
        if not made.is_file():
            said = log.read_text(errors="replace").strip().splitlines()
            raise StageError(f"{program} did not print {page}: {said[-1] if said else 'it said nothing'}")
        write_whole(pdf, made.read_bytes())
