#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the scripts for data sets repeat, what they do not, and what they leave
behind when they are stopped."""
import os
import signal
import subprocess
import sys
import time
import unittest

from dataset_testing import COLMAP, PROGRAM, FolderTest  # First: it sets the path.

from files import DatasetError, write_text
from steps import Scene


class StepsTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.ran = []
        self.input = self.write("input", "1")
        self.scene = Scene("scene", self.root / "out")

    def run_steps(self, option=1, fail=False):
        """Two steps, the second after the first; returns the names of those run."""
        self.ran = []

        def first(step):
            self.ran.append("first goes on" if step.continued else "first")
            path = self.scene.folder / "a"
            path.write_text(path.read_text() + "+" if path.exists() else "a")
            step.run("sh", "-c", "exit 3" if fail else "exit 0")

        def second(_):
            self.ran.append("second")
            (self.scene.folder / "b").write_text("b")

        self.scene.step("first", first, ["a"], {"option": option}, [self.input], resumes=True)
        self.scene.step("second", second, ["b"], after=["first"])
        return self.ran

    def test_done_is_done(self):
        self.assertEqual(self.run_steps(), ["first", "second"])
        self.assertEqual(self.run_steps(), [])

    def test_what_changed_is_done_again_with_what_follows(self):
        self.run_steps()
        self.assertEqual(self.run_steps(option=2), ["first", "second"])
        self.input.write_text("12")
        self.assertEqual(self.run_steps(option=2), ["first", "second"])
        (self.scene.folder / "b").unlink()
        self.assertEqual(self.run_steps(option=2), ["second"])
        (self.scene.folder / "a").unlink()
        self.assertEqual(self.run_steps(option=2), ["first", "second"])
        self.assertEqual((self.scene.folder / "a").read_text(), "a")

    def test_what_failed_goes_on_and_keeps_its_seconds(self):
        with self.assertRaisesRegex(DatasetError, "scene: first failed.*first.log"):
            self.run_steps(fail=True)
        record = self.scene.record("first")
        self.scene.write_record("first", {**record, "seconds": 100.0})
        self.assertEqual(self.run_steps(), ["first goes on", "second"])
        self.assertEqual((self.scene.folder / "a").read_text(), "a+")
        self.assertGreaterEqual(self.scene.seconds("first"), 100)
        self.assertLess(self.scene.seconds("second"), 100)

    def test_what_failed_with_other_options_starts_anew(self):
        with self.assertRaises(DatasetError):
            self.run_steps(fail=True)
        self.assertEqual(self.run_steps(option=2), ["first", "second"])
        self.assertEqual((self.scene.folder / "a").read_text(), "a")

    def test_a_damaged_record_is_as_none(self):
        self.run_steps()
        self.scene.record_path("first").write_text("{")
        self.assertEqual(self.run_steps(), ["first", "second"])

    def test_the_program_ends_with_the_script(self):
        pid_file = self.root / "pid"
        script = self.write("script.py", f'''
import command_line
import dense
def run(args, programs):
    scene = dense.open_scene(args, "sleeper")
    scene.step("sleep", lambda step: step.run(
        "sh", "-c", "echo $$ > {pid_file}.part; mv {pid_file}.part {pid_file}; exec sleep 9999"),
        outputs=[])
command_line.run_main(command_line.make_parser("test", "", "", {{}}, ""), run)
''')
        for number in (signal.SIGTERM, signal.SIGHUP):
            pid_file.unlink(missing_ok=True)
            process = subprocess.Popen(
                [sys.executable, script, "scene", "--output_path", self.root / "out2", "--colmap",
                 COLMAP, "--colmap_tsar", PROGRAM], stdout=subprocess.DEVNULL,
                preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_DFL),
                env=dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path)))
            while process.poll() is None and not pid_file.exists():
                time.sleep(0.02)
            pid = int(pid_file.read_text())
            process.send_signal(number)
            self.assertEqual(process.wait(), 128 + number)
            self.assertRaises(ProcessLookupError, os.kill, pid, 0)

    def test_no_program_outlives_a_signal_at_its_start(self):
        pid_file = self.root / "pid"
        script = self.write("script.py", f'''
import signal
import sys
signal.signal(signal.SIGTERM, lambda number, _: sys.exit(128 + number))
from steps import Scene
Scene("scene", sys.argv[1]).step("step", lambda step: step.run(
    "sh", "-c", "echo $$ > {pid_file}; kill -TERM $PPID; exec sleep 9999"), [])
''')
        for i in range(5):
            status = subprocess.run(
                [sys.executable, script, self.root / f"out{i}"],
                env=dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path))).returncode
            self.assertEqual(status, 128 + signal.SIGTERM)
            self.assertRaises(ProcessLookupError, os.kill, int(pid_file.read_text()), 0)

    def test_only_in_a_folder_of_its_own(self):
        mine = self.write("mine/before.ply", "mine")
        self.rejects("not made by this script", Scene, "scene", self.root / "mine")
        self.assertEqual(mine.read_text(), "mine")
        self.assertEqual(os.listdir(mine.parent), ["before.ply"])

    def test_a_full_disk_is_an_error_of_the_file(self):
        path = self.root / "model.txt"
        os.symlink("/dev/full", f"{path}.part")
        self.rejects(f"{path}: cannot be written: No space left on device", write_text, path, "text")
        self.assertFalse(path.exists())

    def test_one_run_at_a_time(self):
        self.rejects("another run", Scene, "scene", self.root / "out")


if __name__ == "__main__":
    unittest.main()
