// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// A synthetic view, from which evidence is gathered.

#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {

constexpr int kWidth = 40;
constexpr int kHeight = 30;
constexpr int kSize = 10;  // Of a superpixel.
constexpr int kNumColumns = kWidth / kSize;
constexpr int kNumSuperpixels = kNumColumns * kHeight / kSize;
constexpr int kNumPixels = kSize * kSize;  // Of a superpixel.
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Square superpixels, numbered row by row, on a well textured plane that is
// measured everywhere.
class GatherEvidenceTest : public testing::Test {
 protected:
  GatherEvidenceTest()
      : camera_(SyntheticCamera(kWidth, kHeight, 40.0)),
        plane_(DrawnPlane({0.2f, 0.1f, -1.f}, 5.f)) {
    inputs_.superpixels = SquareSuperpixels<int>(kWidth, kHeight, kSize);
    inputs_.num_superpixels = kNumSuperpixels;
    inputs_.superpixel_planes.assign(kNumSuperpixels, plane_);
    inputs_.samples = ToSamples(DrawDepth(plane_, camera_), camera_);
    inputs_.texture = Image<float>(kWidth, kHeight, 5.f);
    inputs_.contrast = Image<float>(kWidth, kHeight, 0.f);
    inputs_.intrinsics = camera_.GetIntrinsics();
    inputs_.resolution.error_per_depth = 0.001f;
  }

  GatheredEvidence GatherAll() const { return GatherEvidence(inputs_); }
  ViewEvidence Gather() const { return GatherAll().evidence; }

  template <typename T>
  void Fill(Image<T>* image, int superpixel, const T& value) const {
    for (size_t i = 0; i < image->NumPixels(); ++i) {
      if (inputs_.superpixels.Data()[i] == superpixel) {
        image->Data()[i] = value;
      }
    }
  }

  void DrawRegionPlane(int superpixel, const Plane& plane) {
    if (inputs_.region_planes.Empty()) {
      inputs_.region_planes = Image<Plane>(kWidth, kHeight);
    }
    Fill(&inputs_.region_planes, superpixel, plane);
  }

  static std::vector<Observation> ObservationsOf(const ViewEvidence& evidence,
                                                 int superpixel) {
    return {
        evidence.observations.begin() + evidence.first_observation[superpixel],
        evidence.observations.begin() +
            evidence.first_observation[superpixel + 1]};
  }

  static const SuperpixelBorder& BorderOf(const ViewEvidence& evidence,
                                          int first,
                                          int second) {
    return *std::find_if(evidence.borders.begin(),
                         evidence.borders.end(),
                         [&](const SuperpixelBorder& border) {
                           return border.first == first &&
                                  border.second == second;
                         });
  }

  const Camera camera_;
  const Plane plane_;
  EvidenceInputs inputs_;
};

}  // namespace tsar
