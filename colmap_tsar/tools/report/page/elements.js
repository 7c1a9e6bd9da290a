// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause
//
// Texts and elements of the page. Names of images are only ever used as text,
// never as HTML.

"use strict";

window.TsarElements = (() => {
  // Texts.

  const number = new Intl.NumberFormat("en");
  const percent = (part, all) =>
    `${(all > 0 ? (100 * part) / all : 0).toFixed(1)}\u00a0%`;
  const short = (value) => Number(value.toPrecision(3)).toString();
  const sum = (values) => values.reduce((total, value) => total + value, 0);
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

  return {
    number,
    percent,
    short,
    sum,
    capital,
    plural,
    h,
    swatch,
    gradient,
    whenNear,
    choice,
  };
})();
