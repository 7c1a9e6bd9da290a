// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/run/load_view.h"

#include <chrono>
#include <limits>

#include "tests/run/refine_workspace_fixture.h"
#include "tests/support/mask_files.h"
#include "tests/support/same_bytes.h"
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

constexpr int kWidth = SyntheticWorkspace::kWidth;
constexpr int kHeight = SyntheticWorkspace::kHeight;

// With masks of the second and the third image, "v1.png" and "left/v2.png".
class RefineMaskedTest : public RefineWorkspaceTest {
 protected:
  void SetUp() override {
    RefineWorkspaceTest::SetUp();
    WriteMasks(&IsMasked);
  }

  // In part of the wall with texture, and of the bare rectangle.
  static bool IsMasked(int x, int y) {
    return x >= 20 && x < 60 && y >= 10 && y < 40;
  }
  void WriteMasks(bool (*is_masked)(int, int)) const {
    for (const char* name : {"v1.png.png", "left/v2.png.png"}) {
      WriteMask(masks_ / name, kWidth, kHeight, is_masked);
    }
  }
  WorkspaceRefineOptions Masked(const std::filesystem::path& root) const {
    WorkspaceRefineOptions options = Options(root);
    options.mask_path = masks_;
    return options;
  }
  WorkspaceRefineOptions Masked() const { return Masked(root_); }
  // Replaces everything that the maps of an image hold where it is masked.
  static void Scramble(const std::filesystem::path& root,
                       const std::string& name) {
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      const MapPaths paths = GetMapPaths(root, name, type);
      Image<float> depth = ReadDepthMap(paths.depth);
      Image<Vec3f> normal = ReadNormalMap(paths.normal);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          if (IsMasked(x, y)) {
            depth(x, y) = (x + y) % 3 == 0 ? 0.f : 4.f + 0.01f * (7 * x % 50);
            normal(x, y) = depth(x, y) > 0.f
                               ? Normalized(Vec3f{0.1f * (y % 5), 0.2f, -1.f})
                               : Vec3f{};
          }
        }
      }
      WriteDepthMap(UserPath(paths.depth), depth);
      WriteNormalMap(UserPath(paths.normal), normal);
    }
  }
  static Tree GeometricMapsOf(const std::filesystem::path& root) {
    Tree maps = MapsOf(root);
    std::erase_if(maps, [](const auto& file) {
      return file.first.find(".photometric.") != std::string::npos;
    });
    return maps;
  }

  const std::filesystem::path masks_ = folder_.Path() / "masks";
};

TEST_F(RefineMaskedTest, MaskedPixelsAreEmptyInAllMaps) {
  for (const bool scene_planes : {true, false}) {
    RefineOptions refine;
    refine.scene_planes = scene_planes;
    const RunSummary summary = Refine(Masked(), refine);
    EXPECT_EQ(summary.num_refined, 4);
    EXPECT_EQ(summary.num_masks, 2);
    EXPECT_EQ(Manifest()["runtime"]["masks"], "2");
    for (const int view : {0, 1}) {
      const MapPaths paths = Paths(view);
      const Image<float> depth = ReadDepthMap(paths.depth);
      const Image<Vec3f> normal = ReadNormalMap(paths.normal);
      const Image<float> sigma = ReadSigmaMap(paths.sigma);
      const Image<uint8_t> confidence = ReadGrayPng(paths.confidence);
      const Image<uint8_t> provenance = ReadGrayPng(paths.provenance);
      int num_with_depth = 0;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          if (view == 1 && IsMasked(x, y)) {
            ASSERT_EQ(depth(x, y), 0.f);
            ASSERT_TRUE(normal(x, y) == Vec3f{});
            ASSERT_EQ(sigma(x, y), 0.f);
            ASSERT_EQ(confidence(x, y), 0);
            ASSERT_EQ(provenance(x, y), 0);
          } else {
            num_with_depth += depth(x, y) > 0.f ? 1 : 0;
          }
        }
      }
      const int num_masked = view == 1 ? 40 * 30 : 0;
      EXPECT_GT(num_with_depth, (kWidth * kHeight - num_masked) * 9 / 10);
      if (scene_planes) {
        const Image<uint16_t> planes = ReadGray16Png(paths.planes);
        EXPECT_EQ(planes(40, 30) == 0, view == 1);
      }
    }
  }
}

// Neither for their own image nor, as sources, for others.
TEST_F(RefineMaskedTest, MaskedPixelsAreNoEvidence) {
  const std::filesystem::path other = folder_.Path() / "other";
  for (const bool scene_planes : {true, false}) {
    RefineOptions refine;
    refine.scene_planes = scene_planes;
    for (const std::filesystem::path& root : {root_, other}) {
      std::filesystem::remove_all(root);
      MakeSyntheticWorkspace(root);
    }
    Scramble(other, "v1.png");
    Scramble(other, "left/v2.png");
    Refine(Masked(), refine);
    Refine(Masked(other), refine);
    const Tree masked = GeometricMapsOf(root_);
    ExpectSameFiles(masked, GeometricMapsOf(other));
    // Without the mask, its content changes the result.
    Refine(Options(root_), refine);
    for (const char* map : {"v0.png.geometric.bin", "v1.png.geometric.bin"}) {
      const std::string name = std::string("stereo/depth_maps/") + map;
      EXPECT_TRUE(MapsOf(root_).at(name) != masked.at(name)) << name;
    }
  }
}

TEST_F(RefineMaskedTest, WhiteMasksChangeNothing) {
  WriteMasks([](int, int) { return false; });
  for (const bool scene_planes : {true, false}) {
    RefineOptions refine;
    refine.scene_planes = scene_planes;
    Redraw();
    Refine(Masked(), refine);
    ExpectSameFiles(MapsOf(root_), RefinedInOneGo(refine));
  }
}

TEST_F(RefineMaskedTest, AnImageThatIsKeptForOtherReasonsStays) {
  // Depths without normals are no evidence; few of them are masked.
  const MapPaths paths = GetMapPaths(root_, "v1.png", MapType::kGeometric);
  WriteNormalMap(UserPath(paths.normal), Image<Vec3f>(kWidth, kHeight));
  const Image<float> depth = ReadDepthMap(paths.depth);
  const RunSummary summary = Refine(Masked());
  ASSERT_EQ(summary.kept.size(), 1u);
  EXPECT_EQ(summary.kept[0].name, "v1.png");
  const Image<float> after = ReadDepthMap(paths.depth);
  EXPECT_TRUE(std::equal(depth.begin(), depth.end(), after.begin()));
}

TEST_F(RefineMaskedTest, RefinesAgainWhereMasksHaveChanged) {
  Refine();
  EXPECT_FALSE(Manifest()["runtime"].contains("masks"));
  const auto has_warning =
      testing::HasSubstr("refined again, since the mask of ");
  // Given, changed, and no longer given; all images have the planes of one
  // scene.
  EXPECT_THAT(WarningsOf(Masked(), 4), has_warning);
  EXPECT_EQ(WarningsOf(Masked(), 0), "");
  const Tree masked = MapsOf(root_);
  WriteMask(
      masks_ / "v1.png.png", kWidth, kHeight, [](int x, int) { return x < 3; });
  EXPECT_THAT(WarningsOf(Masked(), 4),
              testing::HasSubstr("the mask of v1.png has changed\n"));
  WriteMasks(&IsMasked);
  Refine(Masked());
  ExpectSameFiles(MapsOf(root_), masked);
  EXPECT_THAT(WarningsOf(Options(root_), 4), has_warning);
  ExpectSameFiles(MapsOf(root_), RefinedInOneGo());
}

TEST_F(RefineMaskedTest, AnImageThatIsMaskedAltogetherGetsEmptyMaps) {
  WriteMasks([](int, int) { return true; });
  // The photo of "v1.png", and one without a mask.
  for (const char* name : {"images/v1.png", "images/v3.png"}) {
    cv::Mat photo = cv::imread((root_ / name).string());
    photo.colRange(0, 3) = cv::Scalar::all(0);
    cv::imwrite((root_ / name).string(), photo);
  }
  for (const bool scene_planes : {true, false}) {
    RefineOptions refine;
    refine.scene_planes = scene_planes;
    const RunSummary summary = Refine(Masked(), refine);
    EXPECT_EQ(summary.num_refined, 4);
    EXPECT_TRUE(summary.kept.empty());
    EXPECT_EQ(summary.counts.at(kMaskedAway), 2);
    EXPECT_EQ(summary.counts.at(kBlackBorders), 1);
    for (const float z : ReadDepthMap(Paths(1).depth)) {
      ASSERT_EQ(z, 0.f);
    }
    EXPECT_EQ(Refine(Masked(), refine).num_skipped, 4);
  }
}

TEST_F(RefineMaskedTest, WritesMaskedMapsIntoASecondWorkspace) {
  Refine(Masked());
  const Tree in_place = MapsOf(root_);
  Redraw();
  WorkspaceRefineOptions options = Masked();
  options.output_path = folder_.Path() / "out";
  EXPECT_EQ(Refine(options).num_refined, 4);
  const Tree output = MapsOf(options.output_path);
  for (const auto& [name, content] : in_place) {
    ASSERT_EQ(output.count(name), 1u) << name;
    EXPECT_TRUE(output.at(name) == content) << name << " differs";
  }
}

TEST_F(RefineMaskedTest, RefusesMasksThatDoNotFitBeforeAnythingIsChanged) {
  const std::filesystem::path mask = masks_ / "left/v2.png.png";
  const std::string png = ReadText(mask);
  WriteMask(mask, kWidth + 1, kHeight, &IsMasked);
  ExpectRefusal(ErrorCode::kMismatch,
                {mask.string() + ": the mask has 97 x 72 pixels, its "
                                 "undistorted image 96 x 72",
                 "image_undistorter"},
                Masked());
  WriteText(mask, png.substr(0, png.size() - 20));
  ExpectRefusal(ErrorCode::kCorrupt, {mask.string(), "breaks off"}, Masked());
  WorkspaceRefineOptions images = Masked();
  images.mask_path = root_ / "images";
  ExpectRefusal(ErrorCode::kBadOption,
                {"is the folder of the images", "mask_path"},
                images);
  images.mask_path = folder_.Path() / "nowhere";
  ExpectRefusal(ErrorCode::kNotFound, {"no such folder of masks"}, images);
  images.mask_path = root_ / "stereo";
  ExpectRefusal(ErrorCode::kNotFound,
                {"holds no mask of any image", "mask_path"},
                images);
}

// However the view is read.
TEST_F(RefineMaskedTest, ViewsHaveNothingWhereTheyAreMasked) {
  CreateFolders(Paths(1).cost.Parent());
  WriteMap(Paths(1).cost,
           {kWidth, kHeight, 2},
           std::vector<float>(size_t{2} * kWidth * kHeight, 0.25f));
  Workspace workspace(root_, MapType::kGeometric);
  const int image = workspace.Model().IndexOf("v1.png");
  const ViewData whole = LoadView(workspace, image);
  workspace.UseMasks(masks_);
  const ViewData view = LoadView(workspace, image);
  EXPECT_LT(view.num_depths, whole.num_depths);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (IsMasked(x, y)) {
        ASSERT_EQ(view.depth(x, y), 0.f);
        ASSERT_TRUE(view.normal(x, y) == Vec3f{});
        ASSERT_EQ(view.min_cost(x, y), kUndefinedCost);
      } else {
        ASSERT_EQ(view.depth(x, y), whole.depth(x, y));
        ASSERT_TRUE(view.normal(x, y) == whole.normal(x, y));
        ASSERT_EQ(view.min_cost(x, y), whole.min_cost(x, y));
      }
    }
  }
  // Reduced row by row, and as a whole.
  const ViewData rows = LoadReducedView(workspace, image, 32);
  const ViewData reduced = ReduceView(view, 3);
  EXPECT_TRUE(SameBytes(rows.depth, reduced.depth));
  EXPECT_TRUE(SameBytes(rows.normal, reduced.normal));
  EXPECT_EQ(rows.depth(8, 5), 0.f);
}

}  // namespace
}  // namespace tsar
