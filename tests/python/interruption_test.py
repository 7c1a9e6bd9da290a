# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Ctrl-C while refine() works, as a user sees it: in a process of its own."""
import shutil
import signal
import subprocess
import sys
import unittest

import colmap_tsar
from sample_testing import results
from support import SampleTest

# Each image takes several times as long as a signal to be sent and seen.
SLOW = {"scene_planes": False, "num_iterations": 10}
REFINE = f"""
import sys, colmap_tsar
def tell(*state):
    print(*state, file=sys.stderr, flush=True)
def refine():
    colmap_tsar.Workspace(sys.argv[1]).refine(device="cpu", num_threads=1, progress=tell, **{SLOW})
"""

# Survives every signal, and reports it.
GO_ON = """
import signal, time
num_signals = 0
def note(*_):
    global num_signals
    num_signals += 1
    tell("signal", num_signals)
    raise KeyboardInterrupt
signal.signal(signal.SIGINT, note)
try:
    refine()
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
    num_images = 4

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        in_one_go = cls.class_folder / "in_one_go"
        shutil.copytree(cls.sample, in_one_go)
        colmap_tsar.refine(in_one_go, device="cpu", progress=False, **SLOW)
        cls.refined = results(in_one_go)

    def interrupt(self, script):
        """Starts it, and sends a signal when an image is done."""
        process = subprocess.Popen([sys.executable, "-c", REFINE + script, str(self.workspace)],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.wait_for(process, "refine 1 4")
        process.send_signal(signal.SIGINT)
        return process

    def wait_for(self, process, text):
        """Reads the process's standard error up to the line with this text."""
        for line in process.stderr:
            if text in line:
                return
        self.fail(f"the process ended without '{text}': {process.communicate()}")

    def expect_whole_workspace(self):
        """Every map is COLMAP's or the refined one, some of both are there, and
        the same call continues to the bytes of an uninterrupted run."""
        original, refined = results(self.sample), self.refined
        for path, digest in results(self.workspace).items():
            self.assertIn(digest, (original.get(path), refined[path]), path)
        summary = colmap_tsar.refine(self.workspace, device="cpu", progress=False, **SLOW)
        self.assertGreater(summary.num_skipped, 0)
        self.assertGreater(summary.num_refined, 0)
        self.assertEqual(summary.num_skipped + summary.num_refined, self.num_images)
        self.assertEqual(results(self.workspace), refined)

    def test_ends_in_order_and_goes_on(self):
        process = self.interrupt("refine()")
        _, errors = process.communicate()
        # As Python ends every process that a KeyboardInterrupt ends.
        self.assertEqual(process.returncode, -signal.SIGINT, errors)
        self.assertTrue(errors.endswith("KeyboardInterrupt\n"), errors)
        self.expect_whole_workspace()

    def test_a_second_one_does_no_harm(self):
        process = self.interrupt(GO_ON)
        self.wait_for(process, "signal 1")
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate()
        self.assertEqual(process.returncode, 0, errors)
        self.assertEqual(output, "interrupted\nwent on\n")
        self.expect_whole_workspace()


if __name__ == "__main__":
    unittest.main()
