// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/photometric_offset.h"

#include "colmap_tsar/matching/gray_pair.h"

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/for_each_pixel.h"
#include "tests/support/same_bytes.h"
#include "tests/support/synthetic_views.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

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

// A drawn wall with its true depths; each test invalidates one input.
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

  MeasuredOffsets Measure() const {
    Device* const device = device_.get();
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
                                                      *device);
    MeasuredOffsets measured{offsets.offset.ToHost(), offsets.weight.ToHost()};
    ExpectWellFormed(measured);
    return measured;
  }

  // Whatever the input, the result can be averaged.
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
      ASSERT_TRUE(weight <= 0.f || std::abs(offset) <= kMaxPhotometricOffset)
          << i << ": " << offset;
    }
  }
  // Some pixels have texture and would move if the sources gave an offset.
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
};

// Textured at any sampling.
Image<float> Checkers(int width, int height) {
  Image<float> gray(width, height);
  ForEachPixel(width, height, [&](int x, int y) {
    gray(x, y) = (x + y) % 2 == 0 ? 50.f : 200.f;
  });
  return gray;
}

// Turned by half a circle about the vertical axis.
OffsetSource LookingAway(OffsetSource source) {
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
  turned(0, 0) = turned(2, 2) = -1.0;
  source.camera.rotation = turned * source.camera.rotation;
  source.camera.translation = turned * source.camera.translation;
  return source;
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNeverMoves = PhotometricOffsets::kNeverMoves;

// Otherwise the tests below would be meaningless.
TEST_F(MeasureOffsetsTest, MeasuresUnspoiltInputs) {
  const MeasuredOffsets measured = Measure();
  EXPECT_GT(measured.NumMoving(),
            0.5 * static_cast<double>(depth_.NumPixels()));
  for (size_t i = 0; i < depth_.NumPixels(); ++i) {
    if (measured.weight.Data()[i] > 0.f) {
      ASSERT_LT(std::abs(measured.offset.Data()[i]), 0.1f) << i;
    }
  }
}

// A pixel without a valid depth has no offset and does not affect its
// neighbors.
TEST_F(MeasureOffsetsTest, DepthsThatAreNoneStayAlone) {
  const MeasuredOffsets whole = Measure();
  const std::vector<float> depths = {kNan,
                                     kInfinity,
                                     -kInfinity,
                                     0.f,
                                     -5.f,
                                     std::numeric_limits<float>::denorm_min(),
                                     std::numeric_limits<float>::min(),
                                     std::numeric_limits<float>::max()};
  std::vector<bool> is_spoilt(depth_.NumPixels(), false);
  for (size_t k = 0; k < depths.size(); ++k) {
    const int x = 30 + 4 * static_cast<int>(k);
    const int y = 30;
    ASSERT_GT(whole.weight(x, y), 0.f) << x;
    depth_(x, y) = depths[k];
    is_spoilt[static_cast<size_t>(y) * static_cast<size_t>(depth_.Width()) +
              static_cast<size_t>(x)] = true;
  }
  const MeasuredOffsets measured = Measure();
  for (size_t i = 0; i < depth_.NumPixels(); ++i) {
    if (is_spoilt[i]) {
      // One that no source can see may take its neighbors' offset.
      const float depth = depth_.Data()[i];
      EXPECT_LE(measured.weight.Data()[i], depth > 0.f ? 0.f : kNeverMoves)
          << depth;
    } else {
      ASSERT_EQ(measured.weight.Data()[i], whole.weight.Data()[i]) << i;
      ASSERT_EQ(measured.offset.Data()[i], whole.offset.Data()[i]) << i;
    }
  }
}

TEST_F(MeasureOffsetsTest, NormalsThatAreNoneMoveNothing) {
  // The second one sees the surface from behind, the third one is edge-on.
  const Vec3f ray = camera_.GetIntrinsics().Ray(48, 36);
  for (const Vec3f& normal : {Vec3f{0.f, 0.f, 0.f},
                              Vec3f{kNan, kNan, kNan},
                              Vec3f{-ray.z, 0.f, ray.x},
                              Vec3f{0.f, 0.f, kInfinity}}) {
    normal_(48, 36) = normal;
    EXPECT_EQ(Measure().weight(48, 36), kNeverMoves)
        << normal.x << " " << normal.y << " " << normal.z;
  }
}

// Checkers of a size, seen from where the source is.
OffsetSource OfSize(const OffsetSource& source, int width, int height) {
  return {source.camera.Resized(width, height), Checkers(width, height), {}};
}

OffsetSource OfLevel(OffsetSource source, float level) {
  source.gray = Image<float>(source.gray.Width(), source.gray.Height(), level);
  return source;
}

// Sources that look away or lie behind the surface, have no baseline or an
// invalid position, are empty, or are too small for a window.
TEST_F(MeasureOffsetsTest, SourcesThatCannotTellMoveNothing) {
  using Spoil = std::function<OffsetSource(OffsetSource)>;
  std::map<std::string, Spoil> cases = {
      {"looks away", LookingAway},
      {"beyond the surface",
       [](OffsetSource source) {
         source.camera.translation.z() -= 20.0;
         return source;
       }},
      {"in the place of the reference",
       [this](const OffsetSource&) {
         return OffsetSource{camera_, gray_, {}};
       }},
      {"no place",
       [](OffsetSource source) {
         source.camera.translation.x() = kNan;
         return source;
       }},
      {"empty", [](const OffsetSource& source) {
         return OffsetSource{source.camera, {}, {}};
       }}};
  for (const float level : {0.f, 128.f, kNan, kInfinity}) {
    cases["constant " + std::to_string(level)] = [=](OffsetSource source) {
      return OfLevel(source, level);
    };
  }
  for (const auto& [width, height] : {std::pair{1, 1},
                                      std::pair{6, 6},
                                      std::pair{4000, 1},
                                      std::pair{1, 4000}}) {
    cases[std::to_string(width) + " x " + std::to_string(height)] =
        [w = width, h = height](const OffsetSource& source) {
          return OfSize(source, w, h);
        };
  }
  const std::vector<OffsetSource> sources = sources_;
  for (const auto& [name, spoil] : cases) {
    SCOPED_TRACE(name);
    sources_.clear();
    for (const OffsetSource& source : sources) {
      sources_.push_back(spoil(source));
    }
    ExpectNothingToMove();
  }
  sources_.clear();
  ExpectNothingToMove();
}

// Images without texture above the noise, of one pixel, or of none.
TEST_F(MeasureOffsetsTest, ImagesThatCannotTellNeverMove) {
  const auto expect_none = [this] {
    for (const float weight : Measure().weight) {
      ASSERT_EQ(weight, kNeverMoves);
    }
  };
  for (const float variance : {1e4f, kInfinity, kNan}) {
    noise_.constant = variance;
    expect_none();
  }
  noise_.constant = 1.f;
  for (const float level : {0.f, 128.f, kNan, kInfinity}) {
    gray_ = Image<float>(gray_.Width(), gray_.Height(), level);
    expect_none();
  }
  camera_ = camera_.Resized(1, 1);
  gray_ = Image<float>(1, 1, 100.f);
  depth_ = Image<float>(1, 1, 5.f);
  normal_ = Image<Vec3f>(1, 1, {0.f, 0.f, -1.f});
  expect_none();
  gray_ = depth_ = Image<float>();
  normal_ = Image<Vec3f>();
  expect_none();
}

// Without a baseline, offsets have no depth.
TEST_F(MeasureOffsetsTest, ResolutionsThatTellNoDepthMoveNothing) {
  for (const float error : {0.f, kNan, kInfinity, -kInfinity}) {
    resolution_.error_per_depth = error;
    ExpectNothingToMove();
  }
}

// A source that does not see the wall does not affect four others that do.
TEST_F(MeasureOffsetsTest, ASourceThatSeesNothingIsAsGoodAsNone) {
  const MeasuredOffsets without = Measure();
  for (const OffsetSource& blind :
       {OffsetSource{sources_[0].camera, {}, {}}, LookingAway(sources_[0])}) {
    sources_.insert(sources_.begin(), blind);
    const MeasuredOffsets with = Measure();
    EXPECT_TRUE(SameBytes(with.weight, without.weight));
    EXPECT_TRUE(SameBytes(with.offset, without.offset));
    sources_.erase(sources_.begin());
  }
}

// Only valid depths occlude a pixel.
TEST_F(MeasureOffsetsTest, SourceDepthsThatAreNoneHideNothing) {
  for (OffsetSource& source : sources_) {
    source.depth = Image<float>();
  }
  const MeasuredOffsets open = Measure();
  EXPECT_GT(open.NumMoving(), 0);
  for (const float depth : {kNan, 0.f, -1.f, kInfinity}) {
    for (OffsetSource& source : sources_) {
      source.depth =
          Image<float>(source.gray.Width(), source.gray.Height(), depth);
    }
    const MeasuredOffsets measured = Measure();
    EXPECT_TRUE(SameBytes(measured.weight, open.weight));
  }
}

// With images of other sizes, the wall is at the same place.
TEST_F(MeasureOffsetsTest, MeasuresWithSourcesOfAnotherSize) {
  for (const int factor : {2, 16}) {
    for (OffsetSource& source : sources_) {
      const int width = camera_.width * factor;
      const int height = camera_.height * factor;
      Image<float> gray(width, height);
      ForEachPixel(width, height, [&](int x, int y) {
        // The value of the large pixel that contains its center.
        gray(x, y) = source.gray(x * source.gray.Width() / width,
                                 y * source.gray.Height() / height);
      });
      source = {source.camera.Resized(width, height), std::move(gray), {}};
    }
    EXPECT_GT(Measure().NumMoving(), 0) << factor;
  }
}

}  // namespace
}  // namespace tsar
