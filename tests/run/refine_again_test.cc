// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/io/map_io.h"

#include <chrono>

#include "tests/run/refine_workspace_fixture.h"
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

TEST_F(RefineWorkspaceTest, RefinesAgainWhatHasChanged) {
  // All images are of one scene, whether they share its planes or not.
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\nv1.png\nv1.png\nv0.png\nleft/v2.png\nv3.png\n");
  for (const bool scene_planes : {true, false}) {
    RefineOptions refine;
    refine.scene_planes = scene_planes;
    EXPECT_EQ(Refine(Options(root_), refine).num_refined, 3);
    const auto refine_again = [&] {
      testing::internal::CaptureStderr();
      const int num_refined = Refine(Options(root_), refine).num_refined;
      return std::pair(num_refined, testing::internal::GetCapturedStderr());
    };
    EXPECT_EQ(refine_again(), std::pair(0, std::string()));
    const std::filesystem::path photo = root_ / "images/v1.png";
    std::filesystem::last_write_time(
        photo,
        std::filesystem::last_write_time(photo) + std::chrono::seconds(2));
    const auto [num_refined, warnings] = refine_again();
    EXPECT_EQ(num_refined, 3);
    EXPECT_THAT(
        warnings,
        testing::HasSubstr("v0.png and 2 more: refined again, since the "
                           "photo of v1.png has changed\n"));
  }
}

// Plane maps refer to these planes by number.
TEST_F(RefineWorkspaceTest, RefinesAgainWithoutThePlanesOfTheScene) {
  Refine();
  const Tree expected = MapsOf(root_);
  const std::filesystem::path planes = root_ / "stereo/tsar/planes.bin";
  const std::string bytes = ReadText(planes);
  std::string damaged = bytes;
  damaged[damaged.size() / 2] ^= 1;
  const std::filesystem::path other = folder_.Path() / "other";
  MakeSyntheticWorkspace(other);
  RemoveDepths(other, 3);
  Refine(Options(other));
  const std::string of_other_scene = ReadText(other / "stereo/tsar/planes.bin");
  ASSERT_NE(of_other_scene, bytes);
  for (const std::string& content : {std::string(), damaged, of_other_scene}) {
    EXPECT_EQ(Refine().num_refined, 0);
    WriteText(planes, content);
    EXPECT_THAT(WarningsOf(Options(root_), 4),
                testing::HasSubstr("v0.png and 3 more: refined again, since "
                                   "some of what was written for them is "
                                   "missing"));
    EXPECT_TRUE(ReadText(planes) == bytes);
    ExpectSameFiles(expected, MapsOf(root_));
  }
}

// An image that can no longer be refined gets its original maps back.
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
  MakeSyntheticWorkspace(whole);
  const RunSummary all_in_one_go = Refine(Options(whole));

  WorkspaceRefineOptions one_by_one = Options(root_);
  one_by_one.devices.cache_size = 1e-6;
  ExpectError(ErrorCode::kInterrupted, {"2 of 4", "same command"}, [&] {
    Refine(one_by_one, {}, [&] {
      return std::filesystem::exists(Paths(1).record);
    });
  });
  EXPECT_EQ(Manifest()["num_images"]["done"], 2);
  EXPECT_EQ(Manifest()["num_images"]["pending"], 2);

  const RunSummary summary = Refine();
  EXPECT_EQ(summary.num_skipped, 2);
  EXPECT_EQ(summary.num_refined, 2);
  // The counts of pixels are those of all images.
  EXPECT_EQ(summary.counts.at("pixels"), 4 * 96 * 72);
  EXPECT_EQ(summary.counts, all_in_one_go.counts);
  EXPECT_EQ(Manifest()["num_images"]["done"], 4);
  ExpectSameFiles(MapsOf(whole), MapsOf(root_));
}

TEST_F(RefineWorkspaceTest, AFailedWriteLeavesTheOthersDone) {
  // A folder has the temporary name of the third image's confidence map.
  const std::filesystem::path confidence = Paths(2).confidence;
  const std::filesystem::path temporary =
      confidence.string() + AtomicFile::kTemporarySuffix;
  WriteText(temporary / "file", "in the way");
  ExpectError(ErrorCode::kIo, {confidence.string()}, [&] { Refine(); });
  EXPECT_EQ(Manifest()["images"][0]["status"], "done");
  EXPECT_EQ(Manifest()["images"][1]["status"], "done");
  EXPECT_EQ(Manifest()["images"][2]["status"], "failed");
  std::filesystem::remove_all(temporary);
  Refine();
  EXPECT_EQ(Manifest()["num_images"]["done"], 4);
}

TEST_F(RefineWorkspaceTest, AnImageThatCannotBeReadEndsTheRunButNotTheRest) {
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\nv1.png\nv1.png\nv0.png\nv3.png\nleft/v2.png\n");
  const std::string image = ReadText(root_ / "images/v3.png");
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
      // Damage found while the images are observed stops any change.
      EXPECT_EQ(Manifest()["num_images"]["pending"], 2);
      ExpectSameFiles(before, MapsOf(root_));
    } else {
      EXPECT_EQ(Manifest()["num_images"]["done"], 2);
    }
  }
  WriteText(root_ / "images/v3.png", image);
  RefineOptions options;
  options.scene_planes = false;
  // Its time has changed, and with it the scene of all images.
  EXPECT_EQ(Refine(Options(root_), options).num_refined, 3);
  EXPECT_EQ(Refine().num_refined, 3);
}

TEST_F(RefineWorkspaceTest, WhatWasDoneBeforeStaysDoneWhereObservingItFails) {
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\nv1.png\nv1.png\nv3.png\nv3.png\nv1.png\n");
  Refine();
  // Now v0 needs what v1 observes, and that needs the image of v3.
  std::filesystem::remove(Paths(0).confidence);
  const Tree before = MapsOf(root_);
  // As if damaged by the disk: of the same size and time.
  const std::filesystem::path photo = root_ / "images/v3.png";
  const auto time = std::filesystem::last_write_time(photo);
  WriteText(photo, WithZeros(ReadText(photo)));
  std::filesystem::last_write_time(photo, time);
  ExpectError(ErrorCode::kCorrupt, {"v3.png", "is damaged"}, [&] { Refine(); });
  ExpectSameFiles(before, MapsOf(root_));
  const nlohmann::json manifest = Manifest();
  EXPECT_EQ(manifest["num_images"]["failed"], 0);
  EXPECT_EQ(manifest["images"][1]["status"], "done");
  EXPECT_THAT(
      manifest["images"][1]["note"].get<std::string>(),
      testing::AllOf(testing::StartsWith("cannot be observed for other images"),
                     testing::HasSubstr("v3.png")));
  EXPECT_EQ(manifest["images"][2]["status"], "done");
  EXPECT_EQ(manifest["images"][2]["note"], "");

  // If the maps of v1 have changed meanwhile, v1 fails.
  WriteDepthMap(Paths(1).depth, Image<float>(96, 72, 5.5f));
  WriteNormalMap(Paths(1).normal,
                 Image<Vec3f>(96, 72, Vec3f{0.06f, 0.08f, -0.99499f}));
  for (const ContainedPath& path : {Paths(1).depth, Paths(1).normal}) {
    std::filesystem::last_write_time(
        path, std::filesystem::last_write_time(path) + std::chrono::hours(1));
  }
  ExpectError(ErrorCode::kCorrupt, {"v3.png", "is damaged"}, [&] { Refine(); });
  EXPECT_EQ(Manifest()["images"][1]["status"], "failed");
  EXPECT_EQ(Manifest()["num_images"]["failed"], 1);
}

TEST_F(RefineWorkspaceTest, NeighborsWithoutMapsOrDepthsDoNotMatter) {
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
  Redraw();
  RemoveDepths(root_, 3);
  const RunSummary summary = Refine();
  EXPECT_EQ(summary.num_refined, 3);
  ASSERT_EQ(summary.kept.size(), 1u);
  EXPECT_EQ(summary.kept[0].name, "v3.png");
  for (int view = 0; view < 3; ++view) {
    ExpectBareWallFilled(view);
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

}  // namespace
}  // namespace tsar
