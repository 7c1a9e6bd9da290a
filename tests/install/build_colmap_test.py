#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Checks what scripts/build_colmap.sh decides: which patch and packages belong
to a version, and what CMake gets. Stand-ins take the place of CMake and of the
package manager, and a folder with one file that of COLMAP."""
import json
import os
import shutil
import sys

from sample_testing import call, check, parse_arguments

args = parse_arguments("repository", "folder")

SOURCE_FILE = os.path.join("src", "colmap", "exe", "colmap.cc")
STAND_INS = {
    # The last call installs COLMAP; the program lists a command.
    "cmake": f"""#!{sys.executable}
import json, os, sys
with open(os.environ["LOG"], "a") as log:
    log.write(json.dumps([os.environ.get("CMAKE_PREFIX_PATH"), sys.argv[1:]]) + "\\n")
if "--install" in sys.argv:
    os.makedirs(os.environ["PREFIX"] + "/bin", exist_ok=True)
    with open(os.environ["PREFIX"] + "/bin/colmap", "w") as program:
        program.write("#!/bin/sh\\necho '  tsar_refine'\\n")
    os.chmod(program.name, 0o755)
""",
    "dpkg-query": """#!/bin/sh
for package; do :; done
echo "$package" >>"$LOG.packages"
printf installed
""",
    "apt-get": "#!/bin/sh\nexit 1\n",
}
PATCH = """What it does.

--- a/{file}
+++ b/{file}
@@ -1,2 +1,3 @@
 first
+{version}
 last
"""


def path(*names):
    return os.path.join(args.folder, *names)


def write(file, text, mode=0o644):
    os.makedirs(os.path.dirname(file), exist_ok=True)
    with open(file, "w", encoding="utf-8") as out:
        out.write(text)
    os.chmod(file, mode)


def read(file):
    with open(file, encoding="utf-8") as text:
        return text.read()


def build(*arguments):
    """The finished script, CMake's calls and the packages looked for."""
    for name in ("log", "log.packages"):
        if os.path.exists(path(name)):
            os.remove(path(name))
    environment = dict(os.environ, LOG=path("log"), PREFIX=path("in stalled"),
                       PATH=os.pathsep.join((path("bin"), "/usr/bin", "/bin")))
    environment.pop("CMAKE_PREFIX_PATH", None)
    result = call(path("repository", "scripts", "build_colmap.sh"),
                  "--prefix", path("in stalled"), *arguments, env=environment)
    calls = []
    if os.path.exists(path("log")):
        calls = [json.loads(line) for line in read(path("log")).splitlines()]
    packages = set()
    if os.path.exists(path("log.packages")):
        packages = set(read(path("log.packages")).split())
    return result, calls, packages


def build_version(version, patch, *cmake_arguments):
    """Builds it with this patch; CMake's arguments for COLMAP, and packages."""
    result, calls, packages = build("--source", path("colmap"), version,
                                    *(("--", *cmake_arguments) if cmake_arguments else ()))
    check(result.returncode == 0 and "tsar_refine" in result.stdout, f"{version} is built")
    patched = path("repository", "build-colmap", version, "source", SOURCE_FILE)
    check(read(patched) == f"first\n{patch}\nlast\n", f"{version} has the patch {patch}")
    (colmap,) = [call for call in calls if "-S" in call[1]]
    check(colmap[0] == path("in stalled"), "COLMAP's CMake looks in the prefix")
    return colmap[1], packages, result.stderr


def fails(text, code, *arguments):
    result, calls, _ = build(*arguments)
    check(result.returncode == code and text in result.stderr and not calls,
          f"{' '.join(map(os.path.basename, arguments))} fails with '{text}'")


shutil.rmtree(args.folder, ignore_errors=True)
shutil.copytree(os.path.join(args.repository, "scripts"), path("repository", "scripts"))
for name, text in STAND_INS.items():
    write(path("bin", name), text, 0o755)
for version in ("3.9", "3.10", "3.12", "4.1"):
    write(path("repository", "patches", f"colmap-{version}.patch"),
          PATCH.format(file=SOURCE_FILE, version=version))
write(path("colmap", SOURCE_FILE), "first\nlast\n")
write(path("colmap", "CMakeLists.txt"), "")
write(path("other", "CMakeLists.txt"), "")

_, packages, _ = build_version("3.10", "3.10")
check({"libfreeimage-dev", "libboost-test-dev", "libopencv-dev"} <= packages
      and not {"libopenimageio-dev", "libopenblas-openmp-dev"} & packages, "packages of 3.10")
_, packages, _ = build_version("3.12.6", "3.12")
check({"libfreeimage-dev", "libopenblas-openmp-dev"} <= packages
      and "libopenimageio-dev" not in packages, "packages of 3.12")
given = ["-DFETCH_FAISS=OFF", "-DCMAKE_PREFIX_PATH=/a b;/c"]
arguments, packages, _ = build_version("4.1.1", "4.1", *given)
check(arguments[-2:] == given, "CMake gets the arguments after -- last, as they are")
check({"libopenimageio-dev", "libsuitesparse-dev"} <= packages
      and not {"libfreeimage-dev", "libopenblas-openmp-dev"} & packages,
      "packages of 4.1 with a faiss of the user's")
_, _, errors = build_version("4.2.0.dev0", "4.1")
check("trying colmap-4.1.patch" in errors, "a later version is tried with the last patch")
build_version("4.1.1", "4.1")
check(read(path("colmap", SOURCE_FILE)) == "first\nlast\n", "the given source is not changed")

fails("no patch for COLMAP 3.7", 1, "--source", path("colmap"), "3.7")
fails("no patch for COLMAP 3.11", 1, "--source", path("colmap"), "3.11")
fails("does not fit", 1, "--source", path("other"), "4.1.1")
fails("needs the VERSION", 1, "--source", path("colmap"))
fails("holds no CMakeLists.txt", 1, "--source", path("nowhere"), "4.1.1")
fails("--source DIR", 2, "--source")
fails("--source DIR", 2, "--source", path("colmap"), "4.1.1", "4.0.4")
