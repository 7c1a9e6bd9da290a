// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/scene/labeling/refine_borders.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

#include "tests/cuda/cuda_test.h"
#include "tests/cuda/observed_room.h"
#include "tests/support/label_view.h"
#include "tests/support/synthetic_room.h"

namespace tsar {
namespace {

TEST_F(CudaTest, DiscoverPlanes) {
  const SyntheticRoom room;
  const auto run = [&](Device& device) {
    const DiscoveredPlanes found =
        DiscoverPlanes(room.Views(), room.Candidates(), {}, device);
    std::vector<double> numbers;
    for (const ScenePlane& plane : found.planes) {
      numbers.insert(
          numbers.end(), plane.plane.normal.begin(), plane.plane.normal.end());
      numbers.push_back(plane.plane.offset);
      numbers.push_back(plane.support);
    }
    StageResult result;
    result.Add("planes", numbers);
    for (const std::vector<int>& of_view : found.assignment) {
      result.Add("assignment", of_view);
    }
    return result;
  };
  const StageResult on_cpu = run(*cpu_);
  EXPECT_EQ(on_cpu.Channels()[0].values.size(), 3u * 5u);
  EXPECT_EQ(FindDifferences(on_cpu, run(*cuda_)), "");
}

TEST_F(CudaTest, LabelView) {
  const SyntheticRoom room = RoomWithADisc();
  const std::vector<ViewEvidence> evidence = ObserveInPart(room);
  std::vector<ObservedView> views;
  for (size_t i = 0; i < room.cameras.size(); ++i) {
    views.push_back({&evidence[i], room.cameras[i]});
  }
  const DiscoveredPlanes discovered =
      DiscoverPlanes(views, room.Candidates(), {}, *cpu_);
  const PlaneSupport support = FindPlaneSupport(views, discovered, {});
  for (size_t num_views = 1; num_views <= views.size(); ++num_views) {
    const std::vector<ObservedView> seen_by(
        views.begin(), views.begin() + static_cast<std::ptrdiff_t>(num_views));
    // The other views were labeled with what they measured.
    std::vector<VotingLabels> source_labels;
    for (size_t i = 1; i < num_views; ++i) {
      source_labels.push_back(
          {discovered.assignment[i],
           std::vector<float>(discovered.assignment[i].size(),
                              i == 1 ? 1.f : 0.4f)});
    }
    const auto run = [&](Device& device) {
      return LabelView(seen_by, discovered, support, {}, device, source_labels);
    };
    const auto numbers = [](const LabeledView& labeled) {
      StageResult result;
      result.Add("planes", labeled.planes);
      result.Add("labels", labeled.labels);
      result.Add("evidence", labeled.evidence);
      result.Add("qualities", labeled.qualities);
      result.Add("strengths", labeled.strengths);
      return result;
    };
    const LabeledView on_cpu = run(*cpu_);
    if (num_views == views.size()) {
      // Something of everything is there to be compared.
      EXPECT_EQ(
          std::set<int>(on_cpu.labels.begin(), on_cpu.labels.end()).size(),
          room.surfaces.size() + 1);
      EXPECT_EQ(std::set<LabelEvidence>(on_cpu.evidence.begin(),
                                        on_cpu.evidence.end())
                    .size(),
                4u);
    }
    EXPECT_EQ(FindDifferences(numbers(on_cpu), numbers(run(*cuda_))), "")
        << num_views << " views";
  }
}

// Colors and measurements at random, so that many votes are close.
TEST_F(CudaTest, RefineBorders) {
  constexpr int kWidth = 130;
  constexpr int kHeight = 90;
  constexpr int kSize = 15;
  constexpr int kNumColumns = (kWidth + kSize - 1) / kSize;
  constexpr int kNumSuperpixels = kNumColumns * (kHeight / kSize);
  const std::vector<Plane> planes = {{{0.f, 0.f, -1.f}, 4.f},
                                     {{0.6f, 0.f, -0.8f}, 3.f},
                                     {{0.f, -0.28f, -0.96f}, 3.5f}};
  Philox random(60, 0, 0);
  std::vector<int> labels(kNumSuperpixels);
  for (int& label : labels) {
    label = static_cast<int>(random.NextBelow(4)) - 1;
  }
  Image<uint16_t> superpixels(kWidth, kHeight);
  Image<Vec3f> lab(kWidth, kHeight);
  Image<float> depth(2 * kWidth, 2 * kHeight);
  Image<uint8_t> flags(2 * kWidth, 2 * kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      superpixels(x, y) =
          static_cast<uint16_t>(y / kSize * kNumColumns + x / kSize);
      lab(x, y) = {50.f + 10.f * random.NextFloat(),
                   5.f * random.NextFloat(),
                   5.f * random.NextFloat()};
    }
  }
  for (size_t i = 0; i < depth.NumPixels(); ++i) {
    depth.Data()[i] = 3.f + 1.5f * random.NextFloat();
    flags.Data()[i] = random.NextBelow(2) == 0 ? 0 : 255;
  }
  const auto run = [&](Device& device) {
    const DeviceImage<uint16_t> device_superpixels(device, superpixels);
    const DeviceImage<Vec3f> device_lab(device, lab);
    const DeviceImage<float> device_depth(device, depth);
    DeviceImage<uint8_t> device_flags(device, flags);
    const RefinedBorders refined =
        RefineBorders({device_superpixels.View(),
                       device_lab.View(),
                       device_depth.View(),
                       std::as_const(device_flags).View(),
                       {100.f, 100.f, 64.5f, 44.5f},
                       DepthResolution{0.0025f}},
                      labels,
                      planes,
                      {},
                      device);
    DistrustFattened(refined.fattened.View(), device_flags.View(), device);
    StageResult result;
    result.Add("superpixels", refined.superpixels);
    result.Add("fattened", refined.fattened);
    result.Add("flags", device_flags);
    return result;
  };
  const StageResult on_cpu = run(*cpu_);
  const std::vector<double>& fattened = on_cpu.Channels()[1].values;
  EXPECT_NE(std::count(fattened.begin(), fattened.end(), 1.0), 0);
  EXPECT_EQ(FindDifferences(on_cpu, run(*cuda_)), "");
}

}  // namespace
}  // namespace tsar
