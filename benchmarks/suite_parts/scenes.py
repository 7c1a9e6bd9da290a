# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The list of scenes, and what of each is measured."""

import json
from dataclasses import dataclass
from pathlib import Path

from programs import CommandFailed
from suite_parts.maps import Maps

ROLES = ("tuning", "testing")
ORIGINS = ("own", "tsar_stereo")
KEYS = {"name", "path", "role", "maps", "sizes", "noise"}


@dataclass(frozen=True)
class Configuration:
    """A scene at one size and one level of noise, with maps of one origin."""
    scene: str
    path: Path
    role: str
    maps: str
    size: int  # The long side of the maps.
    noise: float  # Gray levels at mid-gray.

    def label(self):
        return (f"{self.scene}, {self.size} px, noise {self.noise:g}, "
                f"{self.maps}")

    def stem(self):
        return f"{self.scene}-{self.size}-{self.noise:g}-{self.maps}"


def as_list(value):
    return value if isinstance(value, list) else [value]


def fail(path, name, text):
    raise CommandFailed(f"{path}: scene '{name}': {text}")


def read_entry(path, entry, root):
    """The configurations of one entry of the list."""
    name = entry.get("name", "?")
    unknown = set(entry) - KEYS
    if unknown:
        fail(path, name, f"'{min(unknown)}' is unknown; there are "
             + ", ".join(sorted(KEYS)))
    for key in ("name", "path", "role"):
        if not isinstance(entry.get(key), str):
            fail(path, name, f"'{key}' is missing or no text")
    if entry["role"] not in ROLES:
        fail(path, name, f"the role is not one of {', '.join(ROLES)}")
    folder = (root / entry["path"]).resolve()
    if not (folder / "sparse").is_dir():
        fail(path, name, f"{folder} is no dense workspace; see --root")
    found = []
    for origin in as_list(entry.get("maps", "own")):
        common = (name, folder, entry["role"], origin)
        if origin == "own":
            found.append(Configuration(*common, Maps(folder).long_side(), 0))
        elif origin == "tsar_stereo":
            sizes, levels = (as_list(entry.get(key, [])) for key
                             in ("sizes", "noise"))
            for value in sizes + levels:
                if not isinstance(value, (int, float)) or value < 0:
                    fail(path, name, f"{value!r} is no size or noise")
            if not sizes:
                fail(path, name, "maps of tsar_stereo need 'sizes'")
            found += [Configuration(*common, int(size), level)
                      for size in sizes for level in levels or [0]]
        else:
            fail(path, name, f"the maps '{origin}' are not one of "
                 + ", ".join(ORIGINS))
    return found


def read_scenes(path, root):
    """All configurations of a list; benchmarks/README.md describes the keys.

    root: the folder below which the paths of the scenes are.
    """
    try:
        entries = json.loads(path.read_text())
    except OSError as error:
        raise CommandFailed(f"{path}: {error.strerror}") from error
    except ValueError as error:
        raise CommandFailed(f"{path}: not JSON ({error})") from error
    if not isinstance(entries, list) or not all(
            isinstance(entry, dict) for entry in entries):
        raise CommandFailed(f"{path}: not a list of scenes")
    found = [configuration for entry in entries
             for configuration in read_entry(path, entry, root)]
    stems = [configuration.stem() for configuration in found]
    for stem in stems:
        if stems.count(stem) > 1:
            raise CommandFailed(f"{path}: {stem} is there twice")
    return found


def as_they_are(paths):
    """Workspaces with their own maps, named on the command line."""
    found = []
    for path in paths:
        folder = path.resolve()
        found.append(Configuration(folder.name, folder, "testing", "own",
                                   Maps(folder).long_side(), 0))
    return found
