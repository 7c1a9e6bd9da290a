# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Curves as an SVG picture, written as text."""

import math
from xml.sax.saxutils import escape

WIDTH, HEIGHT = 640, 220  # The size of one curve's panel.
LEFT, RIGHT, TOP, BOTTOM = 60, 30, 34, 40
COLORS = ("#1f6fb4", "#c4541a", "#3a8a3a", "#7a4fa0", "#8a7a1a", "#555555")


def round_up(value):
    """The next of 1, 2, 5, 10, 20 ... at or above a positive value; 1 for 0."""
    if value <= 0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return next(factor * power for factor in (1, 2, 5, 10)
                if factor * power >= value * (1 - 1e-9))


class Panel:
    def __init__(self, top, xs, lines, logarithmic):
        self.top = top
        self.scale = math.log10 if logarithmic else float
        self.ends = self.scale(xs[0]), self.scale(xs[-1])
        self.y_max = round_up(max(max(ys) for ys in lines.values()))

    def x(self, value):
        low, high = self.ends
        share = ((self.scale(value) - low) / (high - low) if high > low
                 else 0.5)
        return LEFT + share * (WIDTH - LEFT - RIGHT)

    def y(self, value):
        return (self.top + HEIGHT - BOTTOM
                - value / self.y_max * (HEIGHT - TOP - BOTTOM))


def text(x, y, content, anchor="middle"):
    return (f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">'
            f"{escape(content)}</text>")


def line(x1, y1, x2, y2, color):
    return (f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" '
            f'stroke="{color}"/>')


def draw_curve(panel, xs, ys, color):
    points = " ".join(f"{panel.x(x):.1f},{panel.y(y):.1f}"
                      for x, y in zip(xs, ys))
    return [f'<polyline points="{points}" fill="none" stroke="{color}" '
            'stroke-width="2"/>',
            *(f'<circle cx="{panel.x(x):.1f}" cy="{panel.y(y):.1f}" r="3" '
              f'fill="{color}"/>' for x, y in zip(xs, ys))]


def draw_panel(panel, x_label, xs, name, lines, first_color):
    """lines: values by the line's name, which is shown if there are several."""
    top = panel.top
    parts = [text(LEFT, top + 22, name, "start")]
    for step in range(5):
        value = panel.y_max * step / 4
        y = panel.y(value)
        parts += [line(LEFT, y, WIDTH - RIGHT, y, "#dddddd"),
                  text(LEFT - 6, y + 4, f"{value:g}", "end")]
    for x in xs:
        parts += [line(panel.x(x), panel.y(0), panel.x(x), panel.y(0) + 4,
                       "#888888"),
                  text(panel.x(x), panel.y(0) + 18, f"{x:,}")]
    parts.append(text((LEFT + WIDTH - RIGHT) / 2, panel.y(0) + 34, x_label))
    for i, (label, ys) in enumerate(lines.items()):
        color = COLORS[(first_color + i) % len(COLORS)]
        parts += draw_curve(panel, xs, ys, color)
        if len(lines) > 1:
            parts.append(f'<g fill="{color}">' + text(
                WIDTH - RIGHT - 110 * (len(lines) - 1 - i), top + 22, label,
                "end") + "</g>")
    return parts


def write_line_plot(path, x_label, xs, curves, logarithmic=True):
    """One panel for each curve (its name and values), one below the other.

    xs: ascending numbers, shared by all curves, positive on a logarithmic axis;
    each y axis begins at 0, so that a curve that looks flat is flat. Values may
    be those of several lines by name, which then share the panel.
    """
    height = HEIGHT * len(curves)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" '
             f'height="{height}" font-family="sans-serif" font-size="12">',
             f'<rect width="{WIDTH}" height="{height}" fill="white"/>']
    for i, (name, values) in enumerate(curves):
        several = isinstance(values, dict)
        lines = values if several else {name: values}
        panel = Panel(i * HEIGHT, xs, lines, logarithmic)
        parts += draw_panel(panel, x_label, xs, name, lines,
                            0 if several else i)
    path.write_text("\n".join([*parts, "</svg>"]) + "\n")
