// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/refine_workspace.h"

#include "colmap_tsar/controllers/workspace_check.h"
#include "colmap_tsar/store/restore.h"
#include "colmap_tsar/store/workspace_lock.h"
#include "colmap_tsar/workspace/map_io.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <limits>
#include <mutex>
#include <sstream>

#include "tests/support/drawn_workspace.h"
#include "tests/support/test_workspace.h"
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

using Tree = std::map<std::string, std::string>;

// Those files of a tree that other programs read.
Tree MapsOf(const std::filesystem::path& root) {
  Tree maps;
  for (const char* folder : {"stereo/depth_maps",
                             "stereo/normal_maps",
                             "stereo/confidence_maps",
                             "stereo/provenance_maps"}) {
    // Those of this program are not there from the beginning.
    if (!std::filesystem::exists(root / folder)) {
      continue;
    }
    for (auto& [name, content] : ReadTree(root / folder)) {
      maps[std::string(folder) + "/" + name] = std::move(content);
    }
  }
  return maps;
}

// A photo with both ends, but zeros between them: that shows only when it is
// decoded.
std::string WithZeros(std::string photo) {
  const size_t middle = photo.size() / 2;
  return photo.replace(middle, 20, 20, '\0');
}

// Equality without printing megabytes where it fails.
void ExpectSameFiles(const Tree& a, const Tree& b) {
  for (const auto& [name, content] : a) {
    const auto found = b.find(name);
    ASSERT_NE(found, b.end()) << name << " is missing";
    EXPECT_TRUE(found->second == content) << name << " differs";
  }
  for (const auto& [name, content] : b) {
    EXPECT_EQ(a.count(name), 1u) << name << " is new";
  }
}

class RefineWorkspaceTest : public testing::Test {
 protected:
  void SetUp() override { DrawWorkspace(root_); }

  // One thread, so that the order of the images is known.
  WorkspaceRefineOptions Options(const std::filesystem::path& root) const {
    WorkspaceRefineOptions options;
    options.workspace_path = root;
    options.device = "cpu";
    options.num_threads = 1;
    return options;
  }

  RunSummary Refine(
      const WorkspaceRefineOptions& options,
      const RefineOptions& refine = {},
      const std::function<bool()>& should_stop = [] { return false; }) {
    std::ostringstream text;
    Progress progress(text, false);
    return RefineWorkspace(options, refine, progress, should_stop);
  }
  RunSummary Refine() { return Refine(Options(root_)); }

  // Expects an error before anything was changed.
  void ExpectRefusal(ErrorCode code,
                     const std::vector<std::string>& texts,
                     const WorkspaceRefineOptions& options) {
    const Tree before = ReadTree(folder_.Path());
    ExpectError(code, texts, [&] { Refine(options); });
    ExpectSameFiles(before, ReadTree(folder_.Path()));
  }
  void ExpectRefusal(ErrorCode code, const std::vector<std::string>& texts) {
    ExpectRefusal(code, texts, Options(root_));
  }

  MapPaths Paths(int view, MapType type = MapType::kGeometric) const {
    return GetMapPaths(
        root_, DrawnWorkspace::Names()[static_cast<size_t>(view)], type);
  }
  void RemoveMaps(int view, MapType type) const {
    std::filesystem::remove(Paths(view, type).depth);
    std::filesystem::remove(Paths(view, type).normal);
  }
  nlohmann::json Manifest() const {
    return nlohmann::json::parse(ReadText(root_ / "stereo/tsar/manifest.json"));
  }

  // Where an image's evidence lies while a run needs it.
  static std::filesystem::path Evidence(const std::filesystem::path& root,
                                        int view) {
    return root / "stereo/tsar/evidence" /
           (DrawnWorkspace::Names()[static_cast<size_t>(view)] +
            ".geometric.bin");
  }
  // Stops a run once all images have been observed.
  void Observe(const WorkspaceRefineOptions& options,
               const RefineOptions& refine = {}) {
    const std::filesystem::path root = options.output_path.empty()
                                           ? options.workspace_path
                                           : options.output_path;
    ExpectError(ErrorCode::kInterrupted, {"0 of 4", "same command"}, [&] {
      Refine(options, refine, [&] {
        return std::filesystem::exists(Evidence(root, 3));
      });
    });
    for (int view = 0; view < 4; ++view) {
      EXPECT_TRUE(std::filesystem::exists(Evidence(root, view)));
    }
  }
  // The maps of a workspace drawn and changed alike that is refined in one go.
  Tree RefinedInOneGo(
      const RefineOptions& refine = {},
      const std::function<void(const std::filesystem::path&)>& change =
          [](const std::filesystem::path&) {}) {
    const std::filesystem::path root = folder_.Path() / "whole";
    std::filesystem::remove_all(root);
    DrawWorkspace(root);
    change(root);
    Refine(Options(root), refine);
    return MapsOf(root);
  }
  static void RemoveDepths(const std::filesystem::path& root, int view) {
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      WriteDepthMap(
          UserPath(
              GetMapPaths(root,
                          DrawnWorkspace::Names()[static_cast<size_t>(view)],
                          type)
                  .depth),
          Image<float>(96, 72, 0.f));
    }
  }
  bool HasEvidence() const {
    return std::filesystem::exists(root_ / "stereo/tsar/evidence");
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

TEST_F(RefineWorkspaceTest, FillsTheBareWallAndKeepsTheOriginals) {
  const Tree before = ReadTree(root_);
  const RunSummary summary = Refine();
  EXPECT_EQ(summary.num_images, 4);
  EXPECT_EQ(summary.num_refined, 4);
  EXPECT_TRUE(summary.kept.empty());
  EXPECT_EQ(summary.counts.at("pixels"), 4 * 96 * 72);
  EXPECT_GT(summary.counts.at("depth_after"),
            summary.counts.at("depth_before"));

  int64_t num_bare = 0;
  int64_t num_right = 0;
  for (int view = 0; view < 4; ++view) {
    const MapPaths paths = Paths(view);
    for (const auto& [stored, current] :
         {std::pair(paths.original_depth, paths.depth),
          std::pair(paths.original_normal, paths.normal)}) {
      EXPECT_TRUE(ReadText(stored) ==
                  before.at(current.Path().lexically_relative(root_)));
    }
    EXPECT_TRUE(std::filesystem::exists(paths.confidence));
    EXPECT_TRUE(std::filesystem::exists(paths.provenance));
    const Image<float> depth = ReadDepthMap(paths.depth);
    for (int y = 0; y < depth.Height(); ++y) {
      for (int x = 0; x < depth.Width(); ++x) {
        if (DrawnWorkspace::IsBare(view, x, y)) {
          ++num_bare;
          num_right += std::abs(depth(x, y) - 5.f) < 0.05f ? 1 : 0;
        }
      }
    }
  }
  // None was right before, apart from chance.
  EXPECT_GT(num_right, num_bare / 2);
}

TEST_F(RefineWorkspaceTest, RestoreGivesTheSameBytes) {
  const Tree before = ReadTree(root_);
  Refine();
  EXPECT_EQ(Restore(root_).num_restored, 4);
  ExpectSameFiles(before, ReadTree(root_));
}

TEST_F(RefineWorkspaceTest, RestoreRemovesWhatARunLeftThatChangedNoMap) {
  const Tree before = ReadTree(root_);
  Observe(Options(root_));
  EXPECT_TRUE(HasEvidence());
  {
    const WorkspaceLock lock(root_);
    EXPECT_EQ(Restore(root_).num_restored, 0);
  }
  ExpectSameFiles(before, ReadTree(root_));
  ExpectError(
      ErrorCode::kNotFound, {"nothing to restore"}, [&] { Restore(root_); });
  // Nor is the lock something.
  const WorkspaceLock lock(root_);
  ExpectError(
      ErrorCode::kNotFound, {"nothing to restore"}, [&] { Restore(root_); });
}

TEST_F(RefineWorkspaceTest, SkipsWhatIsDoneAndRedoesWithOtherOptions) {
  RefineOptions others;
  others.segment = false;
  Refine(Options(root_), others);
  const Tree with_others = MapsOf(root_);
  Refine();
  const Tree refined = MapsOf(root_);
  EXPECT_FALSE(refined == with_others);

  const RunSummary again = Refine();
  EXPECT_EQ(again.num_skipped, 4);
  EXPECT_EQ(again.num_refined, 0);
  ExpectSameFiles(refined, MapsOf(root_));

  // The originals are refined again, not the refined maps.
  EXPECT_EQ(Refine(Options(root_), others).num_refined, 4);
  ExpectSameFiles(with_others, MapsOf(root_));
}

TEST_F(RefineWorkspaceTest, RefinesAgainWhatHasChanged) {
  // The third alone depends on the last.
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\nv1.png\nv1.png\nv0.png\nleft/v2.png\nv3.png\n");
  for (const bool scene_planes : {true, false}) {
    RefineOptions refine;
    refine.scene_planes = scene_planes;
    EXPECT_EQ(Refine(Options(root_), refine).num_refined, 3);
    const auto refine_again = [&] {
      testing::internal::CaptureStderr();
      const RunSummary summary = Refine(Options(root_), refine);
      const std::string warnings = testing::internal::GetCapturedStderr();
      return std::pair(summary.num_refined, warnings);
    };
    EXPECT_EQ(refine_again(), std::pair(0, std::string()));
    const std::filesystem::path photo = root_ / "images/v3.png";
    std::filesystem::last_write_time(
        photo,
        std::filesystem::last_write_time(photo) + std::chrono::seconds(2));
    const auto [num_refined, warnings] = refine_again();
    EXPECT_EQ(num_refined, 1);
    EXPECT_THAT(warnings,
                testing::HasSubstr("left/v2.png: refined again, since its "
                                   "neighbour v3.png has changed\n"));
    // One line, of one image.
    EXPECT_EQ(warnings.find("refined again"), warnings.rfind("refined again"));
    EXPECT_EQ(refine_again(), std::pair(0, std::string()));
  }
}

// What cannot be refined any more is not as it was refined.
TEST_F(RefineWorkspaceTest, KeepsWhatHasLostItsSources) {
  const Tree before = MapsOf(root_);
  Refine();
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\n__all__\nv1.png\n__all__\nv3.png\nleft/v2.png\n");
  RemoveMaps(2, MapType::kGeometric);
  std::filesystem::remove(Paths(2).original_depth);
  std::filesystem::remove(Paths(2).original_normal);
  testing::internal::CaptureStderr();
  const RunSummary summary = Refine();
  const std::string warnings = testing::internal::GetCapturedStderr();
  EXPECT_EQ(summary.num_refined, 2);
  ASSERT_EQ(summary.kept.size(), 1u);
  EXPECT_EQ(summary.kept[0].name, "v3.png");
  EXPECT_THAT(warnings, testing::Not(testing::HasSubstr("v3.png: ")));
  const Tree after = MapsOf(root_);
  for (const char* path : {"stereo/depth_maps/v3.png.geometric.bin",
                           "stereo/normal_maps/v3.png.geometric.bin"}) {
    EXPECT_TRUE(after.at(path) == before.at(path)) << path;
  }
}

TEST_F(RefineWorkspaceTest, GoesOnAfterAnInterruption) {
  const std::filesystem::path whole = folder_.Path() / "whole";
  DrawWorkspace(whole);
  Refine(Options(whole));

  // While the third image is read, computed or about to be written; there is
  // one thread that writes.
  ExpectError(ErrorCode::kInterrupted, {"2 of 4", "same command"}, [&] {
    Refine(Options(root_), {}, [&] {
      return std::filesystem::exists(Paths(1).record);
    });
  });
  EXPECT_EQ(Manifest()["num_images"]["done"], 2);
  EXPECT_EQ(Manifest()["num_images"]["pending"], 2);

  const RunSummary summary = Refine();
  EXPECT_EQ(summary.num_skipped, 2);
  EXPECT_EQ(summary.num_refined, 2);
  EXPECT_EQ(Manifest()["num_images"]["done"], 4);
  ExpectSameFiles(MapsOf(whole), MapsOf(root_));
}

TEST_F(RefineWorkspaceTest, ThreadsAndMemoryDoNotChangeAByte) {
  WorkspaceRefineOptions options = Options(root_);
  options.output_path = folder_.Path() / "out1";
  EXPECT_EQ(Refine(options).num_workers, 1);
  const Tree expected = MapsOf(options.output_path);
  for (const int num_threads : {2, 7}) {
    options.num_threads = num_threads;
    options.output_path =
        folder_.Path() / ("out" + std::to_string(num_threads));
    EXPECT_EQ(Refine(options).num_workers, std::min(num_threads, 4));
    ExpectSameFiles(expected, MapsOf(options.output_path));
  }
  options.cache_size = 1e-4;
  options.output_path = folder_.Path() / "out_small";
  EXPECT_EQ(Refine(options).num_workers, 1);
  ExpectSameFiles(expected, MapsOf(options.output_path));
  // In place, where the originals of some are read while others are written.
  options = Options(root_);
  options.num_threads = 4;
  Refine(options);
  ExpectSameFiles(expected, MapsOf(root_));
}

// The share of the pixels of all images whose depth in `scaled` is `scale`
// times that in `root` and whose provenance is the same.
double ShareOfScaledPixels(const std::filesystem::path& root,
                           const std::filesystem::path& scaled,
                           double scale,
                           double tolerance) {
  int64_t num_pixels = 0;
  int64_t num_same = 0;
  for (const std::string& name : DrawnWorkspace::Names()) {
    const MapPaths a = GetMapPaths(root, name, MapType::kGeometric);
    const MapPaths b = GetMapPaths(scaled, name, MapType::kGeometric);
    const Image<float> depth_a = ReadDepthMap(a.depth);
    const Image<float> depth_b = ReadDepthMap(b.depth);
    const cv::Mat provenance_a =
        cv::imread(a.provenance.string(), cv::IMREAD_UNCHANGED);
    const cv::Mat provenance_b =
        cv::imread(b.provenance.string(), cv::IMREAD_UNCHANGED);
    for (int y = 0; y < depth_a.Height(); ++y) {
      for (int x = 0; x < depth_a.Width(); ++x) {
        const double expected = depth_a(x, y) * scale;
        const bool is_same =
            std::abs(depth_b(x, y) - expected) <= tolerance * expected &&
            provenance_a.at<uchar>(y, x) == provenance_b.at<uchar>(y, x);
        ++num_pixels;
        num_same += is_same ? 1 : 0;
      }
    }
  }
  return static_cast<double>(num_same) / static_cast<double>(num_pixels);
}

TEST_F(RefineWorkspaceTest, GivesOpenCvItsThreadsBack) {
  const int num_threads_before = cv::getNumThreads();
  cv::setNumThreads(2);
  std::atomic<int> num_threads_meanwhile = 0;
  Refine(Options(root_), {}, [&] {
    num_threads_meanwhile = cv::getNumThreads();
    return false;
  });
  EXPECT_EQ(num_threads_meanwhile, 1);
  EXPECT_EQ(cv::getNumThreads(), 2);
  std::filesystem::remove_all(root_);
  EXPECT_THROW(Refine(), Error);
  EXPECT_EQ(cv::getNumThreads(), 2);
  cv::setNumThreads(num_threads_before);
}

TEST_F(RefineWorkspaceTest, ScalingTheSceneScalesTheDepthsAndNothingElse) {
  Refine();
  struct Case {
    double scale;
    double tolerance;
    double min_share;
  };
  // Powers of two change no digit of any number. Others are rounded, which may
  // turn whether a superpixel gets a plane; each is more than 1 % of an image.
  for (const Case& c : {Case{1024.0, 0.0, 1.0},
                        Case{1.0 / 1024.0, 0.0, 1.0},
                        Case{1000.0, 1e-3, 0.95},
                        Case{0.001, 1e-3, 0.95}}) {
    const std::filesystem::path scaled = folder_.Path() / "scaled";
    std::filesystem::remove_all(scaled);
    DrawWorkspace(scaled, c.scale);
    Refine(Options(scaled));
    EXPECT_GE(ShareOfScaledPixels(root_, scaled, c.scale, c.tolerance),
              c.min_share)
        << c.scale;
  }
}

TEST_F(RefineWorkspaceTest, OutputPathLeavesTheInputAlone) {
  const Tree before = ReadTree(root_);
  WorkspaceRefineOptions options = Options(root_);
  options.output_path = folder_.Path() / "out";
  const RunSummary summary = Refine(options);
  EXPECT_EQ(summary.workspace_path, options.output_path);
  ExpectSameFiles(before, ReadTree(root_));
  Refine();
  ExpectSameFiles(MapsOf(root_), MapsOf(options.output_path));
}

TEST_F(RefineWorkspaceTest, KeepsImagesThatCannotBeRefined) {
  // v1 has no maps, v2 sees only v1, and v3 has no depth.
  RemoveMaps(1, MapType::kGeometric);
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\n__all__\nv1.png\nv0.png\nleft/v2.png\nv1.png\n"
            "v3.png\nv0.png\n");
  for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
    WriteDepthMap(UserPath(Paths(3, type).depth), Image<float>(96, 72, 0.f));
  }
  const std::string before = ReadText(Paths(3).depth);
  const RunSummary summary = Refine(Options(root_), RefineOptions());
  EXPECT_EQ(summary.num_refined, 1);
  EXPECT_EQ(summary.num_sources_without_maps, 1);
  ASSERT_EQ(summary.kept.size(), 3u);
  EXPECT_EQ(summary.kept[0].name, "v1.png");
  EXPECT_THAT(summary.kept[0].reason, testing::HasSubstr("no geometric maps"));
  EXPECT_EQ(summary.kept[1].name, "left/v2.png");
  EXPECT_THAT(summary.kept[1].reason, testing::HasSubstr("source images"));
  EXPECT_EQ(summary.kept[2].name, "v3.png");
  EXPECT_THAT(summary.kept[2].reason, testing::HasSubstr("no valid depth"));
  EXPECT_TRUE(ReadText(Paths(3).depth) == before);
  EXPECT_EQ(Manifest()["num_images"]["kept"], 3);

  std::ostringstream text;
  PrintSummary(summary, text);
  EXPECT_THAT(text.str(), testing::HasSubstr("4 images: 1 refined, 3 kept"));
  EXPECT_THAT(text.str(), testing::HasSubstr("left/v2.png: none of"));
  EXPECT_THAT(text.str(), testing::HasSubstr("colmap stereo_fusion"));
}

TEST_F(RefineWorkspaceTest, CountsValuesThatAreNotFinite) {
  std::string bytes = ReadText(Paths(0).depth);
  for (const float value : {std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity()}) {
    bytes.resize(bytes.size() - sizeof(float));
    std::string text;
    Append(value, &text);
    bytes.insert(std::string("96&72&1&").size(), text);
  }
  WriteText(Paths(0).depth, bytes);
  const RunSummary summary = Refine();
  EXPECT_EQ(summary.counts.at("not_finite"), 2);
  for (const float depth : ReadDepthMap(Paths(0).depth)) {
    ASSERT_TRUE(std::isfinite(depth));
  }
}

TEST_F(RefineWorkspaceTest, TakesPhotometricMapsWhereThereAreNoOthers) {
  for (int view = 0; view < 4; ++view) {
    RemoveMaps(view, MapType::kGeometric);
  }
  EXPECT_EQ(Refine().type, MapType::kPhotometric);
  EXPECT_TRUE(
      std::filesystem::exists(Paths(0, MapType::kPhotometric).original_depth));
  // Not against the user's word.
  WorkspaceRefineOptions options = Options(root_);
  options.input_type = MapType::kGeometric;
  ExpectError(ErrorCode::kNotFound,
              {"depth_maps", "no geometric map", "input_type"},
              [&] { Refine(options); });
}

TEST_F(RefineWorkspaceTest, TwoRunsAtATimeAreRefused) {
  const WorkspaceLock lock(root_);
  ExpectError(
      ErrorCode::kUnsupported, {"lock", "another program"}, [&] { Refine(); });
}

TEST_F(RefineWorkspaceTest, NobodyChangesTheInputOfAnotherRun) {
  WorkspaceRefineOptions options = Options(root_);
  options.output_path = folder_.Path() / "out";
  {
    const WorkspaceLock writer(root_);
    ExpectError(ErrorCode::kUnsupported, {"lock", "another program"}, [&] {
      Refine(options);
    });
    EXPECT_FALSE(std::filesystem::exists(options.output_path));
  }
  // While the first run reads, in the middle of its work.
  int num_refusals = 0;
  Refine(options, {}, [&] {
    static std::mutex mutex;
    const std::lock_guard<std::mutex> lock(mutex);
    ExpectError(ErrorCode::kUnsupported, {root_.string(), "lock"}, [&] {
      const WorkspaceLock writer(root_);
    });
    ++num_refusals;
    return false;
  });
  EXPECT_GT(num_refusals, 0);
  // An output workspace, worked on in place, reads the first one, too.
  const WorkspaceLock writer(root_);
  ExpectError(ErrorCode::kUnsupported, {root_.string(), "lock"}, [&] {
    Refine(Options(options.output_path));
  });
}

TEST_F(RefineWorkspaceTest, NobodyTouchesTheOutputOfAnotherRun) {
  WorkspaceRefineOptions options = Options(root_);
  options.output_path = folder_.Path() / "out";
  Refine(options);
  WriteText(root_ / "stereo/fusion.cfg", "v0.png\n");
  {
    const WorkspaceLock writer(options.output_path);
    const Tree before = ReadTree(options.output_path);
    ExpectError(ErrorCode::kUnsupported,
                {options.output_path.string(), "lock", "another program"},
                [&] { Refine(options); });
    ExpectSameFiles(before, ReadTree(options.output_path));
  }
  Refine(options);
  EXPECT_EQ(ReadText(options.output_path / "stereo/fusion.cfg"), "v0.png\n");
}

TEST_F(RefineWorkspaceTest, TheManifestTellsWhatTheRunWasDoneWith) {
  WorkspaceRefineOptions options = Options(root_);
  options.cache_size = 2.5;
  Refine(options);
  const nlohmann::json runtime = Manifest()["runtime"];
  EXPECT_EQ(runtime["device"], "cpu");
  EXPECT_EQ(runtime["gpu_index"], "-1");
  EXPECT_EQ(runtime["num_threads"], "1");
  EXPECT_EQ(runtime["cache_size"], "2.5");
  EXPECT_EQ(runtime["used"], "1 CPU thread");
  EXPECT_FALSE(Manifest()["options"].contains("device"));
  // No result depends on it, so nothing is done again.
  options.num_threads = 2;
  options.cache_size = 3.0;
  EXPECT_EQ(Refine(options).num_skipped, 4);
  EXPECT_EQ(Manifest()["runtime"]["num_threads"], "2");
}

TEST_F(RefineWorkspaceTest, AFailedWriteLeavesTheOthersDone) {
  // A folder in the place of the third image's confidence map.
  const std::filesystem::path confidence = Paths(2).confidence;
  WriteText(confidence / "file", "in the way");
  ExpectError(ErrorCode::kIo, {confidence.string()}, [&] { Refine(); });
  EXPECT_EQ(Manifest()["images"][0]["status"], "done");
  EXPECT_EQ(Manifest()["images"][1]["status"], "done");
  EXPECT_EQ(Manifest()["images"][2]["status"], "failed");
  std::filesystem::remove_all(confidence);
  Refine();
  EXPECT_EQ(Manifest()["num_images"]["done"], 4);
}

TEST_F(RefineWorkspaceTest, AnImageThatCannotBeReadEndsTheRunButNotTheRest) {
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\nv1.png\nv1.png\nv0.png\nv3.png\nleft/v2.png\n");
  const std::string image = ReadText(root_ / "images/v3.png");
  // Not an image at all: seen before anything is done.
  WriteText(root_ / "images/v3.png", "no picture");
  ExpectRefusal(ErrorCode::kCorrupt, {"v3.png", "not a readable"});
  // Its beginning alone, too.
  WriteText(root_ / "images/v3.png", image.substr(0, image.size() / 10));
  ExpectRefusal(ErrorCode::kCorrupt, {"v3.png", "the image is damaged"});
  WriteText(root_ / "images/v3.png", WithZeros(image));
  const Tree before = MapsOf(root_);
  const std::string depth = ReadText(Paths(3).depth);
  for (const bool scene_planes : {true, false}) {
    RefineOptions options;
    options.scene_planes = scene_planes;
    ExpectError(ErrorCode::kCorrupt, {"v3.png", "is damaged"}, [&] {
      Refine(Options(root_), options);
    });
    EXPECT_EQ(Manifest()["num_images"]["failed"], 1);
    EXPECT_EQ(Manifest()["images"][2]["status"], "failed");
    EXPECT_THAT(Manifest()["images"][2]["note"].get<std::string>(),
                testing::HasSubstr("v3.png"));
    EXPECT_TRUE(ReadText(Paths(3).depth) == depth);
    if (scene_planes) {
      // What is seen while the images are observed comes before any change.
      EXPECT_EQ(Manifest()["num_images"]["pending"], 2);
      ExpectSameFiles(before, MapsOf(root_));
    } else {
      EXPECT_EQ(Manifest()["num_images"]["done"], 2);
    }
  }
  WriteText(root_ / "images/v3.png", image);
  RefineOptions options;
  options.scene_planes = false;
  const RunSummary summary = Refine(Options(root_), options);
  EXPECT_EQ(summary.num_skipped, 2);
  EXPECT_EQ(summary.num_refined, 1);
  EXPECT_EQ(Refine().num_refined, 3);
}

TEST_F(RefineWorkspaceTest, WhatWasDoneBeforeStaysDoneWhereObservingItFails) {
  const std::filesystem::path config = root_ / "stereo/patch-match.cfg";
  WriteText(config, "v1.png\nv3.png\nv3.png\nv1.png\n");
  Refine();
  const Tree before = MapsOf(root_);
  // Now v0 needs what v1 observes, and that needs the image of v3.
  WriteText(config, "v0.png\nv1.png\nv1.png\nv3.png\nv3.png\nv1.png\n");
  // Damaged by the disk, perhaps: of the same size and time.
  const std::filesystem::path photo = root_ / "images/v3.png";
  const auto time = std::filesystem::last_write_time(photo);
  WriteText(photo, WithZeros(ReadText(photo)));
  std::filesystem::last_write_time(photo, time);
  ExpectError(ErrorCode::kCorrupt, {"v3.png", "is damaged"}, [&] { Refine(); });
  ExpectSameFiles(before, MapsOf(root_));
  const nlohmann::json manifest = Manifest();
  EXPECT_EQ(manifest["num_images"]["failed"], 0);
  EXPECT_EQ(manifest["images"][0]["status"], "pending");
  EXPECT_EQ(manifest["images"][1]["status"], "done");
  EXPECT_THAT(
      manifest["images"][1]["note"].get<std::string>(),
      testing::AllOf(testing::StartsWith("cannot be observed for other images"),
                     testing::HasSubstr("v3.png")));
  EXPECT_EQ(manifest["images"][2]["status"], "done");
  EXPECT_EQ(manifest["images"][2]["note"], "");

  // Where the maps of v1 are others by now, it is v1 that fails.
  WriteDepthMap(Paths(1).depth, Image<float>(96, 72, 5.5f));
  WriteNormalMap(Paths(1).normal,
                 Image<Vec3f>(96, 72, Vec3f{0.06f, 0.08f, -0.99499f}));
  for (const ContainedPath& path : {Paths(1).depth, Paths(1).normal}) {
    std::filesystem::last_write_time(
        path, std::filesystem::last_write_time(path) + std::chrono::hours(1));
  }
  ExpectError(ErrorCode::kCorrupt, {"v3.png", "is damaged"}, [&] { Refine(); });
  EXPECT_EQ(Manifest()["images"][1]["status"], "failed");
  EXPECT_EQ(Manifest()["num_images"]["done"], 1);
}

TEST_F(RefineWorkspaceTest, KeepsEvidenceOnlyAsLongAsItIsNeeded) {
  bool was_there = false;
  Refine(Options(root_), {}, [&] {
    was_there = was_there || std::filesystem::exists(Evidence(root_, 2));
    return false;
  });
  EXPECT_TRUE(was_there);
  EXPECT_FALSE(HasEvidence());
  // What a run left behind goes also with one that needs none.
  RefineOptions others;
  others.segment = false;
  Observe(Options(root_), others);
  others.scene_planes = false;
  Refine(Options(root_), others);
  EXPECT_FALSE(HasEvidence());
}

TEST_F(RefineWorkspaceTest, GoesOnWhereAllThatIsMissingIsTheSecondPass) {
  const Tree before = MapsOf(root_);
  Observe(Options(root_));
  ExpectSameFiles(before, MapsOf(root_));
  EXPECT_EQ(Manifest()["num_images"]["pending"], 4);

  // Nothing is observed again.
  const auto time = std::filesystem::last_write_time(Evidence(root_, 0));
  Refine(Options(root_), {}, [&] {
    std::error_code error;
    const auto now =
        std::filesystem::last_write_time(Evidence(root_, 0), error);
    EXPECT_TRUE(error || now == time);
    return false;
  });
  ExpectSameFiles(RefinedInOneGo(), MapsOf(root_));
}

TEST_F(RefineWorkspaceTest, GoesOnAfterAnInterruptionOfTheFirstPass) {
  ExpectError(ErrorCode::kInterrupted, {"0 of 4", "same command"}, [&] {
    Refine(Options(root_), {}, [&] {
      return std::filesystem::exists(Evidence(root_, 1));
    });
  });
  EXPECT_FALSE(std::filesystem::exists(Evidence(root_, 3)));
  EXPECT_EQ(Refine().num_refined, 4);
  ExpectSameFiles(RefinedInOneGo(), MapsOf(root_));
}

using RefineWorkspaceDeathTest = RefineWorkspaceTest;

TEST_F(RefineWorkspaceDeathTest, GoesOnAfterBeingKilledInEitherPass) {
  const Tree expected = RefinedInOneGo();
  for (const std::filesystem::path& file :
       {Evidence(root_, 1), Paths(1).record.Path()}) {
    std::filesystem::remove_all(root_);
    DrawWorkspace(root_);
    EXPECT_EXIT(Refine(Options(root_),
                       {},
                       [&] {
                         if (std::filesystem::exists(file)) {
                           std::raise(SIGKILL);
                         }
                         return false;
                       }),
                testing::KilledBySignal(SIGKILL),
                "");
    EXPECT_TRUE(HasEvidence());
    const RunSummary summary = Refine();
    EXPECT_EQ(summary.num_refined + summary.num_skipped, 4);
    EXPECT_EQ(summary.num_skipped > 0, file == Paths(1).record);
    EXPECT_FALSE(HasEvidence());
    ExpectSameFiles(expected, MapsOf(root_));
  }
}

TEST_F(RefineWorkspaceTest, EvidenceOfOtherOptionsIsNotUsed) {
  RefineOptions others;
  others.min_aggregated_score = 0.95;
  others.superpixel_size = 200;
  Observe(Options(root_), others);
  Refine();
  ExpectSameFiles(RefinedInOneGo(), MapsOf(root_));
}

TEST_F(RefineWorkspaceTest, EvidenceOfMapsThatWereReplacedIsNotUsed) {
  const auto remove_depths = [](const std::filesystem::path& root) {
    RemoveDepths(root, 3);
  };
  Observe(Options(root_));
  // Of an image that has none now, none would be written over the old.
  remove_depths(root_);
  Refine();
  ExpectSameFiles(RefinedInOneGo({}, remove_depths), MapsOf(root_));

  // Nor of one that is no longer to be refined, nor a source.
  std::filesystem::remove_all(root_);
  DrawWorkspace(root_);
  const auto leave_out = [](const std::filesystem::path& root) {
    WriteText(root / "stereo/patch-match.cfg",
              "v0.png\nv1.png, v3.png\nv1.png\nv0.png, v3.png\n");
  };
  Observe(Options(root_));
  leave_out(root_);
  Refine();
  ExpectSameFiles(RefinedInOneGo({}, leave_out), MapsOf(root_));
}

TEST_F(RefineWorkspaceTest, NeighboursWithoutMapsOrDepthsDoNotMatter) {
  // Without maps, as if nobody had listed the image.
  const Tree expected =
      RefinedInOneGo({}, [](const std::filesystem::path& root) {
        WriteText(root / "stereo/patch-match.cfg",
                  "v0.png\nv1.png, left/v2.png\n"
                  "v1.png\nv0.png, left/v2.png\n"
                  "left/v2.png\nv0.png, v1.png\n");
      });
  RemoveMaps(3, MapType::kGeometric);
  EXPECT_EQ(Refine().num_refined, 3);
  for (const auto& [name, content] : MapsOf(root_)) {
    if (name.find("v3.png") == std::string::npos) {
      EXPECT_TRUE(content == expected.at(name)) << name;
    }
  }

  // Without depths, its picture still helps to judge those of the others.
  std::filesystem::remove_all(root_);
  DrawWorkspace(root_);
  RemoveDepths(root_, 3);
  const RunSummary summary = Refine();
  EXPECT_EQ(summary.num_refined, 3);
  ASSERT_EQ(summary.kept.size(), 1u);
  EXPECT_EQ(summary.kept[0].name, "v3.png");
  for (int view = 0; view < 3; ++view) {
    int num_bare = 0;
    int num_right = 0;
    const Image<float> depth = ReadDepthMap(Paths(view).depth);
    for (int y = 0; y < depth.Height(); ++y) {
      for (int x = 0; x < depth.Width(); ++x) {
        if (DrawnWorkspace::IsBare(view, x, y)) {
          ++num_bare;
          num_right += std::abs(depth(x, y) - 5.f) < 0.05f ? 1 : 0;
        }
      }
    }
    EXPECT_GT(num_right, num_bare / 2) << view;
  }
}

TEST_F(RefineWorkspaceTest, TheOrderOfTheImagesDoesNotMatter) {
  const Tree expected = RefinedInOneGo();
  WriteText(root_ / "stereo/patch-match.cfg",
            "v3.png\n__all__\nleft/v2.png\n__all__\nv0.png\n__all__\n"
            "v1.png\n__all__\n");
  Refine();
  ExpectSameFiles(expected, MapsOf(root_));
}

TEST_F(RefineWorkspaceTest, AnInterruptedRunLeavesNoEvidenceInTheInput) {
  const Tree before = ReadTree(root_);
  WorkspaceRefineOptions options = Options(root_);
  options.output_path = folder_.Path() / "out";
  Observe(options);
  ExpectSameFiles(before, ReadTree(root_));
  Refine(options);
  ExpectSameFiles(before, ReadTree(root_));
  EXPECT_FALSE(
      std::filesystem::exists(options.output_path / "stereo/tsar/evidence"));
  ExpectSameFiles(RefinedInOneGo(), MapsOf(options.output_path));
}

TEST_F(RefineWorkspaceTest, RefusesWorkspacesWithoutTheirFolders) {
  ExpectRefusal(ErrorCode::kNotFound,
                {"nowhere", "workspace_path"},
                Options(folder_.Path() / "nowhere"));
  for (const char* name : {"stereo/normal_maps", "stereo", "sparse"}) {
    std::filesystem::remove_all(root_ / name);
    ExpectRefusal(ErrorCode::kNotFound, {name});
  }
}

TEST_F(RefineWorkspaceTest, RefusesMissingAndEmptyImageFiles) {
  WriteText(root_ / "images/left/v2.png", "");
  ExpectRefusal(ErrorCode::kCorrupt, {"left/v2.png", "empty"});
  std::filesystem::remove(root_ / "images/left/v2.png");
  ExpectRefusal(ErrorCode::kNotFound, {"left/v2.png", "image_undistorter"});
}

TEST_F(RefineWorkspaceTest, RefusesImagesThatAreTooLargeToDecode) {
  WriteText(root_ / "sparse/cameras.txt",
            "1 PINHOLE 32768 32769 80 80 48 36\n");
  RemoveMaps(0, MapType::kPhotometric);
  WriteDepthMap(Paths(0).depth, Image<float>(72, 72, 5.f));
  WriteNormalMap(Paths(0).normal, Image<Vec3f>(72, 72, Vec3f{0.f, 0.f, -1.f}));
  ExpectRefusal(ErrorCode::kUnsupported,
                {"v0.png", "32768 x 32769", "2^30", "--max_image_size"});
}

TEST_F(RefineWorkspaceTest, RefusesMapsWithMorePixelsThanItCanNumber) {
  RemoveMaps(1, MapType::kPhotometric);
  // Of these files only the heads take space.
  for (const auto& [path, channels] :
       {std::pair(Paths(1).depth, 1), std::pair(Paths(1).normal, 3)}) {
    const std::string head = "40000&30000&" + std::to_string(channels) + "&";
    WriteText(path, head);
    std::filesystem::resize_file(
        path, head.size() + uintmax_t{4} * 40000 * 30000 * channels);
  }
  ExpectError(ErrorCode::kUnsupported,
              {Paths(1).depth.string(), "40000 x 30000", "max_image_size"},
              [&] { CheckWorkspace(Workspace(root_, MapType::kGeometric)); });
}

TEST_F(RefineWorkspaceTest, LooksForTheMapsThatTakeMemory) {
  const auto look = [&] {
    return CheckWorkspace(Workspace(root_, MapType::kGeometric));
  };
  EXPECT_TRUE(look().has_other_type);
  EXPECT_FALSE(look().has_costs);
  for (int image = 0; image < 3; ++image) {
    RemoveMaps(image, MapType::kPhotometric);
  }
  EXPECT_TRUE(look().has_other_type);
  RemoveMaps(3, MapType::kPhotometric);
  EXPECT_FALSE(look().has_other_type);
  CreateFolders(Paths(2).cost.Parent());
  WritePlanarMap(UserPath(Paths(2).cost),
                 {96, 72, 2, std::vector<float>(2 * 96 * 72)});
  EXPECT_TRUE(look().has_costs);
}

TEST_F(RefineWorkspaceTest, RefusesBrokenMapsOfEitherType) {
  for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
    for (const std::filesystem::path& path :
         {Paths(3, type).depth, Paths(3, type).normal}) {
      const std::string bytes = ReadText(path);
      WriteText(path, bytes.substr(0, bytes.size() / 2));
      ExpectRefusal(ErrorCode::kCorrupt, {path.string(), "not a complete map"});
      WriteText(path, "");
      ExpectRefusal(ErrorCode::kCorrupt, {path.string(), "empty"});
      WriteText(path, bytes);
    }
  }
}

TEST_F(RefineWorkspaceTest, RefusesMapsThatDoNotBelongTogether) {
  WriteDepthMap(UserPath(Paths(3, MapType::kPhotometric).depth),
                Image<float>(48, 36, 5.f));
  WriteNormalMap(UserPath(Paths(3, MapType::kPhotometric).normal),
                 Image<Vec3f>(48, 36, Vec3f{0.f, 0.f, -1.f}));
  ExpectRefusal(ErrorCode::kMismatch, {"v3.png.photometric.bin", "48 x 36"});
  RemoveMaps(3, MapType::kPhotometric);

  const std::string normal = ReadText(Paths(2).normal);
  WriteNormalMap(UserPath(Paths(2).normal),
                 Image<Vec3f>(48, 36, Vec3f{0.f, 0.f, -1.f}));
  ExpectRefusal(ErrorCode::kMismatch, {Paths(2).normal.string(), "48 x 36"});
  WriteDepthMap(UserPath(Paths(2).normal), Image<float>(96, 72, 5.f));
  ExpectRefusal(ErrorCode::kCorrupt, {Paths(2).normal.string(), "channels"});
  std::filesystem::remove(Paths(2).normal);
  ExpectRefusal(ErrorCode::kNotFound,
                {Paths(2).normal.string(), "no normal map"});
  WriteText(Paths(2).normal, normal);
  std::filesystem::remove(Paths(2).depth);
  ExpectRefusal(ErrorCode::kNotFound,
                {Paths(2).depth.string(), "no depth map"});
}

// Of references and sources, of both types, and of what is stored.
TEST_F(RefineWorkspaceTest, RefusesMapsOfAnotherShapeThanTheirImage) {
  Refine();
  WriteText(root_ / "stereo/patch-match.cfg", "v0.png\nv1.png, v3.png\n");
  const auto geometric = Paths(3);
  const auto photometric = Paths(3, MapType::kPhotometric);
  for (const auto& [path, num_channels] : {std::pair(geometric.depth, 1),
                                           {geometric.normal, 3},
                                           {geometric.original_depth, 1},
                                           {geometric.original_normal, 3},
                                           {photometric.depth, 1},
                                           {photometric.normal, 3},
                                           {Paths(0).depth, 1},
                                           {Paths(0).cost, 2}}) {
    const bool is_there = std::filesystem::exists(path);
    const std::string bytes = is_there ? ReadText(path) : "";
    for (const auto& [width, height] :
         {std::pair(72, 96), {4000, 2}, {96, 36}}) {
      CreateFolders(path.Parent());
      WritePlanarMap(
          path,
          {width,
           height,
           num_channels,
           std::vector<float>(
               static_cast<size_t>(width * height * num_channels), 1.f)});
      ExpectRefusal(ErrorCode::kMismatch,
                    {path.string() + ": has " + std::to_string(width) + " x " +
                         std::to_string(height) + " pixels",
                     "not the shape of the image",
                     "of 96 x 72; run patch_match_stereo again"});
    }
    std::filesystem::remove(path);
    if (is_there) {
      WriteText(path, bytes);
    }
  }
}

TEST_F(RefineWorkspaceTest, RefusesCostMapsThatDoNotFit) {
  CreateFolders(Paths(0).cost.Parent());
  WriteDepthMap(UserPath(Paths(0).cost), Image<float>(96, 72, 1.f));
  ExpectRefusal(ErrorCode::kCorrupt, {Paths(0).cost.string(), "channels"});
}

TEST_F(RefineWorkspaceTest, RefusesUnknownImagesAndEmptyConfigurations) {
  const std::filesystem::path config = root_ / "stereo/patch-match.cfg";
  WriteText(config, "v0.png\nv9.png\n");
  ExpectRefusal(ErrorCode::kMismatch, {"patch-match.cfg", "line 2", "v9.png"});
  WriteText(config, "");
  ExpectRefusal(ErrorCode::kNotFound, {"patch-match.cfg", "names no image"});
}

TEST_F(RefineWorkspaceTest, RefusesOptionsThatMakeNoSense) {
  WorkspaceRefineOptions options = Options(root_);
  options.num_threads = 0;
  ExpectRefusal(ErrorCode::kBadOption, {"num_threads"}, options);
  options = Options(root_);
  options.gpu_index = "0,0";
  ExpectRefusal(ErrorCode::kBadOption, {"gpu_index", "twice"}, options);
  options = Options(root_);
  options.device = "abacus";
  ExpectRefusal(ErrorCode::kBadOption, {"device"}, options);
  options = Options(root_);
  options.cache_size = std::numeric_limits<double>::quiet_NaN();
  ExpectRefusal(ErrorCode::kBadOption, {"cache_size"}, options);
  RefineOptions refine;
  refine.num_iterations = 0;
  ExpectError(ErrorCode::kBadOption, {"num_iterations"}, [&] {
    Refine(Options(root_), refine);
  });
}

}  // namespace
}  // namespace tsar
