// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_conventions.h"

#include <functional>
#include <limits>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

namespace tsar {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 72;

// A floor and a wall behind it, of which the image sees sparse points. The
// upper third of its map has no depth unless it is filled.
class MapConventionsTest : public testing::Test {
 protected:
  MapConventionsTest() {
    SparseModel::ModelImage& image = model_.images.emplace_back();
    image.camera = {kWidth, kHeight, 80.0, 80.0, 47.5, 20.0};
    image.camera.rotation =
        Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, -1).normalized())
            .toRotationMatrix();
    image.camera.translation = {1.0, 2.0, 3.0};
    const Intrinsics intrinsics = image.camera.GetIntrinsics();
    for (int y = kHeight / 3; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const Vec3f ray =
            intrinsics.Ray(static_cast<float>(x), static_cast<float>(y));
        const Vec3f wall = Normalized(Vec3f{0.3f, 0.1f, -1.f});
        const float floor = 1.f / std::max(ray.y, 1e-3f);
        const float distance = -5.f / Dot(wall, ray);
        depth_(x, y) = std::min(floor, distance);
        normal_(x, y) = floor < distance ? Vec3f{0.f, -1.f, 0.f} : wall;
        AddPoint(depth_(x, y) * ray);
      }
    }
  }

  void AddPoint(const Vec3f& point) {
    SparseModel::ModelImage& image = model_.images[0];
    image.point_indices.push_back(static_cast<int>(model_.points.size()));
    model_.points.push_back(image.camera.rotation.transpose() *
                            (Eigen::Vector3d(point.x, point.y, point.z) -
                             image.camera.translation));
  }
  void FillTop(float value) {
    std::fill_n(depth_.Data(), kWidth * kHeight / 3, value);
  }
  float NoDepth() const {
    return FindNoDepth(MapSample(depth_, normal_), &model_, 0);
  }
  MapConventions Find(const std::function<Vec3f(const Vec3f&)>& change,
                      bool is_turned) const {
    Image<Vec3f> normal = normal_;
    for (Vec3f& n : normal) {
      n = change(n);
    }
    const MapConventions conventions =
        FindConventions(MapSample(depth_, normal), model_, 0);
    conventions.Apply(normal);
    for (size_t i = 0; i < normal.NumPixels(); ++i) {
      const Vec3f expected =
          is_turned ? normal_.Data()[i] : change(normal_.Data()[i]);
      EXPECT_LT(Norm(normal.Data()[i] - expected), 1e-6f);
    }
    return conventions;
  }

  SparseModel model_;
  Image<float> depth_{kWidth, kHeight};
  Image<Vec3f> normal_{kWidth, kHeight};
};

TEST_F(MapConventionsTest, NumbersFarBeyondAllDepthsStandForNone) {
  EXPECT_EQ(NoDepth(), 0.f);
  AddPoint({0.f, 0.f, 1e5f});  // A wrong one.
  for (const float value :
       {65535.f, 1e10f, 80.f, 12.f, 1e-3f, std::numeric_limits<float>::max()}) {
    FillTop(value);
    EXPECT_EQ(NoDepth(), value);
  }
  FillTop(1e6f);
  ClearNoDepth(NoDepth(), depth_);
  EXPECT_EQ(std::ranges::count(depth_, 0.f), kWidth * kHeight / 3);
  // In millimeters.
  for (float& depth : depth_) {
    depth *= 1000.f;
  }
  FillTop(65535.f);
  EXPECT_EQ(NoDepth(), 65535.f);
  // The marker fills the whole map.
  std::ranges::fill(depth_, 1e6f);
  EXPECT_EQ(NoDepth(), 1e6f);
}

TEST_F(MapConventionsTest, DepthsThatMayBeRightStay) {
  // Another wall, whose points lie there.
  FillTop(20.f);
  for (int i = 0; i < kWidth * kHeight / 3; ++i) {
    const Vec3f ray = model_.images[0].camera.GetIntrinsics().Ray(
        static_cast<float>(i % kWidth), static_cast<float>(i / kWidth));
    AddPoint(20.f * ray);
  }
  EXPECT_EQ(NoDepth(), 0.f);
  // The end of a sensor's range.
  for (float& depth : depth_) {
    depth = std::min(depth, 4.f);
  }
  EXPECT_EQ(NoDepth(), 0.f);
  // The value is in too few pixels.
  depth_(5, MapSample(kWidth, kHeight).rows[2]) = 1e6f;
  EXPECT_EQ(NoDepth(), 0.f);
  std::ranges::fill(depth_, 5.f);
  EXPECT_EQ(NoDepth(), 0.f);
}

TEST_F(MapConventionsTest, WithoutSparsePointsOnlyAbsurdNumbersStandForNone) {
  model_.images[0].point_indices.clear();
  FillTop(20.f);
  EXPECT_EQ(NoDepth(), 0.f);
  FillTop(1e4f);
  EXPECT_EQ(NoDepth(), 1e4f);
  std::ranges::fill(depth_, 5.f);
  EXPECT_EQ(NoDepth(), 0.f);
}

TEST_F(MapConventionsTest, NormalsOfOtherFramesAreTurned) {
  const Eigen::Matrix3d rotation = model_.images[0].camera.rotation;
  const auto in_world = [&](const Vec3f& n) {
    return ToVec3f(rotation.transpose() * Eigen::Vector3d(n.x, n.y, n.z));
  };
  using Change = std::function<Vec3f(const Vec3f&)>;
  for (const auto& [remark, change] :
       std::vector<std::pair<std::string, Change>>{
           {"{}", [](const Vec3f& n) { return n; }},
           {"point away from the camera and are read so",
            [](const Vec3f& n) { return -n; }},
           {"of OpenGL and are read so",
            [](const Vec3f& n) {
              return Vec3f{n.x, -n.y, -n.z};
            }},
           {"of the world and are read so", in_world},
           {"of the world and are read so",
            [&](const Vec3f& n) { return -in_world(n); }},
           {"contradict the depths",
            [](const Vec3f&) {
              return Normalized(Vec3f{0.6f, -0.6f, -1.f});
            }},
           {"no depth has a normal", [](const Vec3f&) { return Vec3f{}; }}}) {
    const bool is_turned = remark.find("read so") != std::string::npos;
    EXPECT_THAT(testing::PrintToString(Find(change, is_turned).remarks),
                testing::HasSubstr(remark));
  }
}

TEST_F(MapConventionsTest, NormalsInTheCamerasFrameWhereTheWorldsIsUsual) {
  NormalEvidence evidence;
  evidence.Add(MapSample(depth_, normal_), model_.images[0].camera);
  const NormalVerdict verdict = evidence.Judge(NormalFrame::kWorld);
  EXPECT_EQ(verdict.frame, NormalFrame::kCamera);
  EXPECT_THAT(verdict.remark,
              testing::HasSubstr("of the camera, not the world"));
}

TEST(MapSampleTest, MapsOfAnySizeHaveOne) {
  for (const int height : {1, 2, 3, 20, 33, 1000}) {
    const MapSample sample(4, height);
    EXPECT_TRUE(std::ranges::is_sorted(sample.rows)) << height;
    EXPECT_TRUE(sample.rows.empty() || sample.rows.back() < height);
    EXPECT_EQ(sample.rows.size() % 2, 0u);
    SparseModel model;
    model.images.emplace_back().camera = {4, height};
    const MapSample map(Image<float>(4, height, 2.f),
                        Image<Vec3f>(4, height, {0.f, 0.f, -1.f}));
    EXPECT_TRUE(FindConventions(map, model, 0).remarks.empty()) << height;
  }
}

}  // namespace
}  // namespace tsar
