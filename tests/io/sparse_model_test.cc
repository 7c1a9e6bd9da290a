// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/sparse_model.h"

#include <algorithm>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

const std::filesystem::path kRig =
    std::filesystem::path(TSAR_SOURCE_DIR) / "tests/data/sparse_rig/4.2";

// Files of a small model as text, to be changed by the tests.
struct TextModel {
  std::string cameras =
      "# Camera list\n1 PINHOLE 80 60 100 101 40 30\n"
      "7 SIMPLE_PINHOLE 64 48 90 32 24\n";
  std::string images =
      "# Image list\n"
      "5 2 0 0 0 1 2 3 1 sub/with space.png\n"
      "1.5 2.5 11 3 4 -1\n"
      "2 0 0 0 -0.5 0 0 0 7 first.png\n"
      "\n";
  std::string points =
      "30 4 5 6 0 0 0 0.5 5 0 2 3\n"
      "11 1 2 3 255 0 0 0.5 5 1\n";

  SparseModel Read() const {
    const TemporaryFolder folder;
    WriteText(folder.Path() / "cameras.txt", cameras);
    WriteText(folder.Path() / "images.txt", images);
    WriteText(folder.Path() / "points3D.txt", points);
    return ReadSparseModel(folder.Path());
  }
};

void Replace(const std::string& from, const std::string& to, std::string* s) {
  const size_t position = s->find(from);
  ASSERT_NE(position, std::string::npos) << from;
  s->replace(position, from.size(), to);
}

TEST(SparseModelTest, ReadsText) {
  const SparseModel model = TextModel().Read();
  ASSERT_EQ(model.images.size(), 2u);
  const SparseModel::ModelImage& first = model.images[0];
  EXPECT_EQ(first.name, "first.png");
  EXPECT_EQ(first.camera.fx, 90);
  EXPECT_EQ(first.camera.fy, 90);
  EXPECT_EQ(first.camera.cx, 32);
  EXPECT_EQ(first.camera.cy, 24);
  // A turn by 180 degrees about z; the quaternion is not of unit length.
  EXPECT_TRUE(first.camera.rotation.isApprox(
      Eigen::Vector3d(-1, -1, 1).asDiagonal().toDenseMatrix()));
  const SparseModel::ModelImage& second = model.images[1];
  EXPECT_EQ(second.name, "sub/with space.png");
  EXPECT_EQ(second.camera.cx, 40);
  EXPECT_EQ(second.camera.cy, 30);
  // By ascending id: 11, 30.
  ASSERT_EQ(model.points.size(), 2u);
  EXPECT_EQ(model.points[0], Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(second.point_indices, testing::ElementsAre(0, 1));
  EXPECT_THAT(first.point_indices, testing::ElementsAre(1));
  EXPECT_EQ(model.IndexOf("sub/with space.png"), 1);
  EXPECT_EQ(model.IndexOf("absent"), -1);
  EXPECT_EQ(model.Find("first.png"), &model.images[0]);
  EXPECT_EQ(model.Find("absent"), nullptr);
}

TEST(SparseModelTest, ReadsTextOfEditors) {
  TextModel text;
  text.points += "12 nan 2 3 0 0 0 0.5 5 0\n";
  const SparseModel expected = TextModel().Read();
  Replace("space.png\n", "space.png  # hall\n# its points\n", &text.images);
  Replace("5 2 0", "  5 +2 0", &text.images);
  Replace("40 30", "40 30 # wide", &text.cameras);
  for (std::string* file : {&text.cameras, &text.images, &text.points}) {
    for (size_t end = 0; (end = file->find('\n', end)) != std::string::npos;) {
      file->replace(end, 1, "\r\n");
      end += 2;
    }
    file->insert(0, "\xEF\xBB\xBF");
  }
  testing::internal::CaptureStderr();
  const SparseModel model = text.Read();
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::HasSubstr("points3D.txt: the position of point 12 is "
                                 "not valid; left out"));
  ASSERT_EQ(model.images.size(), expected.images.size());
  for (size_t i = 0; i < model.images.size(); ++i) {
    EXPECT_EQ(model.images[i].name, expected.images[i].name);
    EXPECT_EQ(model.images[i].camera.rotation,
              expected.images[i].camera.rotation);
    EXPECT_EQ(model.images[i].camera.fx, expected.images[i].camera.fx);
    EXPECT_EQ(model.images[i].point_indices, expected.images[i].point_indices);
  }
  EXPECT_EQ(model.points, expected.points);
}

TEST(SparseModelTest, LeavesOutImagesWithoutPose) {
  for (const char* pose :
       {"nan 0 0 0 1 2 3", "2 0 0 0 1 inf 3", "0 0 0 0 1 2 3"}) {
    SCOPED_TRACE(pose);
    TextModel text;
    Replace("2 0 0 0 1 2 3", pose, &text.images);
    testing::internal::CaptureStderr();
    const SparseModel model = text.Read();
    EXPECT_THAT(testing::internal::GetCapturedStderr(),
                testing::HasSubstr(
                    "images.txt: the pose of image 5 (sub/with space.png) is "
                    "not valid; left out"));
    ASSERT_EQ(model.images.size(), 1u);
    EXPECT_EQ(model.images[0].name, "first.png");
    // As COLMAP counts the images in visibility files.
    EXPECT_EQ(model.images[0].index_in_file, 1);
    EXPECT_THAT(model.images[0].point_indices, testing::ElementsAre(1));
    EXPECT_EQ(model.points.size(), 2u);
    EXPECT_TRUE(model.without_pose.contains("sub/with space.png"));
    Replace("-0.5 0 0 0", "-0.5 0 nan 0", &text.images);
    ExpectError(ErrorCode::kCorrupt,
                {"images.txt", "no image has a valid pose"},
                [&] { text.Read(); });
  }
}

TEST(SparseModelTest, PrefersBinaryWhereAllThreeAreThere) {
  const TemporaryFolder folder;
  ExpectError(ErrorCode::kNotFound, {folder.Path().string()}, [&] {
    ReadSparseModel(folder.Path());
  });
  std::filesystem::copy(kRig / "text", folder.Path());
  WriteText(folder.Path() / "cameras.bin", "broken");
  EXPECT_EQ(ReadSparseModel(folder.Path()).images.size(), 4u);
  for (const char* name : {"images.bin", "points3D.bin"}) {
    WriteText(folder.Path() / name, "broken");
  }
  ExpectError(ErrorCode::kCorrupt,
              {(folder.Path() / "cameras.bin").string()},
              [&] { ReadSparseModel(folder.Path()); });
}

// Cut anywhere, a count larger than the file, any byte replaced: an error or a
// model, never anything else.
TEST(SparseModelTest, SurvivesDamagedBinaryFiles) {
  for (const std::string name : {"cameras.bin", "images.bin", "points3D.bin"}) {
    const TemporaryFolder folder;
    std::filesystem::copy(kRig / "binary", folder.Path());
    const std::string bytes = ReadText(folder.Path() / name);
    const auto expect_corrupt = [&](const std::string& damaged) {
      WriteText(folder.Path() / name, damaged);
      ExpectError(
          ErrorCode::kCorrupt, {name}, [&] { ReadSparseModel(folder.Path()); });
    };
    const size_t step = std::max<size_t>(1, bytes.size() / 100);
    for (size_t i = 0; i < bytes.size(); i += step) {
      expect_corrupt(bytes.substr(0, i));
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(~damaged[i]);
      WriteText(folder.Path() / name, damaged);
      try {
        for (const auto& image : ReadSparseModel(folder.Path()).images) {
          ASSERT_TRUE(image.camera.rotation.allFinite());
        }
      } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr(".bin"));
      }
    }
    for (const uint64_t count : {uint64_t{1} << 20, ~uint64_t{0}}) {
      std::string hostile;
      Append(count, &hostile);
      expect_corrupt(hostile + bytes.substr(8));
    }
  }
}

struct BadText {
  std::string TextModel::*file;
  const char* from;
  const char* to;
  ErrorCode code;
  const char* message;
};

TEST(SparseModelTest, RefusesBadText) {
  constexpr auto kCameras = &TextModel::cameras;
  constexpr auto kImages = &TextModel::images;
  constexpr auto kPoints = &TextModel::points;
  constexpr ErrorCode kCorrupt = ErrorCode::kCorrupt;
  const BadText cases[] = {
      {kCameras,
       "SIMPLE_PINHOLE",
       "SIMPLE_RADIAL",
       ErrorCode::kUnsupported,
       "undistort first with image_undistorter"},
      {kCameras, " 24\n", "\n", kCorrupt, "line 3 ends too early"},
      {kCameras, "7 SIMPLE", "1 SIMPLE", kCorrupt, "more than once"},
      {kCameras, "100 101", "0 101", kCorrupt, "focal"},
      {kCameras, "100 101", "nan 101", kCorrupt, "focal"},
      {kCameras, "100 101", "1e-9 101", kCorrupt, "focal"},
      {kCameras, "100 101", "1x0 101", kCorrupt, "line 2 has \"1x0\""},
      {kCameras, "40 30", "nan 30", kCorrupt, "principal"},
      {kCameras, "80 60", "0 60", kCorrupt, "size"},
      {kCameras, "80 60", "-80 60", kCorrupt, "\"-80\""},
      {kImages, "3 1 sub", "3 9 sub", kCorrupt, "camera 9"},
      {kImages, "first.png", "sub/with space.png", kCorrupt, "the same file"},
      {kImages, "first.png", "", kCorrupt, "name"},
      {kImages, "\n2 0", "\n5 0", kCorrupt, "image 5"},
      {kImages, "5 2 0 0", "5 2 0\n", kCorrupt, "line 2 ends too early"},
      {kPoints, "5 0 2 3", "5 0 8 3", kCorrupt, "image 8"},
      {kPoints, "5 0 2 3", "5 0 2", kCorrupt, "line 1 ends too early"},
      {kPoints, "30 4 5 6", "11 4 5 6", kCorrupt, "more than once"},
      {kPoints, "30 4 5 6", "30 red 5 6", kCorrupt, "line 1 has \"red\""},
      {kCameras, " 24\n", " 24 0.1\n", kCorrupt, "line 3 has \"0.1\" behind"},
      {kImages, "11 3 4 -1", "11 3 4", kCorrupt, "is not the line of points"},
      {kImages, "11 3 4 -1", "11 3 4 a", kCorrupt, "is not the line of points"},
  };
  for (const BadText& bad : cases) {
    SCOPED_TRACE(std::string(bad.from) + " -> " + bad.to);
    TextModel text;
    Replace(bad.from, bad.to, &(text.*bad.file));
    const char* name = bad.file == kCameras  ? "cameras.txt"
                       : bad.file == kImages ? "images.txt"
                                             : "points3D.txt";
    ExpectError(bad.code, {name, bad.message}, [&] { text.Read(); });
  }
}

}  // namespace
}  // namespace tsar
