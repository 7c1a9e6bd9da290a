# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Virtual environments for tests that need packages of the package index."""
import pathlib
import re
import subprocess
import sys

# What pip says where there is no network, no index, or no package for this Python.
# Anything else that goes wrong is a failure, not a reason to skip a test.
UNAVAILABLE = re.compile(
    r"No matching distribution found|Could not find a version"
    r"|ConnectionError|Max retries exceeded|Connection broken|Read timed out"
    r"|ReadTimeoutError|Temporary failure in name resolution|ProxyError|SSLError"
    r"|HTTP error 5\d\d|HTTPError: 5\d\d"
)


class VirtualEnvironment:
    """Made where there is none yet; kept, so that packages are installed once."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.python = self.folder / "bin" / "python"
        # The Python may have been replaced since.
        if subprocess.run(
            ["sh", "-c", f"'{self.python}' -m pip --version"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        ).returncode != 0:
            subprocess.run(
                [sys.executable, "-m", "venv", "--clear", self.folder], check=True
            )

    def pip(self, *arguments):
        """Exit code and output."""
        command = [self.python, "-m", "pip", "--disable-pip-version-check", *arguments]
        result = subprocess.run(
            [str(part) for part in command],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        return result.returncode, result.stdout

    def install(self, *packages):
        """The newest versions, or those that are there where the index cannot be
        reached. False where that leaves a package missing."""
        status, output = self.pip(
            "install", "--upgrade", "--prefer-binary", "--retries", 2, *packages
        )
        if status == 0:
            return True
        print(output)
        if not UNAVAILABLE.search(output):
            raise AssertionError("pip install failed, see above")
        return self.pip("install", "--no-index", *packages)[0] == 0
