// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_io.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/map_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tests/support/test_workspace.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string MapBytes(const std::string& header,
                     const std::vector<float>& values) {
  std::string bytes = header;
  for (const float value : values) {
    Append(value, &bytes);
  }
  return bytes;
}

class MapIoTest : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& bytes) {
    const std::filesystem::path path = folder_.Path() / "view.jpg.bin";
    WriteText(path, bytes);
    return path;
  }
  void ExpectCorruptDepth(const std::string& bytes) {
    const std::filesystem::path path = Write(bytes);
    ExpectError(ErrorCode::kCorrupt,
                {path.string(), "run patch_match_stereo again"},
                [&] { ReadDepthMap(path); });
    ExpectError(
        ErrorCode::kCorrupt, {path.string()}, [&] { ReadMapSize(path); });
  }
  static void ExpectHash(const std::filesystem::path& path,
                         const std::function<uint64_t(AtomicFile*)>& put) {
    AtomicFile file(UserPath(path));
    const uint64_t hash = put(&file);
    file.Commit();
    EXPECT_EQ(hash, HashFile(path));
  }
  TemporaryFolder folder_;
};

TEST_F(MapIoTest, ReadsDepthsRowByRowAndNormalsPlaneByPlane) {
  const auto path = Write(MapBytes("3&2&1&", {1, 2, 3, 4, 5, 6}));
  const Image<float> depth = ReadDepthMap(path);
  ASSERT_EQ(depth.Width(), 3);
  ASSERT_EQ(depth.Height(), 2);
  EXPECT_EQ(depth(2, 0), 3.f);
  EXPECT_EQ(depth(0, 1), 4.f);
  Write(MapBytes("2&1&3&", {1, 2, 3, 4, 5, 6}));
  const Image<Vec3f> normal = ReadNormalMap(path);
  EXPECT_EQ(normal(0, 0), (Vec3f{1, 3, 5}));
  EXPECT_EQ(normal(1, 0), (Vec3f{2, 4, 6}));
}

TEST_F(MapIoTest, MakesBadValuesInvalidAndCountsThoseNotFinite) {
  DepthMapReader depths(
      Write(MapBytes("5&1&1&", {kNan, kInf, -kInf, -1.f, 2.f})));
  std::vector<float> depth(5);
  depths.Read(0, depth);
  EXPECT_EQ(depths.NumNotFinite(), 3);
  EXPECT_EQ(ReadDepthMap(folder_.Path() / "view.jpg.bin")(1, 0), 0.f);
  EXPECT_THAT(depth, testing::ElementsAre(0.f, 0.f, 0.f, 0.f, 2.f));
  NormalMapReader normals(
      Write(MapBytes("3&1&3&", {0, 1, 2, kInf, 1, 2, 0, 1, kNan})));
  std::vector<Vec3f> normal(3);
  normals.Read(0, normal);
  EXPECT_EQ(normals.NumNotFinite(), 2);
  EXPECT_EQ(ReadNormalMap(folder_.Path() / "view.jpg.bin")(2, 0), Vec3f());
  EXPECT_THAT(normal, testing::ElementsAre(Vec3f(), (Vec3f{1, 1, 1}), Vec3f()));
}

TEST_F(MapIoTest, WritesTheBytesThatColmapReads) {
  const auto path = folder_.Path() / "out.bin";
  Image<Vec3f> normal(2, 1);
  normal(0, 0) = {1, 3, 5};
  normal(1, 0) = {2, 4, 6};
  ExpectHash(path,
             [&](AtomicFile* file) { return PutNormalMap(normal, file); });
  EXPECT_EQ(ReadText(path), MapBytes("2&1&3&", {1, 2, 3, 4, 5, 6}));
  ExpectHash(path, [&](AtomicFile* file) {
    return PutDepthMap(Image<float>(1, 2, 7.f), file);
  });
  EXPECT_EQ(ReadText(path), MapBytes("1&2&1&", {7, 7}));
  WriteMap(UserPath(path), {2, 1, 2}, std::vector<float>{1, 2, 3, 4});
  EXPECT_EQ(ReadText(path), MapBytes("2&1&2&", {1, 2, 3, 4}));
}

TEST_F(MapIoTest, RefusesFilesOfAnotherLength) {
  const std::string good = MapBytes("3&2&1&", {1, 2, 3, 4, 5, 6});
  ExpectCorruptDepth("");
  for (size_t length = 1; length < good.size(); ++length) {
    ExpectCorruptDepth(good.substr(0, length));
  }
  ExpectCorruptDepth(good + "x");
  ExpectCorruptDepth(good + "four");
}

TEST_F(MapIoTest, RefusesBadHeaders) {
  for (const char* header : {"0&2&1&",
                             "2&2&0&",
                             "-2&2&1&",
                             " 2&2&1&",
                             "2&2&1",
                             "2&&1&",
                             "2x2x1x",
                             "2.0&2&1&",
                             "2&2&1&\n",
                             "4294967298&2&1&",
                             "99999999999999999999&1&1&",
                             // Products that wrap around to small sizes.
                             "999999999&999999999&999999999&",
                             "65536&65536&1&",
                             "536870912&536870912&536870912&"}) {
    SCOPED_TRACE(header);
    ExpectCorruptDepth(MapBytes(header, {1, 2, 3, 4}));
  }
  const auto path = Write(MapBytes("2&1&2&", {1, 2, 3, 4}));
  ExpectError(
      ErrorCode::kCorrupt, {path.string(), "2"}, [&] { ReadDepthMap(path); });
  ExpectError(
      ErrorCode::kCorrupt, {path.string(), "2"}, [&] { ReadNormalMap(path); });
}

TEST_F(MapIoTest, NamesMissingFilesAndFolders) {
  const auto missing = folder_.Path() / "missing.bin";
  ExpectError(
      ErrorCode::kNotFound, {missing.string()}, [&] { ReadDepthMap(missing); });
  ExpectError(ErrorCode::kCorrupt, {folder_.Path().string()}, [&] {
    ReadDepthMap(folder_.Path());
  });
}

TEST_F(MapIoTest, RefusesToWriteWhatFusionCannotRead) {
  const auto path = folder_.Path() / "out.bin";
  WriteText(path, "old");
  for (const float value : {kNan, kInf}) {
    Image<float> depth(200, 100);  // More than is written at a time.
    depth(150, 60) = value;
    ExpectError(ErrorCode::kMismatch, {"not finite"}, [&] {
      WriteDepthMap(UserPath(path), depth);
    });
    ExpectError(ErrorCode::kMismatch, {"not finite"}, [&] {
      WriteNormalMap(UserPath(path), Image<Vec3f>(2, 2, Vec3f{0, 0, value}));
    });
  }
  ExpectError(ErrorCode::kMismatch, {"3 values for a map of 4"}, [&] {
    WriteMap(UserPath(path), {2, 1, 2}, std::vector<float>{1, 2, 3});
  });
  ExpectError(ErrorCode::kMismatch, {"empty"}, [&] {
    WriteDepthMap(UserPath(path), Image<float>());
  });
  EXPECT_EQ(ReadText(path), "old");
}

constexpr RasterSize kImage = {1244, 829};

TEST(MapShape, IsThatOfTheImageScaledAndRounded) {
  for (const RasterSize image : {kImage, {829, 1244}, {1000, 999}, {3000, 7}}) {
    for (int side = 1; side <= 2 * image.width; ++side) {
      const double height = static_cast<double>(side) / image.width *
                            static_cast<double>(image.height);
      for (const double rounded : {std::floor(height), std::ceil(height)}) {
        const RasterSize map = {side, std::max(1, static_cast<int>(rounded))};
        ASSERT_TRUE(HasShapeOf(map, image))
            << ToString(map) << " of " << ToString(image);
      }
    }
  }
}

TEST(MapShape, IsNoOther) {
  for (const RasterSize map : {RasterSize{829, 1244},
                               {4000, 2},
                               {2, 4000},
                               {1244, 833},
                               {1240, 829},
                               {1244, 1},
                               {622, 420},
                               {414, 622}}) {
    EXPECT_FALSE(HasShapeOf(map, kImage)) << ToString(map);
  }
}

TEST(MapShape, TheErrorNamesFileAndSizes) {
  const auto require = [](const RasterSize& map) {
    RequireShape("maps/v0.bin", map, kImage, "the image v0.png", "map anew");
  };
  EXPECT_NO_THROW(require({622, 415}));
  ExpectError(ErrorCode::kMismatch,
              {"maps/v0.bin: has 829 x 1244 pixels, which is not the shape of "
               "the image v0.png of 1244 x 829; map anew"},
              [&] {
                require({829, 1244});
              });
}

}  // namespace
}  // namespace tsar
