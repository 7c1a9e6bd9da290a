# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Writes rows of gray levels as photos of several formats. Needs nothing but
Python."""
import math
import struct
import zlib


def png_chunk(kind, body):
    return (struct.pack(">I", len(body)) + kind + body
            + struct.pack(">I", zlib.crc32(kind + body)))


def png(rows, bits=8):
    """In colors; of 16 bits, both bytes are the level."""
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), bits, 2, 0, 0, 0)
    body = b"".join(b"\0" + bytes(level for level in row for _ in range(3 * bits // 8))
                    for row in rows)
    return (b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", header)
            + png_chunk(b"IDAT", zlib.compress(body)) + png_chunk(b"IEND", b""))


def ppm(rows):
    body = b"".join(bytes(level for level in row for _ in range(3)) for row in rows)
    return f"P6\n{len(rows[0])} {len(rows)}\n255\n".encode() + body


def bmp(rows):
    """In colors, from the last row to the first."""
    width, height = len(rows[0]), len(rows)
    padding = bytes(-3 * width % 4)
    body = b"".join(bytes(level for level in row for _ in range(3)) + padding
                    for row in reversed(rows))
    return (b"BM" + struct.pack("<IHHI", 54 + len(body), 0, 0, 54)
            + struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, len(body), 0, 0, 0, 0)
            + body)


def tiff(rows):
    """In gray, by Deflate, with the directory at the end."""
    body = zlib.compress(b"".join(map(bytes, rows)))
    body += b"\0" * (len(body) % 2)
    tags = ((256, len(rows[0])), (257, len(rows)), (258, 8), (259, 8), (262, 1), (273, 8),
            (277, 1), (278, len(rows)), (279, len(body)))
    return (b"II*\0" + struct.pack("<I", 8 + len(body)) + body + struct.pack("<H", len(tags))
            + b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags)
            + bytes(4))


def wave(x, u):
    return math.cos((2 * x + 1) * u * math.pi / 16) / (2 if u else math.sqrt(8))


WAVES = [[wave(x, u) for x in range(8)] for u in range(8)]
ZIGZAG = sorted(((u, v) for v in range(8) for u in range(8)),
                key=lambda p: (p[0] + p[1], p[1] if (p[0] + p[1]) % 2 else p[0]))
# All codes have the same length, so that a symbol's code is its place here.
DC_SYMBOLS = list(range(12))
AC_SYMBOLS = [0x00, 0xF0] + [16 * run + size for run in range(16) for size in range(1, 11)]


def coefficients(block):
    """Of the 8 x 8 levels of a block, in the order of the file."""
    by_row = [[sum(row[x] * WAVES[u][x] for x in range(8)) for u in range(8)] for row in block]
    return [round(sum(by_row[y][u] * WAVES[v][y] for y in range(8))) for u, v in ZIGZAG]


def block_bits(values, last_dc):
    """The bits of a block as text."""
    def number(value):
        size = abs(value).bit_length()
        rest = value if value >= 0 else value + (1 << size) - 1
        return size, format(rest, f"0{size}b") if size else ""

    size, rest = number(values[0] - last_dc)
    bits, run = [format(DC_SYMBOLS.index(size), "04b") + rest], 0
    for value in values[1:]:
        if value == 0:
            run += 1
            continue
        bits += [format(AC_SYMBOLS.index(0xF0), "08b")] * (run // 16)
        size, rest = number(value)
        bits.append(format(AC_SYMBOLS.index(16 * (run % 16) + size), "08b") + rest)
        run = 0
    if run:
        bits.append(format(AC_SYMBOLS.index(0x00), "08b"))
    return "".join(bits)


def jpeg(rows):
    """In gray, of the best quality."""
    def segment(marker, body):
        return b"\xff" + bytes([marker]) + struct.pack(">H", len(body) + 2) + body

    def table(number, symbols, num_bits):
        counts = [len(symbols) if i + 1 == num_bits else 0 for i in range(16)]
        return segment(0xC4, bytes([number] + counts + symbols))

    width, height = len(rows[0]), len(rows)
    bits, last_dc = [], 0
    for top in range(0, height, 8):
        for left in range(0, width, 8):
            values = coefficients([[rows[min(y, height - 1)][min(x, width - 1)] - 128
                                    for x in range(left, left + 8)] for y in range(top, top + 8)])
            bits.append(block_bits(values, last_dc))
            last_dc = values[0]
    text = "".join(bits)
    text += "1" * (-len(text) % 8)
    body = int(text, 2).to_bytes(len(text) // 8, "big").replace(b"\xff", b"\xff\0")
    return (b"\xff\xd8" + segment(0xDB, bytes([0] + [1] * 64))
            + segment(0xC0, struct.pack(">BHHB", 8, height, width, 1) + bytes([1, 0x11, 0]))
            + table(0x00, DC_SYMBOLS, 4) + table(0x10, AC_SYMBOLS, 8)
            + segment(0xDA, bytes([1, 1, 0x00, 0, 63, 0])) + body + b"\xff\xd9")
