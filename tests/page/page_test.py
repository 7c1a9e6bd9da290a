#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Refines the sample scene, one of whose images has a hostile name, writes its
page and opens it from the disk in a headless Chromium without a network."""
import os
import shutil
import sys
import time
import urllib.parse

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "sample"))
from sample_testing import check, parse_arguments, run, skip, unpack_small

SYSTEM_PYTHON = "/usr/bin/python3"

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.keys import Keys
except ImportError:
    # The distribution's Python has its packages; another may come before it.
    if sys.executable != SYSTEM_PYTHON and os.access(SYSTEM_PYTHON, os.X_OK):
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON] + sys.argv)
    skip("no Selenium; install python3-selenium")

HOSTILE = '"><svg onload=window.attacked=1>.jpg'

args = parse_arguments("program", "repository", "folder")


def open_browser():
    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not chromium or not driver:
        skip("no Chromium with its driver; see install_dependencies.sh --tests")
    options = Options()
    options.binary_location = chromium
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage",
                     "--window-size=1280,900", "--host-resolver-rules=MAP * ~NOTFOUND"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(options=options, service=Service(driver))


def rename_image(workspace, old, new):
    for parent, _, names in list(os.walk(workspace)):
        for name in names:
            if name.startswith(old):
                os.rename(os.path.join(parent, name), os.path.join(parent, new + name[len(old):]))
    for name in ("sparse/images.txt", "stereo/patch-match.cfg", "stereo/fusion.cfg"):
        with open(os.path.join(workspace, name), encoding="utf-8") as file:
            text = file.read()
        with open(os.path.join(workspace, name), "w", encoding="utf-8") as file:
            file.write(text.replace(old, new))


def wait_for_pictures(browser):
    """Scrolls to each, since pictures are loaded when they are near."""
    for image in browser.find_elements("css selector", "img"):
        browser.execute_script("arguments[0].scrollIntoView()", image)
        while not browser.execute_script("return arguments[0].complete", image):
            time.sleep(0.1)


browser = open_browser()
try:
    shutil.rmtree(args.folder, ignore_errors=True)
    workspace, page = (os.path.join(args.folder, name) for name in ("sample", "page # 100%"))
    unpack_small(args.repository, workspace)
    rename_image(workspace, "v000.jpg", HOSTILE)
    run(args.program, "tsar_refine", "--workspace_path", workspace, "--TsarRefine.device", "cpu")
    run(args.program, "tsar_report", "--workspace_path", workspace, "--report_path", page)
    browser.get("file://" + urllib.parse.quote(os.path.join(page, "index.html")))
    wait_for_pictures(browser)
    check(browser.execute_script("return document.images.length") == 8 * 8, "8 pictures of 8 images")
    check(browser.execute_script(
        "return [...document.images].every((i) => i.naturalWidth > 0 && i.alt &&"
        " i.src.startsWith('file://'))"), "all are on the disk, are shown, and have a text")
    titles = [title.text for title in browser.find_elements("css selector", "h2")]
    check(HOSTILE in titles, "a hostile name is shown as it is")
    check(not browser.execute_script("return window.attacked"), "and does nothing")
    slider = browser.find_element("css selector", "input[type=range]")
    over = browser.find_element("css selector", ".compare img + img")
    clip = lambda: browser.execute_script("return getComputedStyle(arguments[0]).clipPath", over)
    at_start = clip()
    slider.send_keys(Keys.END)
    check(clip() != at_start, "the slider moves the border between before and after")
    check(browser.execute_script(
        "return document.documentElement.scrollWidth <= window.innerWidth"), "it fits the window")
    check([entry for entry in browser.get_log("browser")
           if entry["level"] in ("SEVERE", "WARNING")] == [], "the console is empty")
finally:
    browser.quit()
