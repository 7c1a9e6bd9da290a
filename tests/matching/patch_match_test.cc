// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/patch_match.h"

#include "colmap_tsar/matching/plane_maps.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "tests/matching/textured_plane.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr int kMargin = 8;
constexpr float kMaxCost = 2.f;
constexpr Vec3f kTilt = {0.3f, -0.2f, -1.f};
constexpr Vec3f kSlant = {1.f, 0.3f, -1.f};

template <typename T>
bool SameBytes(const Image<T>& a, const Image<T>& b) {
  return a.HasSizeOf(b) &&
         std::memcmp(a.Data(), b.Data(), a.NumPixels() * sizeof(T)) == 0;
}

struct HostHypotheses {
  Image<Plane> planes;
  Image<float> costs;
};

// How near planes are to the truth, over the pixels off the border.
struct Accuracy {
  float share = 0.f;  // Of the pixels within half a percent of the depth.
  float median_depth_error = 0.f;   // As a fraction of depth.
  float median_normal_error = 0.f;  // In degrees.
};

class PatchMatchTest : public testing::Test {
 protected:
  PatchMatchTest()
      : device_(Device::CreateCpu(2)),
        camera_(DrawnCamera(kWidth, kHeight, 100.0)),
        intrinsics_(camera_.GetIntrinsics()) {
    options_.depth_min = 1.5f;
    options_.depth_max = 6.f;
  }

  TexturedPlane BareScene(const Vec3f& direction) {
    return TexturedPlane(DrawnPlane(direction, 3.f), camera_, *device_);
  }
  // Seen by four sources that have depth maps.
  TexturedPlane Scene(const Vec3f& direction) {
    TexturedPlane scene = BareScene(direction);
    AddSources(&scene);
    return scene;
  }
  void AddSources(TexturedPlane* scene) {
    for (const double sign : {-1.0, 1.0}) {
      scene->AddSource(
          SourceCamera(camera_, {0.5 * sign, 0.0, 0.0}, -0.15 * sign));
      scene->AddSource(SourceCamera(camera_, {0.1, 0.4 * sign, 0.0}, 0.0));
    }
  }
  // The sources of a scene without their depth maps, with all lengths scaled.
  Buffer<SourceView> Images(TexturedPlane& scene, float scale = 1.f) {
    std::vector<SourceView> sources = scene.Sources().ToHost();
    for (SourceView& source : sources) {
      source.depth = {};
      source.from_reference.translation =
          source.from_reference.translation * scale;
    }
    return Buffer<SourceView>(*device_, sources);
  }

  DeviceImage<Plane> Draw(uint32_t stream = 1) {
    return DrawPlanes(intrinsics_, kWidth, kHeight, stream, options_, *device_);
  }
  DeviceImage<Plane> TruePlanes(const TexturedPlane& scene) {
    const ReferenceView reference = scene.Reference();
    return PlanesFromMaps(
        intrinsics_, reference.depth, reference.normal, *device_);
  }
  HostHypotheses Run(const TexturedPlane& scene,
                     const Buffer<SourceView>& sources,
                     DeviceImage<Plane> planes,
                     uint32_t stream = 1) {
    ReferenceView reference = scene.Reference();
    reference.depth = {};
    reference.normal = {};
    const PlaneHypotheses hypotheses = RunPatchMatch(
        {reference, sources, stream}, std::move(planes), options_, *device_);
    return {hypotheses.planes.ToHost(), hypotheses.costs.ToHost()};
  }

  Accuracy Compare(TexturedPlane& scene, const Image<Plane>& planes) const {
    const ReferenceView truth = scene.Reference();
    std::vector<float> depth_errors;
    std::vector<float> normal_errors;
    int num_near = 0;
    for (int y = kMargin; y < kHeight - kMargin; ++y) {
      for (int x = kMargin; x < kWidth - kMargin; ++x) {
        const float depth = planes(x, y).Depth(intrinsics_.Ray(x, y));
        depth_errors.push_back(std::abs(depth / truth.depth(x, y) - 1.f));
        normal_errors.push_back(
            AngleBetween(planes(x, y).normal, truth.normal(x, y)));
        num_near += depth_errors.back() < 0.005f ? 1 : 0;
      }
    }
    const auto median = [](std::vector<float>& errors) {
      std::nth_element(
          errors.begin(), errors.begin() + errors.size() / 2, errors.end());
      return errors[errors.size() / 2];
    };
    return {static_cast<float>(num_near) / depth_errors.size(),
            median(depth_errors),
            median(normal_errors)};
  }

  void ExpectFound(TexturedPlane& scene, const Image<Plane>& planes) const {
    const Accuracy accuracy = Compare(scene, planes);
    EXPECT_GT(accuracy.share, 0.98f);
    EXPECT_LT(accuracy.median_depth_error, 1e-3f);
    EXPECT_LT(accuracy.median_normal_error, 4.f);
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  Intrinsics intrinsics_;
  PatchMatchOptions options_;
};

TEST_F(PatchMatchTest, DrawsPlanesBetweenTheBounds) {
  const Image<Plane> planes = Draw().ToHost();
  int num_in_nearer_half = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec3f ray = intrinsics_.Ray(x, y);
      const Plane& plane = planes(x, y);
      ASSERT_NEAR(Norm(plane.normal), 1.f, 1e-5f);
      ASSERT_LE(Dot(plane.normal, ray), 0.f);
      // A plane may be seen too nearly from the side to have a depth.
      const float slope = -Dot(plane.normal, ray);
      if (slope > 1e-2f) {
        const float depth = plane.Depth(ray);
        ASSERT_GE(depth, 1.5f * (1.f - 1e-4f));
        ASSERT_LE(depth, 6.f * (1.f + 1e-4f));
        // 1 / 2.4 is the middle of 1 / 1.5 and 1 / 6.
        num_in_nearer_half += depth < 2.4f ? 1 : 0;
      }
    }
  }
  EXPECT_NEAR(num_in_nearer_half, kWidth * kHeight / 2, kWidth * kHeight / 20);
  EXPECT_TRUE(SameBytes(planes, Draw().ToHost()));
  EXPECT_FALSE(SameBytes(planes, Draw(2).ToHost()));
}

TEST_F(PatchMatchTest, FindsThePlane) {
  TexturedPlane scene = Scene(kTilt);
  const Image<Plane> drawn = Draw().ToHost();
  ASSERT_LT(Compare(scene, drawn).share, 0.1f);
  const HostHypotheses found = Run(scene, Images(scene), Draw());
  ExpectFound(scene, found.planes);
  for (int y = kMargin; y < kHeight - kMargin; ++y) {
    for (int x = kMargin; x < kWidth - kMargin; ++x) {
      ASSERT_LT(found.costs(x, y), 0.2f) << x << ", " << y;
    }
  }
}

TEST_F(PatchMatchTest, FindsASlantedPlane) {
  TexturedPlane scene = Scene(kSlant);
  ExpectFound(scene, Run(scene, Images(scene), Draw()).planes);
}

TEST_F(PatchMatchTest, FindsThePlaneWithAWiderWindow) {
  TexturedPlane scene = Scene(kTilt);
  options_.window_radius = 8.f;
  ExpectFound(scene, Run(scene, Images(scene), Draw()).planes);
}

TEST_F(PatchMatchTest, FindsThePlaneWithTheGeometricTerm) {
  TexturedPlane scene = Scene(kTilt);
  ExpectFound(scene, Run(scene, scene.Sources(), Draw()).planes);
}

TEST_F(PatchMatchTest, IgnoresExposureAndViewsOfSomethingElse) {
  TexturedPlane scene = Scene(kTilt);
  for (float& value : scene.SourceGray(1)) {
    value = 0.5f * value + 60.f;
  }
  TexturedPlane other = BareScene(kTilt);
  other.AddSource(SourceCamera(camera_, {0.7, 0.2, 0.5}, -0.4));
  scene.AddSource(SourceCamera(camera_, {0.3, 0.2, 0.0}, -0.1));
  scene.SourceGray(4) = other.SourceGray(0);
  ExpectFound(scene, Run(scene, Images(scene), Draw()).planes);
}

TEST_F(PatchMatchTest, TakesMoreThan32Sources) {
  options_.num_iterations = 3;
  TexturedPlane scene = BareScene(kTilt);
  // They look away: only the last four of forty see the plane.
  for (int i = 0; i < 36; ++i) {
    scene.AddSource(SourceCamera(camera_, {0.01 * i, 0.0, 0.0}, 3.14159265));
  }
  AddSources(&scene);
  const Buffer<SourceView> sources = Images(scene);
  ASSERT_EQ(sources.Size(), 40u);
  EXPECT_GT(Compare(scene, Run(scene, sources, Draw()).planes).share, 0.9f);
}

TEST_F(PatchMatchTest, DoesNotDependOnThreads) {
  TexturedPlane scene = Scene(kTilt);
  options_.num_iterations = 2;
  const auto run = [&](int num_threads) {
    device_ = Device::CreateCpu(num_threads);
    return Run(scene, scene.Sources(), Draw());
  };
  // The scene's buffers are made on the device that it was given.
  const std::unique_ptr<Device> first = std::move(device_);
  const HostHypotheses one = run(1);
  const HostHypotheses four = run(4);
  EXPECT_TRUE(SameBytes(one.planes, four.planes));
  EXPECT_TRUE(SameBytes(one.costs, four.costs));
}

TEST_F(PatchMatchTest, DependsOnTheStreamAlone) {
  TexturedPlane scene = Scene(kTilt);
  options_.num_iterations = 2;
  const Buffer<SourceView> sources = Images(scene);
  const HostHypotheses first = Run(scene, sources, Draw(), 1);
  const HostHypotheses again = Run(scene, sources, Draw(), 1);
  const HostHypotheses other = Run(scene, sources, Draw(), 2);
  EXPECT_TRUE(SameBytes(first.planes, again.planes));
  EXPECT_TRUE(SameBytes(first.costs, again.costs));
  EXPECT_FALSE(SameBytes(first.planes, other.planes));
}

TEST_F(PatchMatchTest, KeepsTheTruth) {
  TexturedPlane scene = Scene(kTilt);
  const HostHypotheses kept = Run(scene, Images(scene), TruePlanes(scene));
  const Accuracy accuracy = Compare(scene, kept.planes);
  EXPECT_EQ(accuracy.share, 1.f);
  EXPECT_LT(accuracy.median_depth_error, 5e-4f);
  EXPECT_LT(accuracy.median_normal_error, 2.f);
}

TEST_F(PatchMatchTest, ChangesLessAfterPastIterations) {
  TexturedPlane scene = Scene(kTilt);
  // So far from the truth that only small steps lead to it.
  Image<float> depth = scene.Depth();
  for (float& value : depth) {
    value *= 1.004f;
  }
  const auto accuracy_after = [&](int num_past_iterations) {
    options_.num_iterations = 1;
    options_.num_past_iterations = num_past_iterations;
    return Compare(scene,
                   Run(scene,
                       Images(scene),
                       PlanesFromMaps(intrinsics_,
                                      std::as_const(depth).View(),
                                      scene.Reference().normal,
                                      *device_))
                       .planes);
  };
  EXPECT_LT(accuracy_after(4).median_depth_error,
            accuracy_after(0).median_depth_error);
  // Steps that are too small for floats leave everything where it is but for
  // the two trials that draw anew.
  EXPECT_NEAR(accuracy_after(100).median_depth_error, 0.004f, 2e-4f);
}

TEST_F(PatchMatchTest, DoesNotDependOnTheUnitOfLength) {
  TexturedPlane scene = Scene(kTilt);
  const HostHypotheses expected = Run(scene, Images(scene), Draw());
  const auto scaled = [&](float scale) {
    options_.depth_min = 1.5f * scale;
    options_.depth_max = 6.f * scale;
    return Run(scene, Images(scene, scale), Draw());
  };
  // Powers of two change no digit.
  const HostHypotheses by_1024 = scaled(1024.f);
  // Others round, and here and there another plane wins for it.
  const HostHypotheses by_1000 = scaled(1000.f);
  int num_near = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec3f ray = intrinsics_.Ray(x, y);
      const float depth = expected.planes(x, y).Depth(ray);
      ASSERT_EQ(by_1024.planes(x, y).Depth(ray), 1024.f * depth);
      ASSERT_EQ(by_1024.planes(x, y).normal, expected.planes(x, y).normal);
      ASSERT_EQ(by_1024.costs(x, y), expected.costs(x, y));
      const float by_1000_depth = by_1000.planes(x, y).Depth(ray);
      num_near += std::abs(by_1000_depth / (1000.f * depth) - 1.f) < 2e-3f;
    }
  }
  EXPECT_GT(num_near, kWidth * kHeight * 95 / 100);
  ExpectFound(scene, expected.planes);
}

// Sums over these numbers of sources round one way or the other; planes that
// cost the same must not win by that.
class UntexturedTest : public PatchMatchTest,
                       public testing::WithParamInterface<int> {
 protected:
  TexturedPlane UntexturedScene() {
    TexturedPlane scene = BareScene(kTilt);
    for (int i = 0; i < GetParam(); ++i) {
      scene.AddSource(SourceCamera(camera_, {0.05 * i, 0.1, 0.0}, -0.015 * i));
    }
    scene.Gray() = Image<float>(kWidth, kHeight, 128.f);
    return scene;
  }
};

TEST_P(UntexturedTest, KeepsThePlanesWithoutTexture) {
  TexturedPlane scene = UntexturedScene();
  const HostHypotheses kept = Run(scene, Images(scene), Draw());
  EXPECT_TRUE(SameBytes(kept.planes, Draw().ToHost()));
  for (const float cost : kept.costs) {
    ASSERT_NEAR(cost, kMaxCost, 1e-5f);
  }
}

TEST_P(UntexturedTest, KeepsThePlanesWithoutTextureAndDepths) {
  TexturedPlane scene = UntexturedScene();
  for (int i = 0; i < GetParam(); ++i) {
    scene.SourceDepth(i) = Image<float>(kWidth, kHeight, 0.f);
  }
  const HostHypotheses kept = Run(scene, scene.Sources(), Draw());
  EXPECT_TRUE(SameBytes(kept.planes, Draw().ToHost()));
  for (const float cost : kept.costs) {
    ASSERT_NEAR(cost, kMaxCost + 0.6f, 1e-5f);
  }
}

INSTANTIATE_TEST_SUITE_P(Sources,
                         UntexturedTest,
                         testing::Values(1, 2, 3, 5, 7, 10, 12, 19));

TEST_F(PatchMatchTest, KeepsThePlanesWithoutSources) {
  TexturedPlane scene = BareScene(kTilt);
  const Image<Plane> drawn = Draw().ToHost();
  const HostHypotheses kept = Run(scene, Images(scene), Draw());
  EXPECT_TRUE(SameBytes(kept.planes, drawn));
  for (const float cost : kept.costs) {
    ASSERT_GE(cost, kMaxCost);
    ASSERT_LE(
        cost,
        kMaxCost + options_.geometric_weight * options_.max_geometric_error);
  }
}

TEST_F(PatchMatchTest, CostsKeepWithinTheirBounds) {
  TexturedPlane scene = Scene(kTilt);
  options_.num_iterations = 1;
  const float max =
      kMaxCost + options_.geometric_weight * options_.max_geometric_error;
  for (const float cost : Run(scene, scene.Sources(), Draw()).costs) {
    ASSERT_GE(cost, 0.f);
    ASSERT_LE(cost, max + 1e-5f);
  }
  options_.num_iterations = 0;
  const HostHypotheses first = Run(scene, scene.Sources(), Draw());
  EXPECT_TRUE(SameBytes(first.planes, Draw().ToHost()));
  for (const float cost : first.costs) {
    ASSERT_GE(cost, 0.f);
    ASSERT_LE(cost, max + 1e-5f);
  }
}

TEST_F(PatchMatchTest, FillsPixelsWithoutAPlane) {
  TexturedPlane scene = Scene(kTilt);
  Image<float> depth = scene.Depth();
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if ((x / 4 + y / 4) % 2 == 0) {
        depth(x, y) = 0.f;
      }
    }
  }
  const HostHypotheses filled = Run(scene,
                                    Images(scene),
                                    PlanesFromMaps(intrinsics_,
                                                   std::as_const(depth).View(),
                                                   scene.Reference().normal,
                                                   *device_));
  EXPECT_EQ(Compare(scene, filled.planes).share, 1.f);
}

TEST_F(PatchMatchTest, DrawsPlanesWhereThereAreNone) {
  TexturedPlane scene = Scene(kTilt);
  const HostHypotheses found =
      Run(scene,
          Images(scene),
          DeviceImage<Plane>(*device_, Image<Plane>(kWidth, kHeight)));
  EXPECT_GT(Compare(scene, found.planes).share, 0.9f);
}

TEST_F(PatchMatchTest, TakesOnePixel) {
  TexturedPlane scene(DrawnPlane(kTilt, 3.f), DrawnCamera(1, 1, 5), *device_);
  scene.AddSource(SourceCamera(DrawnCamera(1, 1, 5), {0.1, 0.0, 0.0}, 0.0));
  const HostHypotheses found = Run(scene, Images(scene), TruePlanes(scene));
  ASSERT_EQ(found.planes.NumPixels(), 1u);
  EXPECT_TRUE(found.planes(0, 0).Valid());
}

TEST_F(PatchMatchTest, StartsWithTheTwoSourcesThatMatchBest) {
  options_.num_iterations = 0;
  TexturedPlane scene = Scene(kTilt);
  // Two negatives and two that look away.
  for (int i = 0; i < 2; ++i) {
    scene.AddSource(SourceCamera(camera_, {0.1, 0.0, 0.0}, 3.14159265));
    for (float& value : scene.SourceGray(i)) {
      value = 255.f - value;
    }
  }
  const Image<float> costs = Run(scene, Images(scene), TruePlanes(scene)).costs;
  // The middle is seen by both of the others.
  for (int y = 18; y < 30; ++y) {
    for (int x = 22; x < 42; ++x) {
      ASSERT_LT(costs(x, y), 0.1f) << x << ", " << y;
    }
  }
}

TEST_F(PatchMatchTest, KeepsPlanesBetweenTheBounds) {
  TexturedPlane scene = Scene(kSlant);
  // Of the plane only a strip lies between them.
  options_.depth_min = 2.9f;
  options_.depth_max = 3.1f;
  const HostHypotheses found = Run(scene, Images(scene), Draw());
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float depth = found.planes(x, y).Depth(intrinsics_.Ray(x, y));
      ASSERT_GT(depth, 2.9f * (1.f - 1e-4f)) << x << ", " << y;
      ASSERT_LT(depth, 3.1f * (1.f + 1e-4f)) << x << ", " << y;
    }
  }
}

TEST_F(PatchMatchTest, FindsThePlaneFarFromThoseItHas) {
  TexturedPlane scene = Scene(kTilt);
  // Small steps do not lead anywhere; planes have to be drawn anew.
  options_.num_past_iterations = 100;
  const Image<float> far(kWidth, kHeight, 5.8f);
  const DeviceImage<float> depth(*device_, far);
  const HostHypotheses found =
      Run(scene,
          Images(scene),
          PlanesFromMaps(
              intrinsics_, depth.View(), scene.Reference().normal, *device_));
  EXPECT_LT(Compare(scene, found.planes).median_depth_error, 0.02f);
}

TEST_F(PatchMatchTest, FindsNormalsFarFromThoseItHas) {
  TexturedPlane scene = Scene(kTilt);
  options_.num_past_iterations = 100;
  const Image<Vec3f> wrong(
      kWidth, kHeight, Normalized(Vec3f{-1.f, 0.5f, -0.6f}));
  const DeviceImage<Vec3f> normal(*device_, wrong);
  const HostHypotheses found =
      Run(scene,
          Images(scene),
          PlanesFromMaps(
              intrinsics_, scene.Reference().depth, normal.View(), *device_));
  const Accuracy accuracy = Compare(scene, found.planes);
  EXPECT_LT(accuracy.median_normal_error, 10.f);
  EXPECT_LT(accuracy.median_depth_error, 1e-3f);
}

TEST_F(PatchMatchTest, LooksAtAWindowOfTheGivenRadius) {
  TexturedPlane scene = Scene(kTilt);
  for (int y = 16; y < 32; ++y) {
    for (int x = 22; x < 42; ++x) {
      scene.Gray()(x, y) = 128.f;
    }
  }
  // In the middle only wide windows have texture.
  for (const int num_iterations : {0, 1}) {
    options_.num_iterations = num_iterations;
    const auto cost = [&](float radius) {
      options_.window_radius = radius;
      return Run(scene, Images(scene), TruePlanes(scene)).costs(32, 24);
    };
    EXPECT_EQ(cost(5.f), kMaxCost) << num_iterations;
    EXPECT_LT(cost(12.f), kMaxCost - 0.1f) << num_iterations;
  }
}

TEST_F(PatchMatchTest, FollowsTheDepthsOfSourcesWithoutTexture) {
  TexturedPlane scene = Scene(kTilt);
  Image<float> depth = scene.Depth();
  for (int y = 12; y < 36; ++y) {
    for (int x = 18; x < 46; ++x) {
      scene.Gray()(x, y) = 128.f;
      depth(x, y) *= 1.3f;
    }
  }
  const auto median_error = [&](const Image<Plane>& planes) {
    std::vector<float> errors;
    // Whose windows have no texture.
    for (int y = 17; y < 31; ++y) {
      for (int x = 23; x < 41; ++x) {
        errors.push_back(std::abs(planes(x, y).Depth(intrinsics_.Ray(x, y)) /
                                      scene.Depth()(x, y) -
                                  1.f));
      }
    }
    std::nth_element(
        errors.begin(), errors.begin() + errors.size() / 2, errors.end());
    return errors[errors.size() / 2];
  };
  const auto wrong_planes = [&] {
    return PlanesFromMaps(intrinsics_,
                          std::as_const(depth).View(),
                          scene.Reference().normal,
                          *device_);
  };
  ASSERT_NEAR(median_error(wrong_planes().ToHost()), 0.3f, 1e-3f);
  const float with_depths =
      median_error(Run(scene, scene.Sources(), wrong_planes()).planes);
  EXPECT_LT(with_depths, 0.02f);
  // Not for another reason.
  const float without_depths =
      median_error(Run(scene, Images(scene), wrong_planes()).planes);
  EXPECT_GT(without_depths, 0.1f);
}

TEST_F(PatchMatchTest, MapsComeBackFromPlanes) {
  TexturedPlane scene = BareScene(kTilt);
  Image<float>& depth = scene.Depth();
  depth(3, 4) = 0.f;
  depth(5, 4) = 7.5f;
  const DeviceImage<Plane> planes = TruePlanes(scene);
  EXPECT_FALSE(planes.ToHost()(3, 4).Valid());
  const PlaneMaps maps = MapsFromPlanes(intrinsics_, planes.View(), *device_);
  const Image<float> found_depth = maps.depth.ToHost();
  const Image<Vec3f> found_normal = maps.normal.ToHost();
  const Vec3f normal = Normalized(kTilt);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (x == 3 && y == 4) {
        EXPECT_EQ(found_depth(x, y), 0.f);
        EXPECT_EQ(found_normal(x, y), Vec3f{});
        continue;
      }
      ASSERT_NEAR(found_depth(x, y), depth(x, y), 1e-5f * depth(x, y));
      ASSERT_EQ(found_normal(x, y), normal);
    }
  }
}

TEST_F(PatchMatchTest, MapsHaveNothingWhereThePlaneIsNotSeen) {
  // A floor below the camera, of which pixels above the horizon see nothing.
  Image<Plane> planes(kWidth, kHeight, {{0.f, -1.f, 0.f}, 1.5f});
  const DeviceImage<Plane> on_device(*device_, planes);
  const PlaneMaps maps =
      MapsFromPlanes(intrinsics_, on_device.View(), *device_);
  const Image<float> depth = maps.depth.ToHost();
  const Image<Vec3f> normal = maps.normal.ToHost();
  EXPECT_EQ(depth(10, kHeight / 2 - 5), 0.f);
  EXPECT_EQ(normal(10, kHeight / 2 - 5), Vec3f{});
  EXPECT_NEAR(depth(10, kHeight / 2 + 5), 1.5f / 0.05f, 1e-3f);
  EXPECT_EQ(normal(10, kHeight / 2 + 5), (Vec3f{0.f, -1.f, 0.f}));
}

TEST_F(PatchMatchTest, ResizesPlanesByPlace) {
  const DeviceImage<Plane> drawn = Draw();
  const Image<Plane> planes = drawn.ToHost();
  const auto resize =
      [&](const DeviceImage<Plane>& from, int width, int height) {
        return ResizePlanes(from.View(), width, height, *device_);
      };
  EXPECT_TRUE(SameBytes(resize(drawn, kWidth, kHeight).ToHost(), planes));
  // Every pixel of a larger image of this size has its own there.
  const DeviceImage<Plane> larger = resize(drawn, 2 * kWidth, 3 * kHeight);
  EXPECT_TRUE(SameBytes(resize(larger, kWidth, kHeight).ToHost(), planes));
  const Image<Plane> on_larger = larger.ToHost();
  for (int y = 0; y < 3 * kHeight; ++y) {
    for (int x = 0; x < 2 * kWidth; ++x) {
      ASSERT_EQ(on_larger(x, y).normal, planes(x / 2, y / 3).normal);
    }
  }
  // Sizes without a common divisor: the first and the last stay at the ends.
  const Image<Plane> odd = resize(drawn, 41, 29).ToHost();
  EXPECT_EQ(odd(0, 0).normal, planes(0, 0).normal);
  EXPECT_EQ(odd(40, 28).normal, planes(kWidth - 1, kHeight - 1).normal);
  EXPECT_EQ(odd(20, 14).normal, planes(kWidth / 2, kHeight / 2).normal);
  EXPECT_EQ(resize(drawn, 1, 1).ToHost()(0, 0).normal,
            planes(kWidth / 2, kHeight / 2).normal);
}

}  // namespace
}  // namespace tsar
