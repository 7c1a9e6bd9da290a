// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause
//
// The sections of the overview that need no picture: the numbers of all images,
// the gain against ground truth, and the images that were left as they were.

"use strict";

window.TsarSummary = (() => {
  const report = window.tsarReport;
  const { capital, h, number, percent, short, sum } = window.TsarElements;
  const {
    pixels,
    secondsOf,
    provenanceBar,
    provenanceLegend,
  } = window.TsarImage;

  function fact(name, value, note) {
    return h(
      "div",
      {},
      h("dt", {}, name),
      h("dd", {}, value, note ? h("small", {}, ` ${note}`) : null)
    );
  }

  // The gain in the head: F1 at the smallest tolerance.
  function gainFact(title, rows) {
    return rows
      ? fact(
          `${title}, F1 within ${rows[0].tolerance}`,
          `${rows[0].before.f1.toFixed(3)} → ${rows[0].after.f1.toFixed(3)}`
        )
      : null;
  }

  // Points that are not fused are not to be compared with those that are.
  function fusedFact() {
    const { from_clouds, before_from_maps, all } = report.points;
    if (!from_clouds) {
      return null;
    }
    return before_from_maps
      ? fact("Fused points", number.format(all[1]), "no cloud of the maps before was given")
      : fact("Fused points", `${number.format(all[0])} → ${number.format(all[1])}`);
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
        gainFact("Clouds", report.gains.clouds),
        gainFact("Depth maps", report.gains.depth),
        fusedFact(),
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

  return { summarySection, gainSection, keptSection };
})();
