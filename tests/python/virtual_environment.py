# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Virtual environments for tests that need packages of the package index."""
import contextlib
import fcntl
import importlib
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from sample_testing import SKIPPED
from support import WORK_FOLDER

IS_INSIDE = sys.argv[1:] == ["--inside"]  # Whether this runs in an environment.

# What pip says where there is no network or no index, and what it says there if it
# was told to do without. Anything else that goes wrong is a failure, not a reason
# to skip a test.
UNREACHABLE = re.compile(
    r"ConnectionError|Max retries exceeded|Connection broken|Read timed out"
    r"|ReadTimeoutError|Temporary failure in name resolution|ProxyError|SSLError"
    r"|HTTP error 5\d\d|HTTPError: 5\d\d"
)
NOTHING_FOUND = re.compile(r"No matching distribution found")


class VirtualEnvironment:
    """Made if there is none yet; kept, so that packages are installed once."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.python = self.folder / "bin" / "python"
        # The Python may have been replaced since.
        check = ["sh", "-c", f"'{self.python}' -m pip --version"]
        if subprocess.run(check, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode:
            subprocess.run([sys.executable, "-m", "venv", "--clear", self.folder], check=True)

    def pip(self, *arguments):
        """Exit code and output."""
        command = [self.python, "-m", "pip", "--disable-pip-version-check", *arguments]
        result = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True)
        return result.returncode, result.stdout

    @classmethod
    def with_wheel(cls, folder, wheel):
        """A new one in which the wheel alone is installed."""
        environment = cls(folder)
        status, output = environment.pip("install", "--no-index", wheel)
        if status != 0:
            sys.exit(f"FAILED: pip install\n{output}")
        return environment

    def reaches_index(self):
        """Whether pip gets from it what every index has."""
        with tempfile.TemporaryDirectory() as folder:
            return self.pip("download", "--no-deps", "--dest", folder, "pip")[0] == 0

    def install(self, *packages):
        """The newest versions, or those that are there where the index cannot be
        reached. False where that leaves a package missing."""
        status, output = self.pip(
            "install", "--upgrade", "--prefer-binary", "--retries", 2, *packages
        )
        if status == 0:
            return True
        print(output)
        unreachable = UNREACHABLE.search(output) or (
            NOTHING_FOUND.search(output) and not self.reaches_index()
        )
        if not unreachable:
            raise AssertionError("pip install failed, see above")
        return self.pip("install", "--no-index", *packages)[0] == 0


@contextlib.contextmanager
def locked(folder):
    """Tests that share an environment run side by side: one alone makes it."""
    with open(f"{folder}.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def optional(module):
    """The module, or None."""
    try:
        return importlib.import_module(module)
    except ImportError:
        return None


def run_in_environment(file, *packages):
    """Runs this test again, with --inside, in an environment that is kept in the build
    folder, and ends as it does; as a skipped test without the packages."""
    folder = WORK_FOLDER / f"{packages[0]}_environment"
    with locked(folder):
        environment = VirtualEnvironment(folder)
        is_complete = environment.install(*packages)
    if not is_complete:
        print(f"skipped: {packages[0]} cannot be had from the package index")
        sys.exit(SKIPPED)
    sys.exit(subprocess.run([environment.python, file, "--inside"]).returncode)


def run_tests(file, packages, *modules):
    """The tests of this file, in such an environment where a module is missing."""
    if None in modules and not IS_INSIDE:
        run_in_environment(file, *packages)
    unittest.main(argv=sys.argv[:1])
