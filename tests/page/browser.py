# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""A headless Chromium, and what the test of the page asks it."""
import os
import shutil
import sys
import time
import urllib.parse

SKIPPED = 77  # To ctest.
SYSTEM_PYTHON = "/usr/bin/python3"

try:
    from selenium import webdriver
    from selenium.webdriver.common.by import By
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
except ImportError:
    # The distribution's Python has its packages; another may come before it.
    if sys.executable != SYSTEM_PYTHON and os.access(SYSTEM_PYTHON, os.X_OK):
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON] + sys.argv)
    print("SKIPPED: no Selenium; install python3-selenium")
    sys.exit(SKIPPED)

# Canvases keep what was drawn, so that it can be read back.
KEEP_DRAWN = """
const original = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, options) {
  return original.call(this, kind, { ...options, preserveDrawingBuffer: true });
};
"""

# The colors of a canvas: the share of pixels that differ from its corner, and
# a number that changes with the picture.
READ_CANVAS = """
const canvas = document.querySelector(arguments[0]);
const copy = document.createElement("canvas");
copy.width = canvas.width;
copy.height = canvas.height;
const context = copy.getContext("2d");
context.drawImage(canvas, 0, 0);
const data = context.getImageData(0, 0, copy.width, copy.height).data;
let drawn = 0;
let hash = 0;
for (let i = 0; i < data.length; i += 4) {
  const differs = [0, 1, 2].some((k) => Math.abs(data[i + k] - data[k]) > 8);
  drawn += differs ? 1 : 0;
  hash = (31 * hash + data[i] + 7 * data[i + 1] + 13 * data[i + 2]) % 1000003;
}
return { share: (4 * drawn) / data.length, hash };
"""


class Browser:
    """Opens pages from the disk. width, height: of the window in CSS pixels."""

    def __init__(self):
        chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
        if not chromium or not driver:
            print("SKIPPED: no Chromium with its driver; see install_dependencies.sh --tests")
            sys.exit(SKIPPED)
        options = Options()
        options.binary_location = chromium
        for argument in (
            "--headless=new",
            "--no-sandbox",  # Which root cannot have.
            "--disable-dev-shm-usage",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--host-resolver-rules=MAP * ~NOTFOUND",  # No network.
        ):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=Service(driver))
        self.driver.set_page_load_timeout(600)
        self.driver.set_script_timeout(600)
        self.driver.execute_cdp_cmd(
            "Page.addScriptToEvaluateOnNewDocument", {"source": KEEP_DRAWN}
        )

    def close(self):
        self.driver.quit()

    def look(self, width, height, dark=False):
        self.driver.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600},
        )
        scheme = "dark" if dark else "light"
        self.driver.execute_cdp_cmd(
            "Emulation.setEmulatedMedia",
            {
                "features": [
                    {"name": "prefers-color-scheme", "value": scheme},
                    # So that nothing moves while it is clicked.
                    {"name": "prefers-reduced-motion", "value": "reduce"},
                ]
            },
        )

    def open(self, path, fragment=""):
        self.driver.get("about:blank")  # A new fragment alone would load nothing.
        self.driver.get("file://" + urllib.parse.quote(str(path)) + fragment)

    def ask(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def find(self, selector):
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def click(self, element):
        self.ask("arguments[0].scrollIntoView({ block: 'center' })", element)
        element.click()

    def wait(self, script, what):
        """Until the script returns something true."""
        for _ in range(6000):
            value = self.ask(script)
            if value:
                return value
            time.sleep(0.1)
        raise AssertionError(f"never happened: {what}; it said {self.errors()}")

    def scroll_through(self):
        self.ask("window.scrollTo({ top: 0, behavior: 'instant' })")
        while True:
            self.wait(
                "return [...document.images].every((i) => !i.src || i.complete)",
                "all pictures are loaded",
            )
            at_end = self.ask(
                "const before = scrollY;"
                "window.scrollBy({ top: innerHeight / 2, behavior: 'instant' });"
                "return scrollY === before;"
            )
            time.sleep(0.1)  # For the observers of what is seen.
            if at_end:
                return

    def overflow(self):
        """By how many pixels the page is wider than its window."""
        return self.ask(
            "return document.documentElement.scrollWidth - window.innerWidth"
        )

    def canvas(self, selector="canvas"):
        self.ask(
            "document.querySelector(arguments[0]).scrollIntoView({ behavior: 'instant' })",
            selector,
        )
        time.sleep(0.5)  # A frame or two.
        return self.ask(READ_CANVAS, selector)

    def errors(self):
        """What the console holds since the last call."""
        return [
            entry["message"]
            for entry in self.driver.get_log("browser")
            if entry["level"] in ("SEVERE", "WARNING")
        ]
