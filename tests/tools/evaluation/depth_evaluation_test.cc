// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/depth_evaluation.h"

#include "colmap_tsar/io/map_io.h"

#include <functional>

#include "tests/support/mask_files.h"
#include "tests/support/test_files.h"

namespace tsar {
namespace {

namespace fs = std::filesystem;

class DepthEvaluationTest : public FolderTest {
 protected:
  // Draws a value for every pixel and writes the map.
  void WriteMap(const fs::path& name,
                int size,
                const std::function<float(int, int)>& value) const {
    Image<float> map(size, size);
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        map(x, y) = value(x, y);
      }
    }
    fs::create_directories((folder_ / name).parent_path());
    WriteDepthMap(UserPath(folder_ / name), map);
  }
  void WriteMap(const fs::path& name, int size, float depth) const {
    WriteMap(name, size, [depth](int, int) { return depth; });
  }

  // Plain gray on the left half, a chessboard of pixels on the right one.
  void WritePicture(const std::string& name, int size) const {
    std::string content =
        "P5\n" + std::to_string(size) + " " + std::to_string(size) + "\n255\n";
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const bool is_white = (x + y) % 2 == 0;
        content += static_cast<char>(x < size / 2 ? 128 : is_white ? 255 : 0);
      }
    }
    Write(fs::path("images") / name, content);
  }

  fs::path Truth(const std::string& name) const {
    return fs::path("ground_truth/depth") / (name + ".bin");
  }
  fs::path Map(const std::string& name,
               const std::string& type = "geometric") const {
    return fs::path("stereo/depth_maps") / (name + "." + type + ".bin");
  }
};

void ExpectCounts(const DepthScore& score,
                  const std::string& area,
                  double tolerance,
                  int64_t num_right,
                  int64_t num_estimated,
                  int64_t num_known) {
  EXPECT_EQ(score.area, area);
  EXPECT_EQ(score.tolerance, tolerance);
  EXPECT_EQ(score.num_right, num_right);
  EXPECT_EQ(score.num_estimated, num_estimated);
  EXPECT_EQ(score.num_known, num_known);
}

TEST_F(DepthEvaluationTest, CountsPixelsInAllAndInTexturelessAreas) {
  WritePicture("left/a.pgm", 40);
  // Row 0 is unknown; 10 rows are right, 10 are 5 cm off, 10 are holes, 9 are
  // half a meter off.
  WriteMap(Truth("left/a.pgm"), 40, [](int, int y) { return y > 0 ? 2.f : 0; });
  WriteMap(Map("left/a.pgm"), 40, [](int, int y) {
    return y <= 10 ? 2.f : y <= 20 ? 2.05f : y <= 30 ? 0.f : 1.5f;
  });
  const DepthEvaluation evaluation = EvaluateDepthMaps(folder_, {});
  EXPECT_EQ(evaluation.num_images, 1);
  EXPECT_EQ(evaluation.num_images_without_map, 0);
  ASSERT_EQ(evaluation.scores.size(), 4u);
  ExpectCounts(evaluation.scores[0], "all", 0.02, 400, 1160, 1560);
  ExpectCounts(evaluation.scores[1], "all", 0.1, 800, 1160, 1560);
  // The window of 11 pixels touches the chessboard from column 15 on.
  ExpectCounts(evaluation.scores[2], "textureless", 0.02, 150, 435, 585);
  ExpectCounts(evaluation.scores[3], "textureless", 0.1, 300, 435, 585);
}

TEST_F(DepthEvaluationTest, ADepthOffByTheToleranceIsWrong) {
  WritePicture("a.pgm", 4);
  WriteMap("elsewhere/a.pgm.bin", 4, 2.f);
  WriteMap(Map("a.pgm"), 4, 2.25f);
  DepthEvaluationOptions options;
  options.ground_truth_path = folder_ / "elsewhere";
  options.tolerances = {0.25, 0.26};
  const DepthEvaluation evaluation = EvaluateDepthMaps(folder_, options);
  EXPECT_EQ(evaluation.scores[0].num_right, 0);
  EXPECT_EQ(evaluation.scores[1].num_right, 16);
}

TEST_F(DepthEvaluationTest, LooksGroundTruthUpAtThePixelsOfSmallerMaps) {
  WritePicture("a.pgm", 80);
  WriteMap(Truth("a.pgm"), 40, [](int x, int y) { return 1 + 0.1f * (x + y); });
  WriteMap(Map("a.pgm", "photometric"), 20, [](int x, int y) {
    return 1 + 0.1f * (2 * x + 1 + 2 * y + 1);
  });
  DepthEvaluationOptions options;
  options.input_type = MapType::kPhotometric;
  const DepthEvaluation evaluation = EvaluateDepthMaps(folder_, options);
  EXPECT_EQ(evaluation.scores[0].num_right, 400);
  EXPECT_EQ(evaluation.scores[0].num_known, 400);
  EXPECT_EQ(evaluation.scores[0].F1(), 1);
}

TEST_F(DepthEvaluationTest, AddsUpImagesAndReportsMissingMaps) {
  for (const std::string name : {"a.pgm", "b.pgm", "c.pgm"}) {
    WritePicture(name, 8);
    WriteMap(Truth(name), 8, 1.f);
  }
  WriteMap(Map("a.pgm"), 8, 1.f);
  WriteMap(Map("b.pgm"), 8, 2.f);
  const DepthEvaluation evaluation = EvaluateDepthMaps(folder_, {});
  EXPECT_EQ(evaluation.num_images, 2);
  EXPECT_EQ(evaluation.num_images_without_map, 1);
  EXPECT_EQ(evaluation.scores[0].Precision(), 0.5);
  EXPECT_EQ(evaluation.scores[0].Recall(), 0.5);
}

TEST_F(DepthEvaluationTest, MaskedPixelsAreNotScored) {
  for (const std::string name : {"a.pgm", "left/b.pgm"}) {
    WritePicture(name, 40);
    WriteMap(Truth(name), 40, 2.f);
    // A quarter each is right, wrong, and a hole.
    WriteMap(Map(name), 20, [](int x, int y) {
      return x < 10 ? (y < 10 ? 2.f : 3.f) : y < 10 ? 0.f : 2.f;
    });
  }
  DepthEvaluationOptions options;
  options.mask_path = folder_ / "masks";
  // In one image, one pixel less than the upper half is masked.
  WriteMask(options.mask_path / "left/b.pgm.png", 40, 40, [](int x, int y) {
    return y < 20 && !(x > 37 && y > 17);
  });
  const DepthEvaluation evaluation = EvaluateDepthMaps(folder_, options);
  EXPECT_EQ(evaluation.num_images, 2);
  EXPECT_EQ(evaluation.num_masks, 1);
  ExpectCounts(evaluation.scores[0], "all", 0.02, 300, 500, 601);
  // One of the size of the map says the same.
  WriteMask(options.mask_path / "left/b.pgm.png", 20, 20, [](int x, int y) {
    return y < 10 && !(x == 19 && y == 9);
  });
  ExpectCounts(EvaluateDepthMaps(folder_, options).scores[0],
               "all",
               0.02,
               300,
               500,
               601);
  options.mask_path.clear();
  const DepthEvaluation whole = EvaluateDepthMaps(folder_, options);
  EXPECT_FALSE(whole.num_masks);
  ExpectCounts(whole.scores[0], "all", 0.02, 400, 600, 800);
}

TEST_F(DepthEvaluationTest, RefusesMasksThatAreNone) {
  WritePicture("a.pgm", 8);
  WriteMap(Truth("a.pgm"), 8, 1.f);
  WriteMap(Map("a.pgm"), 8, 1.f);
  DepthEvaluationOptions options;
  options.mask_path = folder_ / "masks";
  const auto evaluate = [&] { EvaluateDepthMaps(folder_, options); };
  EXPECT_EQ(CodeOf(evaluate), ErrorCode::kNotFound);
  WriteMask(
      options.mask_path / "b.pgm.png", 8, 8, [](int, int) { return true; });
  EXPECT_EQ(CodeOf(evaluate), ErrorCode::kNotFound);
  // An image of the workspace without ground truth.
  WritePicture("b.pgm", 8);
  EXPECT_EQ(EvaluateDepthMaps(folder_, options).num_masks, 0);
  WriteMask(
      options.mask_path / "a.pgm.png", 9, 8, [](int, int) { return true; });
  EXPECT_EQ(CodeOf(evaluate), ErrorCode::kMismatch);
  // The folder of the images, whose names would match.
  options.mask_path = folder_ / "images";
  EXPECT_EQ(CodeOf(evaluate), ErrorCode::kBadOption);
}

TEST_F(DepthEvaluationTest, InputsAreThereWholeAndOfTheShapeOfTheGroundTruth) {
  const auto code = [&] {
    return CodeOf([&] { EvaluateDepthMaps(folder_, {}); });
  };
  EXPECT_EQ(code(), ErrorCode::kNotFound);
  WriteMap(Truth("a.pgm"), 8, 1.f);
  EXPECT_EQ(code(), ErrorCode::kNotFound);
  WriteMap(Map("a.pgm"), 8, 1.f);
  EXPECT_EQ(code(), ErrorCode::kNotFound);
  Write("images/a.pgm", "P5\n8 8\n255\ncut off");
  EXPECT_EQ(code(), ErrorCode::kCorrupt);
  WritePicture("a.pgm", 8);
  EXPECT_EQ(code(), std::nullopt);
  WriteDepthMap(UserPath(folder_ / Map("a.pgm")), Image<float>(8, 3, 1.f));
  EXPECT_EQ(code(), ErrorCode::kMismatch);
  WriteMap(Map("a.pgm"), 16, 1.f);
  EXPECT_EQ(code(), std::nullopt);
  WriteMap(Truth("a.pgm"), 8, 0.f);
  EXPECT_EQ(code(), ErrorCode::kCorrupt);
  WriteMap(Truth("a.pgm"), 8, 1.f);
  Write("images/a.pgm", "P5\n8 3\n255\n" + std::string(24, 'x'));
  EXPECT_EQ(code(), ErrorCode::kMismatch);
}

TEST_F(DepthEvaluationTest, ScoresWithoutPixelsAreZero) {
  EXPECT_EQ(DepthScore().Precision(), 0);
  EXPECT_EQ(DepthScore().Recall(), 0);
  EXPECT_EQ(DepthScore().F1(), 0);
}

}  // namespace
}  // namespace tsar
