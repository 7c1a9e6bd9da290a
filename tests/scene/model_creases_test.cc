// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Planes of a scene that begin where others end.

#include "colmap_tsar/scene/model_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "tests/run/counting_device.h"
#include "tests/run/drawn_room_fixture.h"
#include "tests/support/synthetic_observations.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tsar {
namespace {

// The height of the ceiling; y points down.
constexpr double kCeiling = -0.95;
// One pixel spans this much in the corner of the room.
constexpr double kPixel = 5.0 / 90.0;

SyntheticRoom RoomWithCeiling() {
  DrawnSurface ceiling;
  ceiling.plane = PlaneThrough({0.0, 1.0, 0.0}, {-0.5, kCeiling, 4.0});
  ceiling.middle = {-0.5, kCeiling, 4.0};
  return SyntheticRoom({ceiling}, 4);
}

class ModelCreasesTest : public DrawnRoomTest {
 protected:
  static constexpr int kCeilingSurface = 3;

  ModelCreasesTest() : DrawnRoomTest(RoomWithCeiling()) {}

  // Nothing is measured of the ceiling. It has a brightness, as walls and floor
  // have.
  void MakeCeilingBare() {
    Paint([](int surface, const Eigen::Vector3d&) {
      return std::vector<double>{140.0, 130.0, 90.0, 150.0}[surface];
    });
    for (size_t view = 0; view < views_.size(); ++view) {
      ViewEvidence& evidence = room_.evidence[view];
      Forget(
          [&](int, int i) {
            const RayDepth& sample = evidence.observations[i].sample;
            return room_.Hit(room_.cameras[view], {sample.x, sample.y, 1.0})
                       .first == kCeilingSurface;
          },
          &evidence);
      // Candidates of the surfaces, for three views.
      std::vector<Plane>& candidates = room_.evidence[view].candidates;
      for (size_t i = room_.surfaces.size(); i > 0; --i) {
        if ((i - 1) % room_.surfaces.size() == kCeilingSurface) {
          candidates.erase(candidates.begin() +
                           static_cast<std::ptrdiff_t>(i - 1));
        }
      }
    }
  }

  // gray: of a surface and a point on it.
  void Paint(const std::function<double(int surface,
                                        const Eigen::Vector3d& point)>& gray) {
    for (size_t view = 0; view < views_.size(); ++view) {
      const Camera& camera = room_.cameras[view];
      ViewEvidence& evidence = room_.evidence[view];
      for (int y = 0; y < SyntheticRoom::kHeight; ++y) {
        for (int x = 0; x < SyntheticRoom::kWidth; ++x) {
          const Eigen::Vector3d ray(
              (x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
          const auto [surface, depth] = room_.Hit(camera, ray);
          const Eigen::Vector3d point =
              camera.Center() + depth * (camera.rotation.transpose() * ray);
          const auto byte =
              static_cast<uint8_t>(std::lround(gray(surface, point)));
          evidence.color(x, y) = {byte, byte, byte};
          evidence.gray(x, y) = byte;
        }
      }
    }
  }

  // The number of the model's horizontal plane at the ceiling's height, or -1.
  static int FindCeiling(const SceneModel& model) {
    for (size_t i = 0; i < model.planes.size(); ++i) {
      const WorldPlane& plane = model.planes[i].plane;
      if (std::abs(plane.normal.y()) > 0.999 &&
          std::abs(plane.Height({-0.5, kCeiling, 4.0})) < 1.5 * kPixel) {
        return static_cast<int>(i);
      }
    }
    return -1;
  }

  // Superpixels that show nothing but the ceiling, and the share of them that
  // are labeled with a plane.
  double ShareOfCeiling(const SceneModel& model, int plane) const {
    int num_ceiling = 0;
    int num_labeled = 0;
    for (size_t view = 0; view < views_.size(); ++view) {
      const std::vector<int>& labels =
          model.views.at(views_[view].image).planes;
      for (size_t k = 0; k < labels.size(); ++k) {
        if (room_.seen[view][k] == kCeilingSurface) {
          ++num_ceiling;
          num_labeled += labels[k] == plane;
        }
      }
    }
    EXPECT_GE(num_ceiling, 30);
    return static_cast<double>(num_labeled) / num_ceiling;
  }
};

TEST_F(ModelCreasesTest, ACeilingOfWhichNothingWasMeasured) {
  MakeCeilingBare();
  const SceneModel model = *Run();
  const int ceiling = FindCeiling(model);
  ASSERT_GE(ceiling, 0);
  const ModelPlane& plane = model.planes[ceiling];
  EXPECT_EQ(plane.frame, 0);
  EXPECT_EQ(plane.support, 0.0);
  // In the corner, other views mistake it for the left wall.
  EXPECT_GT(ShareOfCeiling(model, ceiling), 0.8);
  // What is measured is labeled as it was.
  for (size_t view = 0; view < views_.size(); ++view) {
    const ViewLabels& labels = model.views.at(views_[view].image);
    for (size_t k = 0; k < labels.planes.size(); ++k) {
      const int surface = room_.seen[view][k];
      if (surface >= 0 && surface != kCeilingSurface) {
        EXPECT_EQ(labels.planes[k], Find(room_.surfaces[surface], model))
            << view << " " << k;
        EXPECT_EQ(labels.origins[k], LabelOrigin::kMeasured);
      }
    }
  }
  EXPECT_THAT(text_.str(), testing::HasSubstr("Model, lines: [4/4]"));
  EXPECT_THAT(text_.str(), testing::HasSubstr("Model, creases: [4/4]"));
  EXPECT_THAT(text_.str(),
              testing::HasSubstr("Model, labels within creases: [4/4]"));
}

// Along a line of four views, noise averages out. The denoised image shows
// nothing.
TEST_F(ModelCreasesTest, ACeilingInNoiseAsStrongAsItsStep) {
  MakeCeilingBare();
  for (ViewEvidence& evidence : room_.evidence) {
    std::ranges::fill(evidence.color, Rgb{100, 100, 100});
  }
  Philox random(9, 0, 0);
  for (ViewEvidence& evidence : room_.evidence) {
    for (uint8_t& gray : evidence.gray) {
      gray =
          static_cast<uint8_t>(std::lround(gray + 10.0 * NextNormal(&random)));
    }
  }
  const SceneModel model = *Run();
  const int ceiling = FindCeiling(model);
  ASSERT_GE(ceiling, 0);
  EXPECT_GT(ShareOfCeiling(model, ceiling), 0.8);
}

// What views would tell each other from before creases were known is void.
TEST_F(ModelCreasesTest, LabelsWithinCreasesBeginAnew) {
  options_.num_sweeps = 1;
  MakeCeilingBare();
  const SceneModel model = *Run();
  const int ceiling = FindCeiling(model);
  ASSERT_GE(ceiling, 0);
  EXPECT_EQ(ShareOfCeiling(model, ceiling), 1.0);
}

// Color cannot contradict them.
TEST_F(ModelCreasesTest, ThreeViewsDoNotGuess) {
  MakeCeilingBare();
  views_.pop_back();
  for (SceneView& view : views_) {
    std::erase(view.sources, views_.size());
  }
  const SceneModel model = *Run();
  EXPECT_GE(FindCeiling(model), 0);
  for (const auto& [image, labels] : model.views) {
    EXPECT_THAT(labels.origins,
                testing::Not(testing::Contains(LabelOrigin::kGuessed)));
  }
}

TEST_F(ModelCreasesTest, WithoutTheOptionThereIsNone) {
  refine_options_.bounding_creases = false;
  MakeCeilingBare();
  const SceneModel model = *Run();
  EXPECT_EQ(FindCeiling(model), -1);
  EXPECT_EQ(model.planes.size(), 3u);
  EXPECT_THAT(text_.str(), testing::Not(testing::HasSubstr("creases")));
}

TEST_F(ModelCreasesTest, DoNotDependOnTheResources) {
  MakeCeilingBare();
  const SceneModel one = *Run();
  ASSERT_GE(FindCeiling(one), 0);
  ExpectSameWithMoreResources(one);
  CountingDevice gpu("GPU", SIZE_MAX);
  resources_.gpus = {{"GPU", &gpu}};
  ExpectSame(one, *Run());
  EXPECT_GT(gpu.NumAllocations(), 0);
}

// The wall and what is above the stripe were measured.
TEST_F(ModelCreasesTest, APaintedStripeIsNoCrease) {
  Paint([](int surface, const Eigen::Vector3d& point) {
    return surface == 0 && point.y() < 0.2 && point.y() > 0.05 ? 160.0 : 100.0;
  });
  const SceneModel with = *Run();
  EXPECT_THAT(text_.str(), testing::HasSubstr("Model, creases: [4/4]"));
  EXPECT_EQ(with.planes.size(), room_.surfaces.size());
  refine_options_.bounding_creases = false;
  ExpectSame(with, *Run());
}

TEST_F(ModelCreasesTest, StopWhenAsked) {
  MakeCeilingBare();
  for (const char* name : {"lines", "creases", "within creases"}) {
    EXPECT_FALSE(Run([&] {
      return text_.str().find(name) != std::string::npos;
    })) << name;
  }
}

}  // namespace
}  // namespace tsar
