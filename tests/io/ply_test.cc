// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/ply.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "tests/support/test_files.h"

namespace tsar {
namespace {

using Points = std::vector<Eigen::Vector3d>;

template <typename T>
std::string Bytes(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

std::string Header(const std::string& format, const std::string& elements) {
  return "ply\nformat " + format + " 1.0\n" + elements + "end_header\n";
}

const char kXyz[] = "property float x\nproperty float y\nproperty float z\n";

class PlyTest : public FolderTest {
 protected:
  Points Read(const std::string& content) {
    return ReadPlyPoints(Write("cloud.ply", content));
  }
  std::optional<ErrorCode> Failure(const std::string& content) {
    return CodeOf([&] { Read(content); });
  }
};

TEST_F(PlyTest, ReadsAscii) {
  const Points expected = {{1, 2, 3}, {-0.5, 1e3, 0}};
  EXPECT_EQ(Read(Header("ascii", std::string("element vertex 2\n") + kXyz) +
                 "1 2 3\n-0.5 1e3 0\n"),
            expected);
}

TEST_F(PlyTest, ReadsBinaryWithOtherProperties) {
  const std::string elements =
      "comment made by a test\nelement vertex 2\nproperty uchar red\n"
      "property float z\nproperty double x\nproperty short y\n";
  std::string body;
  for (int i = 0; i < 2; ++i) {
    body += Bytes<uint8_t>(7) + Bytes<float>(0.25f + i) +
            Bytes<double>(1e-9 + i) + Bytes<int16_t>(static_cast<int16_t>(-i));
  }
  const Points expected = {{1e-9, 0, 0.25}, {1e-9 + 1, -1, 1.25}};
  EXPECT_EQ(Read(Header("binary_little_endian", elements) + body), expected);
}

TEST_F(PlyTest, SkipsElementsAroundTheVertices) {
  const std::string elements =
      std::string(
          "element camera 2\nproperty int a\nproperty uchar b\n"
          "element vertex 1\n") +
      kXyz + "element face 1\nproperty list uchar int vertex_index\n";
  const Points expected = {{4, 5, 6}};
  EXPECT_EQ(Read(Header("ascii", elements) + "1 2\n3 4\n4 5 6\n3 0 0 0\n"),
            expected);
  const std::string vertex =
      Bytes<float>(4) + Bytes<float>(5) + Bytes<float>(6);
  EXPECT_EQ(Read(Header("binary_little_endian", elements) +
                 std::string(10, '\1') + vertex + "rest"),
            expected);
}

TEST_F(PlyTest, ReadsLinesThatEndAsOnWindowsAndACloudWithoutPoints) {
  const Points expected = {{1, 2, 3}};
  EXPECT_EQ(Read("ply\r\nformat ascii 1.0\r\nelement vertex 1\r\nproperty "
                 "float x\r\nproperty float y\r\nproperty float "
                 "z\r\nend_header\r\n1 2 3\r\n"),
            expected);
  EXPECT_TRUE(Read(Header("binary_little_endian",
                          std::string("element vertex 0\n") + kXyz))
                  .empty());
}

TEST_F(PlyTest, CountsThatTheFileCannotHoldAreCorrupt) {
  for (const std::string count :
       {"3", "1000000000000000000", "18446744073709551615", "-1", "many"}) {
    const std::string elements = "element vertex " + count + "\n" + kXyz;
    const std::string before = "element camera " + count +
                               "\nproperty double a\nelement vertex 0\n" + kXyz;
    for (const std::string& content :
         {Header("binary_little_endian", elements) + std::string(24, '\0'),
          Header("ascii", elements) + "1 2 3\n4 5 6\n",
          Header("binary_little_endian", before) + std::string(16, '\0')}) {
      EXPECT_EQ(Failure(content), ErrorCode::kCorrupt) << count;
    }
  }
}

TEST_F(PlyTest, EveryTruncationIsCorrupt) {
  const std::string whole =
      Header("binary_little_endian", std::string("element vertex 2\n") + kXyz) +
      std::string(24, '\0');
  EXPECT_EQ(Failure(whole), std::nullopt);
  for (size_t length = 0; length < whole.size(); ++length) {
    EXPECT_EQ(Failure(whole.substr(0, length)), ErrorCode::kCorrupt) << length;
  }
}

TEST_F(PlyTest, RefusesOtherContent) {
  constexpr ErrorCode kCorrupt = ErrorCode::kCorrupt;
  constexpr ErrorCode kUnsupported = ErrorCode::kUnsupported;
  const std::string vertex = std::string("element vertex 1\n") + kXyz;
  const float bad = std::numeric_limits<float>::quiet_NaN();
  for (const auto& [content, code] :
       {std::pair(std::string("hello\n"), kCorrupt),
        std::pair("ply\n" + vertex + "end_header\n1 2 3\n", kCorrupt),
        std::pair(Header("ascii", "property float x\n" + vertex), kCorrupt),
        std::pair(
            Header("ascii", "element vertex 1\nproperty float x\n") + "1\n",
            kCorrupt),
        std::pair(Header("ascii", "element vertex 1\nproperty half x\n"),
                  kCorrupt),
        std::pair(Header("ascii", "elephant 1\n" + vertex) + "1 2 3\n",
                  kCorrupt),
        std::pair(Header("ascii", "element face 0\nproperty int a\n"),
                  kCorrupt),
        std::pair(Header("ascii", vertex) + "1 two 3\n", kCorrupt),
        std::pair(Header("binary_little_endian", vertex) + Bytes(0.f) +
                      Bytes(bad) + Bytes(0.f),
                  kCorrupt),
        std::pair(Header("binary_big_endian", vertex) + std::string(12, 0),
                  kUnsupported),
        std::pair(
            Header("ascii",
                   "element face 1\nproperty list uchar int i\n" + vertex) +
                "1 0\n1 2 3\n",
            kUnsupported)}) {
    EXPECT_EQ(Failure(content), code) << content;
  }
  EXPECT_EQ(CodeOf([&] { ReadPlyPoints(folder_ / "none.ply"); }),
            ErrorCode::kNotFound);
  EXPECT_EQ(CodeOf([&] { ReadPlyPoints(folder_); }), ErrorCode::kIo);
}

}  // namespace
}  // namespace tsar
