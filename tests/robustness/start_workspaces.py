# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Where the commands start from in the tests of this folder, and options with
which they do little work."""
import os

import synthetic_workspace
from robustness import copy

NUM_IMAGES = 2

STEREO = [word for name in ("num_iterations", "num_geometric_passes", "num_sources", "num_levels")
          for word in ("--TsarStereo." + name, 1)]


def import_options(external):
    return ["--input_path", external, "--format", "depth", "--overwrite", 1]


class StartWorkspaces:
    """Paths of workspaces in a folder: `bare` has no maps, `mapped` has some,
    which are refined in `refined`; into `imported`, those of `external` were
    imported."""

    def __init__(self, folder):
        self.bare, self.mapped, self.refined, self.imported, self.external = (
            os.path.join(folder, name)
            for name in ("bare", "mapped", "refined", "imported", "external"))
        self.import_options = import_options(self.external)

    def write_external_maps(self, scale):
        synthetic_workspace.draw_external_maps(self.external, NUM_IMAGES, scale)

    def make(self, program):
        synthetic_workspace.draw(self.bare, NUM_IMAGES, with_maps=False)
        synthetic_workspace.draw(self.mapped, NUM_IMAGES)
        self.write_external_maps(1.0)
        copy(self.mapped, self.refined)
        program.run("tsar_refine", self.refined)
        copy(self.mapped, self.imported)
        program.run("tsar_import", self.imported, *self.import_options)
