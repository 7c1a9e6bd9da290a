// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/run/workspace_check.h"

#include <cmath>
#include <functional>
#include <mutex>
#include <tuple>

#include "tests/run/refine_workspace_fixture.h"

namespace tsar {
namespace {

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

// Before hours of work, whatever it would write there.
TEST_F(RefineWorkspaceTest, RefusesFoldersUnderTheNamesOfItsFiles) {
  for (const ContainedPath& path : {Paths(1).confidence,
                                    Paths(1).provenance,
                                    Paths(1).planes,
                                    Paths(1).sigma,
                                    GetSceneModelPath(root_)}) {
    WriteText(path.Path() / "inside", "");
    ExpectRefusal(ErrorCode::kIo,
                  {path.string(), "move the folder of this name away"});
    std::filesystem::remove_all(path.Path());
  }
}

TEST_F(RefineWorkspaceTest, RefusesMissingAndDamagedImageFiles) {
  const std::string image = ReadText(root_ / "images/left/v2.png");
  for (const auto& [bytes, what] :
       {std::pair(std::string(), "empty"),
        {"no picture", "not a readable"},
        {image.substr(0, image.size() / 10), "the image is damaged"}}) {
    WriteText(root_ / "images/left/v2.png", bytes);
    ExpectRefusal(ErrorCode::kCorrupt, {"left/v2.png", what});
  }
  std::filesystem::remove(root_ / "images/left/v2.png");
  ExpectRefusal(ErrorCode::kNotFound, {"left/v2.png", "image_undistorter"});
}

TEST_F(RefineWorkspaceTest, RefusesImagesThatAreTooLargeToDecode) {
  WriteText(root_ / "sparse/cameras.txt",
            "1 PINHOLE 32768 32769 32000 32000 48 36\n");
  WriteDepthMap(Paths(0).depth, Image<float>(72, 72, 5.f));
  WriteNormalMap(Paths(0).normal, Image<Vec3f>(72, 72, Vec3f{0.f, 0.f, -1.f}));
  ExpectRefusal(ErrorCode::kUnsupported,
                {"v0.png", "32768 x 32769", "2^30", "--max_image_size"});
}

TEST_F(RefineWorkspaceTest, RefusesMapsWithMorePixelsThanItCanNumber) {
  // Only the headers of these files take space.
  for (const auto& [path, channels] :
       {std::pair(Paths(1).depth, 1), std::pair(Paths(1).normal, 3)}) {
    const std::string head = "40000&30000&" + std::to_string(channels) + "&";
    WriteText(path, head);
    std::filesystem::resize_file(
        path, head.size() + uintmax_t{4} * 40000 * 30000 * channels);
  }
  ExpectError(
      ErrorCode::kUnsupported,
      {Paths(1).depth.string(), "40000 x 30000", "max_image_size"},
      [&] { CheckWorkspace(Workspace(root_, MapType::kGeometric), 1); });
}

TEST_F(RefineWorkspaceTest, RefusesBrokenMaps) {
  for (const std::filesystem::path& path : {Paths(3).depth, Paths(3).normal}) {
    const std::string bytes = ReadText(path);
    WriteText(path, bytes.substr(0, bytes.size() / 2));
    ExpectRefusal(ErrorCode::kCorrupt, {path.string(), "not a complete map"});
    WriteText(path, "");
    ExpectRefusal(ErrorCode::kCorrupt, {path.string(), "empty"});
    WriteText(path, bytes);
  }
}

TEST_F(RefineWorkspaceTest, RefusesMapsThatDoNotBelongTogether) {
  const std::string normal = ReadText(Paths(2).normal);
  WriteNormalMap(UserPath(Paths(2).normal),
                 Image<Vec3f>(48, 36, Vec3f{0.f, 0.f, -1.f}));
  ExpectRefusal(ErrorCode::kMismatch, {Paths(2).normal.string(), "48 x 36"});
  WriteDepthMap(UserPath(Paths(2).normal), Image<float>(96, 72, 5.f));
  ExpectRefusal(ErrorCode::kCorrupt, {Paths(2).normal.string(), "3 channel"});
  std::filesystem::remove(Paths(2).normal);
  ExpectRefusal(ErrorCode::kNotFound,
                {Paths(2).normal.string(), "no normal map"});
  WriteText(Paths(2).normal, normal);
  std::filesystem::remove(Paths(2).depth);
  ExpectRefusal(ErrorCode::kNotFound,
                {Paths(2).depth.string(), "no depth map"});
}

// Maps of references and sources.
TEST_F(RefineWorkspaceTest, RefusesMapsOfAnotherShapeThanTheirImage) {
  Refine();
  WriteText(root_ / "stereo/patch-match.cfg", "v0.png\nv1.png, v3.png\n");
  const auto geometric = Paths(3);
  for (const auto& [path, num_channels] : {std::pair(geometric.depth, 1),
                                           {geometric.normal, 3},
                                           {Paths(0).depth, 1},
                                           {Paths(0).cost, 2}}) {
    const bool is_there = std::filesystem::exists(path);
    const std::string bytes = is_there ? ReadText(path) : "";
    for (const auto& [width, height] :
         {std::pair(72, 96), {4000, 2}, {96, 36}}) {
      CreateFolders(path.Parent());
      const MapSize size = {width, height, num_channels};
      WriteMap(path, size, std::vector<float>(size.NumValues(), 1.f));
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

// A kept original that is no map of this image at all is named; it matters only
// as long as nothing newer is in the place of the refined maps.
TEST_F(RefineWorkspaceTest, RefusesOriginalsThatAreNoMapsOfTheImage) {
  Refine();
  const MapPaths paths = Paths(3);
  const std::string depth = ReadText(paths.original_depth);
  const std::string normal = ReadText(paths.original_normal);
  for (const auto& [other, code] :
       {std::pair(std::string(), ErrorCode::kMismatch),
        {depth.substr(0, depth.size() / 2), ErrorCode::kMismatch},
        {normal, ErrorCode::kCorrupt},
        {std::string("1&1&1&\0\0\0\0", 10), ErrorCode::kMismatch}}) {
    WriteText(paths.original_depth, other);
    ExpectRefusal(code, {"v3.png.geometric.bin"});
  }
  WriteDepthMap(paths.depth, Image<float>(96, 72, 7.f));
  EXPECT_EQ(Refine().num_images, 4);
}

TEST_F(RefineWorkspaceTest, RefusesCostMapsThatDoNotFit) {
  CreateFolders(Paths(0).cost.Parent());
  WriteDepthMap(UserPath(Paths(0).cost), Image<float>(96, 72, 1.f));
  ExpectRefusal(ErrorCode::kCorrupt, {Paths(0).cost.string(), "2 channel"});
}

TEST_F(RefineWorkspaceTest, RefusesConfigurationsWithoutImages) {
  WriteText(root_ / "stereo/patch-match.cfg", "");
  ExpectRefusal(ErrorCode::kNotFound, {"patch-match.cfg", "names no image"});
  std::filesystem::rename(root_ / "images", root_ / "visualize");
  ExpectRefusal(ErrorCode::kNotFound,
                {"images: no such folder", "--output_type COLMAP"});
}

TEST_F(RefineWorkspaceTest, RefusesOptionsThatMakeNoSense) {
  using Options = WorkspaceRefineOptions;
  const auto set_shard = [](Options& o, Shard shard) {
    o.pass = RefinePass::kObserve;
    o.shard = shard;
  };
  const std::tuple<const char*, const char*, std::function<void(Options&)>>
      cases[] = {{"num_threads",
                  "at least 1",
                  [](auto& o) { o.devices.num_threads = 0; }},
                 {"gpu_index",
                  "twice",
                  [](auto& o) {
                    o.devices.gpu_indices = {0, 0};
                  }},
                 {"gpu_index",
                  "no GPU -1",
                  [](auto& o) { o.devices.gpu_indices = {-1}; }},
                 {"cache_size",
                  "positive",
                  [](auto& o) { o.devices.cache_size = NAN; }},
                 {"shard",
                  "part",
                  [&](auto& o) {
                    set_shard(o, {2, 2});
                  }},
                 {"shard",
                  "part",
                  [&](auto& o) {
                    set_shard(o, {-1, 2});
                  }},
                 {"shard", "part", [&](auto& o) {
                    set_shard(o, {0, 0});
                  }}};
  for (const auto& [option, what, change] : cases) {
    Options options = RefineWorkspaceTest::Options(root_);
    change(options);
    ExpectRefusal(ErrorCode::kBadOption, {option, what}, options);
  }
  RefineOptions refine;
  refine.num_iterations = 0;
  ExpectError(ErrorCode::kBadOption, {"num_iterations"}, [&] {
    Refine(RefineWorkspaceTest::Options(root_), refine);
  });
}

}  // namespace
}  // namespace tsar
