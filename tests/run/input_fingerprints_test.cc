// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/input_fingerprints.h"

#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/write_back.h"

#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

constexpr MapType kGeometric = MapType::kGeometric;

// Changes a file's time, as a program that rewrites it does.
void Touch(const std::filesystem::path& path) {
  std::filesystem::last_write_time(
      path, std::filesystem::last_write_time(path) + std::chrono::seconds(2));
}

class InputFingerprintsTest : public testing::Test {
 protected:
  void SetUp() override { MakeTestWorkspace(root_); }
  // The reported change of the inputs, "" for none.
  std::string ChangesOf(const std::function<void()>& change) const {
    const Workspace workspace_before(root_, kGeometric);
    const InputFingerprints before(workspace_before);
    change();
    const Workspace workspace_after(root_, kGeometric);
    const InputFingerprints after(workspace_after);
    const std::string changes = after.ChangesSince(before.States());
    EXPECT_EQ(changes.empty(), after.OfRun() == before.OfRun());
    return changes;
  }
  MapPaths Paths(const std::string& image, MapType type = kGeometric) const {
    return GetMapPaths(root_, image, type);
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

TEST_F(InputFingerprintsTest, NamesWhatHasChanged) {
  const auto refine = [&](int image) {
    for (const MapType type : {MapType::kPhotometric, kGeometric}) {
      WriteRefined(Workspace(root_, type), image, MakeRefinedMaps(42.f), {});
    }
  };
  const std::vector<std::pair<std::function<void()>, std::string>> cases = {
      {[] {}, ""},
      {[&] { Touch(root_ / "images/a.png"); },
       "the photo of a.png has changed"},
      {[&] { Touch(Paths("c.png").normal); },
       "the geometric normal map of c.png has changed"},
      {[&] { Touch(Paths("left/b.png", MapType::kPhotometric).depth); }, ""},
      {[&] { WriteText(Paths("a.png").cost, "costs"); },
       "the geometric cost map of a.png has changed"},
      {[&] {
         Touch(root_ / "images/c.png");
         Touch(root_ / "images/a.png");
       },
       "the photo of a.png and 1 other input have changed"},
      // Refined maps are no inputs; maps that replace them are.
      {[&] { refine(1); }, ""},
      {[&] { Restore(root_); }, ""},
      {[&] { refine(1); }, ""},
      {[&] { WriteTestMaps(root_, "left/b.png", kGeometric, 9.f); },
       "the geometric depth map of left/b.png and 1 other input have changed"},
      {[&] {
         WriteText(root_ / "stereo/patch-match.cfg",
                   "a.png\nleft/b.png\nleft/b.png\na.png\n");
       },
       "the camera of c.png and 7 other inputs have changed"},
      // Images that are neither references nor sources do not count; of an
      // image without maps, only the missing maps do.
      {[&] { Touch(root_ / "images/c.png"); }, ""},
      {[&] {
         Restore(root_);
         std::filesystem::remove(Paths("a.png").depth);
         Touch(root_ / "images/a.png");
       },
       "the camera of a.png and 4 other inputs have changed"},
      {[&] { Touch(root_ / "images/a.png"); }, ""},
  };
  for (size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(ChangesOf(cases[i].first), cases[i].second);
  }
}

TEST(FileState, TellsSizesAndTimesApart) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.Path() / "file";
  EXPECT_EQ(FileState(path), "-");
  WriteText(path, "four");
  const std::string state = FileState(path);
  std::filesystem::create_symlink(path, folder.Path() / "link");
  EXPECT_EQ(FileState(folder.Path() / "link"), state);
  std::filesystem::rename(path, folder.Path() / "renamed");
  EXPECT_EQ(FileState(folder.Path() / "renamed"), state);
  const auto time = std::filesystem::last_write_time(folder.Path() / "renamed");
  WriteText(path, "fives");
  std::filesystem::last_write_time(path, time);
  EXPECT_NE(FileState(path), state);
  WriteText(path, "four");
  std::filesystem::last_write_time(path, time);
  EXPECT_EQ(FileState(path), state);
  Touch(path);
  EXPECT_NE(FileState(path), state);
}

TEST(FingerprintOf, TellsEveryNumberOfACameraApart) {
  const Camera camera;
  const std::vector<std::function<void(Camera*)>> changes = {
      [](Camera* c) { c->width = 1; },
      [](Camera* c) { c->height = 1; },
      [](Camera* c) { c->fx += 1e-12; },
      [](Camera* c) { c->fy += 1e-12; },
      [](Camera* c) { c->cx += 1e-12; },
      [](Camera* c) { c->cy += 1e-12; },
      [](Camera* c) { c->rotation(2, 1) += 1e-12; },
      [](Camera* c) { c->translation.z() += 1e-12; }};
  EXPECT_EQ(FingerprintOf(camera), FingerprintOf(Camera()));
  for (size_t i = 0; i < changes.size(); ++i) {
    Camera other;
    changes[i](&other);
    EXPECT_NE(FingerprintOf(other), FingerprintOf(camera)) << i;
  }
}

}  // namespace
}  // namespace tsar
