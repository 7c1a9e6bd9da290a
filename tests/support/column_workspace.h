// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// A workspace that shows the corner of a textured room, a floor and two walls,
// and in it a textureless column at (0.1, 3) of radius 0.25, from -0.6 to 0.7
// (world frame, z upwards): seven views of 160 x 120 pixels around it. Their
// maps hold the true depths with little noise, except on the column and where
// windows cross its outlines: there depths are wrong by up to a fifth.
struct ColumnWorkspace {
  static constexpr int kWidth = 160;
  static constexpr int kHeight = 120;
  static constexpr int kNumViews = 7;
  static std::string Name(int view);
  // The true depth, and whether it is the column's.
  static double Depth(int view, int x, int y, bool* is_column);
};

// Every image has all others as sources.
void MakeColumnWorkspace(const std::filesystem::path& root);

}  // namespace tsar
