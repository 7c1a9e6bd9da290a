// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace tsar {

// A synthetic workspace shows a wall at depth 5 * scale, seen head-on by four
// cameras side by side, "v0.png", "v1.png", "left/v2.png" and "v3.png" of 96 x
// 72 pixels. The wall has texture except for a rectangle. The geometric maps
// hold the wall's depth with little noise, and in the rectangle a few wrong
// depths; the photometric maps are full of wrong depths there.
struct SyntheticWorkspace {
  static constexpr int kWidth = 96;
  static constexpr int kHeight = 72;
  static constexpr double kDepth = 5.0;
  static const std::vector<std::string>& Names();
  // Whether pixel (x, y) of camera number `view` sees the textureless
  // rectangle.
  static bool IsBare(int view, int x, int y);
};

// Every image has all others as sources.
void MakeSyntheticWorkspace(const std::filesystem::path& root,
                            double scale = 1.0);

// Writes the maps of all images as another program may: the upper rows of the
// geometric ones and a few pixels of the others have this value, 0 for none;
// otherwise normals point away from the camera.
void WriteOtherConventions(const std::filesystem::path& root, float no_depth);

// The content of every file below a folder, also of those that links lead to;
// "folder" for folders.
std::map<std::string, std::string> ReadTree(const std::filesystem::path& root);

}  // namespace tsar
