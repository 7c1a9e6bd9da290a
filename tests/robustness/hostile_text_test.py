#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Puts what terminals obey (escape sequences, control characters of 8 bits,
ends of lines) into every name and text that a command reads, and checks that
none of it is printed."""
import json
import os
import shutil
import struct
import subprocess
import unicodedata
import zlib

import synthetic_workspace
from robustness import KEY, Setting, check, copy, edit, read, read_tree

ESCAPE, CSI, RAW_CSI = b"\x1b[2J", b"\xc2\x9b2J", b"\x9b2J"
TURN, ACCENTS = "\u202egnp".encode(), "caf\u00e9 \u96ea".encode()
EVERYTHING = b"a" + ESCAPE + CSI + RAW_CSI + TURN + b"\x7f\r\t\x07" + "\u2028\u2066".encode() + b"z"
IN_NAMES = EVERYTHING.replace(b"\r", b"").replace(b"\t", b"")

setting = Setting()
work, external = setting.work, setting.path("arrays")
INI = os.path.join(work, "project.ini")
CLOUD, SCANS = os.path.join(work, "cloud.ply"), os.path.join(work, "scans.mlp")
num_cases = 0


def printed(words, code=(0, 1)):
    """What a command prints; no terminal obeys it. code: allowed exit codes."""
    global num_cases
    num_cases += 1
    result = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    text = result.stdout.decode(errors="replace")
    # Control characters, except line ends.
    obeyed = {letter for letter in text
              if letter != "\n" and unicodedata.category(letter) == "Cc"}
    check(not obeyed, f"{words}: {result.stdout!r} holds {obeyed!r}")
    check(result.returncode in code, f"{words} ended with {result.returncode}: {text}")
    check(text.count("ERROR: ") == result.returncode, f"{words}: {text}")
    return text


def call(case, *options, code=(0, 1)):
    """Like printed(), for a command in `work` as it is."""
    return printed(setting.program.arguments(*setting.commands[case][0], *options), code)


def write(path, content):
    synthetic_workspace.write(os.path.join(os.fsencode(work), os.fsencode(path)), content)


def rename_image(name):
    """Gives the first image another name, everywhere but in records."""
    for path in ("sparse/images.txt", "stereo/patch-match.cfg", "stereo/fusion.cfg"):
        edit(os.path.join(work, path), b"v0.png", name)
    for parent, _, names in list(os.walk(os.fsencode(work))):
        for old in names:
            if old.startswith(b"v0.png"):
                os.rename(os.path.join(parent, old),
                          os.path.join(parent, old.replace(b"v0.png", name)))


def write_binary_model(names):
    """The sparse model as COLMAP's binary files, in which names end with a zero and
    may hold ends of lines; without points."""
    width, height, focal = (synthetic_workspace.WIDTH, synthetic_workspace.HEIGHT,
                            synthetic_workspace.FOCAL)
    shutil.rmtree(os.path.join(work, "sparse"))
    write("sparse/cameras.bin", struct.pack(
        "<QIiQQ4d", 1, 1, 1, width, height, focal, focal, width / 2, height / 2))
    write("sparse/images.bin", struct.pack("<Q", len(names)) + b"".join(
        struct.pack("<I7dI", view + 1, 1, 0, 0, 0, -synthetic_workspace.BASELINE * view, 0, 0, 1)
        + name + b"\0" + struct.pack("<Q", 0) for view, name in enumerate(names)))
    write("sparse/points3D.bin", struct.pack("<Q", 0))


def with_profile(picture):
    """libpng warns of a profile that is broken, and names it."""
    name = b"a" + ESCAPE + RAW_CSI + CSI + b"\r"
    profile = struct.pack(">I", 300) + bytes(i * i % 251 for i in range(296))
    body = name + b"\0\0" + zlib.compress(profile)
    return picture[:33] + synthetic_workspace.png_chunk(b"iCCP", body) + picture[33:]


def check_names():
    # Names that no program writes are refused, by every command and without effect.
    for name in (ESCAPE, CSI, b"\x7f", IN_NAMES):
        for case in ("refine", "stereo", "report"):
            setting.prepare(case)
            edit(os.path.join(work, "sparse/images.txt"), b"v0.png", name + b".png")
            before = read_tree(work)
            check("no usable name" in call(case, code=[1]), f"{case} of {name}")
            check(read_tree(work) == before, f"{case} of {name} changes files")
    setting.prepare("refine")
    write_binary_model([b"v0.png\nERROR: all is well", b"left/v1.png"])
    check("no usable name" in call("refine", code=[1]), "a name of two lines")

    # Other names work, whatever the encoding.
    for name in (ACCENTS, TURN, b"caf\xe9", RAW_CSI):
        shown = name.decode(errors="replace").replace("\ufffd", "?")
        for case in ("refine", "restore", "stereo"):
            setting.prepare(case)
            rename_image(name + b".png")
            call(case, code=[0])
        for path in ("images/", "stereo/depth_maps/"):
            setting.prepare("refine")
            rename_image(name + b".png")
            for file in (b".png", b".png.geometric.bin", b".png.photometric.bin"):
                broken = os.fsencode(os.path.join(work, path)) + name + file
                if os.path.exists(broken):
                    write(broken, b"broken")
            check(shown in call("refine", code=[1]), f"broken {path} of {name}")
        # Without its maps; the other one has no source then.
        setting.prepare("refine")
        rename_image(name + b".png")
        for kind in ("depth_maps", "normal_maps"):
            os.remove(os.fsencode(os.path.join(work, "stereo", kind, "")) + name + b".png.geometric.bin")
        check(f"kept {shown}.png: it has no geometric maps" in call("refine", code=[1]), name)
        setting.prepare("stereo")
        rename_image(name + b".png")
        write("sparse/points3D.txt", b"")
        call("stereo")


def check_files():
    """Texts in place of others: file, what is replaced in it, and by what."""
    for path, old, new, options in (
            *(("stereo/patch-match.cfg", old, text, ())
              for text in (EVERYTHING, b"v0.png, " + EVERYTHING, b"\xc3")
              for old in (b"v0.png", b"__all__")),
            ("sparse/cameras.txt", b"PINHOLE", EVERYTHING, ()),
            *(("project.ini", b"key=1", text, ("--project_path", INI))
              for text in (EVERYTHING + b"=1", b"TsarRefine." + EVERYTHING + b"=1",
                           b"workspace_path\x1b=1", b"[" + EVERYTHING + b"]=1",
                           b"input_type=" + EVERYTHING)),
            *(("project.ini", b"key", b"key", words) for words in (
                (b"--" + EVERYTHING, 1), (EVERYTHING,), ("--input_type", EVERYTHING),
                ("--TsarRefine.num_threads", EVERYTHING), ("--project_path", EVERYTHING),
                ("--output_path", os.fsencode(work) + b"/images/" + EVERYTHING)))):
        setting.prepare("refine")
        write("project.ini", b"key=1\n")
        edit(os.path.join(work, path), old, new)
        call("refine", *options, code=[1] if old == new else (0, 1))

    # What other runs left.
    setting.prepare("refine")
    for kind in ("depth_maps", "normal_maps"):
        os.remove(os.path.join(work, "stereo", kind, KEY + ".bin"))
    call("refine")
    record = os.path.join("stereo/tsar/records", KEY + ".json")
    content = json.loads(read(os.path.join(work, record)))
    check(content["note"], "a kept image has a note")
    for field in ("note", "image", "inputs", "type", "status", "options_hash"):
        changed = {**content, field: EVERYTHING.decode(errors="replace")}
        write(record, json.dumps(changed, ensure_ascii=field == "note").encode())
        call("refine", "--TsarRefine.pass", "merge")
        call("report")

    # Whole workspaces in folders of such names.
    place = os.path.join(setting.folder, os.fsdecode(EVERYTHING))
    setting.use(place)
    for case in setting.commands:
        setting.prepare(case)
        call(case, code=[0])
    shutil.rmtree(place)
    call("refine", code=[1])
    setting.use(work)
    setting.prepare("refine")
    call("refine", "--output_path", place, code=[0])


def check_imports():
    words = ["tsar_import", setting.mapped, "--input_path", external, "--output_path",
             setting.imported, "--overwrite", 1, "--format"]

    def import_as(*options, code=(0, 1)):
        return printed(setting.program.arguments(*words, *options), code)

    listed = setting.path("list")
    for name in (EVERYTHING, CSI):
        copy(setting.external, external)
        for ending in (b".npy", b".png"):
            write(os.fsencode(external) + b"/" + name + ending, b"broken")
        for form in ("depth", "acm", "apd", "openmvs"):
            import_as(form)
        write(listed, name + b"\n" + name + b"\n")
        import_as("depth", "--image_list", listed)
        write(os.path.join(external, "v0.npy"),
              b"\x93NUMPY\x01\x00" + struct.pack("<H", len(name)) + name + b"xxxx")
        import_as("depth")
        os.remove(os.path.join(external, "v0.npy"))
        write(os.path.join(external, "v0.pfm"), b"Pf\n" + name + b"\n-1\n")
        import_as("depth")
    shutil.rmtree(external)
    rows = [[5000] * synthetic_workspace.WIDTH] * synthetic_workspace.HEIGHT
    write(os.path.join(external, "v0.png"), with_profile(synthetic_workspace.png(rows, 16)))
    check("1 imported" in import_as("depth", code=[0]), "a profile in depth")


def check_pictures_and_clouds():
    for case, path in (("refine", "images/v0.png"), ("stereo", "images/v0.png"),
                       ("report", "images/v0.png"), ("report", f"stereo/provenance_maps/{KEY}.png")):
        setting.prepare(case)
        write(path, with_profile(read(os.path.join(work, path))))
        call(case, code=[0])
    depth = setting.program.arguments("tsar_evaluate", work)
    write("images/v0.png", with_profile(read(os.path.join(setting.mapped, "images/v0.png"))))
    write("ground_truth/depth/v0.png.bin",
          synthetic_workspace.map_file([synthetic_workspace.depth_map(0, "geometric")]))
    printed(depth, [0])
    write(b"ground_truth/depth/" + EVERYTHING + b".bin", b"broken")
    write(b"stereo/depth_maps/" + EVERYTHING + b".geometric.bin", b"broken")
    printed(depth, [1])

    evaluate = [setting.program.path, "tsar_evaluate", "cloud", "--input_path", CLOUD,
                "--ground_truth_path", SCANS]
    ply = (b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
           b"property float z\nend_header\n1 2 3\n")
    mlp = (b'<MeshLabProject><MeshGroup><MLMesh filename="scan.ply"><MLMatrix44>'
           b"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</MLMatrix44></MLMesh></MeshGroup></MeshLabProject>")
    write(SCANS, mlp)
    write("scan.ply", ply)
    for word in ply.split():
        write(CLOUD, ply.replace(word, EVERYTHING, 1))
        printed(evaluate)
    write(CLOUD, ply)
    for old in (b"scan.ply", b"MeshGroup>", b"MLMatrix44>1", b"MeshLabProject"):
        write(SCANS, mlp.replace(old, EVERYTHING + old))
        printed(evaluate)


check_names()
check_files()
check_imports()
check_pictures_and_clouds()
print(f"{num_cases} cases")
