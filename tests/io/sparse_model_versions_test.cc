// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/sparse_model.h"

#include <algorithm>
#include <map>

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

// A binary model whose only camera is of this model and has these parameters.
void WriteBinaryCamera(int32_t model,
                       const std::vector<double>& params,
                       const std::filesystem::path& folder) {
  std::string cameras;
  Append(uint64_t{1}, &cameras);
  Append(uint32_t{1}, &cameras);
  Append(model, &cameras);
  Append(uint64_t{80}, &cameras);
  Append(uint64_t{60}, &cameras);
  for (const double param : params) {
    Append(param, &cameras);
  }
  WriteText(folder / "cameras.bin", cameras);
  for (const char* name : {"images.bin", "points3D.bin"}) {
    WriteText(folder / name, std::string(sizeof(uint64_t), '\0'));
  }
}

// All that COLMAP has had up to 4.2, by its numbers.
TEST(SparseModelVersionsTest, NamesTheCameraModelsThatItRefuses) {
  const std::map<int32_t, std::string> models = {
      {2, "SIMPLE_RADIAL"},
      {3, "RADIAL"},
      {4, "OPENCV"},
      {5, "OPENCV_FISHEYE"},
      {6, "FULL_OPENCV"},
      {7, "FOV"},
      {8, "SIMPLE_RADIAL_FISHEYE"},
      {9, "RADIAL_FISHEYE"},
      {10, "THIN_PRISM_FISHEYE"},
      {11, "RAD_TAN_THIN_PRISM_FISHEYE"},
      {12, "SIMPLE_DIVISION"},
      {13, "DIVISION"},
      {14, "SIMPLE_FISHEYE"},
      {15, "FISHEYE"},
      {16, "EUCM"},
      {17, "EQUIRECTANGULAR"},
      {18, "with number 18"},
      {-1, "with number -1"},
  };
  for (const auto& [number, name] : models) {
    SCOPED_TRACE(name);
    const char* const advice = name == "EQUIRECTANGULAR"
                                   ? "render perspective images"
                                   : "undistort first with image_undistorter";
    const TemporaryFolder folder;
    // Panoramas have fewer parameters than any other camera.
    WriteBinaryCamera(number, {80, 60}, folder.Path());
    ExpectError(ErrorCode::kUnsupported,
                {"cameras.bin", "(model " + name + ")", advice},
                [&] { ReadSparseModel(folder.Path()); });
    if (number >= 0 && number < 18) {
      const TemporaryFolder text;
      WriteText(text.Path() / "cameras.txt", "1 " + name + " 80 60 80 60\n");
      WriteText(text.Path() / "images.txt", "");
      WriteText(text.Path() / "points3D.txt", "");
      ExpectError(ErrorCode::kUnsupported,
                  {"cameras.txt", "(model " + name + ")", advice},
                  [&] { ReadSparseModel(text.Path()); });
    }
  }
}

TEST(SparseModelVersionsTest, ReadsTheCameraModelsWithoutDistortion) {
  const TemporaryFolder folder;
  WriteBinaryCamera(0, {100, 40, 30}, folder.Path());
  EXPECT_TRUE(ReadSparseModel(folder.Path()).images.empty());
  WriteBinaryCamera(1, {100, 101, 40, 30}, folder.Path());
  EXPECT_TRUE(ReadSparseModel(folder.Path()).images.empty());
  WriteBinaryCamera(1, {100, 101, 40}, folder.Path());
  ExpectError(ErrorCode::kCorrupt, {"cameras.bin"}, [&] {
    ReadSparseModel(folder.Path());
  });
}

}  // namespace
}  // namespace tsar
