"""The web viewer in a real browser, without a network."""

from __future__ import annotations

import io
import time
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest

from fleet.replay import scheme
from fleet.replay.viewer import serve

CHROMIUM = Path("/usr/bin/chromium")
FLAGS = [  # WebGL on a machine without a graphics card
    "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist", "--disable-quic",
]  # fmt: skip
PATIENCE = 180.0  # [s] for a picture, drawn in software

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not CHROMIUM.exists(), reason=f"there is no {CHROMIUM}"),
]


@pytest.mark.parametrize("colours", ["dark", "light"])
def test_the_browser_shows_the_run(rounds, colours, tmp_path):
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    from PIL import Image

    with serve(rounds.path) as address, playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=str(CHROMIUM), args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 720}, color_scheme=colours)
        answered, stopped = [], set()
        page.on("response", lambda response: answered.append(response.url))
        page.on("requestfailed", lambda request: stopped.add(request.failure))
        page.goto(address)
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            image = Image.open(io.BytesIO(page.screenshot(timeout=PATIENCE * 1000.0)))
            if painted(image, 0xFDE725FF) > 500:  # robots, full of energy
                break
            time.sleep(2.0)
        image.save(tmp_path / f"{colours}.png")
        browser.close()
    assert painted(image, 0xFDE725FF) > 500
    assert painted(image, scheme.EVENT_COLOUR, 30) > 20
    assert {urlsplit(url).hostname for url in answered} - {None} == {"127.0.0.1"}
    assert stopped <= {"csp"}  # nothing was tried elsewhere that our policy did not stop


def painted(image, colour, tolerance=14):
    rgb = [colour >> shift & 255 for shift in (24, 16, 8)]
    seen = np.array(image.convert("RGB")).astype(int)
    return int((np.abs(seen - rgb).max(axis=2) <= tolerance).sum())
