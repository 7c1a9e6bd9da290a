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


class StartWorkspaces:
    """Paths of workspaces in a folder: `bare` has no maps, `mapped` has some,
    which are refined in `refined`; `external` has depth images for an import
    to `imported`."""

    def __init__(self, folder):
        self.bare, self.mapped, self.refined, self.imported, self.external = (
            os.path.join(folder, name)
            for name in ("bare", "mapped", "refined", "imported", "external"))

    def make(self, program):
        synthetic_workspace.draw(self.bare, NUM_IMAGES, with_maps=False)
        synthetic_workspace.draw(self.mapped, NUM_IMAGES)
        synthetic_workspace.draw_external_maps(self.external, NUM_IMAGES)
        copy(self.mapped, self.refined)
        program.run("tsar_refine", self.refined)
