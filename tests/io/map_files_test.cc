// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_files.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/io/dense_maps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "tests/support/external_writers.h"
#include "tests/support/test_workspace.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

using testing::ElementsAre;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// The values of the maps of 3 x 2 pixels.
const std::vector<float> kSix = {1, 2, 3, 4, 5, 6};

std::string Encoded(const std::string& extension, const cv::Mat& mat) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);
  std::vector<uchar> bytes;
  // Without this, OpenCV compresses TIFFs of three channels lossily.
  constexpr int kNoCompression = 1;
  EXPECT_TRUE(cv::imencode(
      extension, mat, bytes, {cv::IMWRITE_TIFF_COMPRESSION, kNoCompression}));
  return {bytes.begin(), bytes.end()};
}

DmapContent SmallDmap() {
  DmapContent content;
  content.camera.width = 3;
  content.camera.height = 2;
  content.camera.fx = 4.0;
  content.camera.fy = 5.0;
  content.depth = Image<float>(3, 2);
  std::ranges::copy(kSix, content.depth.begin());
  return content;
}

FloatMap ReadDmb(const std::string& bytes) {
  return ParseDmb(AsBytes(bytes), "some.file");
}
FloatMap ReadApd(const std::string& bytes) {
  return ParseApdMap(AsBytes(bytes), "some.file");
}
FloatMap ReadDmap(const std::string& bytes) {
  const Dmap dmap = ParseDmap(AsBytes(bytes), "some.file");
  return {dmap.depth.Width(), dmap.depth.Height(), 1, ValuesOf(dmap.depth)};
}
template <const char* kName>
FloatMap ReadImage(const std::string& bytes) {
  return ParseDepthImage(AsBytes(bytes), kName).map;
}
constexpr char kPfm[] = "some.file.PFM";
constexpr char kNpy[] = "some.file.npy";
constexpr char kPng[] = "some.file.PNG";
constexpr char kTiff[] = "some.file.tif";
constexpr char kExr[] = "some.file.exr";
constexpr auto kReadPfm = &ReadImage<kPfm>;
constexpr auto kReadNpy = &ReadImage<kNpy>;
constexpr auto kReadTiff = &ReadImage<kTiff>;
constexpr auto kReadExr = &ReadImage<kExr>;

constexpr char kNpz[] = "some.file.npz";

// As numpy.savez writes arrays, the first of which is this one; most fields of
// the headers, which are not read, are zero.
std::string NpzBytes(const std::string& npy, char num_arrays = 1) {
  std::string bytes = "PK\3\4" + std::string(26, '\0') + "depth.npy" + npy +
                      "PK\1\2" + std::string(42, '\0') + "depth.npy" +
                      "PK\5\6" + std::string(18, '\0');
  bytes[bytes.size() - 12] = num_arrays;
  return bytes;
}

struct ValidFile {
  std::string name;
  FloatMap (*read)(const std::string& bytes);
  std::string bytes;
  FloatMap expected;
};

std::vector<ValidFile> ValidFiles() {
  const FloatMap one = {3, 2, 1, kSix};
  const FloatMap three = {1, 2, 3, kSix};
  DmapContent full = SmallDmap();
  full.normal = Image<Vec3f>(3, 2, Vec3f{0.f, 0.6f, -0.8f});
  full.has_confidence = true;
  full.has_views = true;
  std::string doubles;
  std::string halves;
  std::string integers;
  for (const float value : kSix) {
    Append(static_cast<double>(value), &doubles);
    Append(ToPositiveHalf(value), &halves);
    Append(static_cast<uint16_t>(value), &integers);
  }
  const std::string data = FloatData(kSix);
  std::string version_two = NpyBytes("<f4", "(2, 3)", data);
  version_two[6] = 2;
  version_two.insert(10, 2, '\0');
  cv::Mat floats(2, 3, CV_32FC1);
  std::ranges::copy(kSix, floats.begin<float>());
  cv::Mat equal;
  cv::merge(std::vector<cv::Mat>{floats, floats, floats}, equal);
  // OpenCV's own order is blue, green, red.
  cv::Mat colors(2, 1, CV_32FC3);
  colors.at<cv::Vec3f>(0) = {3, 2, 1};
  colors.at<cv::Vec3f>(1) = {6, 5, 4};
  return {
      {"dmb", &ReadDmb, DmbBytes(3, 2, 1, kSix), one},
      {"dmb of normals", &ReadDmb, DmbBytes(1, 2, 3, kSix), three},
      {"apd", &ReadApd, ApdBytes(3, 2, 1, kSix, true), one},
      {"apd without version", &ReadApd, ApdBytes(3, 2, 1, kSix, false), one},
      {"apd of normals", &ReadApd, ApdBytes(1, 2, 3, kSix, true), three},
      {"dmap of depth alone", &ReadDmap, DmapBytes(SmallDmap()), one},
      {"dmap with everything", &ReadDmap, DmapBytes(full), one},
      {"pfm", kReadPfm, PfmBytes(3, 2, 1, kSix, true), one},
      {"big-endian pfm", kReadPfm, PfmBytes(3, 2, 1, kSix, false), one},
      {"pfm of normals", kReadPfm, PfmBytes(1, 2, 3, kSix, true), three},
      {"npy", kReadNpy, NpyBytes("<f4", "(2, 3)", data), one},
      {"npy of 3 dimensions",
       kReadNpy,
       NpyBytes("<f4", "(2, 3, 1)", data),
       one},
      {"npy of a batch",
       kReadNpy,
       NpyBytes("<f4", "(1, 1, 3, 2)", data),
       {2, 3, 1, kSix}},
      {"npy of a plane",
       kReadNpy,
       NpyBytes("<f4", "(1, 3, 2)", data),
       {2, 3, 1, kSix}},
      {"npy of planes",
       kReadNpy,
       NpyBytes("<f4", "(3, 1, 2)", data),
       {2, 1, 3, {1, 3, 5, 2, 4, 6}}},
      {"npz", &ReadImage<kNpz>, NpzBytes(NpyBytes("<f4", "(2, 3)", data)), one},
      {"npy of normals", kReadNpy, NpyBytes("<f4", "(2, 1, 3)", data), three},
      {"npy of halves", kReadNpy, NpyBytes("<f2", "(2, 3)", halves), one},
      {"npy of doubles", kReadNpy, NpyBytes("<f8", "(2, 3)", doubles), one},
      {"npy of integers", kReadNpy, NpyBytes("<u2", "(2, 3)", integers), one},
      {"npy of version 2", kReadNpy, version_two, one},
      {"picture png",
       &ReadImage<kPng>,
       PngBytes(3, 2, {1, 2, 3, 4, 5, 6}),
       one},
      {"picture tiff", kReadTiff, Encoded(".tiff", floats), one},
      {"picture of equal channels", kReadTiff, Encoded(".tiff", equal), one},
      {"picture of normals", kReadTiff, Encoded(".tiff", colors), three},
      {"picture exr", kReadExr, Encoded(".exr", floats), one},
      {"picture exr of normals", kReadExr, Encoded(".exr", colors), three},
  };
}

TEST(MapFormats, ReadWhatWasWritten) {
  for (const ValidFile& file : ValidFiles()) {
    SCOPED_TRACE(file.name);
    const FloatMap map = file.read(file.bytes);
    EXPECT_EQ(map.width, file.expected.width);
    EXPECT_EQ(map.height, file.expected.height);
    EXPECT_EQ(map.channels, file.expected.channels);
    EXPECT_EQ(map.values, file.expected.values);
  }
}

TEST(MapFormats, RefuseEveryCutAndWhatIsTooLong) {
  for (const ValidFile& file : ValidFiles()) {
    // The last bytes of pictures may be insignificant.
    const bool is_picture = file.name.starts_with("picture");
    const size_t end = file.bytes.size() / (is_picture ? 2 : 1);
    for (size_t length = 0; length < end; length += is_picture ? 17 : 1) {
      SCOPED_TRACE(file.name + " cut to " + std::to_string(length));
      ExpectError(ErrorCode::kCorrupt, {"some.file"}, [&] {
        file.read(file.bytes.substr(0, length));
      });
    }
    for (const std::string& more : {std::string("x"), std::string(12, '\0')}) {
      if (!is_picture) {
        SCOPED_TRACE(file.name);
        ExpectError(ErrorCode::kCorrupt, {"some.file"}, [&] {
          file.read(file.bytes + more);
        });
      }
    }
  }
}

TEST(MapFormats, RefuseOtherHeaders) {
  const std::string data = FloatData(kSix);
  const auto npy = [&](const char* type, const char* shape) {
    return NpyBytes(type, shape, data);
  };
  constexpr ErrorCode kCorrupt = ErrorCode::kCorrupt;
  constexpr ErrorCode kUnsupported = ErrorCode::kUnsupported;
  struct Case {
    const char* name;
    std::string bytes;
    ErrorCode code;
    const char* text;
  };
  std::vector<Case> cases = {
      {kNpy, npy("<i4", "(2, 3)"), kUnsupported, "type '<i4'"},
      {kNpy, npy(">f4", "(2, 3)"), kUnsupported, "type '>f4'"},
      {kNpy, npy("|O", "(2, 3)"), kUnsupported, "type '|O'"},
      {kNpy, npy("<f4", "(6,)"), kUnsupported, "1 dimensions"},
      {kNpy, npy("<f4", "(2, 1, 3, 1)"), kUnsupported, "4 dimensions"},
      {kNpy,
       NpyBytes("<f4", "(2, 3)", data, "True"),
       kUnsupported,
       "its columns"},
      {kNpz,
       NpzBytes(npy("<f4", "(2, 3)"), 2),
       kCorrupt,
       "archive of one array"},
      {kNpz, NpzBytes(""), kCorrupt, "save it with numpy.save"},
      {kNpz, std::string(50, 'x'), kCorrupt, "not an uncompressed"},
      {kNpy, npy("<f4", "(2, 4)"), kCorrupt, "bytes follow"},
      {kNpy, npy("<f4", "(0, 6)"), kCorrupt, "no size of a map"},
      {kNpy, npy("<f4", "(-2, -3)"), kCorrupt, "no size of a map"},
      {kNpy, npy("<f4", "(2, x)"), kCorrupt, "shape"},
      {kNpy, npy("<f4", "2, 3"), kCorrupt, "shape"},
      {kNpy, npy("<f4", "(2, 3"), kCorrupt, "shape"},
      {kNpy, npy("<f4", "(16777216, 16777216)"), kCorrupt, "bytes follow"},
      {kNpy, npy("<f4", "(4294967296, 4294967296)"), kCorrupt, "no size"},
      {kNpy, npy("<f4", "(99999999999999999999, 3)"), kCorrupt, "shape"}};
  for (const char* header : {"P5\n3 2\n-1\n",
                             "Pf\n3\n-1\n",
                             "Pf\n3 x\n-1\n",
                             "Pf\n0 2\n-1\n",
                             "Pf\n3 2\n0\n",
                             "Pf\n3 2\nnan\n",
                             "Pf\n3.0 2\n-1\n",
                             "PF\n3 2\n-1\n",
                             "Pf\n99999999999999999999 2\n-1\n",
                             "Pf\n16777216 16777216\n-1\n"}) {
    cases.push_back({kPfm, header + data, kCorrupt, "some.file"});
  }
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const std::string bytes =
        Encoded(".png", cv::Mat(2, 3, type, cv::Scalar(1, 2, 3)));
    cases.push_back(
        {kPng, bytes, kUnsupported, "a picture of 8 bits, not a depth map"});
  }
  for (const Case& bad : cases) {
    SCOPED_TRACE(bad.bytes);
    ExpectError(bad.code, {"some.file", bad.text}, [&] {
      ParseDepthImage(AsBytes(bad.bytes), bad.name);
    });
  }
}

TEST(MapFormats, AnyWhiteSpaceSeparatesInPfmAndOneByteOfItEnds) {
  const FloatMap map = kReadPfm("Pf 1\t1\r\n-0.5\n" +
                                FloatData({std::bit_cast<float>(0x20200a0au)}));
  EXPECT_EQ(std::bit_cast<uint32_t>(map.values[0]), 0x20200a0au);
}

TEST(DepthImage, TellsIntegersAndNames) {
  EXPECT_TRUE(ParseDepthImage(AsBytes(PngBytes(1, 1, {7})), kPng).is_integer);
  EXPECT_TRUE(ParseDepthImage(AsBytes(NpyBytes("<u2", "(1, 1)", "ab")), kNpy)
                  .is_integer);
  EXPECT_FALSE(
      ParseDepthImage(AsBytes(NpyBytes("<f4", "(1, 1)", FloatData({2}))), kNpy)
          .is_integer);
  for (const char* name :
       {"a.png", "a.EXR", "b/a.jpg.tif", "a.tiff", "a.pfm", "a.npy"}) {
    EXPECT_TRUE(IsDepthImageName(name)) << name;
  }
  for (const char* name : {"a.jpg", "a", "png", "a.png.txt", ".png"}) {
    EXPECT_FALSE(IsDepthImageName(name)) << name;
  }
}

TEST(NormalImage, HasThreeChannelsOfFloatsOrOfEncodedIntegers) {
  const std::string floats =
      NpyBytes("<f4", "(1, 2, 3)", FloatData({0, 0, -1, 5, 6, 7}));
  EXPECT_THAT(ParseNormalImage(AsBytes(floats), kNpy).values,
              ElementsAre(0, 0, -1, 5, 6, 7));
  // Black is no direction, and colors of transparent pixels do not count.
  std::string integers;
  for (const uint16_t value : {0, 0, 0, 65535, 32767, 32768}) {
    Append(value, &integers);
  }
  cv::Mat colors = cv::Mat::zeros(1, 2, CV_8UC4);
  colors.at<cv::Vec4b>(1) = {128, 127, 255, 9};
  for (const auto& [bytes, name] :
       {std::pair(NpyBytes("<u2", "(1, 2, 3)", integers), kNpy),
        std::pair(Encoded(".png", colors), kPng)}) {
    const FloatMap map = ParseNormalImage(AsBytes(bytes), name);
    EXPECT_THAT(map.values,
                ElementsAre(0,
                            0,
                            0,
                            1,
                            testing::FloatNear(0, 0.01f),
                            testing::FloatNear(0, 0.01f)));
  }
  // Three equal channels are still three.
  const cv::Mat zeros(2, 3, CV_32FC3, cv::Scalar::all(0));
  EXPECT_EQ(ParseNormalImage(AsBytes(Encoded(".tiff", zeros)), kTiff).channels,
            3);
  for (const auto& [bytes, name] :
       {std::pair(Encoded(".png", cv::Mat(2, 3, CV_8UC1, cv::Scalar(9))), kPng),
        std::pair(NpyBytes("<f4", "(2, 3)", FloatData(kSix)), kNpy)}) {
    ExpectError(ErrorCode::kUnsupported, {name, "three channels"}, [&] {
      ParseNormalImage(AsBytes(bytes), name);
    });
  }
}

TEST(FloatMapTest, WhatIsNoDepthAndNoNormalBecomesZero) {
  const FloatMap depths = {6, 1, 1, {kNan, kInf, -kInf, -1.f, 0.f, 2.f}};
  EXPECT_THAT(ValuesOf(ToDepth(depths, "f")), ElementsAre(0, 0, 0, 0, 0, 2));
  const FloatMap normals = {3, 1, 3, {1, 2, 3, kNan, 0, 1, 0, -kInf, 1}};
  EXPECT_THAT(ValuesOf(ToNormals(normals, "f")),
              ElementsAre(1, 2, 3, 0, 0, 0, 0, 0, 0));
  ExpectError(ErrorCode::kCorrupt, {"f:", "3"}, [&] { ToDepth(normals, "f"); });
  ExpectError(
      ErrorCode::kCorrupt, {"f:", "1"}, [&] { ToNormals(depths, "f"); });
}

class CompanionMapTest : public testing::Test {
 protected:
  void WriteSigma(const Image<uint16_t>& halves) const {
    AtomicFile file(UserPath(path_));
    PutSigmaMap(halves, &file);
    file.Commit();
  }
  // Expects that all readers refuse the file.
  void ExpectRefused(ErrorCode code, const std::string& bytes) const {
    WriteText(path_, bytes);
    ExpectError(code, {path_.string()}, [&] { ReadGrayPng(path_); });
    ExpectError(code, {path_.string()}, [&] { ReadGray16Png(path_); });
    ExpectError(code, {path_.string()}, [&] { ReadSigmaMap(path_); });
  }

  TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.Path() / "map";
};

TEST_F(CompanionMapTest, GrayPicturesKeepTheirValuesAndBits) {
  const auto write = [&](const cv::Mat& pixels) {
    WriteText(path_, Encoded(".png", pixels));
  };
  write((cv::Mat_<uint8_t>(2, 3) << 0, 1, 2, 3, 4, 255));
  const Image<uint8_t> bytes = ReadGrayPng(path_);
  EXPECT_EQ(bytes.Width(), 3);
  EXPECT_THAT(std::vector<int>(bytes.begin(), bytes.end()),
              ElementsAre(0, 1, 2, 3, 4, 255));
  ExpectError(ErrorCode::kCorrupt, {path_.string(), "of 16 bits"}, [&] {
    ReadGray16Png(path_);
  });
  write((cv::Mat_<uint16_t>(2, 3) << 0, 1, 2, 3, 256, 65535));
  const Image<uint16_t> words = ReadGray16Png(path_);
  EXPECT_THAT(std::vector<int>(words.begin(), words.end()),
              ElementsAre(0, 1, 2, 3, 256, 65535));
  ExpectError(ErrorCode::kCorrupt, {path_.string(), "of 8 bits"}, [&] {
    ReadGrayPng(path_);
  });
}

TEST_F(CompanionMapTest, SigmaIsAnArrayOfNumPy) {
  Image<uint16_t> halves(3, 2);
  for (int i = 0; i < 6; ++i) {
    halves.Data()[i] = static_cast<uint16_t>(0x0201 * i);
  }
  WriteSigma(halves);
  const std::string bytes = ReadText(path_);
  ASSERT_EQ(bytes.size(), 128u + 12u);
  EXPECT_EQ(bytes.substr(0, 10), std::string("\x93NUMPY\x01\x00\x76\x00", 10));
  EXPECT_EQ(bytes.substr(10, 59),
            "{'descr': '<f2', 'fortran_order': False, 'shape': (2, 3), }");
  EXPECT_EQ(bytes[127], '\n');
  EXPECT_EQ(bytes.substr(128, 6), std::string("\0\0\x01\x02\x02\x04", 6));
  const Image<float> sigma = ReadSigmaMap(path_);
  ASSERT_EQ(sigma.Width(), 3);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(sigma.Data()[i], HalfToFloat(halves.Data()[i]));
  }
  // Infinite, not a number, negative.
  for (const char* value : {"\x00\x7c", "\x01\x7c", "\x00\x80"}) {
    std::string changed = bytes;
    changed.replace(130, 2, std::string(value, 2));
    WriteText(path_, changed);
    ExpectError(ErrorCode::kCorrupt, {path_.string(), "not a sigma map"}, [&] {
      ReadSigmaMap(path_);
    });
  }
}

TEST_F(CompanionMapTest, WhatIsNoneIsRefused) {
  ExpectError(
      ErrorCode::kNotFound, {path_.string()}, [&] { ReadSigmaMap(path_); });
  ExpectError(
      ErrorCode::kNotFound, {path_.string()}, [&] { ReadGrayPng(path_); });
  cv::Mat drawn(64, 64, CV_16UC1);
  cv::randu(drawn, 0, 65536);
  const std::string png = Encoded(".png", drawn);
  for (const std::string& bytes :
       {std::string(),
        std::string("not a picture"),
        Encoded(".png", cv::Mat(4, 4, CV_8UC3, cv::Scalar(1, 2, 3))),
        png.substr(0, 20),
        png.substr(0, png.size() / 2)}) {
    ExpectRefused(ErrorCode::kCorrupt, bytes);
  }
}

}  // namespace
}  // namespace tsar
