// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/prior_folder.h"

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/external_writers.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

namespace fs = std::filesystem;

constexpr RasterSize kPhoto = {30, 20};

std::string NpyOf(int width,
                  int height,
                  int channels,
                  const std::vector<float>& values) {
  return NpyBytes("<f4",
                  "(" + std::to_string(height) + ", " + std::to_string(width) +
                      (channels == 1 ? ")" : ", 3)"),
                  FloatData(values));
}

class ReadPriorTest : public testing::Test {
 protected:
  fs::path Write(const std::string& name, const std::string& bytes) const {
    WriteText(folder_.Path() / name, bytes);
    return folder_.Path() / name;
  }
  static Image<float> ReadDepth(const fs::path& path,
                                const RasterSize& photo = kPhoto) {
    return ReadPrior({path, {}}, PriorType::kAuto, photo).values;
  }
  static void ExpectRefused(const PriorFiles& files,
                            ErrorCode code,
                            std::vector<std::string> texts) {
    texts.push_back(
        (files.depth.empty() ? files.normals : files.depth).string());
    ExpectError(
        code, texts, [&] { ReadPrior(files, PriorType::kAuto, kPhoto); });
  }

  TemporaryFolder folder_;
};

TEST_F(ReadPriorTest, NormalsGetUnitLength) {
  const fs::path file = Write(
      "a.npy",
      NpyOf(3, 1, 3, {0.f, 0.f, -9.f, 0.f, 0.3f, -0.4f, 1e30f, 0.f, -1.f}));
  const Image<Vec3f> normals =
      ReadPrior({{}, file}, PriorType::kAuto, {30, 10}).normals;
  EXPECT_EQ(normals(0, 0), (Vec3f{0.f, 0.f, -1.f}));
  EXPECT_LT(Norm(normals(1, 0) - Vec3f{0.f, 0.6f, -0.8f}), 1e-6f);
  EXPECT_EQ(normals(2, 0), Vec3f{});
}

TEST_F(ReadPriorTest, NegativeValuesTellThatAConstantIsMissing) {
  const auto values = [&](const std::vector<float>& stored, PriorType type) {
    const fs::path file = Write("a.npy", NpyOf(3, 2, 1, stored));
    const Image<float> read = ReadPrior({file, {}}, type, kPhoto).values;
    return std::vector<float>(read.begin(), read.end());
  };
  const std::vector<float> affine = {-2, -1, 0, 1, NAN, 3};
  for (const PriorType type : {PriorType::kAuto, PriorType::kInverse}) {
    EXPECT_THAT(values(affine, type),
                testing::Pointwise(testing::FloatEq(),
                                   {0.05f, 1.05f, 2.05f, 3.05f, 0.f, 5.05f}));
  }
  EXPECT_THAT(values(affine, PriorType::kMetric),
              testing::ElementsAre(0, 0, 0, 1, 0, 3));
  // One number that stands for "none".
  EXPECT_THAT(values({-1, -1, 2, 1, -1, 3}, PriorType::kAuto),
              testing::ElementsAre(0, 0, 2, 1, 0, 3));
}

TEST_F(ReadPriorTest, ReadsBothWithSizesOfTheirOwn) {
  const fs::path depth = Write("a.npy", NpyOf(3, 2, 1, {1, 2, 3, 4, 5, 6}));
  std::vector<float> values(3 * 6 * 4);
  const fs::path normals = Write("a.normal.npy", NpyOf(6, 4, 3, values));
  const DepthPrior prior =
      ReadPrior({depth, normals}, PriorType::kInverse, kPhoto);
  EXPECT_EQ(prior.type, PriorType::kInverse);
  EXPECT_EQ(prior.values.Width(), 3);
  EXPECT_EQ(prior.normals.Width(), 6);
}

TEST_F(ReadPriorTest, TakesTheNearestPixelsOfLargeRasters) {
  constexpr int kWidth = 2 * kMaxPriorSide;
  constexpr int kHeight = 30;
  std::vector<float> values;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      values.push_back(static_cast<float>(1 + x + kWidth * y));
    }
  }
  const Image<float> depth =
      ReadDepth(Write("a.npy", NpyOf(kWidth, kHeight, 1, values)),
                {10 * kWidth, 10 * kHeight});
  ASSERT_EQ(depth.Width(), kMaxPriorSide);
  ASSERT_EQ(depth.Height(), kHeight / 2);
  for (int y = 0; y < depth.Height(); ++y) {
    for (int x = 0; x < depth.Width(); ++x) {
      ASSERT_EQ(depth(x, y), 1 + (2 * x + 1) + kWidth * (2 * y + 1));
    }
  }
  // A raster one pixel wide is not reduced to less than that.
  const Image<float> narrow = ReadDepth(
      Write("a.npy",
            NpyOf(1, kMaxPriorSide + 1, 1, std::vector<float>(1025, 1.f))),
      {1, kMaxPriorSide + 1});
  EXPECT_EQ(narrow.Width(), 1);
  EXPECT_EQ(narrow.Height(), kMaxPriorSide);
}

TEST_F(ReadPriorTest, AnySizeFitsThatHasThePhotosShape) {
  const auto fits = [&](int width, int height, const RasterSize& photo) {
    const fs::path file =
        Write("a.npy",
              NpyOf(width,
                    height,
                    1,
                    std::vector<float>(static_cast<size_t>(width * height))));
    try {
      ReadDepth(file, photo);
      return true;
    } catch (const Error& error) {
      EXPECT_EQ(error.Code(), ErrorCode::kMismatch);
      return false;
    }
  };
  EXPECT_TRUE(fits(256, 192, {4032, 3024}));
  EXPECT_TRUE(fits(518, 392, {4032, 3024}));  // Multiples of 14.
  EXPECT_TRUE(fits(8, 6, {4, 3}));
  EXPECT_TRUE(fits(256, 192, {4032, 2970}));   // 1.8 % off.
  EXPECT_FALSE(fits(256, 192, {4032, 2950}));  // 2.5 % off.
  EXPECT_FALSE(fits(256, 192, {3024, 4032}));
  EXPECT_TRUE(fits(4, 2, {40, 30}));  // A pixel off.
  EXPECT_FALSE(fits(8, 4, {40, 30}));
  EXPECT_TRUE(fits(1, 1, {40, 30}));
}

TEST_F(ReadPriorTest, TellsWhyAFileIsRefused) {
  const auto file = [&](int width, int height, int channels) {
    return Write("a.npy",
                 NpyOf(width,
                       height,
                       channels,
                       std::vector<float>(
                           static_cast<size_t>(width * height * channels))));
  };
  const std::vector<std::string> shape = {
      "has 2 x 8 pixels", "undistorted image of 30 x 20", "folder images"};
  ExpectRefused({file(2, 8, 1), {}}, ErrorCode::kMismatch, shape);
  ExpectRefused({{}, file(2, 8, 3)}, ErrorCode::kMismatch, shape);
  ExpectRefused({file(3, 2, 3), {}},
                ErrorCode::kUnsupported,
                {"3 channels", ".normal.npy"});
  ExpectRefused(
      {{}, file(3, 2, 1)}, ErrorCode::kUnsupported, {"three channels"});
  for (const char* name : {"a.npy", "a.pfm", "a.png", "a.tif", "a.exr"}) {
    ExpectRefused({Write(name, ""), {}}, ErrorCode::kCorrupt, {"is empty"});
    ExpectRefused({{}, Write(name, "some text")}, ErrorCode::kCorrupt, {});
  }
  const fs::path missing = folder_.Path() / "b.npy";
  ExpectRefused({missing, {}}, ErrorCode::kNotFound, {"no such file"});
  fs::create_directories(missing);
  ExpectRefused({missing, {}}, ErrorCode::kIo, {"cannot be read"});
}

}  // namespace
}  // namespace tsar
