// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/depth_image.h"

#include "colmap_tsar/io/picture_checks.h"

#include <array>
#include <cmath>

#include "tests/io/format_readers.h"
#include "tests/support/external_writers.h"
#include "tests/support/png_files.h"
#include "tests/support/test_workspace.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

using testing::ElementsAre;

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

TEST(NormalImage, HasThreeChannelsOfFloatsOrOfEncodedIntegers) {
  const std::string floats =
      NpyBytes("<f4", "(1, 2, 3)", FloatData({0, 0, -1, 5, 6, 7}));
  EXPECT_THAT(ParseNormalImage(AsBytes(floats), "a.npy").values,
              ElementsAre(0, 0, -1, 5, 6, 7));
  std::string integers;
  for (const uint16_t value : {0, 0, 0, 65535, 32767, 32768}) {
    Append(value, &integers);
  }
  const std::vector<float> decoded =
      ParseNormalImage(AsBytes(NpyBytes("<u2", "(1, 2, 3)", integers)), "a.npy")
          .values;
  // Black is no direction.
  EXPECT_EQ(std::vector<float>(decoded.begin(), decoded.begin() + 3),
            std::vector<float>(3));
  EXPECT_EQ(decoded[3], 1.f);
  EXPECT_NEAR(decoded[4], 0.f, 1e-4f);
  EXPECT_NEAR(decoded[5], 0.f, 1e-4f);
  // Three equal channels are still three.
  const cv::Mat zeros(2, 3, CV_32FC3, cv::Scalar::all(0));
  EXPECT_EQ(ParseNormalImage(AsBytes(EncodedPicture(".tiff", zeros)), "a.tiff")
                .channels,
            3);
  for (const int type : {CV_8UC1, CV_16UC1}) {
    const cv::Mat gray(2, 3, type, cv::Scalar(9));
    for (const char* name : {"a.png", "a.tiff"}) {
      ExpectError(ErrorCode::kUnsupported, {name, "three channels"}, [&] {
        ParseNormalImage(
            AsBytes(EncodedPicture(
                std::filesystem::path(name).extension().string(), gray)),
            name);
      });
    }
  }
  ExpectError(ErrorCode::kUnsupported, {"a.npy", "three channels"}, [&] {
    ParseNormalImage(
        AsBytes(NpyBytes("<f4", "(2, 3)", FloatData(std::vector<float>(6)))),
        "a.npy");
  });
}

TEST(DepthImage, RefusesPngHeadersThatNoFileCanHold) {
  const std::string bytes =
      PngFile(PngHeaderContent(1000000, 2, 16, 0), PngChunk("IDAT", "12345"));
  ExpectError(ErrorCode::kCorrupt, {"a.png", "cannot hold"}, [&] {
    ParseDepthImage(AsBytes(bytes), "a.png");
  });
}

TEST(DepthImage, OddPngFilesPrintNothing) {
  testing::internal::CaptureStderr();
  const std::string broken = PngWithBrokenStream(8, 6, 16);
  ExpectError(ErrorCode::kCorrupt, {"a.png: the PNG file is damaged: "}, [&] {
    ParseDepthImage(AsBytes(broken), "a.png");
  });
  // A color profile that makes no sense, behind the header.
  std::string profiled = PngBytes(1, 1, {7});
  profiled.insert(33, PngChunk("iCCP", "icc"));
  EXPECT_THAT(ParseDepthImage(AsBytes(profiled), "a.png").map.values,
              ElementsAre(7));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
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
  testing::internal::CaptureStderr();
  std::vector<std::string> files = {header(1000000, 60000), header(0, 2)};
  for (const auto& [position, value] : {std::pair(10, 7),  // No width.
                                        std::pair(7, 1),   // Tags far behind.
                                        std::pair(1, 77),  // "IM".
                                        std::pair(2, 7)}) {
    files.push_back(header(3, 2));
    files.back()[position] = static_cast<char>(value);
  }
  for (const std::string& bytes : files) {
    ExpectError(ErrorCode::kCorrupt,
                {"a.tif: the TIFF file is damaged: "},
                [&] { ParseDepthImage(AsBytes(bytes), "a.tif"); });
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
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

}  // namespace
}  // namespace tsar
