// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/depth_image.h"
#include "colmap_tsar/io/float_map.h"

#include <algorithm>
#include <functional>
#include <random>

#include "tests/io/format_readers.h"
#include "tests/support/external_writers.h"
#include "tests/support/test_workspace.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

// One way to read bytes.
using Reader = std::function<FloatMap(const std::string& bytes)>;
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

}  // namespace
}  // namespace tsar
