// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/array_files.h"

#include <bit>
#include <limits>

#include "tests/io/format_readers.h"
#include "tests/support/external_writers.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

using testing::ElementsAre;

constexpr float kInf = std::numeric_limits<float>::infinity();

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

}  // namespace
}  // namespace tsar
