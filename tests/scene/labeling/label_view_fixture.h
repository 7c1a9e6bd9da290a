// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// A reference and other views of drawn planes, to be labeled.

#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "tests/support/label_view.h"
#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {

constexpr int kWidth = 80;
constexpr int kHeight = 60;
constexpr int kSize = 10;  // The side of a superpixel.
constexpr int kNumColumns = kWidth / kSize;
constexpr int kNumRows = kHeight / kSize;
constexpr int kNumSuperpixels = kNumColumns * kNumRows;
constexpr float kStrongEdge = 100.f;
constexpr Rgb kGray = {100, 100, 100};

inline Plane WallAt(float depth) { return DrawnPlane({0.f, 0.f, -1.f}, depth); }

// Square superpixels, numbered row by row, in an image without edges, of which
// each test says what was measured.
class LabelViewTest : public testing::Test {
 protected:
  LabelViewTest() : camera_(SyntheticCamera(kWidth, kHeight, 80.0)) {
    inputs_.superpixels = SquareSuperpixels<int>(kWidth, kHeight, kSize);
    inputs_.num_superpixels = kNumSuperpixels;
    inputs_.superpixel_planes.resize(kNumSuperpixels);
    inputs_.samples = Image<RayDepth>(kWidth, kHeight);
    inputs_.texture = Image<float>(kWidth, kHeight, 5.f);
    inputs_.contrast = Image<float>(kWidth, kHeight, 0.f);
    inputs_.intrinsics = camera_.GetIntrinsics();
    inputs_.resolution.error_per_depth = 0.001f;
  }

  // The plane is measured in these columns of superpixels, both inclusive.
  void Measure(const Plane& plane, int first_column, int last_column) {
    const Image<RayDepth> samples =
        ToSamples(DrawDepth(plane, camera_), camera_);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = first_column * kSize; x < (last_column + 1) * kSize; ++x) {
        inputs_.samples(x, y) = samples(x, y);
      }
    }
  }

  template <typename Function>
  void ForSamplesOf(int superpixel, const Function& function) {
    for (size_t i = 0; i < inputs_.samples.NumPixels(); ++i) {
      if (inputs_.superpixels.Data()[i] == superpixel) {
        function(&inputs_.samples.Data()[i]);
      }
    }
  }

  void DrawEdgeLeftOf(int column) {
    for (int y = 0; y < kHeight; ++y) {
      inputs_.contrast(column * kSize - 1, y) = kStrongEdge;
      inputs_.contrast(column * kSize, y) = kStrongEdge;
    }
  }

  void DrawEdgesEverywhere() {
    inputs_.contrast = Image<float>(kWidth, kHeight, kStrongEdge);
  }

  // A view this far to the right in which nothing was measured, with this
  // image.
  void AddPicture(double right, Image<Rgb> color) {
    pictures_.push_back({right, {}});
    ViewEvidence& evidence = pictures_.back().second;
    evidence.width = kWidth;
    evidence.height = kHeight;
    evidence.resolution.error_per_depth = inputs_.resolution.error_per_depth;
    evidence.first_observation = {0};
    evidence.confident_depth = Image<float>(kWidth, kHeight);
    evidence.color = std::move(color);
  }

  // A second view, 1 to the right, of which this is known for certain. A point
  // at depth 3 lies 80 / 3 pixels further left in it.
  void AddSource(const std::function<float(int x, int y)>& confident_depth) {
    AddPicture(1.0, Image<Rgb>(kWidth, kHeight, kGray));
    Image<float>& depths = pictures_.back().second.confident_depth;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        depths(x, y) = confident_depth(x, y);
      }
    }
  }

  // Each superpixel is assigned to the first plane that explains its first
  // observation.
  ViewLabels Label(const std::vector<Plane>& planes) const {
    ViewEvidence evidence = GatherEvidence(inputs_).evidence;
    evidence.color = color_;
    DiscoveredPlanes discovered;
    for (const Plane& plane : planes) {
      discovered.planes.push_back({ToWorldPlane(plane, camera_), 1.0});
    }
    std::vector<ObservedView> views = {{&evidence, camera_}};
    discovered.assignment.emplace_back();
    for (int s = 0; s < evidence.NumSuperpixels(); ++s) {
      int assignment = -1;
      if (evidence.first_observation[s] < evidence.first_observation[s + 1]) {
        const RayDepth& sample =
            evidence.observations[evidence.first_observation[s]].sample;
        for (size_t k = planes.size(); k-- > 0;) {
          if (RelativeDistance(planes[k], sample) < 1e-3f) {
            assignment = static_cast<int>(k);
          }
        }
      }
      discovered.assignment[0].push_back(assignment);
    }
    for (const auto& [right, of_picture] : pictures_) {
      Camera camera = camera_;
      camera.translation.x() -= right;
      views.push_back({&of_picture, camera});
      discovered.assignment.emplace_back();
    }
    // Several observations to each cell, as in rasters of usual size.
    return LabelView(views,
                     discovered,
                     FindPlaneSupport(views, discovered, 1.0, /*num_cells=*/16),
                     options_,
                     *device_);
  }

  // Columns have these labels from top to bottom.
  static void ExpectColumns(const ViewLabels& view,
                            const std::vector<int>& expected) {
    ASSERT_EQ(view.planes.size(), static_cast<size_t>(kNumSuperpixels));
    for (int s = 0; s < kNumSuperpixels; ++s) {
      EXPECT_EQ(view.planes[s], expected[s % kNumColumns])
          << "column " << s % kNumColumns << ", row " << s / kNumColumns;
    }
  }

  static void ExpectOrigins(const ViewLabels& view,
                            const std::vector<LabelOrigin>& expected) {
    for (int s = 0; s < kNumSuperpixels; ++s) {
      EXPECT_EQ(view.origins[s], expected[s % kNumColumns])
          << "column " << s % kNumColumns << ", row " << s / kNumColumns;
    }
  }

  std::unique_ptr<Device> device_ = Device::CreateCpu(1);
  Camera camera_;
  EvidenceInputs inputs_;
  Image<Rgb> color_{kWidth, kHeight, kGray};
  std::vector<std::pair<double, ViewEvidence>> pictures_;
  LabelOptions options_;
};

}  // namespace tsar
