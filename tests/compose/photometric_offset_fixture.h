// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/compose/photometric_offset.h"
#include "colmap_tsar/matching/gray_pair.h"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "tests/support/synthetic_views.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {

struct MeasuredOffsets {
  Image<float> offset;
  Image<float> weight;

  int NumMoving() const {
    int count = 0;
    for (const float w : weight) {
      count += w > 0.f ? 1 : 0;
    }
    return count;
  }
};

// An image of another camera.
struct OffsetSource {
  Camera camera;
  Image<float> gray;
  Image<float> depth;  // May be empty.
};

// A drawn wall with its true depths, of which a test spoils one input.
class MeasureOffsetsTest : public testing::Test {
 protected:
  MeasureOffsetsTest() : device_(CreateTestDevice(2)) {
    SyntheticViewsOptions options;
    options.has_bare_part = false;
    SyntheticViews drawn = MakeSyntheticViews(options);
    camera_ = drawn.views[0].camera;
    gray_ = GrayOf(drawn.views[0]);
    depth_ = std::move(drawn.truth);
    normal_ = Image<Vec3f>(depth_.Width(), depth_.Height(), drawn.wall.normal);
    for (const ViewData* view : drawn.Sources()) {
      sources_.push_back({view->camera, GrayOf(*view), view->depth});
    }
    resolution_.error_per_depth = 1.f / static_cast<float>(0.3 * camera_.fx);
  }

  Image<float> GrayOf(const ViewData& view) const {
    const DeviceImage<Rgb> color(*device_, view.color);
    return ComputeGray(color.View(), *device_).ToHost();
  }

  MeasuredOffsets Measure(int num_threads = 2) const {
    const std::unique_ptr<Device> device = CreateTestDevice(num_threads);
    DeviceCopies on_device(*device);
    const int width = depth_.Width();
    const int height = depth_.Height();
    ComposedMap composed;
    composed.map.depth = DeviceImage<float>(*device, depth_);
    composed.map.normal = DeviceImage<Vec3f>(*device, normal_);
    composed.provenance = DeviceImage<uint8_t>(
        *device,
        Image<uint8_t>(
            width, height, static_cast<uint8_t>(Provenance::kMeasured)));
    std::vector<DeviceImage<GrayPair>> grays;
    std::vector<SourceView> views;
    for (const OffsetSource& source : sources_) {
      grays.push_back(PairGray(on_device(source.gray), *device));
      views.push_back({source.camera.GetIntrinsics(),
                       ComputeRelativePose(camera_, source.camera),
                       grays.back().View(),
                       on_device(source.depth)});
    }
    const Buffer<SourceView> buffer(*device, views);
    const PhotometricOffsets offsets = MeasureOffsets(composed,
                                                      {camera_.GetIntrinsics(),
                                                       on_device(gray_),
                                                       buffer,
                                                       resolution_,
                                                       noise_},
                                                      options_,
                                                      *device);
    MeasuredOffsets measured{offsets.offset.ToHost(), offsets.weight.ToHost()};
    ExpectWellFormed(measured);
    return measured;
  }

  // Whatever comes in, what comes out can be averaged.
  void ExpectWellFormed(const MeasuredOffsets& measured) const {
    ASSERT_TRUE(measured.offset.HasSizeOf(depth_));
    ASSERT_TRUE(measured.weight.HasSizeOf(depth_));
    for (size_t i = 0; i < depth_.NumPixels(); ++i) {
      const float offset = measured.offset.Data()[i];
      const float weight = measured.weight.Data()[i];
      ASSERT_TRUE(std::isfinite(offset)) << i;
      ASSERT_TRUE(std::isfinite(weight)) << i;
      ASSERT_TRUE(weight >= 0.f || weight == PhotometricOffsets::kNeverMoves)
          << i << ": " << weight;
      ASSERT_TRUE(weight <= 0.f || std::abs(offset) <= options_.max_offset)
          << i << ": " << offset;
    }
  }
  // With pixels that have texture, which would move if the sources told how.
  void ExpectNothingToMove() const {
    const MeasuredOffsets measured = Measure();
    int num_could = 0;
    for (const float weight : measured.weight) {
      ASSERT_LE(weight, 0.f);
      num_could += weight == 0.f ? 1 : 0;
    }
    EXPECT_GT(num_could, 0.9 * static_cast<double>(depth_.NumPixels()));
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  Image<float> gray_;
  Image<float> depth_;
  Image<Vec3f> normal_;
  std::vector<OffsetSource> sources_;
  DepthResolution resolution_;
  NoiseCurve noise_{1.f, 0.f};
  PhotometricOptions options_;
};

}  // namespace tsar
