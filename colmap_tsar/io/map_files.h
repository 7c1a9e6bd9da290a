// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/io/float_map.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace tsar {

// Maps as pictures and arrays: those of other programs, and those that this
// program writes beside depth and normal maps.

// A depth or normal map in a format of pictures or arrays.
struct DepthImage {
  FloatMap map;  // One or three channels; those of pictures are red first.
  bool is_integer = false;  // Stored in integers: the unit is uncertain.
};

// Whether a file's name ends in .png, .exr, .tif, .tiff, .pfm, .npy or .npz, in
// any case.
bool IsDepthImageName(const std::filesystem::path& path);

// Reads the bytes of such a file:
// - PNG of 16 bits, EXR and TIFF of floats or of 16 bits, as OpenCV decodes
//   them. A picture of three equal channels counts as one channel, which some
//   programs write for depth.
// - PFM: "Pf" (one channel) or "PF" (three), width, height, scale, each
// followed
//   by white space, the last by one byte of it; then float32 from the bottom
//   row up, little-endian where the scale is negative. The scale's magnitude is
//   ignored, as all programs that write depth expect.
// - NPY: an array of shape (height, width), (height, width, channels) or
//   (channels, height, width), also as a batch of one, of little-endian
//   float16, float32, float64 or uint16, row by row ("C order").
// - NPZ: an uncompressed archive of one such array.
//
// path: the file's name, which determines the format, also for messages. Throws
// Error: kCorrupt (the content breaks the format), kUnsupported (a picture that
// cannot be depth, such as one of 8 bits; an array of another type or shape).
DepthImage ParseDepthImage(std::span<const uint8_t> bytes,
                           const std::filesystem::path& path);

// Reads the same formats as normals, three values for each pixel, as floats: as
// stored or, for integers (also of 8 bits, in PNG and TIFF), 2 * value /
// largest value - 1; (0, 0, 0) if that is far from a unit vector. Throws Error:
// kCorrupt, kUnsupported (not of three channels).
FloatMap ParseNormalImage(std::span<const uint8_t> bytes,
                          const std::filesystem::path& path);

// The header of an array in NumPy's format (.npy, version 1.0), whose values
// follow row by row: magic, version, the length of the text, and the text,
// padded so that the values begin at a multiple of 64 bytes.
//
// type: NumPy's notation, such as "<f4". shape: such as "480, 640".
std::string NpyHeader(const std::string& type, const std::string& shape);

// Read a picture of one channel: confidence and provenance maps have 8 bits,
// plane maps (the number of the scene plane of each pixel) 16. Throw Error
// kNotFound, and kCorrupt for anything but such a picture.
Image<uint8_t> ReadGrayPng(const std::filesystem::path& path);
Image<uint16_t> ReadGray16Png(const std::filesystem::path& path);

// Sigma maps: the standard deviation of each depth, in the units of the depth
// map; 0 where there is no depth. Files are NumPy arrays of half floats, height
// x width.

// Writes a map into a file that the caller commits. halves: the bits of each
// value, see arithmetic.h.
void PutSigmaMap(const Image<uint16_t>& halves, AtomicFile* file);

// Reads a map. Throws Error kNotFound, and kCorrupt for anything but such a
// map, in which no value is negative or not finite.
Image<float> ReadSigmaMap(const std::filesystem::path& path);

}  // namespace tsar
