// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fused_cloud_writer.h"

#include "colmap_tsar/io/ply.h"

#include <cstring>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

class FusedCloudWriterTest : public testing::Test {
 protected:
  // Turned by a quarter about y: the camera's z is the world's x.
  static Camera TurnedCamera() {
    Camera camera;
    camera.rotation << 0, 0, -1, 0, 1, 0, 1, 0, 0;
    camera.translation = -camera.rotation * Eigen::Vector3d(1000.0, 20.0, 3.0);
    return camera;
  }

  static FusedPoint PointAt(float z, uint64_t sources) {
    FusedPoint point;
    point.position = {0.f, 0.f, z};
    point.normal = {0.f, 0.f, -1.f};
    point.color = {1, 2, 3};
    point.column = point.row = 0;
    point.sources = sources;
    return point;
  }

  template <typename T>
  static T At(const std::string& bytes, size_t place) {
    T value;
    EXPECT_LE(place + sizeof(T), bytes.size());
    std::memcpy(&value, bytes.data() + place, sizeof(T));
    return value;
  }

  const TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.Path() / "fused.ply";
  const std::filesystem::path visibility_path_ =
      folder_.Path() / "fused.ply.vis";
};

TEST_F(FusedCloudWriterTest, PointsAreInTheWorldAndReadAsAPlyFile) {
  FusedCloudWriter writer(UserPath(path_));
  // Written in the order of their places.
  writer.Add(2, EncodePoints({PointAt(5.f, 0)}, TurnedCamera(), {}, 8, {}));
  writer.Add(
      0, EncodePoints({PointAt(2.f, 0b101)}, TurnedCamera(), {}, 7, {9, 4, 1}));
  writer.Add(1, {});
  writer.Commit();
  EXPECT_THAT(ReadPlyPoints(path_),
              testing::ElementsAre(Eigen::Vector3d(1002.0, 20.0, 3.0),
                                   Eigen::Vector3d(1005.0, 20.0, 3.0)));
  const std::string ply = ReadText(path_);
  const size_t begin = ply.find("end_header\n") + 11;
  EXPECT_EQ(ply.size(), begin + 2 * 27);
  EXPECT_EQ(At<float>(ply, begin + 12), -1.f);  // The normal's x.
  EXPECT_EQ(ply.substr(begin + 24, 3), "\1\2\3");
  const std::string visibility = ReadText(visibility_path_);
  EXPECT_EQ(visibility.size(), 8u + 4 * (1 + 3) + 4 * (1 + 1));
  EXPECT_EQ(At<uint64_t>(visibility, 0), 2u);
  EXPECT_EQ(At<uint32_t>(visibility, 8), 3u);
  // Ascending: sources 0 and 2, and the image itself.
  EXPECT_EQ(At<uint32_t>(visibility, 12), 1u);
  EXPECT_EQ(At<uint32_t>(visibility, 16), 7u);
  EXPECT_EQ(At<uint32_t>(visibility, 20), 9u);
  EXPECT_EQ(At<uint32_t>(visibility, 28), 8u);
}

TEST_F(FusedCloudWriterTest, PointsOutsideOfTheBoxAreLeftOut) {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(1001.0, 0.0, 0.0),
                                Eigen::Vector3d(1003.0, 100.0, 10.0));
  const EncodedPoints encoded =
      EncodePoints({PointAt(0.5f, 0), PointAt(2.f, 0), PointAt(4.f, 0)},
                   TurnedCamera(),
                   box,
                   0,
                   {});
  EXPECT_EQ(encoded.count, 1);
  EXPECT_EQ(At<float>(encoded.points, 0), 1002.f);
}

TEST_F(FusedCloudWriterTest, HeadersOfAnyNumberHaveOneLength) {
  const auto size_with = [&](int count) {
    FusedCloudWriter writer(UserPath(path_));
    const std::vector<FusedPoint> points(static_cast<size_t>(count),
                                         PointAt(1.f, 0));
    writer.Add(0, EncodePoints(points, Camera(), {}, 0, {}));
    writer.Commit();
    EXPECT_EQ(ReadPlyPoints(path_).size(), static_cast<size_t>(count));
    return std::filesystem::file_size(path_) - 27u * static_cast<size_t>(count);
  };
  EXPECT_EQ(size_with(0), size_with(12345));
}

}  // namespace
}  // namespace tsar
