// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause
//
// One image: its maps before and after, what lies over its photo, and its numbers.

"use strict";

window.TsarDetail = (() => {
  const report = window.tsarReport;
  const detail = document.getElementById("detail");
  const {
    capital,
    choice,
    gradient,
    h,
    number,
    percent,
    short,
    swatch,
  } = window.TsarElements;
  const { picture, pixels, secondsOf, provenanceLegend } = window.TsarImage;

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
      ...(image.has_sigma
        ? [
            [
              "sigma",
              "Standard deviation",
              () =>
                h(
                  "ul",
                  { class: "legend" },
                  h("li", {}, "0", gradient(report.value_colors), "1 % of the depth"),
                  h("li", {}, swatch("#000"), "no depth")
                ),
            ],
          ]
        : []),
      ...(image.has_planes
        ? [
            [
              "planes",
              "Planes",
              () =>
                h(
                  "p",
                  { class: "muted" },
                  "The planes of the scene, each in the color that it has in their list; black is none."
                ),
            ],
          ]
        : []),
      ...(image.has_prior
        ? [
            [
              "prior",
              "Depth prior",
              () =>
                h(
                  "p",
                  { class: "muted" },
                  "The depth prior in the colors of depth, by one scale and shift that fit the map before; black is none."
                ),
            ],
          ]
        : []),
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
      image.note ? h("p", {}, `${capital(image.note)}.`) : null,
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

  // listed: the images to step through, of which this is one.
  function showDetail(image, listed) {
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

  return { showDetail };
})();
