# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of this folder share: commands, and what a workspace holds."""
import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import time

SKIPPED = 77  # To ctest.

MAPS = ("depth_maps", "normal_maps", "cost_maps")
# Beside these, which tell times, a run writes the same bytes always.
ACCOUNTS = ("stereo/tsar/manifest.json", "stereo/tsar/records/")


def parse_arguments(*names):
    parser = argparse.ArgumentParser()
    for name in ("program", "folder") + names:
        parser.add_argument("--" + name, required=True)
    return parser.parse_args()


def check(condition, message):
    if not condition:
        sys.exit("FAILED: " + message)


def make_folder(wanted):
    """In memory where that can be: a run flushes dozens of files to the disk. It
    goes when the program ends, whatever the result."""
    memory = "/dev/shm"
    parent = memory if os.access(memory, os.W_OK) else wanted
    os.makedirs(parent, exist_ok=True)
    return tempfile.TemporaryDirectory(prefix="tsar_robustness_", dir=parent)


class Program:
    """colmap_tsar, on one CPU thread unless told otherwise."""

    def __init__(self, path, shim=None):
        self.path = path
        self.shim = shim

    def arguments(self, command, workspace, *options):
        group = {"tsar_refine": "TsarRefine", "tsar_stereo": "TsarStereo"}.get(command)
        # Words may be bytes that are no text.
        words = [self.path, command, "--workspace_path", workspace,
                 *(word if isinstance(word, bytes) else str(word) for word in options)]
        if group and "--restore" not in words:
            for name, value in (("device", "cpu"), ("num_threads", "1")):
                if f"--{group}.{name}" not in words:
                    words += [f"--{group}.{name}", value]
        return words

    def start(self, *words, prepare=None, **faults):
        """prepare: called in the new process before the program. faults: kill_at,
        stop_at, log or no_exchange, of fault_points.cc."""
        environment = dict(os.environ)
        if faults:
            environment["LD_PRELOAD"] = self.shim
        for name, value in faults.items():
            environment["TSAR_FAULT_" + name.upper()] = str(value)
        return subprocess.Popen(self.arguments(*words), env=environment, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                preexec_fn=prepare)

    def call(self, *words, **how):
        """(exit code, standard error)"""
        process = self.start(*words, **how)
        _, errors = process.communicate()
        return process.returncode, errors

    def starts(self, *words, patience, **how):
        """Whether the program is loaded and says something of its own. Where a
        library that is loaded with it needs what it cannot have, the loader ends
        the process, or the library waits for ever (OpenBLAS asks for its memory
        until it has it), for which there is patience of so many seconds."""
        process = self.start(*words, **how)
        try:
            process.communicate(timeout=patience)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
        return process.returncode in (0, 1)

    def run(self, *words, **faults):
        code, errors = self.call(*words, **faults)
        check(code == 0, f"{' '.join(words[:2])} ended with {code}: {errors}")

    def evaluate(self, workspace):
        """(exit code, standard error) of tsar_evaluate depth"""
        result = subprocess.run([self.path, "tsar_evaluate", "depth", "--workspace_path", workspace],
                                capture_output=True, text=True, check=False)
        return result.returncode, result.stderr

    def fails_with_one_line(self, *words, texts=(), **how):
        """That the command ends with exit code 1 and one clear line."""
        code, errors = self.call(*words, **how)
        lines = [line for line in errors.splitlines() if line.startswith("ERROR: ")]
        what = f"{' '.join(map(str, words))} ended with {code}: {errors}"
        check(code == 1 and len(lines) == 1 and errors.endswith(lines[0] + "\n"), what)
        check("unexpected failure" not in lines[0], what)
        for text in texts:
            check(text in lines[0], f"no '{text}' in: {lines[0]}")
        return lines[0]


def wait_until_stopped(process):
    """Until a program that was started with stop_at is there."""
    while True:
        with open(f"/proc/{process.pid}/stat", encoding="utf-8") as file:
            state = file.read().rpartition(")")[2].split()[0]
        if state == "T":
            return
        check(state != "Z", "the program ended")
        time.sleep(0.01)


def read_tree(root):
    """The bytes of every file below a folder, by relative path; links are
    followed, folders left out."""
    found = {}
    for parent, _, names in os.walk(root):
        for name in names:
            path = os.path.join(parent, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, root)] = file.read()
    return found


def without_accounts(tree):
    return {path: content for path, content in tree.items() if not path.startswith(ACCOUNTS)}


def maps_of(tree):
    """The depth, normal and cost maps alone."""
    folders = tuple(f"stereo/{name}/" for name in MAPS)
    return {path: content for path, content in tree.items()
            if path.startswith(folders) and not path.endswith(".tsar_tmp")}


def difference(tree, expected):
    """The paths that differ, for messages."""
    return sorted(path for path in tree.keys() | expected.keys()
                  if tree.get(path) != expected.get(path))


def check_same(tree, expected, what):
    check(tree == expected, f"{what}: {difference(tree, expected)} differ")


def check_kept(tree, first, last, case):
    """Maps are of before or of after, and what was before is there."""
    stored = {"refine": "stereo/tsar/original/"}
    for path, content in maps_of(first).items():
        check(tree.get(path) in (content, last.get(path)), f"{path} is neither")
        if case in stored:
            kept = tree.get(stored[case] + path[len("stereo/"):])
            check(content in (tree[path], kept), f"{path} is lost")
    for path, content in maps_of(tree).items():
        check(content in (first.get(path), last.get(path)), f"{path} is not complete")
    for path in first.keys() - maps_of(first).keys():
        if not path.startswith(("stereo/tsar", "stereo/confidence", "stereo/sigma",
                                 "stereo/provenance", "stereo/plane_maps")):
            check(tree.get(path) == first[path], f"{path} changed")


def copy(source, target):
    shutil.rmtree(target, ignore_errors=True)
    shutil.copytree(source, target, symlinks=True)


def set_time(path, hours):
    """Has the file changed so many hours later: clocks may stand still in a test."""
    state = os.stat(path)
    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns + hours * 3600 * 10**9))


def fingerprint(text):
    return hashlib.sha256(text.encode()).hexdigest()[:12]
