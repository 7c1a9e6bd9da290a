# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Ctrl-C while refine() works, as a user sees it: in a process of its own."""
import shutil
import signal
import subprocess
import sys
import unittest

import colmap_tsar
from support import SampleTest, results

REFINE = """
import sys, colmap_tsar
def tell(*state):
    print(*state, file=sys.stderr, flush=True)
colmap_tsar.Workspace(sys.argv[1]).refine(device="cpu", num_threads=1, progress=tell)
"""

# Lives on, whatever comes; says what came.
REFINE_AND_GO_ON = """
import signal, sys, time, colmap_tsar
num_signals = 0
def note(*_):
    global num_signals
    num_signals += 1
    print("signal", num_signals, file=sys.stderr, flush=True)
    raise KeyboardInterrupt
signal.signal(signal.SIGINT, note)
def tell(*state):
    print(*state, file=sys.stderr, flush=True)
try:
    colmap_tsar.Workspace(sys.argv[1]).refine(device="cpu", num_threads=1, progress=tell)
except KeyboardInterrupt:
    print("interrupted")
while num_signals < 2:
    try:
        time.sleep(0.01)
    except KeyboardInterrupt:
        pass
print("went on")
"""


class InterruptionTest(SampleTest):
    num_images = 8

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        in_one_go = cls.class_folder / "in_one_go"
        shutil.copytree(cls.sample, in_one_go)
        colmap_tsar.refine(in_one_go, device="cpu", progress=False)
        cls.refined = results(in_one_go)

    def start(self, script):
        return subprocess.Popen(
            [sys.executable, "-c", script, str(self.workspace)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def wait_for(self, process, text):
        """Reads the process's standard error up to the line with this text."""
        for line in process.stderr:
            if text in line:
                return
        self.fail(f"the process ended without '{text}': {process.communicate()}")

    def expect_whole_workspace(self):
        """Every map is COLMAP's or the refined one, some of both are there, and the
        same call goes on from there to the same bytes as in one go."""
        original, refined = results(self.sample), self.refined
        interrupted = results(self.workspace)
        for path, digest in interrupted.items():
            self.assertIn(digest, (original.get(path), refined[path]), path)
        summary = colmap_tsar.refine(self.workspace, device="cpu", progress=False)
        self.assertGreater(summary.num_skipped, 0)
        self.assertGreater(summary.num_refined, 0)
        self.assertEqual(
            summary.num_skipped + summary.num_refined, self.num_images
        )
        self.assertEqual(results(self.workspace), refined)

    def test_ends_in_order_and_goes_on(self):
        process = self.start(REFINE)
        self.wait_for(process, "Pass 3 of 3 1 8")
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
        # As Python ends whatever a KeyboardInterrupt ends.
        self.assertEqual(process.returncode, -signal.SIGINT, errors)
        self.assertTrue(errors.endswith("KeyboardInterrupt\n"), errors)
        self.expect_whole_workspace()

    def test_a_second_one_does_no_harm(self):
        process = self.start(REFINE_AND_GO_ON)
        self.wait_for(process, "Pass 3 of 3 1 8")
        process.send_signal(signal.SIGINT)
        self.wait_for(process, "signal 1")
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate()
        self.assertEqual(process.returncode, 0, errors)
        self.assertEqual(output, "interrupted\nwent on\n")
        self.expect_whole_workspace()


if __name__ == "__main__":
    unittest.main()
