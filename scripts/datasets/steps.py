# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The steps of one scene, each done once.

A step is skipped when it was done with the same options, from the same inputs and
after the same earlier steps. One that was stopped starts anew, or goes on where
its program can do that. steps/NAME.json of the scene's folder keeps what was done
and the seconds it took, those of stopped attempts included; logs/NAME.log what
the programs printed.
"""
import fcntl
import json
import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import time

from files import DatasetError, write_text

MIN_FREE_BYTES = 16 << 20  # With less, what a program wrote may be cut off.
RECORD_SECONDS = 2     # How often a running step's time is put on record.
PROGRESS_SECONDS = 30  # How often a running step is heard of.


class ProgramError(DatasetError):
    """A program that a step runs has failed."""


def stamp(path):
    """What tells a file from a changed one; for a folder, of all files in it."""
    path = pathlib.Path(path)
    if path.is_dir():
        return [[str(p.relative_to(path)), *stamp(p)]
                for p in sorted(path.rglob("*")) if p.is_file()]
    status = path.stat()
    return [status.st_size, status.st_mtime_ns]


def remove(path):
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def last_line(path):
    """The last line that a program printed, of progress shown in one line too."""
    with open(path, "rb") as file:
        file.seek(max(0, path.stat().st_size - 4096))
        lines = file.read().decode(errors="replace").replace("\r", "\n").split("\n")
    return next((line.strip() for line in reversed(lines) if line.strip()), "")


class Step:
    """A step at work: what its action sees."""

    def __init__(self, scene, name, continued):
        self.scene = scene
        self.name = name
        self.continued = continued  # Outputs of a stopped attempt are there.
        self.log = scene.folder / "logs" / f"{name}.log"
        self.on_wait = lambda: None

    def run(self, *command):
        """Runs a program to its end, which has to be a good one."""
        command = [str(part) for part in command]
        self.log.parent.mkdir(parents=True, exist_ok=True)
        with open(self.log, "a", encoding="utf-8") as log:
            log.write("$ " + shlex.join(command) + "\n")
            log.flush()
            # A signal that comes while the program starts is heard only where the
            # program is ended with it.
            usual = signal.pthread_sigmask(
                signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM, signal.SIGHUP})
            unblock = lambda: signal.pthread_sigmask(signal.SIG_SETMASK, usual)
            try:
                # The program holds the scene's lock as well, so that nothing else
                # touches its files should this script be killed before it.
                process = subprocess.Popen(
                    command, stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                    env=dict(os.environ, QT_QPA_PLATFORM="offscreen"),
                    pass_fds=[self.scene.lock], preexec_fn=unblock)
            except BaseException:
                unblock()
                raise
        try:
            unblock()
            self.wait(process)
        finally:
            if process.poll() is None:
                process.terminate()
                process.wait()
        free = shutil.disk_usage(self.scene.folder).free
        if free < MIN_FREE_BYTES:
            raise DatasetError(f"{self.scene.folder}: the disk is full ({free >> 20} MB left) at "
                               f"step {self.name}; make room and give the same command again")
        if process.returncode != 0:
            raise ProgramError(
                f"{self.scene.name}: {self.name} failed: {pathlib.Path(command[0]).name} "
                f"{command[1]} says '{last_line(self.log)[:300]}'; see {self.log}")

    def wait(self, process):
        begin = told = time.monotonic()
        while True:
            try:
                process.wait(RECORD_SECONDS)
                return
            except subprocess.TimeoutExpired:
                self.on_wait()
            if time.monotonic() - told >= PROGRESS_SECONDS:
                told = time.monotonic()
                self.scene.say(f"{self.name}: {told - begin:.0f} s, {last_line(self.log)[:90]}")


class Scene:
    """One scene's folder of outputs."""

    def __init__(self, name, folder, plan=()):
        self.name = name
        self.plan = list(plan)  # The steps to come, where the number of each is told.
        self.folder = pathlib.Path(folder)
        # What the steps make, they remove as well: nothing else may be there.
        if (self.folder.exists() and not (self.folder / "lock").is_file()
                and any(self.folder.iterdir())):
            raise DatasetError(f"{self.folder}: is there already and was not made by this "
                               "script; name another output folder")
        self.folder.mkdir(parents=True, exist_ok=True)
        self.lock = os.open(self.folder / "lock", os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise DatasetError(f"{self.folder}: another run is at work in it; "
                               "wait for its end") from None

    def say(self, message):
        print(f"[{self.name}] {message}", flush=True)

    def title(self, name):
        """A step's name with its number, where that is known."""
        if name not in self.plan:
            return name
        return f"step {self.plan.index(name) + 1} of {len(self.plan)}: {name}"

    def record_path(self, name):
        return self.folder / "steps" / f"{name}.json"

    def record(self, name):
        """What is on record of a step, or an empty record."""
        try:
            return json.loads(self.record_path(name).read_text(encoding="utf-8"))
        except (FileNotFoundError, ValueError):
            return {"key": None, "state": "", "seconds": 0.0, "id": 0}

    def write_record(self, name, record):
        write_text(self.record_path(name), json.dumps(record, indent=1))

    def step(self, name, action, outputs, options=None, inputs=(), after=(), resumes=False,
             removes=True):
        """Calls action(step) unless its outputs are there from the same options,
        inputs (files or folders) and earlier steps (their names). Older outputs are
        removed before, or by the action itself where removes is False. resumes: the
        action takes up what a stopped attempt left."""
        outputs = [self.folder / output for output in outputs]
        # By way of JSON, so that it equals what is read again.
        key = json.loads(json.dumps({
            "options": options or {},
            "inputs": [[str(path), stamp(path)] for path in inputs],
            "after": [[other, self.record(other)["id"]] for other in after]}))
        old = self.record(name)
        title = self.title(name)
        same = old["key"] == key
        if same and old["state"] == "done" and all(path.exists() for path in outputs):
            self.say(f"{title}: done before ({old['seconds']:.1f} s)")
            return
        continued = same and resumes and old["state"] == "running"
        if not continued:
            for path in outputs if removes else []:
                remove(path)
            remove(self.folder / "logs" / f"{name}.log")
        earlier = old["seconds"] if continued else 0.0
        begin = time.monotonic()

        def put_on_record(state):
            self.write_record(name, {"key": key, "state": state, "id": time.time_ns(),
                                     "seconds": earlier + time.monotonic() - begin})

        put_on_record("running")
        self.say(f"{title} goes on" if continued else title)
        step = Step(self, name, continued)
        step.on_wait = lambda: put_on_record("running")
        try:
            action(step)
        except BaseException:
            put_on_record("running")
            raise
        put_on_record("done")
        self.say(f"{name}: {self.record(name)['seconds']:.1f} s")

    def retire(self, name, output):
        """Moves the output of a step that this run does not ask for into outdated/,
        unless the steps that it was made after are as they were then."""
        old, path = self.record(name), self.folder / output
        after = old["key"]["after"] if old["key"] else []
        current = old["state"] == "done" and all(
            self.record(other)["id"] == number for other, number in after)
        if current or not path.exists():
            return
        target = self.folder / "outdated" / f"{time.time_ns()}_{output}"
        target.parent.mkdir(exist_ok=True)
        os.replace(path, target)
        self.record_path(name).unlink(missing_ok=True)
        self.say(f"{output} is of an earlier run; moved to {target}")

    def seconds(self, *names):
        """How long these steps took together."""
        return sum(self.record(name)["seconds"] for name in names)
