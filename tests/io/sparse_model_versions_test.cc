// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/sparse_model.h"

#include <algorithm>
#include <array>

#include "tests/support/test_workspace.h"
#include <Eigen/Geometry>

namespace tsar {
namespace {

// A rig of two cameras, left and right, at two moments; tests/data/README.md
// says how the files were made.
const std::filesystem::path kRig =
    std::filesystem::path(TSAR_SOURCE_DIR) / "tests/data/sparse_rig";

struct Pose {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d translation;
};

// From the rig to its right camera, and from the world to the rig.
const Pose kRightFromRig = {{0.5, 0.5, 0.5, 0.5}, {-0.5, 0.0, 0.25}};
const Pose kRigFromWorld[] = {{{1, 0, 0, 0}, {0, 0, 2}},
                              {{0, 1, 0, 0}, {1, 2, 3}}};

void ExpectPose(const Pose& expected, const Camera& camera) {
  EXPECT_TRUE(
      camera.rotation.isApprox(expected.rotation.toRotationMatrix(), 1e-12));
  EXPECT_TRUE(camera.translation.isApprox(expected.translation, 1e-12));
}

class SparseModelOfVersionTest : public testing::TestWithParam<std::string> {};

TEST_P(SparseModelOfVersionTest, HasThePosesOfTheImagesOfARig) {
  const SparseModel model = ReadSparseModel(kRig / GetParam());
  ASSERT_EQ(model.images.size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    SCOPED_TRACE(model.images[i].name);
    const Pose& rig = kRigFromWorld[i / 2];
    const bool is_right = i % 2 == 1;
    EXPECT_EQ(model.images[i].name,
              std::string(is_right ? "right/" : "left/") +
                  (i < 2 ? "a.png" : "b.png"));
    EXPECT_EQ(model.images[i].camera.fx, is_right ? 90 : 100);
    EXPECT_EQ(model.images[i].camera.width, is_right ? 64 : 80);
    ExpectPose(is_right ? Pose{kRightFromRig.rotation * rig.rotation,
                               kRightFromRig.rotation * rig.translation +
                                   kRightFromRig.translation}
                        : rig,
               model.images[i].camera);
  }
  ASSERT_EQ(model.points.size(), 3u);
  EXPECT_EQ(model.points[2], Eigen::Vector3d(0.5, -1, 7));
  EXPECT_THAT(model.images[0].point_indices, testing::ElementsAre(0, 2));
  EXPECT_THAT(model.images[1].point_indices, testing::ElementsAre(1, 2));
  EXPECT_THAT(model.images[2].point_indices, testing::ElementsAre(0));
  EXPECT_THAT(model.images[3].point_indices, testing::ElementsAre(1, 2));
}

INSTANTIATE_TEST_SUITE_P(
    Colmap,
    SparseModelOfVersionTest,
    testing::Values("3.8/binary", "3.8/text", "4.2/binary", "4.2/text"),
    [](const auto& info) {
      std::string name = info.param;
      std::replace_if(
          name.begin(),
          name.end(),
          [](char c) { return c == '.' || c == '/'; },
          '_');
      return name;
    });

// Binary, with a camera of each of COLMAP's models, given by its number; with
// fewer parameters than PINHOLE's the file is too short.
TEST(SparseModelVersionsTest, RefusesCamerasWithDistortion) {
  struct Case {
    int32_t model;
    ErrorCode code;
    const char* text;
  };
  for (const auto& [model, code, text] :
       {Case{0, ErrorCode::kCorrupt, "shorter"},
        Case{1, ErrorCode::kCorrupt, "shorter"},
        Case{4, ErrorCode::kUnsupported, "undistort first with"},
        Case{17, ErrorCode::kUnsupported, "render perspective images"},
        Case{-1, ErrorCode::kUnsupported, "undistort first with"}}) {
    const TemporaryFolder folder;
    std::string cameras;
    Append(uint64_t{1}, &cameras);
    Append(uint32_t{1}, &cameras);
    Append(model, &cameras);
    Append(std::array<uint64_t, 2>{80, 60}, &cameras);
    Append(std::array<double, 2>{80, 60}, &cameras);
    WriteText(folder.Path() / "cameras.bin", cameras);
    for (const char* name : {"images.bin", "points3D.bin"}) {
      WriteText(folder.Path() / name, std::string(sizeof(uint64_t), '\0'));
    }
    ExpectError(
        code, {"cameras.bin", text}, [&] { ReadSparseModel(folder.Path()); });
  }
}

}  // namespace
}  // namespace tsar
