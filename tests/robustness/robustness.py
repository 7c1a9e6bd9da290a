# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of this folder share: commands, what they start from, and what a
workspace holds."""
import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time

import synthetic_workspace

SKIPPED = 77  # To ctest.
NUM_IMAGES = 2
KEY = "v0.png.geometric"
# With these, tsar_stereo does little work.
STEREO = [word for name in ("num_iterations", "num_geometric_passes", "num_sources", "num_levels")
          for word in ("--TsarStereo." + name, 1)]
MAPS = ("depth_maps", "normal_maps", "cost_maps")
# Except for these, which record times, a run always writes the same bytes.
ACCOUNTS = ("stereo/tsar/manifest.json", "stereo/tsar/records/")


def check(condition, message):
    if not condition:
        sys.exit("FAILED: " + message)


class Program:
    """colmap_tsar, on one CPU thread unless told otherwise."""

    def __init__(self, path, shim):
        self.path = path
        self.shim = shim

    def arguments(self, command, workspace, *options):
        group = {"tsar_refine": "TsarRefine", "tsar_stereo": "TsarStereo"}.get(command)
        # Words may be bytes that are not text.
        words = [self.path, command, *(["depth"] if command == "tsar_evaluate" else []),
                 "--workspace_path", workspace,
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

    def run(self, *words, **faults):
        code, errors = self.call(*words, **faults)
        check(code == 0, f"{words} ended with {code}: {errors}")
        return errors

    def log(self, *words, **faults):
        """The calls by which an undisturbed run changes files."""
        with tempfile.NamedTemporaryFile("r", encoding="utf-8") as file:
            self.run(*words, log=file.name, **faults)
            return file.read().splitlines()

    def fails_with_one_line(self, *words, texts=(), **how):
        """Checks that the command ends with exit code 1 and one clear line that
        contains these texts."""
        code, errors = self.call(*words, **how)
        what = f"{words} ended with {code}: {errors}"
        check_one_line(code, errors, what)
        line = errors.splitlines()[-1]
        for text in texts:
            check(text in line, f"no '{text}' in: {line}")
        return line


def check_one_line(code, errors, what):
    lines = [line for line in errors.splitlines() if line.startswith("ERROR")]
    check(code == 1 and len(lines) == 1 and errors.endswith(lines[0] + "\n"), what)
    check(lines[0].startswith("ERROR: ") and "unexpected failure" not in lines[0], what)


class Setting:
    """A program, a folder that goes with this object, and in it workspaces to
    start from: `bare` has no maps, `mapped` has some, which are refined in
    `refined`; `external` has depth images for an import to `imported`. Commands
    run in `work`. names: of arguments besides the usual ones."""

    def __init__(self, *names, on_disk=False):
        parser = argparse.ArgumentParser()
        parser.add_argument("--shim")
        for name in ("program", "folder") + names:
            parser.add_argument("--" + name, required=True)
        self.args = parser.parse_args()
        self.program = Program(self.args.program, self.args.shim)
        # In memory if possible: a run flushes dozens of files to the disk.
        parent = self.args.folder if on_disk or not os.access("/dev/shm", os.W_OK) else "/dev/shm"
        os.makedirs(parent, exist_ok=True)
        self._folder = tempfile.TemporaryDirectory(prefix="tsar_robustness_", dir=parent)
        self.folder = self._folder.name
        for name in ("bare", "mapped", "refined", "imported", "external", "outside"):
            setattr(self, name, self.path(name))
        synthetic_workspace.draw(self.bare, NUM_IMAGES, with_maps=False)
        synthetic_workspace.draw(self.mapped, NUM_IMAGES)
        synthetic_workspace.draw_external_maps(self.external, NUM_IMAGES)
        copy(self.mapped, self.refined)
        self.program.run("tsar_refine", self.refined)
        self.use(self.path("work"))

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def use(self, work):
        """Has each command work there, with the workspace it starts from."""
        self.work = work
        self.commands = {
            "refine": (["tsar_refine", work], self.mapped),
            "restore": (["tsar_refine", work, "--restore", 1], self.refined),
            "stereo": (["tsar_stereo", work, *STEREO, "--overwrite", 1], self.bare),
            "report": (["tsar_report", work, "--overwrite", 1], self.refined),
        }

    def prepare(self, case):
        """Makes `work` what the command starts from, and returns the command."""
        command, source = self.commands[case]
        copy(source, self.work)
        return command

    def read_work(self):
        """Without a lock's file: one that is left behind means nothing."""
        return {path: content for path, content in without_accounts(read_tree(self.work)).items()
                if path != "stereo/tsar/lock"}

    def import_to(self, output, *options):
        return ["tsar_import", self.mapped, "--input_path", self.external, "--format", "depth",
                "--output_path", output, *options]


def in_own_name_space():
    """Restarts this test where it may mount; those mounts vanish when it ends.
    Skips it where that is not permitted."""
    if "TSAR_IN_NAME_SPACE" in os.environ:
        return
    probe = subprocess.run(["unshare", "--mount", "sh", "-c", "mount -t tmpfs tmpfs /mnt"],
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    if probe.returncode != 0:
        print("SKIPPED: mounting is not permitted here")
        sys.exit(SKIPPED)
    os.environ["TSAR_IN_NAME_SPACE"] = "1"
    os.execvp("unshare", ["unshare", "--mount", sys.executable, *sys.argv])


def wait_until_stopped(process):
    """Waits for a program that was started with stop_at. Returns whether it has
    stopped; otherwise it has ended."""
    while True:
        with open(f"/proc/{process.pid}/stat", encoding="utf-8") as file:
            state = file.read().rpartition(")")[2].split()[0]
        if state in "TZ":
            return state == "T"
        time.sleep(0.002)


def read(path):
    with open(path, "rb") as file:
        return file.read()


def edit(path, old, new):
    """Replaces bytes in a file that holds them."""
    content = read(path)
    check(old in content, f"{path} holds {old!r}")
    synthetic_workspace.write(path, content.replace(old, new))


def read_tree(root):
    """The bytes of every file below a folder, by relative path; links are
    followed, folders left out."""
    return {os.path.relpath(os.path.join(parent, name), root): read(os.path.join(parent, name))
            for parent, _, names in os.walk(root) for name in names}


def describe(root):
    """What every name below a folder stands for: a file's bytes, a link's target, or
    the kind of anything else."""
    found = {}
    for parent, folders, names in os.walk(root):
        for name in folders + names:
            path = os.path.join(parent, name)
            if os.path.islink(path):
                content = os.readlink(path)
            elif os.path.isfile(path):
                content = read(path)
            else:
                content = os.lstat(path).st_mode
            found[os.path.relpath(path, root)] = content
    return found


def without_accounts(tree):
    return {path: content for path, content in tree.items() if not path.startswith(ACCOUNTS)}


def maps_of(tree):
    """The depth, normal and cost maps alone."""
    folders = tuple(f"stereo/{name}/" for name in MAPS)
    return {path: content for path, content in tree.items()
            if path.startswith(folders) and not path.endswith(".tsar_tmp")}


def check_same(tree, expected, what):
    differ = sorted(path for path in tree.keys() | expected.keys()
                    if tree.get(path) != expected.get(path))
    check(not differ, f"{what}: {differ} differ")


def check_kept(tree, first, last, originals=None):
    """Checks that every map is whole, the former or the new one, and nothing
    else has changed. originals: maps that are in their place or kept."""
    for path in maps_of(first).keys() | maps_of(last).keys() | maps_of(tree).keys():
        check(path not in first or path not in last or path in tree, f"{path} is lost")
        check(tree.get(path) in (first.get(path), last.get(path), None), f"{path} is neither")
    for path, content in maps_of(originals or {}).items():
        kept = tree.get("stereo/tsar/original/" + path[len("stereo/"):])
        check(content in (tree.get(path), kept), f"{path} is lost")
    for path in first.keys() - maps_of(first).keys():
        if not path.startswith(("stereo/tsar", "stereo/confidence", "stereo/sigma",
                                "stereo/provenance", "stereo/plane_maps")):
            check(tree.get(path) == first[path], f"{path} changed")


def copy(source, target):
    shutil.rmtree(target, ignore_errors=True)
    shutil.copytree(source, target, symlinks=True)


def set_time(path, hours):
    """Dates a change hours later: clocks may stand still in a test."""
    state = os.stat(path)
    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns + hours * 3600 * 10**9))
