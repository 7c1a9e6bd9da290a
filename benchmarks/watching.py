# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a program and watches its time and its memory on the host and on GPUs."""

import os
import subprocess
import tempfile
import threading
import time
from dataclasses import dataclass

from programs import CommandFailed, describe_failure, run

# Rarely enough that nvidia-smi, which takes the driver's locks, does not slow
# down what is measured.
POLL_SECONDS = 0.2


@dataclass
class Usage:
    """What a program took. Memory in MiB; gpu_memory is None without a GPU.
    cpu_seconds are those of all its threads, which other programs on the
    machine do not lengthen."""
    seconds: float
    cpu_seconds: float
    host_memory: float
    gpu_memory: float | None


def nvidia_smi(query):
    """The command that prints these properties of all GPUs, a line for each."""
    return ["nvidia-smi", f"--query-gpu={query}",
            "--format=csv,noheader,nounits"]


def describe_gpus():
    """Names and driver of the GPUs, or 'none'."""
    try:
        lines = run(nvidia_smi("name,driver_version")).strip().splitlines()
    except CommandFailed:
        return "none"
    return "; ".join(line.replace(", ", ", driver ") for line in lines)


def used_gpu_memory():
    """MiB in use by the index of each GPU; empty where there is none."""
    try:
        lines = run(nvidia_smi("index,memory.used")).splitlines()
        return {gpu: float(used)
                for gpu, used in (line.split(",") for line in lines)}
    except (CommandFailed, ValueError):
        return {}


class GpuMemoryWatch:
    """The most memory in use on one GPU above what was in use at the start.

    That counts other programs' memory too, so nothing else may run there, and
    the driver's own memory for a program (a few hundred MiB).
    """

    def __init__(self):
        self.at_start = used_gpu_memory()
        self.peak = 0.0 if self.at_start else None
        self.is_over = threading.Event()
        self.thread = threading.Thread(target=self._poll)

    def __enter__(self):
        if self.at_start:
            self.thread.start()
        return self

    def _poll(self):
        while True:
            for gpu, used in used_gpu_memory().items():
                self.peak = max(self.peak, used - self.at_start.get(gpu, used))
            if self.is_over.wait(POLL_SECONDS):
                return

    def __exit__(self, *_):
        self.is_over.set()
        if self.thread.is_alive():
            self.thread.join()


def watch(command, environment=None):
    """Runs a command; raises CommandFailed where it ends with an error."""
    command = [str(word) for word in command]
    with tempfile.TemporaryFile("w+") as output, GpuMemoryWatch() as gpu:
        start = time.monotonic()
        try:
            process = subprocess.Popen(
                command, stdout=output, stderr=subprocess.STDOUT,
                env={**os.environ, **(environment or {})})
        except OSError as error:
            raise CommandFailed(f"{command[0]}: {error.strerror}") from error
        _, status, resources = os.wait4(process.pid, 0)
        seconds = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            output.seek(0)
            raise CommandFailed(describe_failure(
                command, process.returncode, output.read()))
    # Linux gives the largest resident size in KiB.
    return Usage(seconds, resources.ru_utime + resources.ru_stime,
                 resources.ru_maxrss / 1024, gpu.peak)
