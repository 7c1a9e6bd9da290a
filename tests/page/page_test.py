#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Refines the sample scene, one of whose images has a hostile name, writes its
page and opens it from the disk in a headless Chromium."""
import argparse
import json
import os
import shutil
import sys
import urllib.parse

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "sample"))
from browser import Browser  # Ends the test where there is no browser.
from sample_testing import check, run, unpack

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

parser = argparse.ArgumentParser()
for name in ("program", "repository", "folder"):
    parser.add_argument("--" + name, required=True)
args = parser.parse_args()

HOSTILE = '"><svg/onload=window.attacked=1>.jpg'
DESKTOP, PHONE = (1280, 900), (390, 844)
NUM_MANY = 500


def path(*names):
    return os.path.join(args.folder, *names)


def rename_image(workspace, old, new):
    for parent, _, names in list(os.walk(workspace)):
        for name in names:
            if name.startswith(old):
                renamed = os.path.join(parent, new + name[len(old):])
                os.makedirs(os.path.dirname(renamed), exist_ok=True)
                os.rename(os.path.join(parent, name), renamed)
    for name in ("sparse/images.txt", "stereo/patch-match.cfg", "stereo/fusion.cfg"):
        with open(os.path.join(workspace, name), encoding="utf-8") as file:
            text = file.read()
        with open(os.path.join(workspace, name), "w", encoding="utf-8") as file:
            file.write(text.replace(old, new))


def make_many(page, many):
    """A page with hundreds of images, which are links to those of another."""
    shutil.copytree(page, many, ignore=shutil.ignore_patterns("images"))
    script = os.path.join(many, "data", "report.js")
    with open(script, encoding="utf-8") as file:
        prefix, text = file.read().split("{", 1)
    report = json.loads("{" + text.rstrip().rstrip(";"))
    images = []
    os.makedirs(os.path.join(many, "images"))
    for i in range(NUM_MANY):
        image = dict(report["images"][i % len(report["images"])])
        source = os.path.join(page, "images", image["folder"])
        image["folder"] = f"{i:05}"
        image["name"] = f"many/{i:05}.jpg"
        os.symlink(source, os.path.join(many, "images", image["folder"]))
        images.append(image)
    report["images"] = images
    with open(script, "w", encoding="utf-8") as file:
        file.write(prefix + json.dumps(report) + ";\n")


def check_nothing_is_missing(browser, what):
    browser.scroll_through()
    urls = browser.ask(
        "return [...document.querySelectorAll('[src], link[rel=stylesheet]')]"
        ".map((e) => e.src || e.href)"
    )
    check(urls and all(url.startswith("file://") for url in urls), f"{what}: all is on the disk")
    files = [urllib.parse.unquote(urllib.parse.urlparse(url).path) for url in urls]
    check(all(map(os.path.isfile, files)), f"{what}: all {len(files)} files exist")
    check(
        browser.ask("return [...document.images].every((i) => i.naturalWidth > 0 && i.alt)"),
        f"{what}: all pictures are shown, and have a text",
    )
    check(browser.overflow() <= 0, f"{what}: nothing is wider than the window")
    check(browser.errors() == [], f"{what}: the console is empty")


def check_slider(browser, figure):
    slider = figure.find_element("css selector", "input[type=range]")
    box = figure.find_element("css selector", ".compare")
    browser.ask("arguments[0].scrollIntoView({ block: 'center', behavior: 'instant' })", box)
    before = box.screenshot_as_png
    shown = lambda: browser.ask(
        "return [arguments[0].value, getComputedStyle(arguments[1]).clipPath]",
        slider,
        box.find_element("css selector", ".left"),
    )
    at_start = shown()
    slider.send_keys(Keys.ARROW_RIGHT * 30)
    by_keys = shown()
    check(float(by_keys[0]) > float(at_start[0]), "arrow keys move a slider")
    check(by_keys[1] != at_start[1], "and the clip of the picture")
    check(box.screenshot_as_png != before, "and what is seen")
    width = box.size["width"]
    ActionChains(browser.driver).move_to_element_with_offset(
        slider, -width // 4, 0
    ).click().perform()
    check(abs(float(shown()[0]) - 25) < 5, "a click takes the slider there")


def expect_title(browser, title, what):
    browser.wait("return document.querySelector('#detail h2') !== null", "an image is shown")
    shown = "return document.querySelector('#detail h2').textContent"
    browser.wait(shown + f" === {json.dumps(title)}", what)
    check(browser.ask(shown) == title, what)


def check_points(browser):
    ready = "return !document.querySelector('.view p').textContent.startsWith('Loading')"
    browser.canvas()
    browser.wait(ready, "the points are loaded")
    after = browser.canvas()
    check(after["share"] > 0.05, f"the 3D view draws points on {after['share']:.0%}")
    browser.find("input[name=cloud][value=before]")[0].send_keys(Keys.SPACE)
    before = browser.canvas()
    check(0.01 < before["share"] < after["share"], "there are fewer points before")
    canvas = browser.find("canvas")[0]
    ActionChains(browser.driver).drag_and_drop_by_offset(canvas, 120, 40).perform()
    turned = browser.canvas()
    check(turned["hash"] != before["hash"] and turned["share"] > 0.01, "dragging turns them")
    canvas.send_keys("-" * 8)
    check(browser.canvas()["share"] < turned["share"], "a key makes them smaller")


def check_planes(browser, page):
    browser.look(*DESKTOP)
    browser.open(page)
    section = "#planes"
    browser.canvas(f"{section} canvas")
    browser.wait(
        f"return /^\\d+ planes/.test(document.querySelector('{section} .view p').textContent)",
        "the planes are loaded",
    )
    num_shown = lambda: int(browser.find(f"{section} .view p")[0].text.split()[0])
    whole = browser.canvas(f"{section} canvas")
    check(whole["share"] > 0.2, f"the planes cover {whole['share']:.0%} of their view")
    num_planes = num_shown()
    rows = browser.find(f"{section} tbody tr")
    check(len(rows) == min(num_planes, 20), f"{len(rows)} of {num_planes} planes are listed")
    check(all(row.find_elements("css selector", ".swatch") for row in rows), "with colors")
    areas = [float(row.find_elements("css selector", "td")[2].text) for row in rows]
    check(areas == sorted(areas, reverse=True), "the largest first")
    toggles = browser.find(f"{section} fieldset input")
    labels = browser.find(f"{section} fieldset label")
    counts = [int(label.text.split()[1]) for label in labels]
    check(sum(counts) == num_planes, "each plane is of a class")
    browser.find(f"{section} td button")[0].send_keys(Keys.ENTER)
    picked = browser.canvas(f"{section} canvas")
    check(picked["hash"] != whole["hash"], "a click picks a plane out")
    browser.find(f"{section} td button")[0].send_keys(Keys.ENTER)
    check(browser.canvas(f"{section} canvas") == whole, "and another lets it go")
    browser.find(f"{section} canvas")[0].send_keys(Keys.ARROW_LEFT * 4)
    turned = browser.canvas(f"{section} canvas")
    check(turned["hash"] != whole["hash"], "keys turn the planes")
    for toggle, count in zip(toggles, counts):
        before = num_shown()
        toggle.send_keys(Keys.SPACE)
        check(num_shown() == before - count, f"{count} planes are hidden with their class")
    check(browser.canvas(f"{section} canvas")["share"] == 0, "until none is left")
    check(browser.errors() == [], "planes: the console is empty")


def check_images(browser, page):
    browser.look(*DESKTOP)
    browser.open(page)
    browser.click(browser.find("a.tile")[0])
    expect_title(browser, HOSTILE, "a hostile name is shown as it is")
    check_nothing_is_missing(browser, "an image")
    for figure in browser.find("figure:not(.overlay)"):
        check_slider(browser, figure)
    layers = browser.find("input[name=layer]")
    check(len(layers) == 4, "there are four layers")
    over = ".overlay .compare img + img"
    for layer in layers:
        layer.send_keys(Keys.SPACE)
        browser.wait(
            f"const i = document.querySelector('{over}'); return i.complete && i.naturalWidth > 0",
            "the layer is loaded",
        )
        value = layer.get_attribute("value")
        check(browser.find(over)[0].get_attribute("src").endswith(f"/{value}.png"), value)
    browser.find("#detail button")[1].send_keys(Keys.ENTER)
    expect_title(browser, "v001.jpg", "there is a next image")
    focused = "return document.activeElement."
    check(browser.ask(focused + "textContent").startswith("Next"), "whose button has the focus")
    browser.find("#detail input[type=range]")[0].send_keys(Keys.ESCAPE)
    browser.wait("return !document.getElementById('overview').hidden", "Escape leads back")
    check(browser.ask(focused + "hash") == "#image-1", "to the image's tile")
    browser.driver.switch_to.active_element.send_keys(Keys.ENTER)
    expect_title(browser, "v001.jpg", "which opens it again")
    check(browser.ask(focused + "tagName") == "H2", "and its title has the focus")
    browser.click(browser.driver.find_element("link text", "All images"))
    browser.wait("return !document.getElementById('overview').hidden", "the overview is back")
    check(browser.errors() == [], "the console stays empty")


def check_themes(browser, page):
    grounds = {}
    for size in (DESKTOP, PHONE):
        for dark in (False, True):
            for fragment in ("", "#image-2"):
                browser.look(*size, dark)
                browser.open(page, fragment)
                theme = f"{size[0]} px, {'dark' if dark else 'light'}{fragment}"
                check(browser.overflow() <= 0, f"{theme}: as wide as the window")
                grounds[dark] = browser.ask(
                    "return getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)"
                )
    check(max(grounds[True]) < 60 and min(grounds[False]) > 200, "dark is dark, light is light")


def check_many(browser, page):
    loaded = "return document.querySelectorAll('img[src]').length"
    browser.look(*DESKTOP)
    browser.open(page)
    check(len(browser.find("a.tile")) == NUM_MANY, "hundreds of images have a tile each")
    browser.ask(
        "document.getElementById('images').scrollIntoView({ behavior: 'instant' })"
    )
    browser.wait(loaded, "the first pictures are loaded")
    check(browser.ask(loaded) < 60, f"only what is seen is loaded: {browser.ask(loaded)} pictures")
    browser.ask("window.scrollTo({ top: 1e6, behavior: 'instant' })")
    last = "const all = document.querySelectorAll('a.tile img'); return all[all.length - 1].naturalWidth"
    browser.wait(last, "the last picture is loaded")
    check(browser.ask(loaded) < 120, "and nothing that was passed over")
    search = browser.find("input[type=search]")[0]
    search.send_keys("00123")
    check(len(browser.find("a.tile")) == 1, "the search finds one of them")
    browser.click(browser.find("a.tile")[0])
    expect_title(browser, "many/00123.jpg", "and opens it")
    check(browser.errors() == [], "hundreds of images: the console is empty")


browser = Browser()
try:
    shutil.rmtree(args.folder, ignore_errors=True)
    workspace, page = path("sample"), path("page # 100%")
    unpack(args.repository, workspace)
    rename_image(workspace, "v000.jpg", HOSTILE)
    run(args.program, "tsar_refine", "--workspace_path", workspace, "--TsarRefine.device", "cpu")
    run(args.program, "tsar_report", "--workspace_path", workspace, 
        "--report_path", page, "--ground_truth_path", os.path.join(workspace, "ground_truth", "depth"))
    index = os.path.join(page, "index.html")
    browser.look(*DESKTOP)
    browser.open(index)
    check_points(browser)
    check_nothing_is_missing(browser, "the overview")
    check_planes(browser, index)
    check(len(browser.find("#gain tbody tr")) == 4, "the gain has a row for each measure")
    check_images(browser, index)
    check_themes(browser, index)
    check(not browser.ask("return window.attacked"), "a hostile name does nothing")
    make_many(page, path("many"))
    check_many(browser, path("many", "index.html"))
finally:
    browser.close()
