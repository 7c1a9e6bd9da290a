# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""How the tests run reconstruct.sh with stand-ins for the programs."""
import os
import subprocess
import sys

from dataset_testing import REPOSITORY, FolderTest, check_one_line

STAND_IN = REPOSITORY / "tests" / "datasets" / "stand_ins.py"
STEPS = ["features", "matches", "sparse", "workspace", "stereo", "fusion_before", "refinement",
         "fusion_after", "report"]
COMMANDS = ["feature_extractor", "exhaustive_matcher", "mapper", "model_converter",
            "image_undistorter", "tsar_stereo", "tsar_fuse", "tsar_refine", "tsar_fuse",
            "tsar_report"]
# Its header says 16 x 12; it has no pixels, but an end.
PHOTO = (b"\x89PNG\r\n\x1a\n" + b"\0\0\0\rIHDR" + b"\0\0\0\x10\0\0\0\x0c" + bytes(9)
         + b"\0\0\0\0IEND" + bytes(4))


class StandInTest(FolderTest):
    """Runs reconstruct.sh on six photos, with stand-ins for the programs."""

    def setUp(self):
        super().setUp()
        self.photos, self.output = self.root / "photos", self.root / "out"
        for name in ("a.jpg.png", "left/b.PNG", "left/c d.png", "e.png", "f.png", "g.png"):
            path = self.photos / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(PHOTO)

    def call(self, *options, photos=None, output=None, stereo="tsar"):
        return subprocess.run(
            [str(part) for part in (
                sys.executable, REPOSITORY / "scripts" / "datasets" / "reconstruct.py",
                self.photos if photos is None else photos, self.output if output is None else output,
                "--colmap", STAND_IN, "--colmap_tsar", STAND_IN, "--python", STAND_IN,
                "--stereo", stereo, *options)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, "STAND_IN_FOLDER": str(self.root)})

    def run_well(self, *options, **where):
        """Returns what is printed, and the calls of programs."""
        (self.root / "calls.txt").unlink(missing_ok=True)
        result = self.call(*options, **where)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return result.stdout, self.calls()

    def calls(self):
        path = self.root / "calls.txt"
        return path.read_text().splitlines() if path.exists() else []

    def commands(self, *options):
        """The commands that a run with these options calls."""
        return [line.split()[0] for line in self.run_well(*options)[1] if line[0] != " "]

    def refuses(self, text, *options, **where):
        result = self.call(*options, **where)
        check_one_line(self, result, text)
        return result.stderr
