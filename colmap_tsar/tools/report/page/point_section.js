// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause
//
// The section with the 3D view.

"use strict";

window.TsarPointSection = (() => {
  const report = window.tsarReport;
  const { choice, h, number, plural, whenNear } = window.TsarElements;

  // What the points of both clouds are.
  function origin(points) {
    if (points.before_from_maps) {
      return "After: the fused cloud that was given. Before: no cloud was given (before_path), so these are points of the depth maps themselves, not fused: many more, since each view has its own, and depths stand that other views contradict. To compare like with like, let tsar_report fuse the maps before refinement (--fuse), or give such a cloud.";
    }
    if (!points.from_clouds) {
      return "Points of the depth maps themselves, at the same pixels before and after: not fused, so that depths stand that other views contradict.";
    }
    const of = (at) =>
      points.fused[at] ? `the maps, fused by ${points.fusion}` : "the fused cloud that was given";
    return of(0) === of(1)
      ? `Before and after: ${of(1)}.`
      : `Before: ${of(0)}. After: ${of(1)}.`;
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
        const made = new window.TsarPoints.View(
          canvas,
          points.eye,
          points.up,
          points.target
        );
        for (const name of ["before", "after"]) {
          const cloud = await window.TsarPoints.load(name);
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
              ["before", points.before_from_maps ? "Before, not fused" : "Before"],
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
      h("p", { class: "muted" }, origin(points))
    );
  }

  return { pointsSection };
})();
