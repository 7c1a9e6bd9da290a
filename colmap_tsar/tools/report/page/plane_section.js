// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause
//
// The section with the planes of the scene: in 3D, and as a table.

"use strict";

window.TsarPlaneSection = (() => {
  const report = window.tsarReport;
  const { capital, h, number, percent, plural, short, sum, swatch, whenNear } =
    window.TsarElements;

  const CLASSES = ["floor", "ceiling", "wall", "other"];
  const NUM_LISTED = 20;
  const NUM_FRAMED = 1000;
  const DIM = 0.3; // Of the planes beside the one that is picked.

  // What the 3D view and the table share.
  const hidden = new Set(); // Classes.
  let picked = null;
  let showsBacks = false;

  function partsOf(planes) {
    return planes
      .filter((plane) => !hidden.has(plane.class))
      .map((plane) => ({
        first: plane.first,
        count: plane.count,
        brightness: picked && picked !== plane ? DIM : 1,
      }));
  }

  // Vertices to frame: of each plane as many as its area is worth, since small
  // planes may have more of them than large ones.
  function sampleOf(planes, positions) {
    const all = sum(planes.map((plane) => plane.area));
    const sample = [];
    for (const plane of planes) {
      const wanted = Math.ceil((NUM_FRAMED * plane.area) / all);
      for (let i = 0; i < wanted; ++i) {
        const at = plane.first + Math.floor((i * plane.count) / wanted);
        sample.push(...positions.subarray(3 * at, 3 * at + 3));
      }
    }
    return sample;
  }

  function viewOf(planes) {
    const status = h("p", { role: "status" }, "Loading the planes …");
    const canvas = h("canvas", {
      tabindex: "0",
      role: "img",
      "aria-label":
        "3D view of the planes. Arrow keys turn it, plus and minus zoom, Home " +
        "resets it.",
    });
    const frame = h("div", { class: "view" }, canvas, status);
    let view = null;
    const update = () => {
      if (view) {
        const parts = partsOf(planes);
        view.showTriangles(parts, showsBacks);
        status.textContent = `${plural(parts.length, "plane")}. Drag to turn, shift or two fingers to move, wheel or pinch to zoom.`;
      }
    };
    whenNear(frame, async () => {
      try {
        const made = new window.TsarPoints.View(
          canvas,
          report.points.eye,
          report.points.up
        );
        const mesh = await window.TsarPoints.load("planes");
        const sample = sampleOf(planes, mesh.positions);
        made.add("planes", mesh.positions, mesh.colors, sample);
        made.show("planes");
        made.frame("planes");
        view = made;
        update();
      } catch (error) {
        status.textContent = `The 3D view cannot be shown: ${error.message}.`;
      }
    });
    return { frame, update, reset: () => view && view.frame("planes") };
  }

  function toggle(text, isOn, onChange) {
    return h(
      "label",
      {},
      h("input", {
        type: "checkbox",
        checked: isOn,
        onchange: (event) => onChange(event.target.checked),
      }),
      text
    );
  }

  function classToggles(planes, update) {
    return h(
      "fieldset",
      { class: "choice", "aria-label": "Classes shown" },
      CLASSES.map((name) => [
        name,
        planes.filter((plane) => plane.class === name).length,
      ])
        .filter(([, count]) => count > 0)
        .map(([name, count]) =>
          toggle(`${capital(name)} ${number.format(count)}`, true, (isOn) => {
            if (isOn) {
              hidden.delete(name);
            } else {
              hidden.add(name);
            }
            update();
          })
        )
    );
  }

  // Picks a plane by a click on its name; a second click lets it go.
  function row(plane, update) {
    const name = h(
      "button",
      {
        type: "button",
        "aria-pressed": String(picked === plane),
        onclick: () => {
          picked = picked === plane ? null : plane;
          for (const button of document.querySelectorAll("#planes td button")) {
            const isPicked = picked !== null && button === name;
            button.setAttribute("aria-pressed", String(isPicked));
          }
          update();
        },
      },
      swatch(plane.color),
      ` ${plane.id}`
    );
    return h(
      "tr",
      {},
      h("td", {}, name),
      h("td", {}, capital(plane.class)),
      h("td", {}, short(plane.area)),
      h("td", {}, plane.tilt === null ? "–" : `${plane.tilt.toFixed(1)}°`),
      h("td", {}, number.format(plane.images)),
      h("td", {}, percent(plane.measured, 1)),
      h("td", {}, plane.sigma === null ? "–" : short(plane.sigma))
    );
  }

  function table(planes, update) {
    const body = h("tbody", {});
    const list = (count) =>
      body.replaceChildren(
        ...planes.slice(0, count).map((plane) => row(plane, update))
      );
    list(NUM_LISTED);
    const frame = h(
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
            ["Plane", "Class", "Area", "Tilt", "Images", "Measured", "σ of offset"].map(
              (text) => h("th", { scope: "col" }, text)
            )
          )
        ),
        body
      )
    );
    const all = h(
      "button",
      {
        type: "button",
        onclick: () => {
          list(planes.length);
          all.remove();
        },
      },
      `All ${plural(planes.length, "plane")}`
    );
    return [frame, planes.length > NUM_LISTED ? all : null];
  }

  function planesSection() {
    // Those that any image shows.
    const planes = (report.planes || []).filter((plane) => plane.count > 0);
    if (planes.length === 0) {
      return null;
    }
    const { frame, update, reset } = viewOf(planes);
    return h(
      "section",
      { id: "planes", class: "card-box" },
      h(
        "div",
        { class: "head" },
        h("h2", {}, "Planes"),
        h(
          "div",
          { class: "controls" },
          classToggles(planes, update),
          toggle("Backs", showsBacks, (isOn) => {
            showsBacks = isOn;
            update();
          }),
          h("button", { type: "button", onclick: reset }, "Reset")
        )
      ),
      frame,
      h(
        "p",
        { class: "muted" },
        "The planes of the scene, the largest first; click one to pick it out. Lengths and areas are in units of the model; tilt is the angle to level or upright, whichever is nearer; measured is the share of the pixels whose depth was not filled."
      ),
      table(planes, update)
    );
  }

  return { planesSection };
})();
