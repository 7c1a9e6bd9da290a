# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""A synthetic workspace, and what a user may change in it after it was refined. Every
change gives the files that it writes a later time than the one before, so that
no two of them fall into one tick of the clock."""
import math
import os

import synthetic_workspace
from synthetic_workspace import BASELINE, FOCAL, HEIGHT, NAMES, WIDTH

BEGIN = 1_600_000_000  # Seconds; every file that is changed is a minute younger.


class ChangingWorkspace:
    """A workspace, in several folders at once. sources: with which images each
    image is compared; those that are left out are no references."""

    def __init__(self, root, sources):
        self.roots = [root]
        self.time = BEGIN
        self.names = list(NAMES)
        self.sources = dict(sources)
        self.position = {name: BASELINE * view for view, name in enumerate(NAMES)}
        self.focal = {name: FOCAL for name in NAMES}
        synthetic_workspace.draw(root, len(NAMES))
        for parent, _, files in os.walk(root):
            for file in files:
                os.utime(os.path.join(parent, file), (BEGIN, BEGIN))
        self.write_model()

    def write(self, path, content):
        self.time += 60
        for root in self.roots:
            synthetic_workspace.write(os.path.join(root, path), content)
            os.utime(os.path.join(root, path), (self.time, self.time))

    def write_model(self):
        """The sparse model, in which each image has a camera of its own, and the
        lists of images."""
        cameras = images = ""
        for number, name in enumerate(self.names, 1):
            focal = self.focal[name]
            cameras += f"{number} PINHOLE {WIDTH} {HEIGHT} {focal} {focal} {WIDTH / 2} {HEIGHT / 2}\n"
            images += f"{number} 1 0 0 0 {-self.position[name]} 0 0 {number} {name}\n\n"
        self.write("sparse/cameras.txt", cameras.encode())
        self.write("sparse/images.txt", images.encode())
        points = synthetic_workspace.sparse_model(self.names)["points3D.txt"]
        self.write("sparse/points3D.txt", points.encode())
        lists = "".join(f"{name}\n{', '.join(sources)}\n" for name, sources in self.sources.items())
        self.write("stereo/patch-match.cfg", lists.encode())
        self.write("stereo/fusion.cfg", "".join(f"{name}\n" for name in self.names).encode())

    def move(self, name, distance=0.003):
        self.position[name] += distance
        self.write_model()

    def zoom(self, name, factor=1.01):
        self.focal[name] *= factor
        self.write_model()

    def set_sources(self, sources, names=None):
        self.sources = dict(sources)
        self.names = list(names or self.names)
        self.write_model()

    def repaint(self, name, shift=3):
        view = NAMES.index(name)
        rows = [[synthetic_workspace.level(view, x, y) - shift for x in range(WIDTH)]
                for y in range(HEIGHT)]
        self.write("images/" + name, synthetic_workspace.png(rows))

    def match_again(self, name, kind, factor=1.002):
        """As COLMAP does: both maps, over whatever has their names."""
        depths = [factor * depth for depth in synthetic_workspace.depth_map(NAMES.index(name), kind)]
        tilt = factor - 1.0
        normals = [[tilt if depth > 0 else 0.0 for depth in depths], [0.0] * len(depths),
                   [-math.sqrt(1.0 - tilt * tilt) if depth > 0 else 0.0 for depth in depths]]
        tail = f"{name}.{kind}.bin"
        self.write("stereo/depth_maps/" + tail, synthetic_workspace.map_file([depths]))
        self.write("stereo/normal_maps/" + tail, synthetic_workspace.map_file(normals))

    def export_costs(self, name, kind, cost=0.3):
        costs = [cost if x % 7 else 1.5 for _ in range(HEIGHT) for x in range(WIDTH)]
        self.write(f"stereo/cost_maps/{name}.{kind}.bin",
                   synthetic_workspace.map_file([costs, [2.0] * len(costs)]))
