#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The folders of the library are layers, in the order of colmap_tsar/
CMakeLists.txt, with the tools, which may be left out, below the commands alone:
a file includes what lies in its own folder or in one below, and no file
includes itself by way of others."""
import os
import re

from library_sources import library_sources
from sample_testing import check, parse_arguments

args = parse_arguments("repository")

INCLUDE = re.compile(r'^#include "colmap_tsar/([^"]+)"', re.MULTILINE)


def upward_includes(includes, layers):
    """The pairs of a file and what it includes from a higher folder."""
    def layer(name):
        return layers.index(os.path.dirname(name))
    return [(name, other) for name, others in sorted(includes.items())
            for other in others if layer(other) > layer(name)]


def circle(includes):
    """Files each of which includes the next, the last one the first; or []."""
    done = set()

    def walk(name, way):
        if name in way:
            return way[way.index(name):]
        if name in done:
            return []
        for other in includes.get(name, ()):
            found = walk(other, way + [name])
            if found:
                return found
        done.add(name)
        return []

    for name in sorted(includes):
        found = walk(name, [])
        if found:
            return found
    return []


# What the two report for a library that breaks the rules.
check(upward_includes({"a/x.h": ["b/y.h", "a/z.h"], "b/y.h": ["a/z.h"]}, ["a", "b"]) ==
      [("a/x.h", "b/y.h")], "an include that goes up is found")
check(circle({"a/x.h": ["a/y.h"], "a/y.h": ["a/z.h"], "a/z.h": ["a/y.h"]}) ==
      ["a/y.h", "a/z.h"], "a circle is found")

with open(os.path.join(args.repository, "colmap_tsar", "CMakeLists.txt"),
          encoding="utf-8") as file:
    below, above = re.split(r"foreach\(tool.*?endforeach\(\)\n", file.read(), flags=re.DOTALL)
with open(os.path.join(args.repository, "cmake", "TsarTools.cmake"),
          encoding="utf-8") as file:
    tools = re.search(r"set\(TSAR_TOOLS ([\w ]+)\)", file.read()).group(1).split()
FOLDER = re.compile(r"add_subdirectory\(([\w/]+)\)")
layers = (FOLDER.findall(below) + [f"tools/{tool}" for tool in tools] +
          FOLDER.findall(above))
includes = {name: INCLUDE.findall(source)
            for name, source in library_sources(args.repository)}
check(len(includes) > 200, f"{len(includes)} sources were read")
unknown = sorted({name for others in includes.values() for name in others} - set(includes))
check(not unknown, f"every included file exists: {unknown}")
up = upward_includes(includes, layers)
check(not up, "no include goes up" +
      "".join(f"\n  {name} includes {other}" for name, other in up))
found = circle(includes)
check(not found, "no include goes in a circle" +
      "".join(f"\n  {name}" for name in found))
