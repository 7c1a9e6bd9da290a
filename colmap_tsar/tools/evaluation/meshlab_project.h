// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// One mesh or scan of a MeshLab project.
struct MeshlabScan {
  std::filesystem::path path;       // Path of the PLY file.
  Eigen::Matrix4d world_from_scan;  // A rigid motion, units of the points.
};

// Reads a MeshLab project (.mlp), the form in which ETH3D gives the poses of
// its laser scans. Relative file names start at the project's folder; the scans
// are not read. Throws Error: kNotFound, kIo, kCorrupt (not such a file, or it
// lists no scan), kUnsupported (a matrix is no rigid motion).
std::vector<MeshlabScan> ReadMeshlabProject(const std::filesystem::path& path);

}  // namespace tsar
