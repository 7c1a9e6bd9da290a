// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/formats/apd_map.h"
#include "colmap_tsar/import/formats/depth_image.h"
#include "colmap_tsar/import/formats/dmap.h"
#include "colmap_tsar/import/formats/dmb.h"
#include "colmap_tsar/import/formats/npy.h"
#include "colmap_tsar/import/formats/pfm.h"
#include "colmap_tsar/import/formats/picture_header.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "tests/import/external_writers.h"
#include "tests/support/test_workspace.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

using testing::ElementsAre;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
const std::vector<float> kSix = {1, 2, 3, 4, 5, 6};

std::string Int32s(const std::vector<int32_t>& numbers) {
  std::string bytes;
  for (const int32_t number : numbers) {
    Append(number, &bytes);
  }
  return bytes;
}

DmapContent SmallDmap() {
  DmapContent content;
  content.camera.width = 3;
  content.camera.height = 2;
  content.camera.fx = 4.0;
  content.camera.fy = 5.0;
  content.camera.cx = 1.5;
  content.camera.cy = 1.0;
  content.camera.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  content.camera.translation = {1, 2, 3};
  content.depth = Image<float>(3, 2);
  content.normal = Image<Vec3f>(3, 2, Vec3f{0.f, 0.6f, -0.8f});
  for (size_t i = 0; i < 6; ++i) {
    content.depth.Data()[i] = kSix[i];
  }
  return content;
}

std::string EncodedPicture(const std::string& extension, const cv::Mat& mat) {
  std::vector<uchar> bytes;
  // Without this, OpenCV writes three channels of TIFF with loss.
  constexpr int kNoCompression = 1;
  EXPECT_TRUE(cv::imencode(
      extension, mat, bytes, {cv::IMWRITE_TIFF_COMPRESSION, kNoCompression}));
  return {bytes.begin(), bytes.end()};
}

// One way to read bytes: the size and the values of what comes out.
using Reader = std::function<FloatMap(const std::string& bytes)>;

FloatMap ReadDmb(const std::string& bytes) {
  return ParseDmb(AsBytes(bytes), "some.file");
}
FloatMap ReadApd(const std::string& bytes) {
  return ParseApdMap(AsBytes(bytes), "some.file");
}
FloatMap ReadPfm(const std::string& bytes) {
  return ParsePfm(AsBytes(bytes), "some.file");
}
FloatMap ReadNpy(const std::string& bytes) {
  return ParseNpy(AsBytes(bytes), "some.file").map;
}
FloatMap ReadDmap(const std::string& bytes) {
  const Dmap dmap = ParseDmap(AsBytes(bytes), "some.file");
  return {dmap.depth.Width(), dmap.depth.Height(), 1, ValuesOf(dmap.depth)};
}
FloatMap ReadPng(const std::string& bytes) {
  return ParseDepthImage(AsBytes(bytes), "some.file.PNG").map;
}
FloatMap ReadTiff(const std::string& bytes) {
  return ParseDepthImage(AsBytes(bytes), "some.file.tif").map;
}

struct ValidFile {
  std::string name;
  Reader read;
  std::string bytes;
  FloatMap expected;
};

std::vector<ValidFile> ValidFiles() {
  const FloatMap one = {3, 2, 1, kSix};
  const FloatMap three = {1, 2, 3, kSix};
  DmapContent bare = SmallDmap();
  bare.normal = {};
  DmapContent full = SmallDmap();
  full.has_confidence = true;
  full.has_views = true;
  std::string doubles;
  std::string big_endian;
  for (const float value : kSix) {
    Append(static_cast<double>(value), &doubles);
    Append(__builtin_bswap16(static_cast<uint16_t>(value)), &big_endian);
  }
  cv::Mat floats(2, 3, CV_32FC1);
  std::copy(kSix.begin(), kSix.end(), floats.begin<float>());
  cv::Mat equal;
  cv::merge(std::vector<cv::Mat>{floats, floats, floats}, equal);
  return {
      {"dmb", &ReadDmb, DmbBytes(3, 2, 1, kSix), one},
      {"dmb of normals", &ReadDmb, DmbBytes(1, 2, 3, kSix), three},
      {"apd", &ReadApd, ApdBytes(3, 2, 1, kSix, true), one},
      {"apd without version", &ReadApd, ApdBytes(3, 2, 1, kSix, false), one},
      {"apd of normals", &ReadApd, ApdBytes(1, 2, 3, kSix, true), three},
      {"apd of normals without version",
       &ReadApd,
       ApdBytes(1, 2, 3, kSix, false),
       three},
      {"dmap", &ReadDmap, DmapBytes(SmallDmap()), one},
      {"dmap of depth alone", &ReadDmap, DmapBytes(bare), one},
      {"dmap with everything", &ReadDmap, DmapBytes(full), one},
      {"pfm", &ReadPfm, PfmBytes(3, 2, 1, kSix, true), one},
      {"pfm, big-endian", &ReadPfm, PfmBytes(3, 2, 1, kSix, false), one},
      {"pfm of normals", &ReadPfm, PfmBytes(1, 2, 3, kSix, true), three},
      {"npy", &ReadNpy, NpyBytes("<f4", "(2, 3)", FloatData(kSix)), one},
      {"npy, last dimension 1",
       &ReadNpy,
       NpyBytes("<f4", "(2, 3, 1)", FloatData(kSix)),
       one},
      {"npy of normals",
       &ReadNpy,
       NpyBytes("<f4", "(2, 1, 3)", FloatData(kSix)),
       three},
      {"npy of doubles", &ReadNpy, NpyBytes("<f8", "(2, 3)", doubles), one},
      {"npy of integers", &ReadNpy, NpyBytes(">u2", "(2, 3)", big_endian), one},
      {"png", &ReadPng, PngBytes(3, 2, {1, 2, 3, 4, 5, 6}), one},
      {"tiff", &ReadTiff, EncodedPicture(".tiff", floats), one},
      {"tiff of three equal channels",
       &ReadTiff,
       EncodedPicture(".tiff", equal),
       one},
  };
}

TEST(FloatFormats, ReadWhatWasWritten) {
  for (const ValidFile& file : ValidFiles()) {
    SCOPED_TRACE(file.name);
    const FloatMap map = file.read(file.bytes);
    EXPECT_EQ(map.width, file.expected.width);
    EXPECT_EQ(map.height, file.expected.height);
    EXPECT_EQ(map.channels, file.expected.channels);
    EXPECT_EQ(map.values, file.expected.values);
  }
}

TEST(FloatFormats, RefuseEveryCutAndWhatIsTooLong) {
  for (const ValidFile& file : ValidFiles()) {
    for (size_t length = 0; length < file.bytes.size(); ++length) {
      SCOPED_TRACE(file.name + " cut to " + std::to_string(length));
      // Pictures may end in bytes that say nothing.
      if (file.name.starts_with("tiff") || file.name == "png") {
        if (length % 7 != 0 || length > file.bytes.size() / 2) {
          continue;
        }
      }
      ExpectError(ErrorCode::kCorrupt, {"some.file"}, [&] {
        file.read(file.bytes.substr(0, length));
      });
    }
    if (!file.name.starts_with("tiff") && file.name != "png") {
      SCOPED_TRACE(file.name);
      ExpectError(ErrorCode::kCorrupt, {"some.file"}, [&] {
        file.read(file.bytes + "x");
      });
      ExpectError(ErrorCode::kCorrupt, {"some.file"}, [&] {
        file.read(file.bytes + std::string(12, '\0'));
      });
    }
  }
}

// Flips, replaces, inserts and cuts bytes: either there is a clear error, or a
// map of the size that it says.
TEST(FloatFormats, StandMutations) {
  std::mt19937 random(1);
  for (const ValidFile& file : ValidFiles()) {
    SCOPED_TRACE(file.name);
    const bool is_picture = file.name.starts_with("tiff") || file.name == "png";
    for (int i = 0; i < (is_picture ? 40 : 400); ++i) {
      std::string bytes = file.bytes;
      const auto position = [&] { return random() % bytes.size(); };
      for (uint32_t edits = 1 + random() % 4; edits > 0; --edits) {
        switch (random() % 4) {
          case 0:
            bytes[position()] ^= static_cast<char>(1u << (random() % 8));
            break;
          case 1:
            bytes[position()] = static_cast<char>(random());
            break;
          case 2:
            bytes.insert(position(), 1, static_cast<char>(random()));
            break;
          default:
            // Most headers lie in the first bytes.
            bytes[random() % std::min<size_t>(32, bytes.size())] =
                static_cast<char>(random() % 2 == 0 ? 0xff : 0x7f);
        }
      }
      if (random() % 8 == 0) {
        bytes.resize(position());
      }
      try {
        const FloatMap map = file.read(bytes);
        ASSERT_GT(map.width, 0);
        ASSERT_GT(map.height, 0);
        ASSERT_EQ(map.values.size(),
                  static_cast<size_t>(map.width) *
                      static_cast<size_t>(map.height) *
                      static_cast<size_t>(map.channels));
      } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("some.file"));
      }
    }
  }
}

TEST(Dmb, RefusesBadHeaders) {
  const std::vector<std::pair<std::vector<int32_t>, std::string>> cases = {
      {{0, 2, 3, 1}, "type is 0"},
      {{2, 2, 3, 1}, "type is 2"},
      {{1, 0, 3, 1}, "no size of a map"},
      {{1, -2, -3, 1}, "no size of a map"},
      {{1, 2, 3, 0}, "no size of a map"},
      {{1, 2, 3, -1}, "no size of a map"},
      {{1, 3, 3, 1}, "24 bytes follow"},
      {{1, 2, 3, 3}, "24 bytes follow"},
      // Products that wrap around to small numbers.
      {{1, 65536, 65536, 1}, "24 bytes follow"},
      {{1, 16777216, 16777216, 16}, "24 bytes follow"},
      {{1, 2147483647, 2147483647, 1}, "no size of a map"},
      {{1, 2, 3, 2147483647}, "no size of a map"}};
  for (const auto& [header, text] : cases) {
    SCOPED_TRACE(testing::PrintToString(header));
    ExpectError(ErrorCode::kCorrupt, {"some.file", text}, [&] {
      ReadDmb(Int32s(header) + FloatData(kSix));
    });
  }
}

TEST(ApdMap, TellsTheHeadersApartWhateverTheVersion) {
  for (const int32_t version : {0, 1, 2, 5, 21, -1}) {
    SCOPED_TRACE(version);
    const FloatMap map = ReadApd(Int32s({version, 2, 3, 5}) + FloatData(kSix));
    EXPECT_EQ(map.width, 3);
    EXPECT_EQ(map.height, 2);
  }
}

TEST(ApdMap, RefusesOtherMatrices) {
  for (const std::vector<int32_t>& header :
       {std::vector<int32_t>{1, 2, 3, 0},  // Bytes.
        {1, 2, 3, 6},                      // Doubles.
        {1, 3, 2, 21},
        {1, -2, -3, 5},
        {2, 4, 5},
        {0, 0, 5},
        {65536, 65536, 5}}) {
    SCOPED_TRACE(testing::PrintToString(header));
    ExpectError(ErrorCode::kCorrupt, {"some.file", "[version]"}, [&] {
      ReadApd(Int32s(header) + FloatData(kSix));
    });
  }
}

TEST(ToDepth, MakesInvalidWhatIsNoDepth) {
  const FloatMap map = {6, 1, 1, {kNan, kInf, -kInf, -1.f, 0.f, 2.f}};
  const Image<float> depth = ToDepth(map, "some.file");
  EXPECT_THAT(ValuesOf(depth), ElementsAre(0, 0, 0, 0, 0, 2));
  ExpectError(ErrorCode::kCorrupt, {"some.file", "3"}, [] {
    ToDepth({1, 1, 3, {1, 2, 3}}, "some.file");
  });
}

TEST(ToNormals, MakesInvalidWhatIsNotFinite) {
  const Image<Vec3f> normals =
      ToNormals({3, 1, 3, {1, 2, 3, kNan, 0, 1, 0, -kInf, 1}}, "some.file");
  EXPECT_THAT(ValuesOf(normals), ElementsAre(1, 2, 3, 0, 0, 0, 0, 0, 0));
  ExpectError(ErrorCode::kCorrupt, {"some.file", "1"}, [] {
    ToNormals({1, 1, 1, {1}}, "some.file");
  });
}

TEST(Dmap, ReadsNameCameraDepthAndNormals) {
  DmapContent content = SmallDmap();
  content.image_name = "C:\\photos\\b.jpg";
  content.has_confidence = true;
  content.has_views = true;
  content.depth(0, 0) = kNan;
  content.depth(1, 0) = -2.f;
  const std::string bytes = DmapBytes(content);
  const Dmap dmap = ParseDmap(AsBytes(bytes), "some.file");
  EXPECT_EQ(dmap.image_name, "C:\\photos\\b.jpg");
  EXPECT_EQ(dmap.camera.file, "some.file");
  EXPECT_EQ(dmap.camera.fx, 4.0);
  EXPECT_EQ(dmap.camera.fy, 5.0);
  EXPECT_EQ(dmap.camera.cx, 1.5);
  EXPECT_EQ(dmap.camera.cy, 1.0);
  EXPECT_TRUE(dmap.camera.rotation == content.camera.rotation);
  EXPECT_TRUE(dmap.camera.center.isApprox(content.camera.Center()));
  EXPECT_THAT(ValuesOf(dmap.depth), ElementsAre(0, 0, 3, 4, 5, 6));
  EXPECT_EQ(ValuesOf(dmap.normal), ValuesOf(content.normal));
  EXPECT_EQ(ParseDmapImageName(AsBytes(bytes.substr(0, kMaxDmapNameEnd)), "f"),
            "C:\\photos\\b.jpg");
}

TEST(Dmap, RefusesBadHeadersAndCameras) {
  const std::string good = DmapBytes(SmallDmap());
  const auto with = [&](size_t position, const std::string& part) {
    std::string bytes = good;
    bytes.replace(position, part.size(), part);
    return bytes;
  };
  const size_t ids = 30 + SmallDmap().image_name.size();
  const size_t camera = ids + 16;
  std::string huge;
  Append(uint32_t{0xffffffff}, &huge);
  std::string zero(8, '\0');
  std::string nan;
  Append(std::numeric_limits<double>::quiet_NaN(), &nan);
  std::string two;
  Append(2.0, &two);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {with(0, "XX"), "not a depth map of OpenMVS"},
      {with(2, "\x13"), "not a depth map of OpenMVS"},
      {with(12, huge), "no size of a map"},
      {with(16, huge), "no size of a map"},
      {with(28, "\xff\xff"), "shorter than its content"},
      {with(ids, huge), "shorter than its content"},
      {with(2, "\x01"), "bytes follow"},
      {with(2, "\x07"), "bytes follow"},
      {with(camera, zero), "focal length"},
      {with(camera, nan), "no number"},
      {with(camera + 72 + 8, two), "rotation"},
      {with(camera + 144, nan), "no number"}};
  for (const auto& [bytes, text] : cases) {
    SCOPED_TRACE(text);
    ExpectError(
        ErrorCode::kCorrupt, {"some.file", text}, [&] { ReadDmap(bytes); });
  }
  ExpectError(ErrorCode::kUnsupported, {"some.file", "no depth"}, [&] {
    ReadDmap(with(2, "\x02"));
  });
}

TEST(Pfm, ReadsFromTheBottomUp) {
  const FloatMap map = ReadPfm("Pf\n1 2\n-1\n" + FloatData({10.f, 20.f}));
  EXPECT_THAT(map.values, ElementsAre(20, 10));
}

TEST(Pfm, AnyWhiteSpaceSeparatesAndOneByteOfItEnds) {
  const FloatMap map = ReadPfm("Pf 1\t1\r\n-0.5\n" +
                               FloatData({std::bit_cast<float>(0x20200a0au)}));
  EXPECT_EQ(std::bit_cast<uint32_t>(map.values[0]), 0x20200a0au);
}

TEST(Pfm, RefusesBadHeaders) {
  for (const char* header : {"P5\n3 2\n-1\n",
                             "Pf\n3\n-1\n",
                             "Pf\n3 x\n-1\n",
                             "Pf\n0 2\n-1\n",
                             "Pf\n-3 -2\n-1\n",
                             "Pf\n3 2\n0\n",
                             "Pf\n3 2\nnan\n",
                             "Pf\n3 2\nx\n",
                             "Pf\n3.0 2\n-1\n",
                             "PF\n3 2\n-1\n",
                             "Pf\n99999999999999999999 2\n-1\n",
                             "Pf\n16777216 16777216\n-1\n",
                             "Pf\n00000000000000000000000000000000000000000003 "
                             "2\n-1\n"}) {
    SCOPED_TRACE(header);
    ExpectError(ErrorCode::kCorrupt, {"some.file"}, [&] {
      ReadPfm(header + FloatData(kSix));
    });
  }
}

TEST(Npy, ReadsHalves) {
  std::string data;
  for (const uint16_t half :
       {0x0000, 0x3c00, 0xc000, 0x3555, 0x7bff, 0x0001, 0x7c00, 0x7e00}) {
    Append(half, &data);
  }
  const std::vector<float> values =
      ReadNpy(NpyBytes("<f2", "(2, 4)", data)).values;
  EXPECT_EQ(values[0], 0.f);
  EXPECT_EQ(values[1], 1.f);
  EXPECT_EQ(values[2], -2.f);
  EXPECT_NEAR(values[3], 1.f / 3.f, 1e-4f);
  EXPECT_EQ(values[4], 65504.f);
  EXPECT_EQ(values[5], std::ldexp(1.f, -24));
  EXPECT_EQ(values[6], kInf);
  EXPECT_TRUE(std::isnan(values[7]));
}

TEST(Npy, TellsIntegers) {
  EXPECT_FALSE(ParseNpy(AsBytes(NpyBytes("<f4", "(1, 1)", FloatData({2}))), "f")
                   .is_integer);
  EXPECT_TRUE(
      ParseNpy(AsBytes(NpyBytes("<u2", "(1, 1)", "ab")), "f").is_integer);
}

TEST(Npy, ReadsVersionTwo) {
  std::string bytes = NpyBytes("<f4", "(2, 3)", FloatData(kSix));
  bytes[6] = 2;
  bytes.insert(10, 2, '\0');
  EXPECT_EQ(ReadNpy(bytes).values, kSix);
}

TEST(Npy, RefusesOtherTypesShapesAndOrders) {
  const std::string data = FloatData(kSix);
  const std::vector<std::pair<std::string, std::string>> unsupported = {
      {NpyBytes("<i4", "(2, 3)", data), "<i4"},
      {NpyBytes("|u1", "(2, 12)", data), "|u1"},
      {NpyBytes("|O", "(2, 3)", data), "|O"},
      {NpyBytes("", "(2, 3)", data), "type ''"},
      {NpyBytes("<f4", "(2, 3)", data, "True"), "columns"},
      {NpyBytes("<f4", "(6,)", data), "1 dimensions"},
      {NpyBytes("<f4", "()", data.substr(0, 4)), "0 dimensions"},
      {NpyBytes("<f4", "(1, 2, 3, 1)", data), "4 dimensions"}};
  for (const auto& [bytes, text] : unsupported) {
    SCOPED_TRACE(text);
    ExpectError(
        ErrorCode::kUnsupported, {"some.file", text}, [&] { ReadNpy(bytes); });
  }
  for (const char* shape : {"(2, 4)",
                            "(0, 6)",
                            "(-2, -3)",
                            "(2, x)",
                            "2, 3",
                            "(2, 3",
                            "(16777216, 16777216)",
                            "(4294967296, 4294967296)",
                            "(99999999999999999999, 3)",
                            "(2, 3, 100)"}) {
    SCOPED_TRACE(shape);
    ExpectError(ErrorCode::kCorrupt, {"some.file"}, [&] {
      ReadNpy(NpyBytes("<f4", shape, data));
    });
  }
  std::string bytes = NpyBytes("<f4", "(2, 3)", data);
  bytes.replace(bytes.find("descr"), 5, "descx");
  ExpectError(ErrorCode::kCorrupt, {"descr"}, [&] { ReadNpy(bytes); });
}

TEST(DepthImage, TellsIntegersAndPicturesApart) {
  EXPECT_TRUE(
      ParseDepthImage(AsBytes(PngBytes(1, 1, {7})), "a.png").is_integer);
  const std::string floats =
      EncodedPicture(".tiff", cv::Mat(2, 3, CV_32FC1, cv::Scalar(2)));
  EXPECT_FALSE(ParseDepthImage(AsBytes(floats), "a.tiff").is_integer);
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC3}) {
    const cv::Mat picture(2, 3, type, cv::Scalar(1, 2, 3));
    ExpectError(ErrorCode::kUnsupported, {"a.png", "picture"}, [&] {
      ParseDepthImage(AsBytes(EncodedPicture(".png", picture)), "a.png");
    });
  }
  const cv::Mat bytes(2, 3, CV_8UC1, cv::Scalar(1));
  ExpectError(ErrorCode::kUnsupported, {"a.tif", "picture"}, [&] {
    ParseDepthImage(AsBytes(EncodedPicture(".tiff", bytes)), "a.tif");
  });
}

TEST(DepthImage, ReadsExrWhereOpenCvCan) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);
  if (!cv::haveImageWriter("a.exr")) {
    GTEST_SKIP() << "OpenCV was built without EXR";
  }
  const cv::Mat depth(2, 3, CV_32FC1, cv::Scalar(2.5));
  const std::string bytes = EncodedPicture(".exr", depth);
  const FloatMap map = ParseDepthImage(AsBytes(bytes), "a.exr").map;
  EXPECT_EQ(map.channels, 1);
  EXPECT_EQ(map.values, std::vector<float>(6, 2.5f));
  // OpenCV's own order is blue, green, red.
  const cv::Mat normal(1, 1, CV_32FC3, cv::Scalar(-0.8, 0.6, 0.1));
  const FloatMap normals =
      ParseDepthImage(AsBytes(EncodedPicture(".exr", normal)), "a.exr").map;
  EXPECT_THAT(normals.values, ElementsAre(0.1f, 0.6f, -0.8f));
  ExpectError(ErrorCode::kCorrupt, {"a.exr"}, [&] {
    ParseDepthImage(AsBytes(bytes.substr(0, bytes.size() / 2)), "a.exr");
  });
}

TEST(DepthImage, RefusesPngHeadersThatNoFileCanHold) {
  std::string bytes = PngBytes(3, 2, {1, 2, 3, 4, 5, 6});
  bytes.replace(16, 4, std::string("\x00\x10\x00\x00", 4));
  ExpectError(ErrorCode::kCorrupt, {"a.png", "1048576 x 2"}, [&] {
    ParseDepthImage(AsBytes(bytes), "a.png");
  });
  bytes[24] = 8;  // Bits; the provenance maps have so many.
  ExpectError(ErrorCode::kCorrupt, {"a.png", "1048576 x 2"}, [&] {
    CheckPngFrame(AsBytes(bytes), "a.png");
  });
}

TEST(DepthImage, RefusesTiffHeadersThatNoFileCanHold) {
  // Little-endian: no tags but width and height, as LONG and as SHORT.
  const auto header = [](uint32_t width, uint16_t height) {
    std::string bytes("II*\0\x08\0\0\0\x02\0", 10);
    Append(std::array<uint16_t, 4>{256, 4, 1, 0}, &bytes);
    Append(width, &bytes);
    Append(std::array<uint16_t, 6>{257, 3, 1, 0, height, 0}, &bytes);
    Append(uint32_t{0}, &bytes);
    return bytes;
  };
  ExpectError(ErrorCode::kCorrupt, {"a.tif", "1000000 x 60000"}, [&] {
    ParseDepthImage(AsBytes(header(1000000, 60000)), "a.tif");
  });
  ExpectError(ErrorCode::kCorrupt, {"a.tif", "0 x 2"}, [&] {
    ParseDepthImage(AsBytes(header(0, 2)), "a.tif");
  });
  std::string bytes = header(3, 2);
  bytes[10] = 7;
  ExpectError(ErrorCode::kCorrupt, {"a.tif", "no size"}, [&] {
    ParseDepthImage(AsBytes(bytes), "a.tif");
  });
  bytes = header(3, 2);
  bytes[7] = 1;
  ExpectError(ErrorCode::kCorrupt, {"a.tif", "shorter"}, [&] {
    ParseDepthImage(AsBytes(bytes), "a.tif");
  });
  for (const char* start : {"IM*", "II+"}) {
    bytes.replace(0, 3, start);
    ExpectError(ErrorCode::kCorrupt, {"a.tif", "not a TIFF"}, [&] {
      ParseDepthImage(AsBytes(bytes), "a.tif");
    });
  }
}

TEST(DepthImage, ReadsBigEndianTiff) {
  // One strip of 2 x 1 pixels of 16 bits: 258 bits, 273 offset, 279 bytes.
  const std::vector<std::pair<uint16_t, uint16_t>> tags = {{256, 2},
                                                           {257, 1},
                                                           {258, 16},
                                                           {259, 1},
                                                           {262, 1},
                                                           {273, 110},
                                                           {278, 1},
                                                           {279, 4}};
  std::string bytes("MM\0*\0\0\0\x08", 8);
  const auto add = [&](uint16_t value) {
    Append(__builtin_bswap16(value), &bytes);
  };
  add(8);
  for (const auto& [tag, value] : tags) {
    for (const uint16_t number :
         {tag, uint16_t{3}, uint16_t{0}, uint16_t{1}, value, uint16_t{0}}) {
      add(number);
    }
  }
  Append(uint32_t{0}, &bytes);
  ASSERT_EQ(bytes.size(), 110u);
  add(1234);
  add(5);
  const DepthImage image = ParseDepthImage(AsBytes(bytes), "a.tif");
  EXPECT_TRUE(image.is_integer);
  EXPECT_THAT(image.map.values, ElementsAre(1234, 5));
}

TEST(DepthImage, RefusesExrHeadersThatNoFileCanHold) {
  const auto header = [](int32_t right) {
    std::string bytes("v/1\x01\x02\0\0\0channels\0chlist\0\x01\0\0\0\0", 29);
    bytes += std::string("dataWindow\0box2i\0\x10\0\0\0", 21);
    Append(std::array<int32_t, 4>{0, 0, right, 20000}, &bytes);
    return bytes;
  };
  ExpectError(ErrorCode::kCorrupt, {"a.exr", "20000 x 20001"}, [&] {
    ParseDepthImage(AsBytes(header(19999)), "a.exr");
  });
  ExpectError(ErrorCode::kCorrupt, {"a.exr", "-4 x 20001"}, [&] {
    ParseDepthImage(AsBytes(header(-5)), "a.exr");
  });
  ExpectError(ErrorCode::kCorrupt, {"a.exr", "shorter"}, [&] {
    ParseDepthImage(AsBytes(header(5).substr(0, 60)), "a.exr");
  });
  ExpectError(ErrorCode::kCorrupt, {"a.exr", "no dataWindow"}, [&] {
    ParseDepthImage(AsBytes(header(5).substr(0, 29) + std::string(9, '\0')),
                    "a.exr");
  });
  // What comes after the size, too, is longer than the file.
  const auto attribute = [](const std::string& type, uint32_t size) {
    std::string bytes = std::string("some\0", 5) + type + '\0';
    Append(size, &bytes);
    return bytes;
  };
  for (const std::string& more :
       {attribute("unknown", 0x646e6957),
        attribute("stringvector", 4) + "\xff\xff\xff\x7f",
        attribute("float", 3) + "abc",
        attribute("floatvector", 5) + "abcde",
        attribute("chlist", 22) + std::string("name\0", 5) +
            std::string(16, 'a') + "b",
        attribute("preview", 8) + "\xff\xff\xff\x01\xff\xff\xff\x01"}) {
    ExpectError(ErrorCode::kCorrupt, {"a.exr"}, [&] {
      CheckExr(AsBytes(header(5) + more + std::string(99, '\0')), "a.exr");
    });
  }
  CheckExr(AsBytes(header(5) + attribute("unknown", 2) + "ab" + '\0'), "a.exr");
  ExpectError(ErrorCode::kCorrupt, {"a.exr", "not an EXR"}, [&] {
    ParseDepthImage(AsBytes("PFv/1"), "a.exr");
  });
}

TEST(DepthImage, KnowsItsNames) {
  for (const char* name :
       {"a.png", "a.EXR", "b/a.jpg.tif", "a.tiff", "a.pfm", "a.npy"}) {
    EXPECT_TRUE(IsDepthImageName(name)) << name;
  }
  for (const char* name : {"a.jpg", "a", "png", "a.png.txt", ".png"}) {
    EXPECT_FALSE(IsDepthImageName(name)) << name;
  }
}

TEST(StoredCamera, ReadsWhatConvertersWrite) {
  const Camera camera = SmallDmap().camera;
  const std::string text = CamBytes(camera);
  const StoredCamera stored = ParseCamFile(AsBytes(text), "some.file");
  EXPECT_TRUE(stored.rotation.isApprox(camera.rotation));
  EXPECT_TRUE(stored.center.isApprox(camera.Center()));
  EXPECT_EQ(stored.fx, 4.0);
  EXPECT_EQ(stored.fy, 5.0);
  EXPECT_EQ(stored.cx, 1.5);
  EXPECT_EQ(stored.cy, 1.0);
}

TEST(StoredCamera, RefusesWhatIsNoCamera) {
  const std::string good = CamBytes(SmallDmap().camera);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "\"extrinsic\" with 16"},
      {with("extrinsic", "extrinsics"), "\"extrinsic\" with 16"},
      {with("intrinsic\n4", "intrinsic\nx"), "\"intrinsic\" with 9"},
      {good.substr(0, good.find("intrinsic\n4")), "\"intrinsic\" with 9"},
      {with("intrinsic\n4", "intrinsic\n-4"), "focal length"},
      {with("intrinsic\n4", "intrinsic\n0"), "focal length"},
      {with("extrinsic\n 0", "extrinsic\n 7"), "rotation"}};
  for (const auto& [text, what] : cases) {
    SCOPED_TRACE(text);
    ExpectError(ErrorCode::kCorrupt, {"some.file", what}, [&] {
      ParseCamFile(AsBytes(text), "some.file");
    });
  }
}

}  // namespace
}  // namespace tsar
