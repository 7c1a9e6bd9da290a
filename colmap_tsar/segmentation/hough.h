// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <cstdint>
#include <vector>

namespace tsar {

struct LineSegment {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
};

struct HoughOptions {
  // epsilon: the least number of edge pixels that vote for a line.
  int min_votes = 5;
  // upsilon: the longest gap between two pieces of a segment, in pixels.
  int max_gap = 15;
  // A gap may also not be longer than this share of the segment.
  float max_gap_share = 0.1f;
  // Segments shorter than this share of the image's shorter side are dropped.
  float min_length_share = 1.f / 30.f;
  // Keys the random order in which the edge pixels vote.
  uint32_t image_id = 0;
};

// Straight segments through edge pixels by a progressive probabilistic Hough
// transform: pixels vote in random order; as soon as a line has enough votes it
// is followed from that pixel in both directions over gaps of at most
// t_c = min(0.1 * length, max_gap), and what it covers votes no more.
// edges: 1 on edges, 0 elsewhere.
std::vector<LineSegment> DetectLineSegments(ImageView<const uint8_t> edges,
                                            const HoughOptions& options);

// Sets the pixels of each segment to 1; the line is 8-connected, which keeps
// 4-connected regions apart.
void DrawLineSegments(const std::vector<LineSegment>& segments,
                      ImageView<uint8_t> edges);

}  // namespace tsar
