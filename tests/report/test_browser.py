"""The page in a real browser: it shows, complains of nothing, and asks nobody for anything."""

# SPDX-License-Identifier: GPL-3.0-or-later

import http.server
import re
import shutil
import subprocess
import threading
from pathlib import Path

import pytest

from pipeline.progress import silent
from pipeline.report.page.page import filled, sections
from pipeline.report.views.render import Pictures
from tests.report.contents import whole

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync",
    "--disable-background-networking", "--disable-component-update", "--enable-logging=stderr", "--dump-dom",
)  # fmt: skip
OWN_BUSINESS = re.compile(r"(https?://)?(?!fonts)[\w.-]+\.google(apis)?\.com(:443|/)")
"""What Chromium asks its maker for at every start, whatever page it shows."""
PAGE = "http://report.test/report.html"


class _Proxy(http.server.BaseHTTPRequestHandler):
    """Stands between the browser and the rest of the world, of which there is the page alone."""

    asked: list[str]
    html: bytes

    def do_GET(self) -> None:
        self.asked.append(self.path)
        self.send_response(200 if self.path == PAGE else 404)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(self.html if self.path == PAGE else b"")

    def do_CONNECT(self) -> None:
        self.asked.append(self.path)
        self.send_error(403)

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing: what was asked is kept."""


def visit(html: str, profile: Path) -> tuple[list[str], list[str], str]:
    """Open a page; give what the browser asked for, what it complained of, and the page as it understood it."""
    assert CHROMIUM is not None
    handler = type("Handler", (_Proxy,), {"asked": [], "html": html.encode()})
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        command = [CHROMIUM, *FLAGS, f"--proxy-server=127.0.0.1:{server.server_port}", f"--user-data-dir={profile}"]
        answer = subprocess.run([*command, PAGE], capture_output=True, text=True, timeout=120, check=True)
        server.shutdown()
    return handler.asked, [line for line in answer.stderr.splitlines() if "CONSOLE" in line], answer.stdout  # type: ignore[attr-defined]


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not on the PATH")
def test_a_browser_shows_the_page_without_complaint_or_request(tmp_path: Path) -> None:
    content = whole()
    html = filled(content, sections(content, silent), Pictures({"duct": b"not shown by --dump-dom"}))
    asked, complaints, understood = visit(html, tmp_path / "profile")
    assert [url for url in asked if not OWN_BUSINESS.match(url)] == [PAGE]
    assert complaints == []
    # as many charts arrived as were sent: the markup is what it looks like
    assert understood.count("<svg") == html.count("<svg") > 10
