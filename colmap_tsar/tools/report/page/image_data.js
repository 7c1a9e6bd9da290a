// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause
//
// What window.tsarReport tells of an image, and the origin of its depths.

"use strict";

window.TsarImage = (() => {
  const report = window.tsarReport;
  const { capital, h, percent, sum, swatch } = window.TsarElements;

  const pixels = (image) => image.width * image.height;
  const secondsOf = (image) => sum(Object.values(image.seconds));
  const picture = (image, file) =>
    `images/${encodeURIComponent(image.folder)}/${file}`;

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
        counts[i] > 0
          ? h(
              "li",
              {},
              swatch(kind.color),
              `${capital(kind.name)} ${percent(counts[i], all)}`
            )
          : null
      )
    );
  }

  return { pixels, secondsOf, picture, provenanceBar, provenanceLegend };
})();
