// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// Reads the positions (properties x, y, z of any number type) of the vertices
// of a PLY file, ASCII or binary little-endian; other properties and the
// elements after the vertices are skipped. Throws Error: kNotFound, kIo,
// kCorrupt (not a PLY file, shorter than its header says, or a position that is
// not finite), kUnsupported (big-endian, or lists at or before the vertices).
// Sizes are checked against the file's length before memory is allocated.
std::vector<Eigen::Vector3d> ReadPlyPoints(const std::filesystem::path& path);

}  // namespace tsar
