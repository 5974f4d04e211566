"""Screenshots of the built site, on a desk and on a phone, light and dark; the browser's console must stay empty.

``python docs/building/screenshots.py SITE FOLDER [PAGE ...]`` serves SITE on this machine, and writes a PNG for each page and look.
Needs Chromium.
"""

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

PAGES = (
    "", "generated/gallery/", "quick-start/", "limits/", "coming-from/pyvrp/", "notebooks/first_tour/", "generated/variants/",
    "generated/command-line/", "reference/functions/",
)  # fmt: skip
LOOKS = {"desk-light": ("1280,1000", 1), "desk-dark": ("1280,1000", 0), "phone-light": ("500,900", 1), "phone-dark": ("500,900", 0)}
"""Window, and Chromium's preferred colour scheme (0 dark, 1 light); headless windows are at least 500 wide."""

NOISE = re.compile(r"INFO:CONSOLE.*\"(.*)\", source: (.*) \(")


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        return


@contextmanager
def served(site: Path) -> Iterator[str]:
    """Address of ``site`` on this machine."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(site)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_address[1]}/"
    finally:
        server.shutdown()


def browser() -> str:
    """Path of Chromium; raises FileNotFoundError where there is none."""
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if found := shutil.which(name):
            return found
    raise FileNotFoundError("no Chromium is installed (Debian: apt-get install chromium)")


def screenshot(address: str, target: Path, window: str, scheme: int, seconds: int = 60) -> list[str]:
    """Write a picture of a page, and return what the page wrote to the console."""
    with tempfile.TemporaryDirectory() as profile:
        words = [
            browser(), "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--enable-logging=stderr",
            "--virtual-time-budget=4000", f"--user-data-dir={profile}", f"--window-size={window}",
            f"--blink-settings=preferredColorScheme={scheme}", f"--screenshot={target}", address,
        ]  # fmt: skip
        ended = subprocess.run(words, capture_output=True, text=True, timeout=seconds)
    return [f"{text} ({where})" for text, where in NOISE.findall(ended.stderr)]


def main(arguments: Sequence[str] | None = None) -> int:
    """All pages in all looks; exit code 1 where a console is not empty."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("site", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("pages", nargs="*", default=PAGES, help="below the site's root, such as quick-start/")
    asked = parser.parse_args(arguments)
    asked.folder.mkdir(parents=True, exist_ok=True)
    said = 0
    with served(asked.site) as root:
        for page in asked.pages:
            for look, (window, scheme) in LOOKS.items():
                target = (asked.folder / f"{page.strip('/').replace('/', '-') or 'home'}-{look}.png").resolve()
                for line in screenshot(root + page, target, window, scheme):
                    said += 1
                    print(f"{page or 'home'}: {line}", file=sys.stderr)
                print(target)
    return int(said > 0)


if __name__ == "__main__":
    raise SystemExit(main())
