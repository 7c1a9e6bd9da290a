# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Curves over a logarithmic axis as an SVG picture, by nothing but text."""

import math
from xml.sax.saxutils import escape

WIDTH, HEIGHT = 640, 220  # Of one curve's panel.
LEFT, RIGHT, TOP, BOTTOM = 60, 30, 34, 40
COLORS = ("#1f6fb4", "#c4541a")


def round_up(value):
    """The next of 1, 2, 5, 10, 20 ... at or above a positive value."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(factor * power for factor in (1, 2, 5, 10)
                if factor * power >= value * (1 - 1e-9))


class Panel:
    def __init__(self, top, xs, ys):
        self.top = top
        self.xs = [math.log10(x) for x in xs]
        self.y_max = round_up(max(ys))

    def x(self, value):
        low, high = self.xs[0], self.xs[-1]
        share = (math.log10(value) - low) / (high - low) if high > low else 0.5
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


def draw_panel(top, x_label, xs, name, ys, color):
    panel = Panel(top, xs, ys)
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
    points = " ".join(f"{panel.x(x):.1f},{panel.y(y):.1f}"
                      for x, y in zip(xs, ys))
    parts.append(f'<polyline points="{points}" fill="none" stroke="{color}" '
                 'stroke-width="2"/>')
    parts += [f'<circle cx="{panel.x(x):.1f}" cy="{panel.y(y):.1f}" r="3" '
              f'fill="{color}"/>' for x, y in zip(xs, ys)]
    return parts


def write_line_plot(path, x_label, xs, curves):
    """One panel for each curve (its name and values), below each other.

    xs: ascending positive numbers, shared by all curves; each y axis begins at
    0, so that a curve that looks flat is flat.
    """
    height = HEIGHT * len(curves)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" '
             f'height="{height}" font-family="sans-serif" font-size="12">',
             f'<rect width="{WIDTH}" height="{height}" fill="white"/>']
    for i, (name, ys) in enumerate(curves):
        parts += draw_panel(i * HEIGHT, x_label, xs, name, ys,
                            COLORS[i % len(COLORS)])
    path.write_text("\n".join([*parts, "</svg>"]) + "\n")
