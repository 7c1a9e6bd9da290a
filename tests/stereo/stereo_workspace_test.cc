// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/stereo/stereo_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/controllers/load_view.h"
#include "colmap_tsar/controllers/refine_workspace.h"
#include "colmap_tsar/pipeline/depth_interval.h"
#include "colmap_tsar/stereo/stereo_image.h"
#include "colmap_tsar/store/workspace.h"
#include "colmap_tsar/workspace/map_io.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <sstream>

#include "tests/support/mask_files.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

constexpr double kDepth = SyntheticWorkspace::kDepth;
constexpr int kMapWidth = SyntheticWorkspace::kWidth / 4;
constexpr int kMapHeight = SyntheticWorkspace::kHeight / 4;

TEST(SparseDepthInterval, IsThatOfThePointsInFrontWidened) {
  SparseModel model;
  model.images.resize(2);
  model.images[0].camera.translation = {0, 0, 1};
  for (int i = 0; i < 101; ++i) {
    model.points.push_back({0, 0, 1.0 + i});
    model.images[0].point_indices.push_back(i);
  }
  model.points.push_back({0, 0, -50});
  model.images[0].point_indices.push_back(101);
  const std::optional<DepthInterval> range = SparseDepthInterval(model, 0);
  ASSERT_TRUE(range);
  // Depths 2 to 102; one of a hundred is left out at either end.
  EXPECT_DOUBLE_EQ(range->min, 3 * 0.75);
  EXPECT_DOUBLE_EQ(range->max, 101 * 1.25);
  EXPECT_FALSE(SparseDepthInterval(model, 1));
}

class StereoWorkspaceTest : public testing::Test {
 protected:
  void SetUp() override {
    MakeSyntheticWorkspace(root_);
    RemoveMaps(root_);
    options_.depth_min = 0.5 * kDepth;
    options_.depth_max = 2.0 * kDepth;
    options_.num_iterations = 2;
    // Enough for tests of files; matching itself needs all of an image.
    options_.max_image_size = kMapWidth;
  }

  static void RemoveMaps(const std::filesystem::path& root) {
    for (const char* folder : {"depth_maps", "normal_maps"}) {
      std::filesystem::remove_all(root / "stereo" / folder);
    }
  }

  StereoSummary Run(
      bool overwrite = false,
      int num_threads = 1,
      const std::function<bool()>& should_stop = [] { return false; }) {
    DeviceOptions devices;
    devices.choice = DeviceChoice::kCpu;
    devices.num_threads = num_threads;
    std::ostringstream log;
    Progress progress(log, false);
    return MatchWorkspace(root_,
                          devices,
                          options_,
                          overwrite,
                          progress,
                          should_stop,
                          image_list_path_,
                          mask_path_);
  }

  void ExpectError(ErrorCode code,
                   const std::string& text,
                   const std::function<void()>& function) {
    try {
      function();
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.Code(), code);
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos)
          << error.what();
    }
  }

  std::map<std::string, std::string> Maps() const {
    std::map<std::string, std::string> maps;
    for (const char* folder : {"depth_maps", "normal_maps", "cost_maps"}) {
      if (!std::filesystem::exists(root_ / "stereo" / folder)) {
        continue;
      }
      for (auto& [name, content] : ReadTree(root_ / "stereo" / folder)) {
        maps[std::string(folder) + "/" + name] = std::move(content);
      }
    }
    return maps;
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
  StereoOptions options_;
  std::filesystem::path image_list_path_;
  std::filesystem::path mask_path_;
};

TEST_F(StereoWorkspaceTest, MakesListedImagesAsAmongAll) {
  // A chain: the last pass on an image needs the photometric maps of its
  // source alone, and of the source's own, but not of the rest.
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\nv1.png\nv1.png\nleft/v2.png\nleft/v2.png\nv3.png\n"
            "v3.png\nleft/v2.png\n");
  options_.num_geometric_passes = 2;
  options_.planar_prior = false;
  Run();
  const auto whole = Maps();
  for (const char* folder :
       {"depth_maps", "normal_maps", "cost_maps", "tsar_stereo"}) {
    std::filesystem::remove_all(root_ / "stereo" / folder);
  }
  image_list_path_ = folder_.Path() / "list.txt";
  WriteText(image_list_path_, "v0.png\r\n");
  EXPECT_EQ(Run().num_images, 1);
  const auto listed = Maps();
  const std::vector<std::pair<std::string, bool>> expected = {
      {"depth_maps/v0.png.geometric.bin", true},
      {"cost_maps/v0.png.geometric.bin", true},
      {"depth_maps/v0.png.photometric.bin", true},
      {"depth_maps/v1.png.photometric.bin", true},
      {"depth_maps/left/v2.png.photometric.bin", true},
      {"depth_maps/v3.png.photometric.bin", false},
      {"depth_maps/v1.png.geometric.bin", false},
      {"depth_maps/left/v2.png.geometric.bin", false}};
  for (const auto& [name, is_there] : expected) {
    ASSERT_EQ(listed.count(name), is_there ? 1u : 0u) << name;
    if (is_there) {
      EXPECT_TRUE(listed.at(name) == whole.at(name)) << name << " differs";
    }
  }
  EXPECT_EQ(Run().num_skipped, 1);
  // Now all; what was made stays.
  image_list_path_.clear();
  EXPECT_EQ(Run().num_skipped, 1);
  EXPECT_TRUE(Maps() == whole);
}

TEST_F(StereoWorkspaceTest, TakesAModelInTheFolder0) {
  options_.geom_consistency = false;
  std::filesystem::rename(root_ / "sparse", root_ / "0");
  std::filesystem::create_directory(root_ / "sparse");
  std::filesystem::rename(root_ / "0", root_ / "sparse/0");
  EXPECT_EQ(Run().num_images, 4);
  EXPECT_EQ(Maps().count("depth_maps/v3.png.photometric.bin"), 1u);
}

TEST_F(StereoWorkspaceTest, NeverRemovesMapsThatTheListLeavesOut) {
  WriteText(root_ / "stereo/depth_maps/v1.png.geometric.bin", "of COLMAP");
  image_list_path_ = folder_.Path() / "list.txt";
  WriteText(image_list_path_, "v0.png\n");
  const auto before = Maps();
  ExpectError(ErrorCode::kUnsupported, "another program", [&] { Run(); });
  ExpectError(ErrorCode::kUnsupported, "not in the list", [&] { Run(true); });
  EXPECT_TRUE(Maps() == before);
  WriteText(image_list_path_, "v9.png\n");
  ExpectError(ErrorCode::kMismatch, "line 1 names v9.png", [&] { Run(true); });
  EXPECT_TRUE(Maps() == before);
}

TEST_F(StereoWorkspaceTest, FindsTheWallWhereItHasTexture) {
  options_.max_image_size = StereoOptions().max_image_size;
  const StereoSummary summary = Run();
  EXPECT_EQ(summary.num_images, 4);
  EXPECT_EQ(summary.num_skipped, 0);
  EXPECT_TRUE(summary.without_sources.empty());
  const Workspace workspace(root_, MapType::kGeometric);
  int num_textured = 0;
  int num_found = 0;
  int num_right = 0;
  for (int view = 0; view < 4; ++view) {
    const int image =
        workspace.Model().IndexOf(SyntheticWorkspace::Names()[view]);
    const DepthNormal dense =
        workspace.ReadOriginalMaps(image, MapType::kPhotometric);
    const DepthNormal filtered =
        workspace.ReadOriginalMaps(image, MapType::kGeometric);
    const PlanarMap costs =
        ReadPlanarMap(workspace.CostPath(image, MapType::kGeometric));
    ASSERT_EQ(costs.channels, 2);
    const Intrinsics intrinsics = workspace.Model()
                                      .images[static_cast<size_t>(image)]
                                      .camera.GetIntrinsics();
    for (int y = 8; y < SyntheticWorkspace::kHeight - 8; ++y) {
      for (int x = 8; x < SyntheticWorkspace::kWidth - 8; ++x) {
        EXPECT_GT(dense.depth(x, y), 0.f);
        EXPECT_GE(dense.depth(x, y), 0.999 * options_.depth_min);
        EXPECT_LE(dense.depth(x, y), 1.001 * options_.depth_max);
        const float z = filtered.depth(x, y);
        const size_t i = static_cast<size_t>(y) * SyntheticWorkspace::kWidth +
                         static_cast<size_t>(x);
        const float cost = costs.values[i];
        EXPECT_TRUE(cost >= 0.f && cost <= 2.f);
        EXPECT_LE(cost, costs.values[i + filtered.depth.NumPixels()]);
        if (z > 0.f) {
          EXPECT_LT(Dot(filtered.normal(x, y), intrinsics.Ray(x, y)), 0.f);
        }
        bool is_textured = true;
        for (const int dx : {-6, 0, 6}) {
          for (const int dy : {-6, 0, 6}) {
            is_textured = is_textured &&
                          !SyntheticWorkspace::IsBare(view, x + dx, y + dy);
          }
        }
        if (is_textured) {
          ++num_textured;
          num_found += z > 0.f;
          num_right += std::abs(z - kDepth) < 0.01 * kDepth;
        }
      }
    }
  }
  EXPECT_GT(num_textured, 4000);
  EXPECT_GT(num_found, 0.9 * num_textured);
  EXPECT_GT(num_right, 0.97 * num_found);
}

// What the maps say about the bare part of the wall.
struct BareWall {
  int num_found = 0;
  int num_right = 0;
  int num_with_evidence = 0;
};

BareWall LookAtBareWall(const std::filesystem::path& root) {
  BareWall bare;
  const Workspace workspace(root, MapType::kGeometric);
  for (int view = 0; view < 4; ++view) {
    const int image =
        workspace.Model().IndexOf(SyntheticWorkspace::Names()[view]);
    const Image<float> depth =
        workspace.ReadOriginalMaps(image, MapType::kGeometric).depth;
    const PlanarMap costs =
        ReadPlanarMap(workspace.CostPath(image, MapType::kGeometric));
    for (int y = 0; y < depth.Height(); ++y) {
      for (int x = 0; x < depth.Width(); ++x) {
        bool is_bare = true;
        for (const int dx : {-3, 0, 3}) {
          for (const int dy : {-3, 0, 3}) {
            is_bare =
                is_bare && SyntheticWorkspace::IsBare(view, x + dx, y + dy);
          }
        }
        if (is_bare && depth(x, y) > 0.f) {
          ++bare.num_found;
          bare.num_right += std::abs(depth(x, y) - kDepth) < 0.01 * kDepth;
          bare.num_with_evidence +=
              costs.values[depth.View().Index(x, y)] < 2.f;
        }
      }
    }
  }
  return bare;
}

TEST_F(StereoWorkspaceTest, ThePriorFillsTheBareWallAndSaysSo) {
  options_.max_image_size = StereoOptions().max_image_size;
  options_.planar_prior = false;
  Run();
  const BareWall without = LookAtBareWall(root_);
  options_.planar_prior = true;
  Run(/*overwrite=*/true);
  const BareWall with = LookAtBareWall(root_);
  EXPECT_EQ(without.num_with_evidence, without.num_found);
  EXPECT_GT(with.num_right, 3 * without.num_right);
  // Some triangles have a vertex in front of the wall.
  EXPECT_GT(with.num_right, 0.65 * with.num_found);
  EXPECT_EQ(with.num_with_evidence, without.num_with_evidence);
}

// What tsar_refine reads is the same: the prior changes nothing for it.
// In the files, where what was measured may have no defined cost, and as
// tsar_refine reads them.
TEST_F(StereoWorkspaceTest, ThePriorLeavesWhatWasMeasuredAsItIs) {
  struct Result {
    std::vector<DepthNormal> maps;
    std::vector<std::vector<float>> costs;
    std::vector<ViewData> views;
  };
  const auto run = [&](bool planar_prior) {
    options_.planar_prior = planar_prior;
    Run(/*overwrite=*/true);
    const Workspace workspace(root_, MapType::kGeometric);
    Result result;
    for (int image = 0; image < 4; ++image) {
      result.maps.push_back(
          workspace.ReadOriginalMaps(image, MapType::kGeometric));
      result.costs.push_back(
          ReadPlanarMap(workspace.CostPath(image, MapType::kGeometric)).values);
      result.views.push_back(LoadView(workspace, image));
    }
    return result;
  };
  const auto same = [](const auto& first, const auto& second) {
    return first.NumPixels() == second.NumPixels() &&
           std::memcmp(first.Data(),
                       second.Data(),
                       first.NumPixels() * sizeof(*first.Data())) == 0;
  };
  options_.max_image_size = StereoOptions().max_image_size;
  // The wide window measures where the cost's smaller one has no texture.
  for (const int window_radius : {StereoOptions().window_radius, 15}) {
    options_.window_radius = window_radius;
    const Result without = run(false);
    const Result with = run(true);
    int num_filled = 0;
    for (size_t image = 0; image < 4; ++image) {
      const DepthNormal& before = without.maps[image];
      const DepthNormal& after = with.maps[image];
      const size_t num_pixels = before.depth.NumPixels();
      ASSERT_EQ(after.depth.NumPixels(), num_pixels);
      for (size_t i = 0; i < num_pixels; ++i) {
        if (!(before.depth.Data()[i] > 0.f)) {
          num_filled += after.depth.Data()[i] > 0.f ? 1 : 0;
          continue;
        }
        ASSERT_EQ(after.depth.Data()[i], before.depth.Data()[i]) << i;
        ASSERT_TRUE(after.normal.Data()[i] == before.normal.Data()[i]) << i;
        for (const size_t channel : {size_t{0}, num_pixels}) {
          ASSERT_EQ(with.costs[image][channel + i],
                    without.costs[image][channel + i])
              << i;
        }
      }
      EXPECT_TRUE(same(with.views[image].depth, without.views[image].depth));
      EXPECT_TRUE(same(with.views[image].normal, without.views[image].normal));
      EXPECT_TRUE(
          same(with.views[image].min_cost, without.views[image].min_cost));
      EXPECT_TRUE(same(with.views[image].second_cost,
                       without.views[image].second_cost));
    }
    EXPECT_GT(num_filled, 20) << window_radius;
  }
}

TEST_F(StereoWorkspaceTest, ASecondRunHasNothingToDo) {
  Run();
  const auto first = ReadTree(root_);
  const StereoSummary again = Run();
  EXPECT_EQ(again.num_skipped, 4);
  EXPECT_TRUE(ReadTree(root_) == first);
}

TEST_F(StereoWorkspaceTest, ThreadsDoNotMatter) {
  Run();
  const auto first = Maps();
  options_.num_sources = 19;  // More than there are: the same sources.
  Run(/*overwrite=*/true, /*num_threads=*/5);
  EXPECT_TRUE(Maps() == first);
}

TEST_F(StereoWorkspaceTest, GoesOnAfterAnInterruptionInAnyPass) {
  Run();
  const auto expected = Maps();
  // Files of maps, also of those between the passes.
  const auto count_files = [&] {
    int count = 0;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(root_ / "stereo")) {
      count += entry.path().extension() == ".bin" ? 1 : 0;
    }
    return count;
  };
  std::filesystem::remove_all(root_ / "stereo/tsar_stereo");
  RemoveMaps(root_);
  std::filesystem::remove_all(root_ / "stereo/cost_maps");
  int num_interruptions = 0;
  for (;;) {
    const int num_before = count_files();
    try {
      Run(false, 1, [&] { return count_files() > num_before; });
      break;
    } catch (const Error& error) {
      ASSERT_EQ(error.Code(), ErrorCode::kInterrupted) << error.what();
      ASSERT_LT(++num_interruptions, 100);
    }
  }
  // Four passes of four images, each of which may end a run; what has been
  // computed by then is written. After the last there is nothing to interrupt.
  EXPECT_GE(num_interruptions, 2);
  EXPECT_LT(num_interruptions, 4 * 4);
  EXPECT_TRUE(Maps() == expected);
  for (const char* pass : {"pass_1", "pass_2"}) {
    EXPECT_FALSE(std::filesystem::exists(root_ / "stereo/tsar_stereo" / pass));
  }
}

TEST_F(StereoWorkspaceTest, MakesPhotometricMapsAloneIfToldSo) {
  options_.geom_consistency = false;
  Run();
  const Workspace workspace(root_, MapType::kPhotometric);
  for (int image = 0; image < 4; ++image) {
    EXPECT_TRUE(workspace.HasMaps(image, MapType::kPhotometric));
    EXPECT_FALSE(workspace.HasMaps(image, MapType::kGeometric));
  }
}

TEST_F(StereoWorkspaceTest, MapsMayBeSmallerThanTheImages) {
  Run();
  const Workspace workspace(root_, MapType::kGeometric);
  const MapSize size = ReadMapSize(workspace.DepthPath(0, MapType::kGeometric));
  EXPECT_EQ(size.width, kMapWidth);
  EXPECT_EQ(size.height, kMapHeight);
}

TEST_F(StereoWorkspaceTest, RefusesMapsOfOthersUnlessToldToReplaceThem) {
  MakeSyntheticWorkspace(root_);
  const auto before = ReadTree(root_);
  ExpectError(ErrorCode::kUnsupported, "overwrite 1", [&] { Run(); });
  const auto after = ReadTree(root_);
  for (const auto& [name, content] : before) {
    EXPECT_TRUE(after.at(name) == content) << name;
  }
  Run(/*overwrite=*/true);
  // Now they are its own, but of other options.
  options_.num_iterations = 1;
  ExpectError(ErrorCode::kUnsupported, "other options", [&] { Run(); });
}

TEST_F(StereoWorkspaceTest, RefusesARefinedWorkspaceAndLeavesItAsItIs) {
  // Smaller images have no superpixel that could be refined.
  options_.max_image_size = SyntheticWorkspace::kWidth / 2;
  Run();
  WorkspaceRefineOptions refine;
  refine.workspace_path = root_;
  refine.devices.choice = DeviceChoice::kCpu;
  std::ostringstream log;
  Progress progress(log, false);
  const RunSummary refined =
      RefineWorkspace(refine, {}, progress, [] { return false; });
  EXPECT_EQ(refined.num_refined, 4);
  const auto before = ReadTree(root_);
  ExpectError(
      ErrorCode::kUnsupported, "restore 1", [&] { Run(/*overwrite=*/true); });
  EXPECT_TRUE(ReadTree(root_) == before);
}

TEST_F(StereoWorkspaceTest, RemovesNothingWhereOneImageHasBeenRefined) {
  MakeSyntheticWorkspace(root_);
  const Workspace workspace(root_, MapType::kGeometric);
  const MapPaths paths = workspace.Paths(3, MapType::kGeometric);
  CreateFolders(paths.original_depth.Parent());
  std::filesystem::copy_file(paths.depth, paths.original_depth);
  const auto before = Maps();
  ExpectError(
      ErrorCode::kUnsupported, "restore 1", [&] { Run(/*overwrite=*/true); });
  EXPECT_TRUE(Maps() == before);
}

TEST_F(StereoWorkspaceTest, NamesWhatHasChanged) {
  Run();
  const auto expected = Maps();
  const auto touch = [&](const std::string& name) {
    const std::filesystem::path path = root_ / "images" / name;
    std::filesystem::last_write_time(
        path, std::filesystem::last_write_time(path) + std::chrono::seconds(2));
  };
  touch("v1.png");
  ExpectError(ErrorCode::kUnsupported,
              "images/v1.png: its photo has changed since the maps were made; "
              "give overwrite 1 to make all maps anew",
              [&] { Run(); });
  touch("left/v2.png");
  ExpectError(ErrorCode::kUnsupported,
              "images/left/v2.png: its photo has changed since the maps were "
              "made, and 1 other image has changed, too; give overwrite 1",
              [&] { Run(); });
  EXPECT_TRUE(Maps() == expected);
  EXPECT_EQ(Run(/*overwrite=*/true).num_skipped, 0);
  EXPECT_TRUE(Maps() == expected);
  EXPECT_EQ(Run().num_skipped, 4);
}

// A run that was killed before its first map, and a file that is not whole.
TEST_F(StereoWorkspaceTest, BeginsAnewWhereThereIsNothingToLose) {
  Run();
  const auto expected = Maps();
  const std::filesystem::path inputs = root_ / "stereo/tsar_stereo/inputs.txt";
  const std::string text = ReadText(inputs);
  for (const std::string& broken : {std::string("a b c d v0.png\n"),
                                    text.substr(text.find('\n') + 1),
                                    text.substr(0, text.find('\n') + 20),
                                    std::string()}) {
    WriteText(inputs, broken);
    ExpectError(ErrorCode::kUnsupported, "overwrite 1", [&] { Run(); });
    EXPECT_TRUE(Maps() == expected);
    RemoveMaps(root_);
    std::filesystem::remove_all(root_ / "stereo/cost_maps");
    EXPECT_EQ(Run().num_skipped, 0);
    EXPECT_TRUE(Maps() == expected);
    EXPECT_EQ(ReadText(inputs), text);
  }
}

TEST_F(StereoWorkspaceTest, NeedsDepthsToLookFor) {
  options_.depth_min = options_.depth_max = -1;
  ExpectError(ErrorCode::kNotFound, "depth_min", [&] { Run(); });
}

TEST_F(StereoWorkspaceTest, NamesAMissingImage) {
  std::filesystem::remove(root_ / "images/left/v2.png");
  ExpectError(ErrorCode::kNotFound, "left/v2.png", [&] { Run(); });
}

TEST_F(StereoWorkspaceTest, NamesAnImageThatIsCutOffAndChangesNothing) {
  MakeSyntheticWorkspace(root_);
  const std::string photo = ReadText(root_ / "images/left/v2.png");
  WriteText(root_ / "images/left/v2.png", photo.substr(0, photo.size() / 10));
  const auto before = ReadTree(root_);
  ExpectError(ErrorCode::kCorrupt, "left/v2.png: the image is damaged", [&] {
    Run(/*overwrite=*/true);
  });
  auto after = ReadTree(root_);
  after.erase("stereo/tsar");
  after.erase("stereo/tsar/lock");
  EXPECT_TRUE(after == before);
}

// As where the images were undistorted to another size meanwhile.
TEST_F(StereoWorkspaceTest, MapsOfAnotherSizeAreNotItsOwn) {
  options_.num_iterations = 1;
  Run();
  const Workspace workspace(root_, MapType::kGeometric);
  const std::filesystem::path path =
      workspace.DepthPath(1, MapType::kGeometric);
  WriteDepthMap(UserPath(path), Image<float>(kMapHeight, kMapWidth, 5.f));
  ExpectError(ErrorCode::kUnsupported, "overwrite 1", [&] { Run(); });
  EXPECT_EQ(Run(/*overwrite=*/true).num_skipped, 0);
  EXPECT_EQ(ReadMapSize(path).width, kMapWidth);
}

TEST(StereoOptions, RejectsDepthsThatMakeNoRange) {
  for (const auto& [min, max] :
       {std::pair{1.0, -1.0}, {-1.0, 1.0}, {2.0, 1.0}, {0.0, 1.0}}) {
    StereoOptions options;
    options.depth_min = min;
    options.depth_max = max;
    EXPECT_THROW(options.Check(), Error) << min << " " << max;
  }
  StereoOptions options;
  options.max_image_size = 0;
  EXPECT_THROW(options.Check(), Error);
}

TEST(StereoOptions, TextTellsEveryValueApart) {
  StereoOptions other;
  other.filter_min_ncc = 0.1000001;
  EXPECT_NE(other.Text(), StereoOptions().Text());
}

class StereoMaskedTest : public StereoWorkspaceTest {
 protected:
  // Of the second image, of its own size.
  void WriteMaskWhere(bool (*is_masked)(int x, int y)) const {
    WriteMask(folder_.Path() / "masks/v1.png.png",
              SyntheticWorkspace::kWidth,
              SyntheticWorkspace::kHeight,
              is_masked);
  }
  void UseMasks() { mask_path_ = folder_.Path() / "masks"; }
};

TEST_F(StereoMaskedTest, MaskedPixelsGetNoDepth) {
  WriteMaskWhere([](int x, int y) { return x >= 40 && y == 20; });
  UseMasks();
  EXPECT_EQ(Run().num_masks, 1);
  for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
    for (const char* name : {"v0.png", "v1.png"}) {
      const MapPaths paths = GetMapPaths(root_, name, type);
      const Image<float> depth = ReadDepthMap(paths.depth);
      const Image<Vec3f> normal = ReadNormalMap(paths.normal);
      const PlanarMap costs = ReadPlanarMap(paths.cost);
      ASSERT_EQ(depth.Width(), kMapWidth);
      int num_beside = 0;
      for (int y = 0; y < kMapHeight; ++y) {
        for (int x = 0; x < kMapWidth; ++x) {
          const size_t i = depth.View().Index(x, y);
          if (std::string(name) == "v1.png" && x >= 10 && y == 5) {
            ASSERT_EQ(depth(x, y), 0.f);
            ASSERT_TRUE(normal(x, y) == Vec3f{});
            ASSERT_EQ(costs.values[i], 2.f);
            ASSERT_EQ(costs.values[i + depth.NumPixels()], 2.f);
          } else {
            num_beside += depth(x, y) > 0.f ? 1 : 0;
          }
        }
      }
      if (type == MapType::kPhotometric) {
        EXPECT_EQ(num_beside,
                  kMapWidth * kMapHeight -
                      (std::string(name) == "v1.png" ? kMapWidth - 10 : 0));
      } else {
        EXPECT_GT(num_beside, 100);
      }
    }
  }
  EXPECT_EQ(Run().num_skipped, 4);
}

// So that what lies around them gets nothing from them.
TEST_F(StereoMaskedTest, HolesStayHolesInGeometricPasses) {
  const std::filesystem::path root = folder_.Path() / "with_maps";
  MakeSyntheticWorkspace(root);
  const Workspace workspace(root, MapType::kPhotometric);
  std::vector<ViewData> views;
  for (const char* name : {"v1.png", "v0.png", "left/v2.png"}) {
    views.push_back(LoadView(workspace, workspace.Model().IndexOf(name)));
  }
  const auto is_hole = [](int x, int y) { return x > 70 && y < 20; };
  for (int y = 0; y < 20; ++y) {
    for (int x = 71; x < SyntheticWorkspace::kWidth; ++x) {
      views[0].depth(x, y) = 0.f;
      views[0].normal(x, y) = {};
    }
  }
  options_.num_geometric_passes = 2;
  const auto device = Device::CreateCpu(1);
  for (const bool keeps_holes : {false, true}) {
    for (const int pass : {0, 1}) {
      options_.planar_prior = false;
      const StereoMaps maps =
          MatchImageGeometrically(views[0],
                                  {&views[1], &views[2]},
                                  {0.5 * kDepth, 2.0 * kDepth},
                                  1,
                                  pass,
                                  keeps_holes,
                                  options_,
                                  *device);
      int num_in_hole = 0;
      int num_beside = 0;
      for (int y = 0; y < SyntheticWorkspace::kHeight; ++y) {
        for (int x = 0; x < SyntheticWorkspace::kWidth; ++x) {
          (is_hole(x, y) ? num_in_hole : num_beside) +=
              maps.depth(x, y) > 0.f ? 1 : 0;
        }
      }
      EXPECT_EQ(num_in_hole > 0, !keeps_holes) << pass;
      EXPECT_GT(num_beside, 1000);
    }
  }
}

TEST_F(StereoMaskedTest, WhiteMasksChangeNothing) {
  const StereoSummary summary = Run();
  EXPECT_FALSE(summary.num_masks);
  const auto whole = Maps();
  WriteMaskWhere([](int, int) { return false; });
  UseMasks();
  EXPECT_EQ(Run(/*overwrite=*/true).num_skipped, 0);
  EXPECT_TRUE(Maps() == whole);
}

TEST_F(StereoMaskedTest, MakesMapsAnewWhereMasksHaveChanged) {
  Run();
  const auto whole = Maps();
  const std::filesystem::path inputs = root_ / "stereo/tsar_stereo/inputs.txt";
  const std::string without = ReadText(inputs);
  EXPECT_EQ(without.find('+'), std::string::npos);
  WriteMaskWhere([](int x, int) { return x > 50; });
  const auto expect_refused = [&] {
    const auto before = Maps();
    ExpectError(ErrorCode::kUnsupported,
                "images/v1.png: its mask has changed since the maps were made; "
                "give overwrite 1",
                [&] { Run(); });
    EXPECT_TRUE(Maps() == before);
  };
  UseMasks();
  expect_refused();
  Run(/*overwrite=*/true);
  EXPECT_FALSE(Maps() == whole);
  WriteMaskWhere([](int x, int) { return x > 51; });
  std::filesystem::last_write_time(
      mask_path_ / "v1.png.png",
      std::filesystem::file_time_type::clock::now() + std::chrono::seconds(2));
  expect_refused();
  Run(/*overwrite=*/true);
  mask_path_.clear();
  expect_refused();
  Run(/*overwrite=*/true);
  EXPECT_TRUE(Maps() == whole);
  EXPECT_EQ(ReadText(inputs), without);
}

TEST_F(StereoMaskedTest, RefusesMasksThatDoNotFit) {
  WriteMask(folder_.Path() / "masks/v1.png.png", 95, 72, [](int, int) {
    return true;
  });
  UseMasks();
  ExpectError(ErrorCode::kMismatch,
              "v1.png.png: the mask has 95 x 72 pixels, its undistorted image "
              "96 x 72, and its maps 24 x 18",
              [&] { Run(); });
  mask_path_ = root_ / "sparse";
  ExpectError(
      ErrorCode::kNotFound, "holds no mask of any image", [&] { Run(); });
  EXPECT_TRUE(Maps().empty());
}

}  // namespace
}  // namespace tsar
