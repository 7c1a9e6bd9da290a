// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/run/refine_workspace_fixture.h"

namespace tsar {
namespace {

class RefineListedTest : public RefineWorkspaceTest {
 protected:
  WorkspaceRefineOptions Listed(const std::string& names) const {
    WriteText(list_, names);
    WorkspaceRefineOptions options = Options(root_);
    options.image_list_path = list_;
    return options;
  }
  // Expects that only the maps of this image were refined, with the same result
  // as in a run on all images.
  static void ExpectRefined(const Tree& maps,
                            const std::string& image,
                            const Tree& before,
                            const Tree& whole) {
    for (const auto& [name, content] : whole) {
      if (content == "folder") {
        continue;
      }
      const auto found = maps.find(name);
      const auto original = before.find(name);
      if (name.find("/" + image + ".") != std::string::npos) {
        ASSERT_NE(found, maps.end()) << name;
        EXPECT_TRUE(found->second == content) << name << " differs";
      } else if (original != before.end()) {
        EXPECT_TRUE(found != maps.end() && found->second == original->second)
            << name << " has changed";
      } else {
        EXPECT_EQ(found, maps.end()) << name << " is new";
      }
    }
  }

  const std::filesystem::path list_ = folder_.Path() / "list.txt";
};

TEST_F(RefineListedTest, RefinesThemAloneAsAmongAll) {
  for (const bool scene_planes : {true, false}) {
    RefineOptions refine;
    refine.scene_planes = scene_planes;
    const Tree whole = RefinedInOneGo(refine);
    Redraw();
    const Tree before = MapsOf(root_);
    const RunSummary summary =
        Refine(Listed("left/v2.png\r\nleft/v2.png\r\n"), refine);
    EXPECT_EQ(summary.num_refined, 1);
    EXPECT_EQ(summary.num_not_listed, 3);
    ExpectRefined(MapsOf(root_), "left/v2.png", before, whole);
    EXPECT_EQ(Manifest()["num_images"]["done"], 1);
    EXPECT_EQ(Manifest()["num_images"]["pending"], 3);
    EXPECT_EQ(Manifest()["runtime"]["listed_images"], "1");
    EXPECT_FALSE(std::filesystem::exists(root_ / "stereo/tsar/evidence"));

    // The same list again, then all images: only the others are refined.
    const Tree listed = MapsOf(root_);
    const RunSummary again = Refine(Listed("left/v2.png\n"), refine);
    EXPECT_EQ(again.num_refined, 0);
    EXPECT_EQ(again.num_skipped, 1);
    ExpectSameFiles(MapsOf(root_), listed);
    const RunSummary all = Refine(Options(root_), refine);
    EXPECT_EQ(all.num_refined, 3);
    EXPECT_EQ(all.num_skipped, 1);
    ExpectSameFiles(MapsOf(root_), whole);
    EXPECT_FALSE(Manifest()["runtime"].contains("listed_images"));
  }
}

// Images that are not listed do not count as done.
TEST_F(RefineListedTest, AnInterruptionTellsOfTheListedAlone) {
  WorkspaceRefineOptions options = Listed("v1.png\nv3.png\n");
  options.devices.cache_size = 1e-6;  // One image at a time.
  ExpectError(ErrorCode::kInterrupted, {"1 of 2", "same command"}, [&] {
    Refine(
        options, {}, [&] { return std::filesystem::exists(Paths(1).record); });
  });
  EXPECT_EQ(Refine(options).num_skipped, 1);
}

TEST_F(RefineListedTest, LinksTheOthersInASecondWorkspace) {
  WorkspaceRefineOptions options = Listed("v0.png\n");
  options.output_path = folder_.Path() / "out";
  const Tree before = ReadTree(root_);
  EXPECT_EQ(Refine(options).num_refined, 1);
  ExpectSameFiles(ReadTree(root_), before);
  const auto is_link = [&](int view) {
    return std::filesystem::is_symlink(
        GetMapPaths(options.output_path,
                    SyntheticWorkspace::Names()[view],
                    MapType::kGeometric)
            .depth);
  };
  EXPECT_FALSE(is_link(0));
  EXPECT_TRUE(is_link(1));
}

// Their planes are those of the whole scene.
TEST_F(RefineListedTest, RefusesToLeaveOthersWithPlanesOfAnotherScene) {
  Refine();
  RefineOptions other;
  other.seed = 7;
  const WorkspaceRefineOptions options = Listed("v1.png\n");
  const Tree before = ReadTree(root_);
  ExpectError(ErrorCode::kUnsupported,
              {list_.string() + ": leaves out v0.png", "output_path"},
              [&] { Refine(options, other); });
  ExpectSameFiles(ReadTree(root_), before);
  // Unchanged, all match.
  EXPECT_EQ(Refine(options).num_skipped, 1);
  // Without such planes, images are refined by themselves.
  other.scene_planes = false;
  EXPECT_EQ(Refine(options, other).num_refined, 1);
}

TEST_F(RefineListedTest, RefusesWrongListsBeforeAnythingIsChanged) {
  ExpectRefusal(ErrorCode::kMismatch,
                {"list.txt: line 2 names v9.png, which is not in the sparse"},
                Listed("v0.png\nv9.png\n"));
  ExpectRefusal(ErrorCode::kMismatch, {"names no image"}, Listed("\n"));
  WorkspaceRefineOptions missing = Listed("v0.png\n");
  missing.image_list_path = folder_.Path() / "none";
  ExpectRefusal(ErrorCode::kNotFound, {"none", "image_list_path"}, missing);
  WorkspaceRefineOptions shard = Listed("v0.png\n");
  shard.pass = RefinePass::kObserve;
  shard.shard = {0, 2};
  ExpectRefusal(ErrorCode::kBadOption, {"image_list_path", "pass all"}, shard);
  WriteText(root_ / "stereo/patch-match.cfg", "v0.png\n__all__\n");
  ExpectRefusal(
      ErrorCode::kMismatch,
      {"line 1 names v1.png, which stereo/patch-match.cfg gives no sources"},
      Listed("v1.png\n"));
}

}  // namespace
}  // namespace tsar
