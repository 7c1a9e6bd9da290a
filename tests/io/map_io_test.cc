// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_io.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/companion_maps.h"
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

TEST_F(MapIoTest, ReadsDepthsRowByRow) {
  const auto path = Write(MapBytes("3&2&1&", {1, 2, 3, 4, 5, 6}));
  const Image<float> depth = ReadDepthMap(path);
  ASSERT_EQ(depth.Width(), 3);
  ASSERT_EQ(depth.Height(), 2);
  EXPECT_EQ(depth(2, 0), 3.f);
  EXPECT_EQ(depth(0, 1), 4.f);
  const MapSize size = ReadMapSize(path);
  EXPECT_EQ(size.width, 3);
  EXPECT_EQ(size.height, 2);
  EXPECT_EQ(size.channels, 1);
}

TEST_F(MapIoTest, ReadsNormalsPlaneByPlane) {
  const auto path = Write(MapBytes("2&1&3&", {1, 2, 3, 4, 5, 6}));
  const Image<Vec3f> normal = ReadNormalMap(path);
  EXPECT_EQ(normal(0, 0), (Vec3f{1, 3, 5}));
  EXPECT_EQ(normal(1, 0), (Vec3f{2, 4, 6}));
}

TEST_F(MapIoTest, MakesBadDepthsInvalidAndCountsThoseNotFinite) {
  int64_t count = -1;
  const Image<float> depth = ReadDepthMap(
      Write(MapBytes("5&1&1&", {kNan, kInf, -kInf, -1.f, 2.f})), &count);
  EXPECT_EQ(count, 3);
  EXPECT_THAT(std::vector<float>(depth.begin(), depth.end()),
              testing::ElementsAre(0.f, 0.f, 0.f, 0.f, 2.f));
}

TEST_F(MapIoTest, MakesBadNormalsInvalidAndCountsThem) {
  int64_t count = -1;
  const Image<Vec3f> normal = ReadNormalMap(
      Write(MapBytes("3&1&3&", {0, 1, 2, kInf, 1, 2, 0, 1, kNan})), &count);
  EXPECT_EQ(count, 2);
  EXPECT_EQ(normal(0, 0), Vec3f());
  EXPECT_EQ(normal(1, 0), (Vec3f{1, 1, 1}));
  EXPECT_EQ(normal(2, 0), Vec3f());
}

TEST_F(MapIoTest, WritesTheBytesThatColmapReads) {
  const auto path = folder_.Path() / "out.bin";
  Image<Vec3f> normal(2, 1);
  normal(0, 0) = {1, 3, 5};
  normal(1, 0) = {2, 4, 6};
  ExpectHash(
      path, [&](AtomicFile* file) { return PutNormalMap(normal, file); });
  EXPECT_EQ(ReadText(path), MapBytes("2&1&3&", {1, 2, 3, 4, 5, 6}));
  ExpectHash(path, [&](AtomicFile* file) {
    return PutDepthMap(Image<float>(1, 2, 7.f), file);
  });
  EXPECT_EQ(ReadText(path), MapBytes("1&2&1&", {7, 7}));
  const PlanarMap map = {2, 1, 2, {1, 2, 3, 4}};
  ExpectHash(path,
                   [&](AtomicFile* file) { return PutPlanarMap(map, file); });
  EXPECT_EQ(ReadText(path), MapBytes("2&1&2&", {1, 2, 3, 4}));
  const PlanarMap read = ReadPlanarMap(path);
  EXPECT_EQ(read.width, 2);
  EXPECT_EQ(read.height, 1);
  EXPECT_EQ(read.channels, 2);
  EXPECT_EQ(read.values, map.values);
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
                             "2&0&1&",
                             "2&2&0&",
                             "-2&2&1&",
                             "+2&2&1&",
                             " 2&2&1&",
                             "2 &2&1&",
                             "2&2&1",
                             "2&&1&",
                             "&&&",
                             "2x2x1x",
                             "0x2&2&1&",
                             "2.0&2&1&",
                             "2&2&1&\n",
                             "4294967298&2&1&",
                             "99999999999999999999&1&1&"}) {
    SCOPED_TRACE(header);
    ExpectCorruptDepth(MapBytes(header, {1, 2, 3, 4}));
  }
}

// Products of these numbers wrap around to small sizes in 32 and 64 bits.
TEST_F(MapIoTest, RefusesAbsurdSizesBeforeAllocating) {
  for (const char* header : {"999999999&999999999&1&",
                             "999999999&999999999&999999999&",
                             "65536&65536&1&",
                             "536870912&536870912&536870912&"}) {
    SCOPED_TRACE(header);
    ExpectCorruptDepth(MapBytes(header, {}));
    ExpectCorruptDepth(MapBytes(header, {1, 2, 3, 4}));
  }
}

TEST_F(MapIoTest, RefusesTheWrongNumberOfChannels) {
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
    ExpectError(ErrorCode::kMismatch, {"not finite"}, [&] {
      WriteDepthMap(UserPath(path), Image<float>(2, 2, value));
    });
    ExpectError(ErrorCode::kMismatch, {"not finite"}, [&] {
      WriteNormalMap(UserPath(path), Image<Vec3f>(2, 2, Vec3f{0, 0, value}));
    });
  }
  ExpectError(ErrorCode::kMismatch, {"empty"}, [&] {
    WriteDepthMap(UserPath(path), Image<float>());
  });
  ExpectError(ErrorCode::kMismatch, {path.string()}, [&] {
    WritePlanarMap(UserPath(path), {2, 2, 1, {1, 2, 3}});
  });
  EXPECT_EQ(ReadText(path), "old");
}

constexpr RasterSize kImage = {1244, 829};

TEST(MapShape, IsThatOfTheImageScaledAndRounded) {
  for (const RasterSize image :
       {kImage, {829, 1244}, {6208, 4135}, {96, 72}, {1000, 999}, {3000, 7}}) {
    for (int side = 1; side <= 2 * image.width; ++side) {
      const double scale = static_cast<double>(side) / image.width;
      for (const double height : {std::floor(scale * image.height),
                                  std::round(scale * image.height),
                                  std::ceil(scale * image.height)}) {
        const RasterSize map = {side, std::max(1, static_cast<int>(height))};
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

class SigmaMapTest : public testing::Test {
 protected:
  void Write(const Image<uint16_t>& halves) const {
    AtomicFile file({folder_.Path(), "sigma.npy"});
    PutSigmaMap(halves, &file);
    file.Commit();
  }
  void ExpectCorrupt(const std::string& bytes) const {
    WriteText(path_, bytes);
    ExpectError(
        ErrorCode::kCorrupt, {path_.string()}, [&] { ReadSigmaMap(path_); });
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / "sigma.npy";
};

TEST_F(SigmaMapTest, IsAnArrayOfNumPy) {
  Image<uint16_t> halves(3, 2);
  for (int i = 0; i < 6; ++i) {
    halves.Data()[i] = static_cast<uint16_t>(0x0201 * i);
  }
  Write(halves);
  const std::string bytes = ReadText(path_);
  ASSERT_EQ(bytes.size(), 128u + 12u);
  EXPECT_EQ(bytes.substr(0, 10), std::string("\x93NUMPY\x01\x00\x76\x00", 10));
  EXPECT_EQ(bytes.substr(10, 59),
            "{'descr': '<f2', 'fortran_order': False, 'shape': (2, 3), }");
  EXPECT_EQ(bytes[127], '\n');
  EXPECT_EQ(bytes.substr(128, 6), std::string("\0\0\x01\x02\x02\x04", 6));
  const Image<float> sigma = ReadSigmaMap(path_);
  ASSERT_EQ(sigma.Width(), 3);
  ASSERT_EQ(sigma.Height(), 2);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(sigma.Data()[i], HalfToFloat(halves.Data()[i]));
  }
}

TEST_F(SigmaMapTest, RefusesWhatIsNone) {
  ExpectError(
      ErrorCode::kNotFound, {path_.string()}, [&] { ReadSigmaMap(path_); });
  Write(Image<uint16_t>(3, 2, ToPositiveHalf(0.5f)));
  const std::string good = ReadText(path_);
  ExpectCorrupt("");
  ExpectCorrupt(good.substr(0, 100));
  ExpectCorrupt(good.substr(0, good.size() - 1));
  ExpectCorrupt(good + "xx");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bytes = good;
    return bytes.replace(bytes.find(from), from.size(), to);
  };
  ExpectCorrupt(with("<f2", "<f4"));
  ExpectCorrupt(with("False", "True "));
  ExpectCorrupt(with("(2, 3)", "(3, 2)x"));
  ExpectCorrupt(with("(2, 3)", "(0, 3)"));
  ExpectCorrupt(with("(2, 3)", "(2, -)"));
  ExpectCorrupt(with("(2, 3), }    ", "(999999999, 3), }"));
  // Infinite, not a number, negative.
  for (const char* value : {"\x00\x7c", "\x01\x7c", "\x00\x80"}) {
    std::string bytes = good;
    ExpectCorrupt(bytes.replace(130, 2, std::string(value, 2)));
  }
}

}  // namespace
}  // namespace tsar
