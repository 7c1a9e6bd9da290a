# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Files as data sets hold them: errors that name them, numbers, image sizes."""
import os
import pathlib
import re
import struct

IMAGE_ENDINGS = (".jpg", ".jpeg", ".png")


class DatasetError(Exception):
    """Bad input: one line that names the file, what is wrong and what to do."""


def read_lines(path, what):
    """The lines of a text file without their ends; what says in an error which
    file of the data set it is."""
    try:
        return pathlib.Path(path).read_text(encoding="utf-8").splitlines()
    except FileNotFoundError:
        raise DatasetError(f"{path}: not found; it should hold {what}") from None
    except (OSError, UnicodeDecodeError) as error:
        raise DatasetError(f"{path}: cannot be read: {error}") from None


def parse_numbers(line, count, place, kind=float):
    """Exactly count finite numbers of a line; place names file and line."""
    try:
        values = [kind(word) for word in line.split()]
    except ValueError:
        raise DatasetError(f"{place}: '{line[:60]}' are not numbers") from None
    if len(values) != count:
        raise DatasetError(f"{place}: {len(values)} numbers instead of {count}")
    if any(value - value != 0 for value in values):
        raise DatasetError(f"{place}: a number that is not finite")
    return values


def write_bytes(path, content):
    """Writes a whole file or none."""
    part = pathlib.Path(f"{path}.part")
    part.parent.mkdir(parents=True, exist_ok=True)
    try:
        part.write_bytes(content)
    except OSError as error:
        # A disk that is full does not tell of which file.
        raise DatasetError(f"{path}: cannot be written: {error.strerror}; the same command goes "
                           "on from here once it can") from None
    os.replace(part, path)


def write_text(path, text):
    write_bytes(path, text.encode("utf-8"))


def jpeg_size(file):
    """Width and height from the frame header of a JPEG file."""
    file.seek(2)
    while True:
        marker, code, length = struct.unpack(">BBH", file.read(4))
        if marker != 0xFF:
            raise ValueError
        # Frame headers, without the codes in between for tables.
        if 0xC0 <= code <= 0xCF and code not in (0xC4, 0xC8, 0xCC):
            height, width = struct.unpack(">xHH", file.read(5))
            return width, height
        file.seek(length - 2, os.SEEK_CUR)


def image_size(path):
    """Width and height of a JPEG or PNG file, from its header alone."""
    try:
        with open(path, "rb") as file:
            start = file.read(24)
            if start[:8] == b"\x89PNG\r\n\x1a\n":
                return struct.unpack(">II", start[16:24])
            if start[:2] == b"\xff\xd8":
                return jpeg_size(file)
    except FileNotFoundError:
        raise DatasetError(f"{path}: not found, or a link to what is not there") from None
    except (OSError, ValueError, struct.error):
        pass
    raise DatasetError(f"{path}: cannot be read as a JPEG or PNG image; copy it "
                       "again, or remove it")


def jpeg_is_whole(content):
    """Whether the markers of a JPEG file lead to that of its end. What cameras write
    behind it does not count, nor do the ends of the thumbnails in its header."""
    place = 2
    while place + 4 <= len(content) and content[place] == 0xFF:
        if content[place + 1] == 0xD9:
            return True
        is_scan = content[place + 1] == 0xDA
        place += 2 + int.from_bytes(content[place + 2:place + 4], "big")
        if is_scan:  # Up to a marker that is no escape, restart or padding.
            marker = re.compile(rb"\xff[^\x00\x01\xd0-\xd7\xff]").search(content, place)
            place = marker.start() if marker else len(content)
    return content[place:place + 2] == b"\xff\xd9"


def png_is_whole(content):
    """Whether the chunks of a PNG file lead to its last one, and that is there."""
    place = 8
    while place + 12 <= len(content):
        kind = content[place + 4:place + 8]
        place += 12 + int.from_bytes(content[place:place + 4], "big")
        if kind == b"IEND":
            return place <= len(content)
    return False


def check_photo(path):
    """That a JPEG or PNG file is there from its first byte to its last: of what is
    missing, decoders make gray areas without a word. Returns the photo's size."""
    size = image_size(path)
    content = pathlib.Path(path).read_bytes()
    is_whole = png_is_whole if content[:1] == b"\x89" else jpeg_is_whole
    if not is_whole(content):
        raise DatasetError(f"{path}: the picture is cut short; copy it again, or remove it")
    return size


def has_alpha(path):
    """Whether a PNG file has an alpha channel, which COLMAP does not read."""
    with open(path, "rb") as file:
        start = file.read(26)
    return start[:4] == b"\x89PNG" and len(start) == 26 and start[25] in (4, 6)


def has_exif(path):
    """Whether a photo tells of the camera that took it."""
    with open(path, "rb") as file:
        start = file.read(1 << 16)
    return b"Exif\0\0" in start or b"eXIf" in start


def find_photos(folder):
    """The images in a folder and its subfolders as names relative to it, sorted,
    and the endings of other files. What begins with a dot is left out."""
    def refuse(error):
        raise error

    names, others = [], set()
    for parent, folders, files in os.walk(folder, onerror=refuse):
        folders[:] = [name for name in folders if not name.startswith(".")]
        for path in (pathlib.Path(parent, name) for name in files if not name.startswith(".")):
            if path.suffix.lower() in IMAGE_ENDINGS:
                names.append(path.relative_to(folder).as_posix())
            else:
                others.add(path.suffix.lower())
    return sorted(names), sorted(others)


def list_images(folder):
    """The images right in a folder, sorted by name."""
    return sorted(p for p in pathlib.Path(folder).iterdir()
                  if p.suffix.lower() in IMAGE_ENDINGS and p.is_file())


def find_scenes(path, is_scene, what):
    """The folder itself if it is a scene, or else the scenes right in it; a scene
    is what is_scene(folder) says, and what describes one in the error."""
    path = pathlib.Path(path)
    if not path.is_dir():
        raise DatasetError(f"{path}: is not a folder; name a scene, or a folder of scenes")
    path = path.resolve()
    if is_scene(path):
        return [path]
    scenes = sorted(p for p in path.iterdir() if p.is_dir() and is_scene(p))
    if not scenes:
        raise DatasetError(f"{path}: is neither a scene nor a folder of scenes; "
                           f"a scene has {what}")
    return scenes
