# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The problems of docs/troubleshooting.md, provoked: commands, each with a
function that first spoils "dense", a fresh copy of the sample scene's
workspace, in the current folder. Its files are hard links: they are replaced,
never written into."""
import contextlib
import fcntl
import os
import resource
import struct
import subprocess
import time

from sample_testing import gray_png


def write(path, content):
    """Replaces a file; its other links keep the former content."""
    with contextlib.suppress(FileNotFoundError):
        os.remove(path)
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with open(path, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())


def read(path):
    with open(path) as file:
        return file.read()


MAP = "dense/stereo/depth_maps/v003.jpg.geometric.bin"


class SmallFiles:
    """Limits files to so few bytes as long as it lives."""

    def __init__(self, num_bytes):
        self.before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (num_bytes, self.before[1]))

    def __del__(self):
        resource.setrlimit(resource.RLIMIT_FSIZE, self.before)


def remove_maps(*kinds):
    for folder in ("depth_maps", "normal_maps"):
        for name in os.listdir(f"dense/stereo/{folder}"):
            if any(f".{kind}." in name for kind in kinds):
                os.remove(f"dense/stereo/{folder}/{name}")


def edit(path, old, new):
    text = read(path)
    assert old in text, (path, old)
    write(path, text.replace(old, new, 1))


def spoil(path, change):
    """Replaces the bytes of a file of the workspace."""
    with open(path, "rb") as file:
        write(path, change(file.read()))


def enlarge_the_camera_of_an_image():
    cameras = read("dense/sparse/cameras.txt")
    assert "1 PINHOLE 640 480" in cameras
    write("dense/sparse/cameras.txt",
          cameras + cameras.replace("1 PINHOLE 640 480", "2 PINHOLE 1280 960"))
    edit("dense/sparse/images.txt", " 1 v000.jpg", " 2 v000.jpg")


def lock():
    """Held as long as the file is open: until the folder goes."""
    os.makedirs("dense/stereo/tsar")
    file = open("dense/stereo/tsar/lock", "w")
    fcntl.flock(file, fcntl.LOCK_EX)
    return file


def png(bits, width, height):
    """A gray picture of zeros."""
    return gray_png([bytes(width * bits // 8)] * height, bits)


def photo_after_stereo():
    """Once tsar_stereo, which is too slow to wait for here, had begun."""
    remove_maps("geometric", "photometric")
    process = subprocess.Popen([os.environ["COLMAP_TSAR"], "tsar_stereo", "--workspace_path", "dense"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not os.path.exists("dense/stereo/tsar_stereo/options.txt"):
        assert process.poll() is None
        time.sleep(0.01)
    process.kill()
    process.wait()
    write("dense/stereo/depth_maps/v000.jpg.photometric.bin", "1&1&1&0000")
    spoil("dense/images/v001.jpg", lambda content: content)
    os.utime("dense/images/v001.jpg", (0, 0))


def depth_in_other_units():
    """COLMAP's own depth, as floats in millimeters."""
    os.makedirs("depth")
    for name in sorted(os.listdir("dense/images")):
        with open(f"dense/stereo/depth_maps/{name}.photometric.bin", "rb") as file:
            content = file.read()
        header, values = content.split(b"&1&", 1)
        width, height = (int(n) for n in header.split(b"&"))
        depth = struct.unpack(f"<{width * height}f", values)
        rows = [depth[row * width:(row + 1) * width] for row in range(height)]
        floats = [1000 * value for row in reversed(rows) for value in row]
        write("depth/" + name.replace(".jpg", ".pfm"),
              f"Pf\n{width} {height}\n-1.0\n".encode()
              + struct.pack(f"<{len(floats)}f", *floats))


REFINE = "tsar_refine --workspace_path dense"
MASKS = REFINE + " --mask_path masks"
PRIORS = REFINE + " --prior_path priors"
STEREO = "tsar_stereo --workspace_path dense"
FUSE = "tsar_fuse --workspace_path dense --output_path "
REPORT = "tsar_report --workspace_path dense"
IMPORT = "tsar_import --format depth --input_path depth --workspace_path dense --output_path imported"
PROVENANCE = "dense/stereo/provenance_maps/v000.jpg.geometric.png"

# The arguments of the program, and what is wrong before it is called with them.
SITUATIONS = (
    ("tsar_refine --workspace_path project",
     lambda: (os.mkdir("project"), os.rename("dense/sparse", "project/sparse"))),
    (REFINE, lambda: (os.rename("dense/sparse", "model"), os.mkdir("dense/sparse"),
                      os.rename("model", "dense/sparse/1"))),
    (REFINE, lambda: os.remove("dense/sparse/points3D.txt")),
    (REFINE, lambda: edit("dense/sparse/cameras.txt", "PINHOLE 640 480 ",
                          "EQUIRECTANGULAR 640 480 ")),
    (REFINE, lambda: edit("dense/sparse/images.txt", "v000.jpg", "v\x1b[2J000.jpg")),
    (REFINE, enlarge_the_camera_of_an_image),
    (REFINE, lambda: remove_maps("geometric", "photometric")),
    (REFINE + " --input_type geometric", lambda: remove_maps("geometric")),
    (FUSE + "fused.ply", lambda: remove_maps("geometric", "photometric")),
    (REFINE, lambda: spoil(MAP, lambda content: content[:len(content) // 2])),
    (REFINE, lambda: spoil(MAP, lambda content: content.replace(b"480&360&", b"360&480&", 1))),
    (REFINE, lambda: spoil("dense/images/v003.jpg", lambda content: content[:len(content) // 10])),
    (REFINE, lock),
    (REFINE, lambda: SmallFiles(1000)),
    (REFINE + " --output_path --TsarRefine.device cpu", lambda: None),
    (REFINE + " --image_list_path list.txt", lambda: write("list.txt", "v000.jpg\nv001.png\n")),
    (FUSE + "fused.ply --bounding_box_path box.txt", lambda: write("box.txt", "-1 -1 0\n1 1\n")),
    (MASKS, lambda: write("masks/v000.png", png(8, 640, 480))),
    (MASKS, lambda: write("masks/v000.jpg.png", png(8, 100, 80))),
    (MASKS, lambda: write("masks/v000.jpg.png", "GIF89a")),
    (PRIORS, lambda: write("priors/v000.jpg", "")),
    (PRIORS, lambda: write("priors/v000.pfm",
                           b"Pf\n6 8\n-1\n" + struct.pack("<48f", *[1.0] * 48))),
    (PRIORS, lambda: write("priors/v000.png", png(8, 640, 480))),
    (REFINE, lambda: write(PROVENANCE, "of a refinement")),
    (REPORT, lambda: None),
    ("tsar_planes --workspace_path dense --output_path planes.json", lambda: None),
    (REPORT + " --report_path dense/images/report", lambda: None),
    (FUSE + "dense/fused.ply", lambda: write("dense/fused.ply", "ply\nproperty float nx\n")),
    (STEREO, lambda: None),
    (STEREO, photo_after_stereo),
    (IMPORT, lambda: write("depth/v000.png", png(8, 480, 360))),
    (IMPORT, lambda: write("depth/frame-17.png", png(16, 480, 360))),
    (IMPORT, depth_in_other_units),
)
