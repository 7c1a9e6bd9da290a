// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/regions/edges.h"

#include "colmap_tsar/device/atomic.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/device/scan_and_sort.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace tsar {
namespace {

struct RobertsKernel {
  ImageView<const Rgb> color;
  float min_gradient;  // Threshold of the squared differences.

  TSAR_HD float Gray(int x, int y) const { return GrayLevel(color(x, y)); }

  TSAR_HD uint8_t operator()(int x, int y) const {
    // The last row and column repeat themselves.
    const int right = x + 1 < color.width ? x + 1 : x;
    const int below = y + 1 < color.height ? y + 1 : y;
    const float first = Gray(x, y) - Gray(right, below);
    const float second = Gray(right, y) - Gray(x, below);
    return first * first + second * second > min_gradient ? 1 : 0;
  }
};

constexpr int kNumAngles = 180;
constexpr int kThreadsPerAngle = 2048;
// epsilon: the least number of edge pixels that vote for a line.
constexpr int kMinVotes = 5;
// The longest gap as a share of the segment's length.
constexpr float kMaxGapShare = 0.1f;
// The least length of segments as a share of the image's shorter side.
constexpr float kMinLengthShare = 1.f / 30.f;
constexpr double kPi = 3.14159265358979323846;

// A unit vector.
struct Direction {
  float x;
  float y;
};

// The normals of the lines at each angle.
Buffer<Direction> MakeNormals(Device& device) {
  std::vector<Direction> normals;
  for (int angle = 0; angle < kNumAngles; ++angle) {
    normals.push_back({static_cast<float>(std::cos(angle * kPi / kNumAngles)),
                       static_cast<float>(std::sin(angle * kPi / kNumAngles))});
  }
  return Buffer<Direction>(device, normals);
}

struct Pixel {
  int x;
  int y;
};

struct IsEdgeKernel {
  const uint8_t* edges;
  int* is_edge;
  TSAR_HD void operator()(int64_t i) const {
    is_edge[i] = edges[i] != 0 ? 1 : 0;
  }
};

struct ListEdgesKernel {
  ImageView<const uint8_t> edges;
  const int* positions;
  Pixel* pixels;
  TSAR_HD void operator()(int x, int y) const {
    if (edges(x, y) != 0) {
      pixels[positions[edges.Index(x, y)]] = {x, y};
    }
  }
};

// Votes for the lines x cos(angle) + y sin(angle) = distance, one degree and
// one pixel apart. Each angle has a row of distances.
struct Accumulator {
  const Direction* normals;
  ImageView<int> votes;

  // The number of distances: the last column is the greatest distance of a
  // width x height image.
  static int NumDistances(int width, int height) {
    return 2 * (static_cast<int>(std::hypot(width, height)) + 1) + 1;
  }
  TSAR_HD int Index(int angle, const Pixel& pixel) const {
    const Direction normal = normals[angle];
    // The shifted value is not negative, so that truncation rounds.
    const float shift = votes.width / 2 + 0.5f;
    return angle * votes.width +
           static_cast<int>(pixel.x * normal.x + pixel.y * normal.y + shift);
  }
};

// Each angle's votes are counted by num_threads threads.
struct VoteKernel {
  const Pixel* pixels;
  int num_pixels;
  int num_threads;
  Accumulator accumulator;

  TSAR_HD void operator()(int thread, int angle) const {
    for (int i = thread; i < num_pixels; i += num_threads) {
      int* votes = accumulator.votes.data + accumulator.Index(angle, pixels[i]);
      if (num_threads == 1) {
        ++*votes;
      } else {
        AtomicAdd(votes, 1);
      }
    }
  }
};

// Steps along a line from a pixel, one pixel at a time along its longer axis.
class LineWalk {
 public:
  TSAR_HD LineWalk(const Pixel& start, const Direction& direction)
      : start_(start) {
    const float longer = fmaxf(fabsf(direction.x), fabsf(direction.y));
    step_x_ = direction.x / longer;
    step_y_ = direction.y / longer;
  }
  TSAR_HD Pixel At(int step) const {
    return {Round(start_.x + step * step_x_), Round(start_.y + step * step_y_)};
  }

 private:
  TSAR_HD static int Round(float value) {
    return static_cast<int>(floorf(value + 0.5f));
  }

  Pixel start_;
  float step_x_;
  float step_y_;
};

// The line of each edge pixel as an index into the votes: the one with most
// votes, or -1 if it has too few.
struct ElectKernel {
  const Pixel* pixels;
  Accumulator accumulator;
  int min_votes;
  ImageView<int> lines;

  TSAR_HD void operator()(int64_t i) const {
    const Pixel pixel = pixels[i];
    int best = -1;
    int most_votes = min_votes - 1;
    for (int angle = 0; angle < kNumAngles; ++angle) {
      const int line = accumulator.Index(angle, pixel);
      if (accumulator.votes.data[line] > most_votes) {
        most_votes = accumulator.votes.data[line];
        best = line;
      }
    }
    lines(pixel.x, pixel.y) = best;
  }
};

struct DrawKernel {
  const Pixel* pixels;
  ImageView<const uint8_t> edges;
  Accumulator accumulator;
  ImageView<const int> lines;
  int max_gap;
  float min_length;
  ImageView<uint8_t> drawn;

  TSAR_HD void operator()(int64_t i) const {
    const Pixel pixel = pixels[i];
    const int line = lines(pixel.x, pixel.y);
    if (line < 0) {
      return;
    }
    // The line is perpendicular to its normal.
    const Direction normal =
        accumulator.normals[line / accumulator.votes.width];
    const LineWalk walk(pixel, {-normal.y, normal.x});
    const Pixel before = walk.At(-1);
    if (edges.Contains(before.x, before.y) && edges(before.x, before.y) != 0 &&
        lines(before.x, before.y) == line) {
      return;  // The other pixel draws the segment.
    }
    int forward = Follow(walk, 1, 0, 0);
    const int backward = Follow(walk, -1, 0, forward);
    // A longer segment may cross a wider gap, so the first side goes on.
    forward = Follow(walk, 1, forward, backward);
    const Pixel first = walk.At(-backward);
    const Pixel last = walk.At(forward);
    const float dx = static_cast<float>(last.x - first.x);
    const float dy = static_cast<float>(last.y - first.y);
    if (dx * dx + dy * dy < min_length * min_length) {
      return;
    }
    for (int step = -backward; step <= forward; ++step) {
      const Pixel covered = walk.At(step);
      AtomicStore(&drawn(covered.x, covered.y), 1);
    }
  }

  // The number of pixels from the start that a walk reaches over allowed gaps.
  // reached: the number reached so far; behind: the segment's length on the
  // other side.
  TSAR_HD int Follow(const LineWalk& walk,
                     int direction,
                     int reached,
                     int behind) const {
    for (int step = reached + 1;; ++step) {
      const Pixel pixel = walk.At(direction * step);
      if (!edges.Contains(pixel.x, pixel.y)) {
        return reached;
      }
      if (edges(pixel.x, pixel.y) != 0) {
        reached = step;
        continue;
      }
      // A pixel's step is always allowed: lines of one pixel's width have none
      // in rows where rounding moves them aside.
      const float longest_gap =
          fminf(fmaxf(kMaxGapShare * (behind + reached + 1), 1.f),
                static_cast<float>(max_gap));
      if (step - reached > longest_gap) {
        return reached;
      }
    }
  }
};

}  // namespace

DeviceImage<uint8_t> DetectRobertsEdges(ImageView<const Rgb> color,
                                        float threshold,
                                        Device& device) {
  return MapPixels<uint8_t>(device,
                            color.width,
                            color.height,
                            RobertsKernel{color, threshold * threshold});
}

DeviceImage<uint8_t> DrawLineSegments(ImageView<const uint8_t> edges,
                                      int max_gap,
                                      Device& device) {
  const int64_t count = static_cast<int64_t>(edges.NumPixels());
  Buffer<int> is_edge(device, edges.NumPixels());
  ParallelFor(device, count, IsEdgeKernel{edges.data, is_edge.Data()});
  const Buffer<int> positions =
      ExclusiveSum(is_edge.Data(), edges.NumPixels(), device);
  int num_edges = 0;
  device.CopyToHost(&num_edges, positions.Data() + count, sizeof(int));
  Buffer<Pixel> pixels(device, num_edges);
  ParallelFor(device,
              edges.width,
              edges.height,
              ListEdgesKernel{edges, positions.Data(), pixels.Data()});

  const Buffer<Direction> normals = MakeNormals(device);
  DeviceImage<int> votes(
      device, Accumulator::NumDistances(edges.width, edges.height), kNumAngles);
  Fill(device, votes.View().data, votes.View().NumPixels(), 0);
  const Accumulator accumulator{normals.Data(), votes.View()};
  // On the CPU, the angles alone occupy all threads.
  const int num_threads = device.IsCuda() ? kThreadsPerAngle : 1;
  ParallelFor(device,
              num_threads,
              kNumAngles,
              VoteKernel{pixels.Data(), num_edges, num_threads, accumulator});
  DeviceImage<int> lines(device, edges.width, edges.height);
  ParallelFor(device,
              num_edges,
              ElectKernel{pixels.Data(), accumulator, kMinVotes, lines.View()});
  DeviceImage<uint8_t> drawn(device, edges.width, edges.height);
  Copy(device, edges.data, edges.NumPixels(), drawn.View().data);
  ParallelFor(device,
              num_edges,
              DrawKernel{pixels.Data(),
                         edges,
                         accumulator,
                         lines.View(),
                         max_gap,
                         kMinLengthShare * std::min(edges.width, edges.height),
                         drawn.View()});
  return drawn;
}

}  // namespace tsar
