// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/segmentation/hough.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace tsar {
namespace {

constexpr int kNumAngles = 180;
constexpr double kPi = 3.14159265358979323846;

// Votes of the edge pixels for lines x cos(angle) + y sin(angle) = distance,
// one degree and one pixel apart.
class Accumulator {
 public:
  Accumulator(int width, int height)
      : offset_(static_cast<int>(std::hypot(width, height)) + 1),
        num_distances_(2 * offset_ + 1),
        votes_(static_cast<size_t>(kNumAngles) * num_distances_, 0) {
    for (int angle = 0; angle < kNumAngles; ++angle) {
      cos_[angle] = static_cast<float>(std::cos(angle * kPi / kNumAngles));
      sin_[angle] = static_cast<float>(std::sin(angle * kPi / kNumAngles));
    }
  }

  // Adds a pixel's votes; returns the angle of the line that now has most of
  // them, and how many.
  std::pair<int, int> Add(int x, int y) {
    int best_angle = 0;
    int best_votes = 0;
    for (int angle = 0; angle < kNumAngles; ++angle) {
      const int votes = ++votes_[Cell(angle, x, y)];
      if (votes > best_votes) {
        best_votes = votes;
        best_angle = angle;
      }
    }
    return {best_angle, best_votes};
  }

  void Remove(int x, int y) {
    for (int angle = 0; angle < kNumAngles; ++angle) {
      --votes_[Cell(angle, x, y)];
    }
  }

  float Cos(int angle) const { return cos_[angle]; }
  float Sin(int angle) const { return sin_[angle]; }

 private:
  size_t Cell(int angle, int x, int y) const {
    const int distance =
        static_cast<int>(std::lround(x * cos_[angle] + y * sin_[angle]));
    return static_cast<size_t>(angle) * num_distances_ + distance + offset_;
  }

  int offset_;
  int num_distances_;
  std::vector<int> votes_;
  float cos_[kNumAngles];
  float sin_[kNumAngles];
};

// Steps along a line from a pixel, one pixel at a time along its longer axis.
class LineWalk {
 public:
  LineWalk(int x, int y, float direction_x, float direction_y)
      : x_(x), y_(y) {
    const float longer =
        std::max(std::abs(direction_x), std::abs(direction_y));
    step_x_ = direction_x / longer;
    step_y_ = direction_y / longer;
  }
  int X(int step) const { return static_cast<int>(std::lround(x_ + step * step_x_)); }
  int Y(int step) const { return static_cast<int>(std::lround(y_ + step * step_y_)); }

 private:
  float x_;
  float y_;
  float step_x_;
  float step_y_;
};

// How many pixels, counted from the start, a walk may reach with pieces no
// further apart than allowed. behind: the segment's length on the other side.
int Follow(const LineWalk& walk,
           int direction,
           int behind,
           ImageView<const uint8_t> edges,
           const HoughOptions& options) {
  int reached = 0;
  for (int step = 1;; ++step) {
    const int x = walk.X(direction * step);
    const int y = walk.Y(direction * step);
    if (!edges.Contains(x, y)) {
      return reached;
    }
    if (edges(x, y) != 0) {
      reached = step;
      continue;
    }
    // A pixel's step is always allowed: lines of one pixel's width have none in
    // rows where rounding moves them aside.
    const float longest_gap =
        std::min(std::max(options.max_gap_share * (behind + reached + 1), 1.f),
                 static_cast<float>(options.max_gap));
    if (step - reached > longest_gap) {
      return reached;
    }
  }
}

std::vector<int> ShuffledEdgePixels(ImageView<const uint8_t> edges,
                                    uint32_t image_id) {
  std::vector<int> pixels;
  for (size_t i = 0; i < edges.NumPixels(); ++i) {
    if (edges.data[i] != 0) {
      pixels.push_back(static_cast<int>(i));
    }
  }
  Philox random(image_id, 0, 0);
  for (size_t i = pixels.size(); i > 1; --i) {
    std::swap(pixels[i - 1], pixels[random.NextBelow(static_cast<uint32_t>(i))]);
  }
  return pixels;
}

}  // namespace

std::vector<LineSegment> DetectLineSegments(ImageView<const uint8_t> edges,
                                            const HoughOptions& options) {
  enum : uint8_t { kWaiting, kVoted, kCovered };
  Image<uint8_t> states(edges.width, edges.height, kWaiting);
  Accumulator accumulator(edges.width, edges.height);
  const float min_length =
      options.min_length_share * std::min(edges.width, edges.height);
  std::vector<LineSegment> segments;
  for (const int pixel : ShuffledEdgePixels(edges, options.image_id)) {
    const int x = pixel % edges.width;
    const int y = pixel / edges.width;
    if (states(x, y) != kWaiting) {
      continue;
    }
    states(x, y) = kVoted;
    const auto [angle, votes] = accumulator.Add(x, y);
    if (votes < options.min_votes) {
      continue;
    }
    // The line runs at a right angle to its normal (cos, sin).
    const LineWalk walk(x, y, -accumulator.Sin(angle), accumulator.Cos(angle));
    int forward = Follow(walk, 1, 0, edges, options);
    const int backward = Follow(walk, -1, forward, edges, options);
    // A longer segment may cross a wider gap, so the first side is tried again.
    forward = Follow(walk, 1, backward, edges, options);
    const LineSegment segment{walk.X(-backward),
                              walk.Y(-backward),
                              walk.X(forward),
                              walk.Y(forward)};
    if (std::hypot(segment.x1 - segment.x0, segment.y1 - segment.y0) <
        min_length) {
      continue;
    }
    segments.push_back(segment);
    for (int step = -backward; step <= forward; ++step) {
      uint8_t& state = states(walk.X(step), walk.Y(step));
      if (state == kVoted) {
        accumulator.Remove(walk.X(step), walk.Y(step));
      }
      state = kCovered;
    }
  }
  return segments;
}

void DrawLineSegments(const std::vector<LineSegment>& segments,
                      ImageView<uint8_t> edges) {
  for (const LineSegment& segment : segments) {
    const int dx = segment.x1 - segment.x0;
    const int dy = segment.y1 - segment.y0;
    const int length = std::max(std::abs(dx), std::abs(dy));
    for (int i = 0; i <= length; ++i) {
      const float t = length > 0 ? static_cast<float>(i) / length : 0.f;
      const int x = static_cast<int>(std::lround(segment.x0 + t * dx));
      const int y = static_cast<int>(std::lround(segment.y0 + t * dy));
      edges(x, y) = 1;
    }
  }
}

}  // namespace tsar
