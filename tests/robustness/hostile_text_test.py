#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Puts what terminals obey (escape sequences, control characters of 8 bits, ends of
lines) into every name and text that a command reads, and sees that none of it is
printed."""
import json
import os
import shutil
import struct
import subprocess
import unicodedata
import zlib

import synthetic_workspace
from robustness import Program, check, copy, make_folder, parse_arguments, read_tree
from start_workspaces import STEREO, StartWorkspaces

ESCAPE, CSI, RAW_CSI = b"\x1b[2J", b"\xc2\x9b2J", b"\x9b2J"
TURN, LINE, ACCENTS = "\u202egnp".encode(), b"\nERROR: all is well", "caf\u00e9 \u96ea".encode()
EVERYTHING = b"a" + ESCAPE + CSI + RAW_CSI + TURN + b"\x7f\r\t\x07" + "\u2028\u2066".encode() + b"z"

args = parse_arguments()
program = Program(args.program)
folder = make_folder(args.folder)
work, external = (os.path.join(folder.name, name) for name in ("work", "arrays"))
start = StartWorkspaces(folder.name)
start.make(program)
REFINE = ["tsar_refine", work]
RESTORE = ["tsar_refine", work, "--restore", 1]
TO_STEREO = ["tsar_stereo", work, *STEREO, "--overwrite", 1]
REPORT = ["tsar_report", work, "--overwrite", 1]
EVALUATE = ["tsar_evaluate", "depth", "--workspace_path", work]
KEY = "v0.png.geometric"
num_cases = 0


def printed(what, words):
    """(exit code, all that a command prints), which no terminal obeys."""
    global num_cases
    num_cases += 1
    words = [os.fsdecode(word) if isinstance(word, bytes) else str(word) for word in words]
    if words[0] != "tsar_evaluate":
        words = program.arguments(*words)[1:]
    result = subprocess.run([args.program, *words], stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, check=False)
    output = result.stdout
    text = output.decode(errors="replace")
    # Control characters, but for the ends of lines.
    obeyed = {letter for letter in text
              if letter != "\n" and unicodedata.category(letter) == "Cc"}
    check(not obeyed, f"{what}: {output!r} holds {obeyed!r}")
    check(result.returncode in (0, 1), f"{what} ended with {result.returncode}: {text}")
    check(text.count("ERROR: ") == result.returncode, f"{what}: {text}")
    return result.returncode, text


def write(path, content):
    synthetic_workspace.write(os.fsencode(path), content)


def edit(path, old, new):
    with open(os.path.join(work, path), "rb") as file:
        content = file.read()
    check(old in content, f"{path} holds {old!r}")
    write(os.path.join(work, path), content.replace(old, new))


def fresh(source):
    copy(source, work)
    return work


def rename_image(name):
    """Gives the first image another name, everywhere."""
    for path in ("sparse/images.txt", "stereo/patch-match.cfg", "stereo/fusion.cfg"):
        edit(path, b"v0.png", name)
    for parent, _, names in list(os.walk(os.fsencode(work))):
        for old in names:
            if old.startswith(b"v0.png"):
                os.rename(os.path.join(parent, old),
                          os.path.join(parent, old.replace(b"v0.png", name)))
    for parent, _, names in os.walk(os.path.join(os.fsencode(work), b"stereo/tsar/records")):
        for record in names:
            path = os.path.join(parent, record)
            with open(path, encoding="utf-8") as file:
                content = json.load(file)
            if content["image"] == "v0.png":
                content["image"] = name.decode(errors="replace")
                write(path, json.dumps(content).encode())



def write_binary_model(names):
    """The sparse model of the synthetic workspace as COLMAP's binary files, in which
    names end with a zero and may hold ends of lines."""
    sparse = os.path.join(work, "sparse")
    points = []
    with open(os.path.join(sparse, "points3D.txt"), encoding="ascii") as file:
        for line in file:
            words = line.split()
            points.append(struct.pack("<Q3d3BdQ", int(words[0]), *map(float, words[1:4]),
                                      0, 0, 0, 0.5, len(names))
                          + b"".join(struct.pack("<II", view + 1, 0) for view in range(len(names))))
    shutil.rmtree(sparse)
    width, height, focal = synthetic_workspace.WIDTH, synthetic_workspace.HEIGHT, synthetic_workspace.FOCAL
    write(os.path.join(sparse, "cameras.bin"),
          struct.pack("<QIiQQ4d", 1, 1, 1, width, height, focal, focal, width / 2, height / 2))
    write(os.path.join(sparse, "images.bin"), struct.pack("<Q", len(names)) + b"".join(
        struct.pack("<I7dI", view + 1, 1, 0, 0, 0, -synthetic_workspace.BASELINE * view, 0, 0, 1)
        + name + b"\0" + struct.pack("<Q", 0) for view, name in enumerate(names)))
    write(os.path.join(sparse, "points3D.bin"), struct.pack("<Q", len(points)) + b"".join(points))


# Names that no program writes are refused, by every command and without effect.
for name in (ESCAPE, CSI, b"\x7f", EVERYTHING):
    for command, source in ((REFINE, start.mapped),
                            (TO_STEREO, start.bare), (REPORT, start.refined)):
        fresh(source)
        edit("sparse/images.txt", b"v0.png", name.replace(b"\r", b"").replace(b"\t", b"") + b".png")
        before = read_tree(work)
        code, text = printed(f"{command[0]} of {name}", command)
        check(code == 1 and "no usable name" in text, f"{name}: {text}")
        check(read_tree(work) == before, f"{command[0]} of {name} changes files")
fresh(start.mapped)
write_binary_model([b"v0.png" + LINE, b"left/v1.png"])
code, text = printed("a name of two lines", REFINE)
check(code == 1 and "no usable name" in text, text)
fresh(start.mapped)
write_binary_model([b"v0.png", b"left/v1.png"])
check(printed("a binary model", REFINE)[0] == 0, "a binary model works")

# Other names work, whatever the encoding.
for name in (ACCENTS, TURN, b"caf\xe9", RAW_CSI):
    shown = name.decode(errors="replace").replace("\ufffd", "?")
    for command, source in ((REFINE, start.mapped), (RESTORE, start.refined),
                            (TO_STEREO, start.bare), (REPORT, start.refined)):
        fresh(source)
        rename_image(name + b".png")
        code, text = printed(f"{command[0]} of {name}", command)
        check(code == 0, f"{command[0]} of {name}: {text}")
    fresh(start.mapped)
    rename_image(name + b".png")
    for kind in ("depth_maps", "normal_maps"):
        os.remove(os.fsencode(os.path.join(work, "stereo", kind, "")) + name + b".png.geometric.bin")
    code, text = printed(f"keeping {name}", REFINE)
    # The other one has no source then.
    check(code == 1 and f"kept {shown}.png: it has no geometric maps" in text, text)
    for path in ("images/", "stereo/depth_maps/"):
        fresh(start.mapped)
        rename_image(name + b".png")
        for file in (b".png", b".png.geometric.bin", b".png.photometric.bin"):
            broken = os.fsencode(os.path.join(work, path)) + name + file
            if os.path.exists(broken):
                write(broken, b"broken")
        code, text = printed(f"broken {path} of {name}", REFINE)
        check(code == 1 and shown in text, text)
    fresh(start.bare)
    rename_image(name + b".png")
    write(os.path.join(work, "sparse", "points3D.txt"), b"")
    printed(f"{name} without points", TO_STEREO)

# Texts beside the names.
for words in ([EVERYTHING], [b"\xc3"]):
    fresh(start.mapped)
    edit("stereo/patch-match.cfg", b"v0.png", words[0])
    printed("patch-match.cfg", REFINE)
    fresh(start.mapped)
    edit("stereo/patch-match.cfg", b"__all__", b"v0.png, " + words[0])
    printed("sources in patch-match.cfg", REFINE)
fresh(start.mapped)
edit("sparse/cameras.txt", b"PINHOLE", EVERYTHING)
printed("the model of a camera", REFINE)
for key in (EVERYTHING, b"TsarRefine." + EVERYTHING, b"workspace_path\x1b",
            b"[" + EVERYTHING + b"]"):
    fresh(start.mapped)
    write(os.path.join(work, "project.ini"), key + b"=1\n")
    printed("a key", [*REFINE, "--project_path", os.path.join(work, "project.ini")])
fresh(start.mapped)
write(os.path.join(work, "project.ini"), b"input_type=" + EVERYTHING + b"\n")
printed("a value", [*REFINE, "--project_path", os.path.join(work, "project.ini")])
for words in ([b"--" + EVERYTHING, 1], [EVERYTHING], ["--input_type", EVERYTHING],
              ["--TsarRefine.num_threads", EVERYTHING], ["--project_path", EVERYTHING],
              ["--output_path", os.fsencode(work) + b"/images/" + EVERYTHING]):
    fresh(start.mapped)
    code, _ = printed(f"the words {words}", [*REFINE, *words])
    check(code == 1, f"{words} are refused")
code, text = printed("a path", ["tsar_refine", os.path.join(work, os.fsdecode(EVERYTHING))])
check(code == 1, text)

# Whole workspaces in folders of such names.
for command, source in ((REFINE, start.mapped), (RESTORE, start.refined),
                        (TO_STEREO, start.bare), (REPORT, start.refined)):
    place = os.path.join(folder.name, os.fsdecode(EVERYTHING.replace(b"/", b"")))
    copy(source, place)
    code, text = printed("a folder", [command[0], place, *command[2:]])
    check(code == 0, text)
    shutil.rmtree(place)
place = os.path.join(folder.name, os.fsdecode(EVERYTHING))
fresh(start.mapped)
check(printed("an output", [*REFINE, "--output_path", place])[0] == 0, "an output")
shutil.rmtree(place)

# What other runs left: records, notes, shards.
fresh(start.mapped)
for kind in ("depth_maps", "normal_maps"):
    os.remove(os.path.join(work, "stereo", kind, KEY + ".bin"))
printed("keeping", REFINE)
record = os.path.join(work, "stereo/tsar/records", KEY + ".json")
with open(record, encoding="utf-8") as file:
    content = json.load(file)
check(content["note"], "a kept image has a note")
for field in ("note", "image", "inputs", "type", "status", "options_hash"):
    changed = dict(content)
    changed[field] = EVERYTHING.decode(errors="replace")
    write(record, json.dumps(changed, ensure_ascii=field == "note").encode())
    printed(f"a record's {field}", [*REFINE, "--TsarRefine.pass", "merge"])
    printed(f"a record's {field}", REPORT)

# Files to import.
for name in (EVERYTHING.replace(b"/", b""), CSI):
    fresh(start.mapped)
    shutil.rmtree(external, ignore_errors=True)
    copy(start.external, external)
    write(os.fsencode(external) + b"/" + name + b".npy", b"broken")
    write(os.fsencode(external) + b"/" + name + b".png", b"broken")
    import_it = ["tsar_import", work, "--input_path", external, "--output_path", start.imported,
                 "--overwrite", 1, "--format"]
    for form in ("depth", "acm", "apd", "openmvs"):
        printed(f"importing {form} files", [*import_it, form])
    write(os.path.join(folder.name, "list"), name + b"\n" + name + b"\n")
    printed("a list", [*import_it, "depth", "--image_list", os.path.join(folder.name, "list")])
    write(os.path.join(external, "v0.npy"),
          b"\x93NUMPY\x01\x00" + struct.pack("<H", len(name)) + name + b"xxxx")
    printed("an array", [*import_it, "depth"])
    os.remove(os.path.join(external, "v0.npy"))
    write(os.path.join(external, "v0.pfm"), b"Pf\n" + name + b"\n-1\n")
    printed("a PFM", [*import_it, "depth"])


def png_chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def with_profile(picture):
    """libpng warns of a profile that is broken, and names it."""
    name = b"a" + ESCAPE + RAW_CSI + CSI + b"\r"
    profile = struct.pack(">I", 300) + bytes(i * i % 251 for i in range(296))
    body = name + b"\0\0" + zlib.compress(profile)
    return picture[:33] + png_chunk(b"iCCP", body) + picture[33:]


def depth_png():
    """Of 16 bits in gray."""
    width, height = synthetic_workspace.WIDTH, synthetic_workspace.HEIGHT
    rows = b"".join(b"\0" + struct.pack(">H", 5000) * width for _ in range(height))
    return (b"\x89PNG\r\n\x1a\n"
            + png_chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0))
            + png_chunk(b"IDAT", zlib.compress(rows)) + png_chunk(b"IEND", b""))


def put_profile_into(path):
    with open(path, "rb") as file:
        content = file.read()
    write(path, with_profile(content))


# Pictures, and clouds.
for command, source, path in (
        (TO_STEREO, start.bare, "images/v0.png"), (REPORT, start.refined, "images/v0.png"),
        (REPORT, start.refined, f"stereo/provenance_maps/{KEY}.png"),
        (REFINE, start.mapped, "images/v0.png")):
    fresh(source)
    put_profile_into(os.path.join(work, path))
    code, text = printed(f"a profile in {path}", command)
    check(code == 0, text)
fresh(start.mapped)
shutil.rmtree(external)
write(os.path.join(external, "v0.png"), with_profile(depth_png()))
code, text = printed("a profile in depth", [*import_it, "depth"])
check(code == 0 and "1 imported" in text, text)
fresh(start.mapped)
put_profile_into(os.path.join(work, "images/v0.png"))
write(os.path.join(work, "ground_truth/depth/v0.png.bin"),
      synthetic_workspace.map_file([synthetic_workspace.depth_map(0, "geometric")]))
check(printed("a profile", EVALUATE)[0] == 0, "a profile")
hostile_name = os.fsencode(os.path.join(work, "ground_truth/depth/")) + EVERYTHING + b".bin"
write(hostile_name, b"broken")
write(os.fsencode(os.path.join(work, "stereo/depth_maps/")) + EVERYTHING + b".geometric.bin",
      b"broken")
check(printed("ground truth", EVALUATE)[0] == 1, "ground truth")
cloud, scans = os.path.join(work, "cloud.ply"), os.path.join(work, "scans.mlp")
EVALUATE_CLOUD = ["tsar_evaluate", "cloud", "--input_path", cloud, "--ground_truth_path", scans]
PLY = [b"ply", b"format ascii 1.0", b"element vertex 1", b"property float x",
       b"property float y", b"property float z", b"end_header", b"1 2 3"]
MLP = (b'<MeshLabProject><MeshGroup><MLMesh filename="scan.ply"><MLMatrix44>'
       b"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</MLMatrix44></MLMesh></MeshGroup></MeshLabProject>")
write(scans, MLP)
write(os.path.join(work, "scan.ply"), b"\n".join(PLY) + b"\n")
for index in range(len(PLY)):
    words = PLY[index].split()
    for place in range(len(words)):
        lines = list(PLY)
        lines[index] = b" ".join(words[:place] + [EVERYTHING] + words[place + 1:])
        write(cloud, b"\n".join(lines) + b"\n")
        printed(f"a cloud's {PLY[index]}", EVALUATE_CLOUD)
write(cloud, b"\n".join(PLY) + b"\n")
for old in (b"scan.ply", b"MeshGroup>", b"MLMatrix44>1", b"MeshLabProject"):
    write(scans, MLP.replace(old, EVERYTHING + old))
    printed(f"scans' {old}", EVALUATE_CLOUD)
print(f"{num_cases} cases")
