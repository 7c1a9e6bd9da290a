// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/sigma_map.h"

#include "colmap_tsar/base/half.h"

#include <string>

#include "tests/support/test_workspace.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

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
