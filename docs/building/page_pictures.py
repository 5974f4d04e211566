"""Pictures of pages for the documentation, and the browser that their tests look at them in.

``python docs/building/page_pictures.py FOLDER`` solves a bundled instance, does the bundled campaign, and writes a PNG of the page of each,
on a desk and on a phone in the dark. Needs Chromium and its driver (Debian: ``chromium``, ``chromium-driver``).
"""

import argparse
import io
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from screenshots import browser

DESK, PHONE, GUTTER = (1160, 960), (390, 960), 16
"""Sizes of windows, and of the room between two pictures."""


class Browser:
    """A headless Chromium with one window. Raises FileNotFoundError where it or its driver is not installed."""

    def __init__(self) -> None:
        from selenium import webdriver

        driver = shutil.which("chromedriver")
        if driver is None:
            raise FileNotFoundError("Chromium's driver is not installed (Debian: apt-get install chromium-driver)")
        options = webdriver.ChromeOptions()
        options.binary_location = browser()
        for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"):
            options.add_argument(word)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver: Any = webdriver.Chrome(options=options, service=webdriver.ChromeService(executable_path=driver))

    def close(self) -> None:
        """End Chromium."""
        self.driver.quit()

    def open(self, page: Path, *, width: int = 1200, height: int = 900, dark: bool = False) -> None:
        """Show a page in a window of this size, in CSS pixels."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})
        self.driver.get(page.resolve().as_uri())

    def all(self, selector: str) -> list[Any]:
        """Elements by a CSS selector."""
        found: list[Any] = self.driver.find_elements("css selector", selector)
        return found

    def run(self, script: str, *arguments: Any) -> Any:
        """Run the body of a JavaScript function in the page, and return its result."""
        return self.driver.execute_script(script, *arguments)

    def click(self, element: Any) -> None:
        """Press an element, in the middle of the window."""
        self.run("arguments[0].scrollIntoView({block: 'center'})", element)
        element.click()

    @property
    def said(self) -> list[str]:
        """Messages on the console since it was last asked."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def picture(self) -> NDArray[np.float32]:
        """The window as an array of shape (height, width, 3), from 0 to 1."""
        from matplotlib.image import imread

        return np.asarray(imread(io.BytesIO(self.driver.get_screenshot_as_png()), format="png"), dtype=np.float32)[:, :, :3]


def side_by_side(shown: Browser, page: Path, target: Path, *, picked: bool = False) -> None:
    """Write the picture of a page on a desk and on a phone; ``picked``: with a stop of its map, else from the first table on."""
    parts = []
    for (width, height), dark in ((DESK, False), (PHONE, True)):
        shown.open(page, width=width, height=height, dark=dark)
        if picked:
            shown.click(shown.all(".legend button")[1])
            shown.click(shown.all(".told .stops button")[2])
        place = "'.map'" if picked else "'.scroll'"
        if dark or not picked:
            shown.run(f"scrollTo(0, (document.querySelector({place})?.offsetTop ?? 16) - 16)")
        parts += [shown.picture(), np.full((height, GUTTER, 3), 0.6, dtype=np.float32)]
    from matplotlib.image import imsave

    imsave(target, np.concatenate(parts[:-1], axis=1))


def main(arguments: Sequence[str] | None = None) -> int:
    """All pictures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    folder: Path = parser.parse_args(arguments).folder.resolve()
    shown = Browser()
    try:
        with tempfile.TemporaryDirectory() as place:
            for words, page in (
                ("solve demo-rc50 --solver pyvrp --convention trunc1 --time-limit 10 --bound-time 20 --quiet --page answer.html", "answer"),
                ("bench demo-campaign --quiet --against savings --page campaign.html", "campaign"),
            ):
                subprocess.run([sys.executable, "-m", "waybound", *words.split()], check=True, cwd=place, stdout=subprocess.DEVNULL)
                side_by_side(shown, Path(place, f"{page}.html"), folder / f"page-{page}.png", picked=page == "answer")
    finally:
        shown.close()
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
