// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause
//
// Shows window.tsarReport, which data/report.js holds. Names of images are only
// ever used as text, never as HTML.

"use strict";

(() => {
  const report = window.tsarReport;
  const overview = document.getElementById("overview");
  const detail = document.getElementById("detail");

  const STAGES = {
    superpixels: {
      title: "Superpixels",
      text: "Borders of the superpixels, the smallest parts that get a plane.",
    },
    edges: { title: "Edges", text: "Steps of brightness, which bound regions." },
    lines: {
      title: "Lines",
      text: "Edges with the straight lines that close their gaps.",
    },
    regions: {
      title: "Regions",
      text: "Regions without texture, a colour each; black is none.",
    },
    scene_labels: {
      title: "Surfaces",
      text: "Surfaces of the scene, a colour each; black is none.",
    },
  };

  // Texts.

  const number = new Intl.NumberFormat("en");
  const percent = (part, all) =>
    `${(all > 0 ? (100 * part) / all : 0).toFixed(1)}\u00a0%`;
  const short = (value) => Number(value.toPrecision(3)).toString();
  const pixels = (image) => image.width * image.height;
  const sum = (values) => values.reduce((total, value) => total + value, 0);
  const secondsOf = (image) => sum(Object.values(image.seconds));
  const capital = (text) => text[0].toUpperCase() + text.slice(1);
  const plural = (count, noun) =>
    `${number.format(count)} ${noun}${count === 1 ? "" : "s"}`;

  // Elements. Attributes that begin with "on" are listeners; "style" sets CSS
  // properties; children that are texts stay texts.
  function h(tag, attributes, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes || {})) {
      if (name.startsWith("on")) {
        element.addEventListener(name.slice(2), value);
      } else if (name === "style") {
        for (const [property, text] of Object.entries(value)) {
          element.style.setProperty(property, text);
        }
      } else if (value === true) {
        element.setAttribute(name, "");
      } else if (value !== false && value !== undefined) {
        element.setAttribute(name, value);
      }
    }
    element.append(...children.flat().filter((child) => child !== null));
    return element;
  }

  const picture = (image, file) =>
    `images/${encodeURIComponent(image.folder)}/${file}`;

  const swatch = (color) =>
    h("span", { class: "swatch", style: { background: color } });

  const gradient = (colors) =>
    h("span", {
      class: "scale",
      style: { background: `linear-gradient(to right, ${colors.join(", ")})` },
    });

  // Calls back once when the element comes near what is seen of the page.
  const waiting = new Map();
  const watcher = new IntersectionObserver(
    (entries) => {
      for (const entry of entries) {
        if (entry.isIntersecting && waiting.has(entry.target)) {
          watcher.unobserve(entry.target);
          waiting.get(entry.target)();
          waiting.delete(entry.target);
        }
      }
    },
    { rootMargin: "300px" }
  );
  function whenNear(element, action) {
    waiting.set(element, action);
    watcher.observe(element);
  }

  function choice(name, label, options, chosen, onChoose) {
    return h(
      "fieldset",
      { class: "choice", "aria-label": label },
      options.map(([value, text]) =>
        h(
          "label",
          {},
          h("input", {
            type: "radio",
            name,
            value,
            checked: value === chosen,
            onchange: () => onChoose(value),
          }),
          text
        )
      )
    );
  }

  // Provenance: counts of pixels by kind, as a bar and as a list.

  function provenanceBar(counts) {
    const all = sum(counts);
    const text = report.provenance
      .map((kind, i) => `${kind.name} ${percent(counts[i], all)}`)
      .join(", ");
    return h(
      "div",
      { class: "stack", role: "img", "aria-label": `Origin of depth: ${text}` },
      report.provenance.map((kind, i) =>
        h("span", {
          title: `${kind.name}: ${percent(counts[i], all)}`,
          style: { background: kind.color, flex: String(counts[i]) },
        })
      )
    );
  }

  function provenanceLegend(counts) {
    const all = sum(counts);
    return h(
      "ul",
      { class: "legend" },
      report.provenance.map((kind, i) =>
        h(
          "li",
          {},
          swatch(kind.color),
          `${capital(kind.name)} ${percent(counts[i], all)}`
        )
      )
    );
  }

  // The overview.

  function fact(name, value, note) {
    return h(
      "div",
      {},
      h("dt", {}, name),
      h("dd", {}, value, note ? h("small", {}, ` ${note}`) : null)
    );
  }

  function summarySection() {
    const images = report.images;
    const all = sum(images.map(pixels));
    const before = sum(images.map((image) => image.before));
    const after = sum(images.map((image) => image.after));
    const counts = report.provenance.map((_, i) =>
      sum(images.map((image) => image.provenance[i]))
    );
    const timed = images.filter((image) => secondsOf(image) > 0);
    return h(
      "section",
      { id: "summary", class: "card-box", "aria-label": "Summary" },
      h(
        "dl",
        { class: "facts" },
        fact(
          "Pixels with depth",
          `${percent(before, all)} → ${percent(after, all)}`
        ),
        fact(
          "Refined images",
          number.format(images.length),
          report.kept.length
            ? `${number.format(report.kept.length)} left as they were`
            : ""
        ),
        fact("Maps", report.type),
        timed.length
          ? fact(
              "Time per image",
              `${short(sum(timed.map(secondsOf)) / timed.length)} s`,
              "of one worker"
            )
          : null
      ),
      provenanceBar(counts),
      provenanceLegend(counts)
    );
  }

  function pointsSection() {
    const { points } = report;
    const status = h("p", { role: "status" }, "Loading the points …");
    const canvas = h("canvas", {
      tabindex: "0",
      role: "img",
      "aria-label":
        "3D view of the points. Arrow keys turn it, plus and minus zoom, Home " +
        "resets it.",
    });
    const frame = h("div", { class: "view" }, canvas, status);
    let view = null;
    let shown = "after";
    // Maps lie over each other, so that their points are further apart than
    // their number says.
    let size = points.from_clouds ? "1" : "1.8";
    const describe = () => {
      const at = shown === "before" ? 0 : 1;
      const part =
        points.all[at] > points.shown[at]
          ? `${number.format(points.shown[at])} of ${number.format(points.all[at])} points`
          : plural(points.all[at], "point");
      status.textContent = `${part}. Drag to turn, shift or two fingers to move, wheel or pinch to zoom.`;
    };
    whenNear(frame, async () => {
      try {
        const made = new TsarPoints.View(canvas, points.eye, points.up);
        for (const name of ["before", "after"]) {
          const cloud = await TsarPoints.load(name);
          made.add(name, cloud.positions, cloud.colors);
        }
        view = made;
        view.setPointSize(Number(size));
        view.frame("after");
        view.show(shown);
        describe();
      } catch (error) {
        status.textContent = `The 3D view cannot be shown: ${error.message}.`;
      }
    });
    return h(
      "section",
      { id: "points", class: "card-box" },
      h(
        "div",
        { class: "head" },
        h("h2", {}, "3D view"),
        h(
          "div",
          { class: "controls" },
          choice(
            "cloud",
            "Points shown",
            [
              ["before", "Before"],
              ["after", "After"],
            ],
            shown,
            (name) => {
              shown = name;
              if (view) {
                view.show(name);
                describe();
              }
            }
          ),
          h(
            "label",
            {},
            "Size",
            h("input", {
              type: "range",
              min: "0.3",
              max: "4",
              step: "0.1",
              value: size,
              oninput: (event) => {
                size = event.target.value;
                if (view) {
                  view.setPointSize(Number(size));
                }
              },
            })
          ),
          h(
            "button",
            { type: "button", onclick: () => view && view.frame("after") },
            "Reset"
          )
        )
      ),
      frame,
      h(
        "p",
        { class: "muted" },
        points.from_clouds
          ? "The clouds that stereo_fusion made of the maps before and after."
          : "Points of the depth maps themselves, at the same pixels before and after: not fused, so that depths stand that other views contradict."
      )
    );
  }

  function gainTable(title, rows, names) {
    const cell = (row, name) => {
      const gain = row.after[name] - row.before[name];
      const text = `${row.before[name].toFixed(3)} → ${row.after[name].toFixed(3)}`;
      const kind = gain > 0.0005 ? "gain" : gain < -0.0005 ? "loss" : "";
      return h("td", { class: kind }, text);
    };
    return h(
      "div",
      { class: "table-frame" },
      h(
        "table",
        {},
        h("caption", {}, title),
        h(
          "thead",
          {},
          h(
            "tr",
            {},
            h("th", { scope: "col" }, "Within"),
            names.map((name) =>
              h("th", { scope: "col" }, name === "f1" ? "F1" : capital(name))
            )
          )
        ),
        h(
          "tbody",
          {},
          rows.map((row) =>
            h(
              "tr",
              {},
              h(
                "td",
                {},
                row.area && row.area !== "all"
                  ? `${row.tolerance}, ${row.area} areas`
                  : String(row.tolerance)
              ),
              names.map((name) => cell(row, name))
            )
          )
        )
      )
    );
  }

  function gainSection() {
    const { depth, clouds } = report.gains;
    if (!depth && !clouds) {
      return null;
    }
    return h(
      "section",
      { id: "gain", class: "card-box" },
      h("div", { class: "head" }, h("h2", {}, "Gain against ground truth")),
      clouds
        ? gainTable("Clouds", clouds, ["accuracy", "completeness", "f1"])
        : null,
      depth
        ? gainTable("Depth maps", depth, ["precision", "recall", "f1"])
        : null,
      h(
        "p",
        { class: "muted" },
        "Before → after, 1 is best; tolerances in units of the model. Precision and accuracy are shares of what was estimated, recall and completeness of what is there."
      )
    );
  }

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

  function keptSection() {
    if (report.kept.length === 0) {
      return null;
    }
    return h(
      "section",
      { id: "kept", class: "card-box" },
      h("div", { class: "head" }, h("h2", {}, "Images left as they were")),
      h(
        "div",
        { class: "table-frame" },
        h(
          "table",
          {},
          h(
            "tbody",
            {},
            report.kept.map((image) =>
              h(
                "tr",
                {},
                h("td", {}, image.name),
                h("td", { style: { "text-align": "left" } }, image.reason)
              )
            )
          )
        )
      )
    );
  }

  // One image.

  function compare(image, kind, alt) {
    const load = (when) =>
      h("img", {
        src: picture(image, `${kind}_${when}.png`),
        alt: `${image.name}: ${alt} ${when}`,
        width: image.picture_width,
        height: image.picture_height,
        decoding: "async",
      });
    const left = load("before");
    left.className = "left";
    const box = h(
      "div",
      { class: "compare" },
      load("after"),
      left,
      h("span", { class: "handle" }),
      h("span", { class: "tag before" }, "Before"),
      h("span", { class: "tag after" }, "After"),
      h("input", {
        type: "range",
        min: "0",
        max: "100",
        step: "0.5",
        value: "50",
        "aria-label": `${capital(alt)}: before on the left, after on the right`,
        oninput: (event) =>
          box.style.setProperty("--at", `${event.target.value}%`),
      })
    );
    return box;
  }

  function depthPanel(image) {
    return h(
      "figure",
      { class: "card-box" },
      h("div", { class: "head" }, h("h3", {}, "Depth")),
      compare(image, "depth", "depth"),
      h(
        "figcaption",
        {},
        h(
          "ul",
          { class: "legend" },
          h(
            "li",
            {},
            `${short(image.nearest)} near`,
            gradient(report.depth_colors),
            `${short(image.farthest)} far`
          ),
          h("li", {}, swatch("#000"), "none")
        )
      )
    );
  }

  function normalPanel(image) {
    return h(
      "figure",
      { class: "card-box" },
      h("div", { class: "head" }, h("h3", {}, "Normals")),
      compare(image, "normals", "normals"),
      h(
        "figcaption",
        {},
        h(
          "ul",
          { class: "legend" },
          h("li", {}, swatch("#8080ff"), "to the camera"),
          h("li", {}, swatch("#ff8080"), "to the right"),
          h("li", {}, swatch("#80ff80"), "up"),
          h("li", {}, swatch("#000"), "none")
        )
      )
    );
  }

  // The layers over the photo: value, title and what explains it.
  function layersOf(image) {
    return [
      ["provenance", "Origin", () => provenanceLegend(image.provenance)],
      [
        "confidence",
        "Confidence",
        () =>
          h(
            "ul",
            { class: "legend" },
            h("li", {}, "0 guess", gradient(report.value_colors), "1 sure"),
            h("li", {}, swatch("#000"), "no depth")
          ),
      ],
      ...image.stages.map((stage) => [
        stage,
        STAGES[stage].title,
        () => h("p", { class: "muted" }, STAGES[stage].text),
      ]),
    ];
  }

  // Kept from image to image.
  let layer = "provenance";
  let opacity = "0.8";

  function overlayPanel(image) {
    const layers = layersOf(image);
    if (!layers.some(([value]) => value === layer)) {
      layer = "provenance";
    }
    const over = h("img", {
      width: image.picture_width,
      height: image.picture_height,
      style: { opacity },
    });
    const caption = h("figcaption", {});
    const choose = (value) => {
      layer = value;
      const [, title, explain] = layers.find(([name]) => name === value);
      over.src = picture(image, `${value}.png`);
      over.alt = `${image.name}: ${title.toLowerCase()}`;
      caption.replaceChildren(explain());
    };
    choose(layer);
    return h(
      "figure",
      { class: "card-box overlay" },
      h(
        "div",
        { class: "head" },
        h("h3", {}, "Over the photo"),
        h(
          "label",
          { class: "muted controls" },
          "Photo",
          h("input", {
            type: "range",
            min: "0",
            max: "1",
            step: "0.05",
            value: opacity,
            "aria-label": "How much of the layer covers the photo",
            oninput: (event) => {
              opacity = event.target.value;
              over.style.opacity = opacity;
            },
          }),
          "layer"
        )
      ),
      h(
        "div",
        { class: "head" },
        choice(
          "layer",
          "Layer over the photo",
          layers.map(([value, title]) => [value, title]),
          layer,
          choose
        )
      ),
      h(
        "div",
        { class: "compare" },
        h("img", {
          src: picture(image, "photo.jpg"),
          alt: `${image.name}: photo`,
          width: image.picture_width,
          height: image.picture_height,
        }),
        over
      ),
      caption
    );
  }

  function numberPanel(image) {
    const all = pixels(image);
    const row = (color, name, count) =>
      h(
        "tr",
        {},
        h("td", {}, color ? swatch(color) : null, color ? " " : null, name),
        h("td", {}, number.format(count)),
        h("td", {}, percent(count, all))
      );
    const stages = Object.entries(image.seconds).sort((a, b) => b[1] - a[1]);
    return h(
      "div",
      { class: "card-box" },
      h("div", { class: "head" }, h("h3", {}, "Numbers")),
      h(
        "div",
        { class: "table-frame" },
        h(
          "table",
          {},
          h(
            "thead",
            {},
            h(
              "tr",
              {},
              h("th", { scope: "col" }, `${image.width} × ${image.height}`),
              h("th", { scope: "col" }, "Pixels"),
              h("th", { scope: "col" }, "Share")
            )
          ),
          h(
            "tbody",
            {},
            row(null, "With depth before", image.before),
            row(null, "With depth after", image.after),
            report.provenance.map((kind, i) =>
              row(kind.color, capital(kind.name), image.provenance[i])
            )
          )
        )
      ),
      stages.length
        ? h(
            "details",
            {},
            h(
              "summary",
              {},
              `${short(secondsOf(image))} s of one worker, by stage`
            ),
            h(
              "table",
              {},
              h(
                "tbody",
                {},
                stages.map(([stage, seconds]) =>
                  h(
                    "tr",
                    {},
                    h("td", {}, capital(stage)),
                    h("td", {}, `${seconds.toFixed(3)} s`)
                  )
                )
              )
            )
          )
        : null
    );
  }

  let isLarge = false;

  function showDetail(image) {
    const at = listed.indexOf(image);
    const go = (step) => {
      const next = listed[at + step];
      if (next) {
        // Pages of images are one step of the browser's history.
        location.replace(`#image-${next.index}`);
      }
    };
    const panels = h(
      "div",
      { class: isLarge ? "panels large" : "panels" },
      depthPanel(image),
      normalPanel(image),
      overlayPanel(image),
      numberPanel(image)
    );
    const step = (text, by) =>
      h(
        "button",
        { type: "button", disabled: !listed[at + by], onclick: () => go(by) },
        text
      );
    detail.replaceChildren(
      h(
        "div",
        { class: "head" },
        h("h2", { tabindex: "-1" }, image.name),
        h(
          "div",
          { class: "controls" },
          h("a", { href: "#images" }, "All images"),
          step("← Previous", -1),
          h("span", { class: "muted" }, `${at + 1} of ${listed.length}`),
          step("Next →", 1),
          h(
            "button",
            {
              type: "button",
              "aria-pressed": String(isLarge),
              onclick: (event) => {
                isLarge = !isLarge;
                panels.classList.toggle("large", isLarge);
                event.target.setAttribute("aria-pressed", String(isLarge));
              },
            },
            "Large"
          )
        )
      ),
      panels
    );
  }

  // What the address asks for: an image, or a place in the overview.
  let scrolled = 0;
  let lastShown = 0;
  function route() {
    // Keys and screen readers go on where this hides or replaces what they were
    // at: at the same button or the title of an image, or at its tile.
    const focused = document.activeElement;
    const losesFocus = focused === document.body || detail.contains(focused);
    const pressed = [...detail.querySelectorAll("button")].indexOf(focused);
    const match = location.hash.match(/^#image-(\d+)$/);
    const image = match ? report.images[Number(match[1])] : undefined;
    if (image) {
      if (detail.hidden) {
        scrolled = window.scrollY;
      }
      if (!listed.includes(image)) {
        listed = [...report.images];
      }
      showDetail(image);
      lastShown = image.index;
    }
    const wasDetail = !detail.hidden;
    detail.hidden = !image;
    overview.hidden = Boolean(image);
    if (image) {
      window.scrollTo({ top: 0, behavior: "instant" });
      const button = detail.querySelectorAll("button")[pressed];
      const isUsable = button && !button.disabled;
      const target = isUsable ? button : detail.querySelector("h2");
      target.focus({ preventScroll: true });
    } else {
      detail.replaceChildren();
      if (wasDetail) {
        const section = document.getElementById(location.hash.slice(1));
        if (section && section.id !== "images") {
          section.scrollIntoView();
        } else {
          window.scrollTo({ top: scrolled, behavior: "instant" });
        }
        const tileLink = overview.querySelector(`a[href="#image-${lastShown}"]`);
        if (losesFocus && tileLink) {
          tileLink.focus({ preventScroll: true });
        }
      }
    }
  }

  function start() {
    if (!report) {
      overview.append(
        h(
          "p",
          { class: "note" },
          "The file data/report.js is missing: copy the whole folder of the report, not index.html alone."
        )
      );
      return;
    }
    report.images.forEach((image, index) => {
      image.index = index;
    });
    const sections = [
      [summarySection(), "Summary"],
      [gainSection(), "Gain"],
      [pointsSection(), "3D view"],
      [imagesSection(), "Images"],
      [keptSection(), "Left as they were"],
    ].filter(([section]) => section);
    overview.append(...sections.map(([section]) => section));
    document
      .getElementById("sections")
      .append(
        ...sections.map(([section, text]) =>
          h("a", { href: `#${section.id}` }, text)
        )
      );
    document.getElementById("footer").textContent =
      `Made by colmap_tsar ${report.version} tsar_report.`;
    window.addEventListener("hashchange", route);
    document.addEventListener("keydown", (event) => {
      if (detail.hidden || event.altKey || event.ctrlKey || event.metaKey) {
        return;
      }
      const inField = event.target.tagName === "INPUT";
      if (event.key === "Escape") {
        location.hash = "#images";
      } else if (
        !inField &&
        (event.key === "ArrowLeft" || event.key === "ArrowRight")
      ) {
        const [previous, next] = detail.querySelectorAll("button");
        (event.key === "ArrowLeft" ? previous : next).click();
      }
    });
    route();
  }

  start();
})();
