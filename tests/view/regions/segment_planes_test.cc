// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/regions/assign_region_planes.h"

#include <vector>

#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 12;
constexpr float kMaxGap = 0.02f;

// Faces the camera.
Plane At(float depth) { return {{0.f, 0.f, -1.f}, depth}; }

// One row of pixels, of which the first ten are one segment, whose own plane is
// at depth 4.
class SegmentPlanesTest : public testing::Test {
 protected:
  SegmentPlanesTest()
      : device_(CreateTestDevice(2)),
        labels_(kWidth, 1, -1),
        samples_(kWidth, 1),
        of_segments_(kWidth, 1),
        of_regions_(kWidth, 1) {
    for (int x = 0; x < 10; ++x) {
      labels_(x, 0) = 0;
      of_segments_(x, 0) = At(4.f);
    }
  }
  // count samples at one depth, from a pixel on.
  void Measure(int first, int count, float depth) {
    for (int x = first; x < first + count; ++x) {
      samples_(x, 0) = {0.f, 0.f, depth};
    }
  }
  void SetRegion(int first, int count, float depth) {
    for (int x = first; x < first + count; ++x) {
      of_regions_(x, 0) = At(depth);
    }
  }
  // The depths of the planes of all pixels; 0: none.
  std::vector<float> Take() const {
    DeviceImage<Plane> planes(*device_, of_regions_);
    TakePlanesOfSegments({DeviceImage<int>(*device_, labels_), 1},
                         DeviceImage<RayDepth>(*device_, samples_).View(),
                         DeviceImage<Plane>(*device_, of_segments_).View(),
                         kMaxGap,
                         planes.View(),
                         *device_);
    std::vector<float> depths;
    for (const Plane& plane : planes.ToHost()) {
      depths.push_back(plane.Valid() ? plane.Depth({0.f, 0.f, 1.f}) : 0.f);
    }
    return depths;
  }

  std::unique_ptr<Device> device_;
  Image<int> labels_;
  Image<RayDepth> samples_;
  Image<Plane> of_segments_;
  Image<Plane> of_regions_;
};

std::vector<float> Depths(float first_four, float next_six, float last_two) {
  std::vector<float> depths(4, first_four);
  depths.insert(depths.end(), 6, next_six);
  depths.insert(depths.end(), 2, last_two);
  return depths;
}

TEST_F(SegmentPlanesTest, ReplaceWhatMostSamplesContradict) {
  SetRegion(0, 12, 5.f);
  Measure(0, 3, 4.f);
  Measure(3, 2, 5.f);
  // Beyond the segment, whatever is measured there.
  Measure(10, 2, 4.f);
  EXPECT_EQ(Take(), Depths(4.f, 4.f, 5.f));
}

TEST_F(SegmentPlanesTest, LeaveWhatMostSamplesConfirm) {
  SetRegion(0, 12, 5.f);
  Measure(0, 2, 4.f);
  Measure(2, 3, 5.f);
  EXPECT_EQ(Take(), Depths(5.f, 5.f, 5.f));
  // Also beside the pixels that it has one for.
  of_regions_(9, 0) = {};
  EXPECT_EQ(Take()[9], 0.f);
  // A plane as good as that of the segment stays, too: within the gap, whose
  // samples are nearer is a question of noise.
  SetRegion(0, 12, 4.07f);
  Measure(0, 5, 4.f);
  EXPECT_EQ(Take(), Depths(4.07f, 4.07f, 4.07f));
}

TEST_F(SegmentPlanesTest, AreNotTakenOnTrust) {
  // Nothing is measured, or nothing where regions have planes.
  SetRegion(4, 8, 5.f);
  EXPECT_EQ(Take(), Depths(0.f, 5.f, 5.f));
  Measure(0, 4, 4.f);
  EXPECT_EQ(Take(), Depths(0.f, 5.f, 5.f));
  // Both planes are contradicted.
  Measure(0, 10, 7.f);
  EXPECT_EQ(Take(), Depths(0.f, 5.f, 5.f));
}

TEST_F(SegmentPlanesTest, AreTakenAlsoBesideThePlanesThatTheyContradict) {
  SetRegion(0, 4, 5.f);
  Measure(0, 10, 4.f);
  of_segments_(9, 0) = {};
  std::vector<float> expected = Depths(4.f, 4.f, 0.f);
  expected[9] = 0.f;
  EXPECT_EQ(Take(), expected);
}

}  // namespace
}  // namespace tsar
