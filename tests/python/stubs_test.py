# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The types agree with the module: mypy finds no difference. Skipped if mypy is
not available from the package index."""
import os
import pathlib
import tempfile

import colmap_tsar
from sample_testing import call, check, run, skip
from support import WORK_FOLDER
from virtual_environment import VirtualEnvironment

USE = """\
import colmap_tsar

workspace = colmap_tsar.Workspace("dense")

image_of_depth: object = None

def tell(name: str, done: int, total: int) -> None: ...

summary = workspace.refine(scene_planes=False, device="cpu", progress=tell)
workspace.refine(preset="paper", segment=False, num_iterations=3)
colmap_tsar.refine("dense", seed=1, pass_="observe", cylinders=False)
share: float = summary.counts["depth_after"] / summary.counts["pixels"]
workspace.stereo(num_levels=1, device="auto", gpu_index=0)
workspace.refine(priors={"a.jpg": image_of_depth}, prior_type="metric")
colmap_tsar.refine("dense", priors=lambda name: (None, image_of_depth))
fused: int = workspace.fuse("fused.ply", preset="paper", max_reproj_error=1).num_points
workspace.report(max_image_size=500)
names = [image.name.upper() for image in workspace.images]
image: colmap_tsar.WorkspaceImage = workspace["a.jpg"]
width: int = image.camera.width
"""

# Each is an error of its own.
MISUSE = (
    "workspace.refine(num_thread=3)",
    "colmap_tsar.refine('dense', scene_planes='no')",
    "workspace.refine(priors=3)",
    "workspace.stereo(num_levels='two')",
    "workspace.stereo(device='gpu')",
    "workspace.fuse('fused.ply', min_num_views=2.5)",
    "workspace.import_maps('maps', 'depth', 'imported', overwrite='no')",
    "workspace.report(num_threads=[1])",
    "workspace[3]",
)


def main():
    package = pathlib.Path(colmap_tsar.__file__).parent
    with tempfile.TemporaryDirectory(dir=WORK_FOLDER) as folder:
        folder = pathlib.Path(folder)
        check((package / "py.typed").is_file(), "the package says that it has types")

        environment = VirtualEnvironment(WORK_FOLDER / "mypy_environment")
        if not environment.install("mypy", "numpy"):
            skip("mypy cannot be had from the package index")
        python = environment.python
        print(run(python, "-m", "mypy.stubtest", "--ignore-missing-stub", "colmap_tsar"))
        (folder / "use.py").write_text(USE + "\n".join(MISUSE) + "\n")
        checked = call(
            *(python, "-m", "mypy", "--strict", "--follow-imports=silent"),
            *("--hide-error-context", "--no-error-summary"),
            *("--cache-dir", folder / "cache", folder / "use.py"),
            env=dict(os.environ, MYPYPATH=str(package.parent)),
        )
        lines = {int(line.split(":")[1]) for line in checked.stdout.splitlines() if ": error:" in line}
        first = USE.count("\n") + 1
        check(
            lines == set(range(first, first + len(MISUSE))),
            f"mypy finds what is wrong and nothing else:\n{checked.stdout}{checked.stderr}",
        )


if __name__ == "__main__":
    main()
