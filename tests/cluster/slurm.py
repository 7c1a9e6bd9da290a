# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""A Slurm of one machine, with its files in a folder of its own, for a test."""
import ctypes
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

COMMANDS = ("slurmctld", "slurmd", "sbatch", "scontrol", "squeue", "scancel")
_PR_SET_PDEATHSIG = 1
_PR_SET_CHILD_SUBREAPER = 36
_LIBC = ctypes.CDLL(None)


class NotAvailable(Exception):
    """The message says why."""


def _free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


def _children():
    """The children of this process, also those that ended ones left to it."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                parent = (entry / "stat").read_text().rpartition(")")[2].split()[1]
            except OSError:
                continue
            if int(parent) == os.getpid():
                found.append(int(entry.name))
    return found


class Slurm:
    """Lives as long as a with statement. Whatever happens in it, all processes end
    with it: the daemons are children of this process, which also becomes the
    parent of what they leave behind."""

    def __init__(self):
        missing = [name for name in COMMANDS if shutil.which(name, path=self._path()) is None]
        if missing:
            raise NotAvailable("not installed: " + ", ".join(missing))
        if os.geteuid() != 0:
            raise NotAvailable("Slurm's daemon starts jobs as root alone")
        # A short path, as a socket's must be.
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="tsar_slurm_", dir="/tmp"))
        self.environment = dict(os.environ, PATH=self._path(),
                                SLURM_CONF=str(self.folder / "slurm.conf"))
        self._daemons = {}

    @staticmethod
    def _path():
        return os.environ["PATH"] + ":/usr/sbin:/sbin"

    def __enter__(self):
        _LIBC.prctl(_PR_SET_CHILD_SUBREAPER, 1)
        signal.signal(signal.SIGTERM, lambda *_: sys.exit("terminated"))
        try:
            self._start()
        except BaseException:
            self._stop()
            raise
        return self

    def __exit__(self, *_):
        self._stop()

    def call(self, *command, **variables):
        return subprocess.run([str(part) for part in command], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True,
                              env=dict(self.environment, **variables))

    def run(self, *command, **variables):
        result = self.call(*command, **variables)
        if result.returncode != 0:
            raise AssertionError(f"failed: {command}\n{result.stdout}")
        return result.stdout

    def jobs(self):
        """What squeue lists, by its own names: "12_0" to state."""
        text = self.run("squeue", "--noheader", "--array", "--format=%i %T")
        return dict(line.split() for line in text.splitlines())

    def describe(self, job):
        """What scontrol knows about a job, as a dict."""
        text = self.run("scontrol", "--oneliner", "show", "job", job)
        return dict(part.split("=", 1) for part in text.split() if "=" in part)

    def logs(self):
        return "\n".join(f"== {path.name}\n{path.read_text(errors='replace')[-2000:]}"
                         for path in sorted(self.folder.glob("*.log")))

    def _configure(self):
        folder = self.folder
        controller_port, node_port = _free_ports(2)
        host = socket.gethostname().split(".")[0]
        for name in ("state", "spool"):
            (folder / name).mkdir()
        (folder / "cgroup.conf").write_text("CgroupMountpoint=/sys/fs/cgroup\n")
        # Credentials that expire soon, because a job that is queued again waits
        # until its last one has. More cores than there may be, so that the
        # shards run at the same time.
        (folder / "slurm.conf").write_text(
            f"""ClusterName=tsar
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser=root
AuthType=auth/none
CredType=cred/none
AuthInfo=cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_interval=1
SchedulerType=sched/builtin
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
KillWait=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""
        )

    def _launch(self, name, *options):
        log = open(self.folder / f"{name}.out.log", "w")
        self._daemons[name] = subprocess.Popen(
            [shutil.which(name, path=self._path()), *options], env=self.environment, stdout=log,
            stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
            preexec_fn=lambda: _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL))

    def _wait(self, condition, what):
        for _ in range(600):
            if condition():
                return
            for name, daemon in self._daemons.items():
                if daemon.poll() is not None:
                    raise NotAvailable(f"{name} cannot be started here:\n{self.logs()}")
            time.sleep(0.1)
        raise NotAvailable(f"{what} after a minute:\n{self.logs()}")

    def _start(self):
        self._configure()
        self._launch("slurmctld", "-D")
        self._launch("slurmd", "-D")
        self._wait(lambda: "idle" in self.call("sinfo", "--noheader", "--format=%T").stdout,
                   "the node is not ready")

    def _stop(self):
        if "slurmd" in self._daemons:
            self.call("scancel", "--user=root")
        for daemon in reversed(self._daemons.values()):
            daemon.kill()
            daemon.wait()
        # This process inherits what slurmd had started, then what that had
        # started.
        while children := _children():
            for child in children:
                os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)
        shutil.rmtree(self.folder)
