#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Packs the built tree as Debian packages and as an archive, without building
anything, looks at what is in them, and runs the program from both."""
import glob
import gzip
import io
import os
import shutil
import subprocess
import sys
import tarfile

from sample_testing import call, check, parse_arguments, run, skip

args = parse_arguments("cmake", "cpack", "build", "source", "version", "folder")

PROGRAM_FILES = [
    "bin/colmap_tsar",
    "share/man/man1/colmap_tsar.1.gz",
    "share/man/man1/colmap_tsar-tsar_refine.1.gz",
    "share/bash-completion/completions/colmap_tsar",
    "share/fish/vendor_completions.d/colmap_tsar.fish",
]
LIBRARY_FILES = [
    "include/colmap_tsar/run/refine_workspace.h",
    "include/colmap_tsar/cli/commands.h",
    "lib/libcolmap_tsar.a",
    "lib/cmake/ColmapTsar/ColmapTsarConfig.cmake",
]


def check_conda_recipe():
    """The recipe repeats the version, which it cannot read."""
    path = os.path.join(args.source, "packaging", "conda", "recipe.yaml")
    with open(path) as file:
        check(f'\n  version: "{args.version}"\n' in file.read(), "the recipe's version")


def built_files():
    """What building would renew: path -> time of its last change."""
    paths = [
        os.path.join(args.build, "bin", "colmap_tsar"),
        os.path.join(args.build, "libcolmap_tsar.a"),
        os.path.join(args.build, "manual", "pages.stamp"),
    ]
    return {path: os.stat(path).st_mtime_ns for path in paths}


def check_modes(members, where):
    """members: (path, mode, is a folder) of all that is packed."""
    for path, mode, is_folder in members:
        runs = is_folder or path.endswith("/bin/colmap_tsar")
        check(
            mode & 0o777 == (0o755 if runs else 0o644),
            f"{where}: mode of {path} is {mode & 0o777:o}",
        )


def check_tree(root, expected, where):
    """Files that must be there; none may reveal where it was built."""
    for path in expected:
        check(os.path.isfile(os.path.join(root, path)), f"{where} has {path}")
    count = 0
    for parent, _, names in os.walk(root):
        for name in names:
            path = os.path.join(parent, name)
            with open(path, "rb") as file:
                content = file.read()
            if name.endswith(".gz"):
                content = gzip.decompress(content)
            for folder in (args.source, args.build):
                if os.fsencode(folder + "/") in content:
                    sys.exit(f"FAILED: {where}: {path} holds the path {folder}")
            count += 1
    check(count >= len(expected), f"{where}: no path of this machine in {count} files")


def check_program(prefix, where):
    program = os.path.join(prefix, "bin", "colmap_tsar")
    headers = run("objdump", "-p", program)
    check("RPATH" not in headers and "RUNPATH" not in headers, f"{where}: no RPATH")
    check(
        run(program, "--version").startswith(f"colmap_tsar {args.version} ("),
        f"{where}: the program runs",
    )
    check(
        "--workspace_path" in run(program, "tsar_refine", "--help"),
        f"{where}: the program explains its commands",
    )
    result = call(program, "tsar_refine", "--workspace_path", os.path.join(prefix, "nowhere"))
    check(
        result.returncode == 1 and result.stderr.startswith("ERROR: "),
        f"{where}: the program tells errors",
    )


def check_library(prefix, where):
    """Another project finds the package where it lies now."""
    folder = os.path.join(args.folder, "configured")
    shutil.rmtree(folder, ignore_errors=True)
    run(args.cmake, "-S", os.path.join(args.source, "examples", "refine_workspace"),
        "-B", folder, "-DCMAKE_PREFIX_PATH=" + prefix)
    with open(os.path.join(folder, "CMakeCache.txt")) as file:
        check(
            f"ColmapTsar_DIR:PATH={prefix}/lib/cmake/ColmapTsar\n" in file.read(),
            f"{where}: CMake finds the library",
        )


def test_debian_packages():
    root = os.path.join(args.folder, "root")
    fields = {}
    packages = []
    for package in ("colmap-tsar", "libcolmap-tsar-dev"):
        found = glob.glob(os.path.join(args.folder, f"{package}_{args.version}-1_*.deb"))
        check(len(found) == 1, f"there is one package {package}")
        packages += found
        fields[package] = dict(
            line.split(": ", 1)
            for line in run("dpkg-deb", "--field", found[0]).splitlines()
            if not line.startswith(" ") and ": " in line
        )
        listing = subprocess.run(["dpkg-deb", "--fsys-tarfile", found[0]], check=True,
                                 stdout=subprocess.PIPE).stdout
        with tarfile.open(fileobj=io.BytesIO(listing)) as archive:
            members = archive.getmembers()
        check_modes([(m.name, m.mode, m.isdir()) for m in members], package)
        check(all(m.uid == 0 and m.gid == 0 for m in members), f"{package}: root owns all")
        run("dpkg-deb", "--extract", found[0], root)

    program, library = fields["colmap-tsar"], fields["libcolmap-tsar-dev"]
    depends = program["Depends"].replace(", ", ",").split(",")
    for needed in ("libc6 (>=", "libstdc++6", "libopencv-core", "libgoogle-glog"):
        check(any(d.startswith(needed) for d in depends), f"it depends on {needed}")
    for needed in ("libopencv-dev", "libceres-dev", "libxxhash-dev"):
        check(needed in library["Depends"], f"the library depends on {needed}")
    check((program["Section"], library["Section"]) == ("science", "libdevel"), "sections")
    check(
        program["Description"] != library["Description"]
        and all("(c)" not in f["Maintainer"] and "@example.org>" in f["Maintainer"]
                for f in fields.values()),
        "descriptions and a maintainer who is nobody",
    )

    documents = [
        f"share/doc/{package}/{name}"
        for package in fields
        for name in ("copyright", "changelog.gz", "changelog.Debian.gz")
    ]
    usr = os.path.join(root, "usr")
    check_tree(
        usr,
        PROGRAM_FILES + LIBRARY_FILES + documents
        + ["share/zsh/vendor-completions/_colmap_tsar"],
        "Debian packages",
    )
    with open(os.path.join(usr, "share/doc/colmap-tsar/copyright")) as file:
        text = file.read()
    check(
        "License: BSD-3-Clause" in text and "Copyright: 2026, the TSAR for COLMAP authors\n" in text
        and "THIS SOFTWARE IS PROVIDED" in text,
        "the copyright file has owner and license",
    )
    check_program(usr, "Debian packages")
    check_library(usr, "Debian packages")
    if os.geteuid() == 0:
        test_dpkg(packages)
    if shutil.which("lintian"):
        # The one tag is for packages of Debian's own archive.
        result = call("lintian", "--allow-root", "--fail-on", "error,warning",
                      "--suppress-tags", "initial-upload-closes-no-bugs", *packages)
        check(result.returncode == 0, "lintian has no complaint " + result.stdout)
    else:
        print("skipped: lintian is not installed")


def test_dpkg(packages):
    """dpkg itself installs and removes them, in a system with nothing else."""
    root = os.path.join(args.folder, "system")
    os.makedirs(os.path.join(root, "var", "lib", "dpkg", "updates"))
    os.makedirs(os.path.join(root, "var", "lib", "dpkg", "info"))
    open(os.path.join(root, "var", "lib", "dpkg", "status"), "w").close()
    dpkg = ["dpkg", f"--root={root}", "--force-depends", "--log=/dev/null"]
    run(*dpkg, "--install", *packages)
    check_program(os.path.join(root, "usr"), "installed by dpkg")
    run(*dpkg, "--purge", "colmap-tsar", "libcolmap-tsar-dev")
    left = [n for _, _, names in os.walk(os.path.join(root, "usr")) for n in names]
    check(left == [], "purging leaves no file")


def test_archive():
    found = glob.glob(os.path.join(args.folder, f"colmap-tsar-{args.version}-*.tar.gz"))
    check(len(found) == 1, "there is one archive")
    top = os.path.basename(found[0])[: -len(".tar.gz")]
    with tarfile.open(found[0]) as archive:
        members = archive.getmembers()
        check(
            all(m.name == top or m.name.startswith(top + "/") for m in members),
            "the archive has one folder",
        )
        check_modes([(m.name, m.mode, m.isdir()) for m in members], "archive")
        archive.extractall(args.folder)
    prefix = os.path.join(args.folder, "any place")
    os.rename(os.path.join(args.folder, top), prefix)
    expected = PROGRAM_FILES + LIBRARY_FILES + [
        "README", "share/doc/colmap-tsar/LICENSE", "share/zsh/site-functions/_colmap_tsar"]
    check_tree(prefix, expected, "archive")
    with open(os.path.join(prefix, "README")) as file:
        text = file.read()
    for needed in ("libopencv_core.so", "libglog.so", "libstdc++.so.6", "apt-get install"):
        check(needed in text, f"its README names {needed}")
    check(" libopencv-core" in text and " libgoogle-glog" in text, "its README names packages")
    check_program(prefix, "archive")
    check_library(prefix, "archive")


for tool in ("dpkg-deb", "dpkg-shlibdeps", "objdump", "file"):
    if not shutil.which(tool):
        skip(f"{tool} is not installed")
shutil.rmtree(args.folder, ignore_errors=True)
os.makedirs(args.folder)
before = built_files()
os.umask(0o077)
run(args.cpack, "--config", os.path.join(args.build, "CPackConfig.cmake"), "-B", args.folder)
check(built_files() == before, "packing builds nothing")
shutil.rmtree(os.path.join(args.folder, "_CPack_Packages"))
test_debian_packages()
test_archive()
check_conda_recipe()
shutil.rmtree(args.folder)
