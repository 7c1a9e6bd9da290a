# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a scene's images larger, smaller or as noisy as a camera's."""

import zlib
from pathlib import Path

import numpy as np

from programs import CommandFailed

EXPOSURE = 0.08  # At most, for each image.
VIGNETTING = 0.25  # Darker at the corners.
NOISY_QUALITY = 88  # JPEG's quality.
CLEAN_QUALITY = 95


def load_opencv():
    try:
        import cv2
    except ImportError as error:
        raise CommandFailed(
            "images can only be resized or made noisy with OpenCV for Python; "
            "install python3-opencv, or opencv-python-headless by pip, or "
            "measure only the scenes' own maps") from error
    return cv2


def with_noise(values, sigma, random):
    """Gray values as a camera takes them: exposure and vignetting of the image,
    and noise that grows with the square root of the light.

    sigma: standard deviation at mid-gray, 128.
    """
    height, width = values.shape[:2]
    x = (2 * np.arange(width) + 1) / width - 1
    y = (2 * np.arange(height) + 1) / height - 1
    # 1 at the corners, whatever the shape of the image.
    squared = ((x * width) ** 2 + ((y * height) ** 2)[:, None]) / (
        width ** 2 + height ** 2)
    exposure = random.uniform(1 - EXPOSURE, 1 + EXPOSURE)
    values = values * (exposure * (1 - VIGNETTING * squared))[..., None]
    spread = sigma * np.sqrt(np.clip(values, 1, 255) / 128)
    return values + spread * random.standard_normal(values.shape)


def convert_image(source, target, size, sigma):
    """Writes an image of this width and height with this noise; the same name
    gets the same noise."""
    cv2 = load_opencv()
    pixels = cv2.imread(str(source), cv2.IMREAD_COLOR)
    if pixels is None:
        raise CommandFailed(f"{source}: OpenCV cannot read the image")
    if (pixels.shape[1], pixels.shape[0]) != tuple(size):
        enlarged = size[0] > pixels.shape[1]
        pixels = cv2.resize(pixels, size, interpolation=cv2.INTER_CUBIC
                            if enlarged else cv2.INTER_AREA)
    if sigma > 0:
        seed = zlib.crc32(f"{source.name} {sigma:g}".encode())
        values = with_noise(pixels.astype(float), sigma,
                            np.random.default_rng(seed))
        pixels = np.clip(values + 0.5, 0, 255).astype(np.uint8)
    target.parent.mkdir(parents=True, exist_ok=True)
    quality = NOISY_QUALITY if sigma > 0 else CLEAN_QUALITY
    options = ([cv2.IMWRITE_JPEG_QUALITY, quality]
               if Path(target).suffix.lower() in (".jpg", ".jpeg") else [])
    if not cv2.imwrite(str(target), pixels, options):
        raise CommandFailed(f"{target}: OpenCV cannot write the image")
