// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/refine_borders.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/scene/evidence/measurement_flags.h"
#include "colmap_tsar/view/superpixels/samples.h"

#include <cmath>
#include <utility>

namespace tsar {
namespace {

// The largest number of planes within reach of a pixel; more are rare.
constexpr int kMaxSides = 4;
// Every other pixel suffices to find the superpixels around, which are not that
// thin.
constexpr int kStepToSides = 2;
// Neighbors vote on a grid of this many steps from the center. It is rotated by
// one pixel per step, and so samples every row and column: straight and thin
// structures are not missed.
constexpr int kVotesPerRadius = 4;

// The measurement of each pixel of the raster: the trusted depth at its center,
// or 0.
struct MeasuredKernel {
  ImageView<const float> depth;
  ImageView<const uint8_t> flags;
  ImageView<float> measured;

  TSAR_HD void operator()(int x, int y) const {
    const int column =
        static_cast<int>((x + 0.5f) * depth.width / measured.width);
    const int row =
        static_cast<int>((y + 0.5f) * depth.height / measured.height);
    measured(x, y) = MeasurementFlags::IsTrusted(flags(column, row))
                         ? depth(column, row)
                         : 0.f;
  }
};

// A plane of the superpixels around a pixel.
struct Side {
  int label = -1;
  uint16_t superpixel = 0;  // The nearest one.
  int distance = 0;         // Squared.
  float votes = 0.f;
};

// Access of the kernels to the neighborhood of a pixel.
struct Neighborhood {
  BorderInputs inputs;
  const int* labels;
  const Plane* planes;
  BorderOptions options;
  ImageView<const float> measured;
  ImageView<const uint16_t> superpixels;  // As refined so far.

  TSAR_HD float Gap(float a, float b) const {
    const float nearer = fminf(a, b);
    return fabsf(a - b) /
           (nearer * inputs.resolution.RelativeDepthError(nearer));
  }

  // The depth of a label's plane at a pixel; 0 where there is none.
  TSAR_HD float DepthOf(int label, int x, int y) const {
    return label < 0 ? 0.f : planes[label].Depth(inputs.intrinsics.Ray(x, y));
  }

  TSAR_HD int LabelAt(int x, int y) const { return labels[superpixels(x, y)]; }

  // Finds the candidate planes of the pixel, its own first. Returns their
  // number.
  TSAR_HD int FindSides(int x, int y, Side* sides) const {
    const uint16_t own = superpixels(x, y);
    const float own_depth = DepthOf(labels[own], x, y);
    sides[0] = {labels[own], own, 0, 0.f};
    int num_sides = 1;
    const int reach = options.reach;
    for (int v = -reach; v <= reach; v += kStepToSides) {
      for (int u = -reach; u <= reach; u += kStepToSides) {
        const int distance = u * u + v * v;
        if (distance > reach * reach ||
            !inputs.superpixels.Contains(x + u, y + v)) {
          continue;
        }
        const uint16_t superpixel = inputs.superpixels(x + u, y + v);
        const int label = labels[superpixel];
        int i = 0;
        while (i < num_sides && sides[i].label != label) {
          ++i;
        }
        if (i == num_sides) {
          if (i == kMaxSides || !CanHave(label, own_depth, x, y)) {
            continue;
          }
          ++num_sides;
        } else if (i == 0 || distance >= sides[i].distance) {
          continue;
        }
        sides[i] = {label, superpixel, distance, 0.f};
      }
    }
    return num_sides;
  }

  // Whether another label is possible for a pixel and differs from its own.
  TSAR_HD bool CanHave(int label, float own_depth, int x, int y) const {
    const float depth = DepthOf(label, x, y);
    if (!(depth > 0.f)) {
      return label < 0;
    }
    return !(own_depth > 0.f) || Gap(depth, own_depth) >= options.min_gap;
  }

  // Calls body(x, y, weight) for the pixels around and the pixel itself.
  template <typename Body>
  TSAR_HD void ForNeighbors(int x, int y, const Body& body) const {
    const Vec3f color = inputs.lab(x, y);
    const float per_color = 1.f / (options.color_sigma * options.color_sigma);
    const float per_distance =
        1.f / (options.spatial_sigma * options.spatial_sigma);
    const int step =
        options.radius > kVotesPerRadius ? options.radius / kVotesPerRadius : 1;
    for (int j = -kVotesPerRadius; j <= kVotesPerRadius; ++j) {
      for (int i = -kVotesPerRadius; i <= kVotesPerRadius; ++i) {
        const int u = step * i - j;
        const int v = step * j + i;
        if (!superpixels.Contains(x + u, y + v)) {
          continue;
        }
        const Vec3f difference = inputs.lab(x + u, y + v) - color;
        // This replaces exp(), which the devices round differently.
        const float c = 1.f + Dot(difference, difference) * per_color;
        const float d = 1.f + static_cast<float>(u * u + v * v) * per_distance;
        body(x + u, y + v, 1.f / (c * c * d * d));
      }
    }
  }
};

// The vote of a pixel in its neighborhood.
struct Ballot {
  int label = -1;
  // Reliability of its measurement, in [0, 1).
  float belief = 0.f;
  // Weight of its vote for the plane.
  float vote = 0.f;
};

struct BallotKernel {
  Neighborhood around;
  ImageView<Ballot> ballots;

  TSAR_HD void operator()(int x, int y) const {
    const int label = around.LabelAt(x, y);
    const float belief = Belief(label, x, y);
    ballots(x, y) = {label, belief, Vote(label, belief, x, y)};
  }

  // The reliability by the texture on the pixel's own side: an edge belongs to
  // one side.
  TSAR_HD float Belief(int label, int x, int y) const {
    const ImageView<const Vec3f>& lab = around.inputs.lab;
    float low = lab(x, y).x;
    float high = low;
    for (int v = y - 1; v <= y + 1; ++v) {
      for (int u = x - 1; u <= x + 1; ++u) {
        if (lab.Contains(u, v) && around.LabelAt(u, v) == label) {
          low = fminf(low, lab(u, v).x);
          high = fmaxf(high, lab(u, v).x);
        }
      }
    }
    const float share = (high - low) / around.options.contrast;
    return share * share / (1.f + share * share);
  }

  TSAR_HD float Vote(int label, float belief, int x, int y) const {
    const float unmeasured = around.options.vote_of_unmeasured;
    const float measured = around.measured(x, y);
    if (!(measured > 0.f)) {
      return unmeasured;
    }
    const float depth = around.DepthOf(label, x, y);
    return depth > 0.f && around.Gap(depth, measured) <= around.options.on_plane
               ? unmeasured + (1.f - unmeasured) * belief
               : unmeasured * (1.f - belief);
  }
};

// Marks the pixels that may change: those near borders.
struct ContestedKernel {
  Neighborhood around;
  ImageView<uint8_t> contested;

  TSAR_HD void operator()(int x, int y) const {
    Side sides[kMaxSides];
    contested(x, y) = around.FindSides(x, y, sides) > 1 ? 1 : 0;
  }
};

struct RoundKernel {
  Neighborhood around;
  ImageView<const Ballot> ballots;
  ImageView<const uint8_t> contested;
  ImageView<uint16_t> refined;

  TSAR_HD void operator()(int x, int y) const {
    refined(x, y) = around.superpixels(x, y);
    if (contested(x, y) == 0) {
      return;
    }
    Side sides[kMaxSides];
    const int num_sides = around.FindSides(x, y, sides);
    around.ForNeighbors(x, y, [&](int u, int v, float weight) {
      const Ballot& ballot = ballots(u, v);
      for (int i = 0; i < num_sides; ++i) {
        if (sides[i].label == ballot.label) {
          sides[i].votes += weight * ballot.vote;
        }
      }
    });
    int best = 0;
    for (int i = 1; i < num_sides; ++i) {
      if (sides[i].votes > sides[best].votes) {
        best = i;
      }
    }
    refined(x, y) = sides[best].superpixel;
  }
};

struct FattenedKernel {
  Neighborhood around;
  ImageView<const Ballot> ballots;
  ImageView<uint8_t> fattened;

  TSAR_HD void operator()(int x, int y) const {
    fattened(x, y) = 0;
    const int label = ballots(x, y).label;
    const int side = SideOfPlane(label, x, y);
    if (side == 0) {
      return;
    }
    float votes_for = 0.f;
    float votes_against = 0.f;
    around.ForNeighbors(x, y, [&](int u, int v, float weight) {
      const int other = SideOfPlane(label, u, v);
      if (other == side) {
        votes_for += weight * ballots(u, v).belief;
      } else if (other == 0 && ballots(u, v).label == label) {
        votes_against += weight * ballots(u, v).vote;
      }
    });
    fattened(x, y) = votes_for < votes_against ? 1 : 0;
  }

  // The side of the plane on which the measurement lies: -1 in front, 1 behind,
  // 0 on it or where either is missing.
  TSAR_HD int SideOfPlane(int label, int x, int y) const {
    const float depth = around.measured(x, y);
    const float plane = around.DepthOf(label, x, y);
    if (!(depth > 0.f) || !(plane > 0.f) ||
        around.Gap(plane, depth) <= around.options.on_plane) {
      return 0;
    }
    return depth < plane ? -1 : 1;
  }
};

struct DistrustKernel {
  ImageView<const uint8_t> fattened;
  ImageView<uint8_t> flags;

  TSAR_HD void operator()(int x, int y) const {
    if (fattened(ReducedRaster::FromMap(x, flags.width, fattened.width),
                 ReducedRaster::FromMap(y, flags.height, fattened.height)) !=
        0) {
      flags(x, y) = MeasurementFlags::WithoutTrust(flags(x, y));
    }
  }
};

}  // namespace

RefinedBorders RefineBorders(const BorderInputs& inputs,
                             const std::vector<int>& labels,
                             const std::vector<Plane>& planes,
                             const BorderOptions& options,
                             Device& device) {
  const int width = inputs.superpixels.width;
  const int height = inputs.superpixels.height;
  const Buffer<int> device_labels(device, labels);
  const Buffer<Plane> device_planes(device, planes);
  DeviceImage<float> measured(device, width, height);
  ParallelFor(device,
              width,
              height,
              MeasuredKernel{inputs.depth, inputs.flags, measured.View()});
  Neighborhood around{inputs,
                      device_labels.Data(),
                      device_planes.Data(),
                      options,
                      measured.View(),
                      inputs.superpixels};
  DeviceImage<uint8_t> marks(device, width, height);
  ParallelFor(device, width, height, ContestedKernel{around, marks.View()});
  DeviceImage<uint16_t> refined(device, width, height);
  DeviceImage<uint16_t> previous(device, width, height);
  DeviceImage<Ballot> ballots(device, width, height);
  ParallelFor(device, width, height, BallotKernel{around, ballots.View()});
  for (int round = 0; round < options.num_rounds; ++round) {
    ParallelFor(
        device,
        width,
        height,
        RoundKernel{around, ballots.View(), marks.View(), refined.View()});
    std::swap(refined, previous);
    around.superpixels = previous.View();
    ParallelFor(device, width, height, BallotKernel{around, ballots.View()});
  }
  ParallelFor(device,
              width,
              height,
              FattenedKernel{around, ballots.View(), marks.View()});
  return {std::move(previous), std::move(marks)};
}

void DistrustFattened(ImageView<const uint8_t> fattened,
                      ImageView<uint8_t> flags,
                      Device& device) {
  ParallelFor(
      device, flags.width, flags.height, DistrustKernel{fattened, flags});
}

}  // namespace tsar
