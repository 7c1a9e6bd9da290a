// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause
//
// Shows window.tsarReport, which data/report.js holds: the overview, or the image
// that the address names.

"use strict";

(() => {
  const report = window.tsarReport;
  const overview = document.getElementById("overview");
  const detail = document.getElementById("detail");
  const { h } = window.TsarElements;
  const { gainSection, keptSection, summarySection } = window.TsarSummary;
  const { pointsSection } = window.TsarPointSection;
  const { planesSection } = window.TsarPlaneSection;
  const { imagesSection, listWith } = window.TsarImageGrid;
  const { showDetail } = window.TsarDetail;

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
      showDetail(image, listWith(image));
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
      [planesSection(), "Planes"],
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
