// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause
//
// The images as a grid of tiles, to be searched and ordered.

"use strict";

window.TsarImageGrid = (() => {
  const report = window.tsarReport;
  const { h, percent, plural, whenNear } = window.TsarElements;
  const { picture, pixels } = window.TsarImage;

  const gainOf = (image) => (image.after - image.before) / pixels(image);
  const ORDERS = {
    model: ["Order of the model", (a, b) => a.index - b.index],
    gain: ["Most gained first", (a, b) => gainOf(b) - gainOf(a)],
    empty: [
      "Least depth first",
      (a, b) => a.after / pixels(a) - b.after / pixels(b),
    ],
    name: ["Name", (a, b) => (a.name < b.name ? -1 : 1)],
  };

  function tile(image) {
    const preview = h("img", {
      alt: `${image.name}: photo, depth before and depth after`,
      style: {
        "aspect-ratio": `${3 * image.picture_width} / ${image.picture_height}`,
      },
    });
    whenNear(preview, () => {
      preview.src = picture(image, "preview.jpg");
    });
    return h(
      "li",
      {},
      h(
        "a",
        { class: "tile", href: `#image-${image.index}` },
        preview,
        h(
          "div",
          {},
          h("strong", { title: image.name }, image.name),
          h(
            "span",
            {},
            `${percent(image.before, pixels(image))} → ${percent(image.after, pixels(image))}`
          )
        )
      )
    );
  }

  // The images as the grid shows them, which is also the order for paging.
  let listed = [];

  function imagesSection() {
    const grid = h("ul", { class: "grid" });
    const found = h("span", { class: "muted", role: "status" });
    const tiles = new Map();
    const search = h("input", {
      type: "search",
      placeholder: "Find a name",
      "aria-label": "Find images by name",
      oninput: () => fill(),
    });
    const order = h(
      "select",
      { "aria-label": "Order of the images", onchange: () => fill() },
      Object.entries(ORDERS).map(([value, [text]]) =>
        h("option", { value }, text)
      )
    );
    function fill() {
      const wanted = search.value.toLowerCase();
      listed = report.images
        .filter((image) => image.name.toLowerCase().includes(wanted))
        .sort(ORDERS[order.value][1]);
      found.textContent = plural(listed.length, "image");
      grid.replaceChildren(
        ...listed.map((image) => {
          if (!tiles.has(image)) {
            tiles.set(image, tile(image));
          }
          return tiles.get(image);
        })
      );
    }
    fill();
    return h(
      "section",
      { id: "images" },
      h(
        "div",
        { class: "head" },
        h("h2", {}, "Images"),
        h("div", { class: "controls" }, found, search, order)
      ),
      grid,
      h(
        "p",
        { class: "muted" },
        "Photo, depth before, depth after; the share of pixels with a depth."
      )
    );
  }

  // The images in this order; all of them where this one is not among them.
  function listWith(image) {
    if (!listed.includes(image)) {
      listed = [...report.images];
    }
    return listed;
  }

  return { imagesSection, listWith };
})();
