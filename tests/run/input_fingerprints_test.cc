// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/input_fingerprints.h"

#include "colmap_tsar/run/store/record.h"

#include <chrono>
#include <functional>
#include <map>

#include "tests/support/test_workspace.h"
#include "tests/support/write_refined.h"

namespace tsar {
namespace {

constexpr MapType kGeometric = MapType::kGeometric;

// What a program that writes a file anew does to its time.
void Touch(const std::filesystem::path& path) {
  std::filesystem::last_write_time(
      path, std::filesystem::last_write_time(path) + std::chrono::seconds(2));
}

// Images 0 to 7 are "a.png", "left/b.png", "c.png" and "d.png" to "h.png". The
// sources of the first are the second, whose sources are it and the third;
// those of the third are all others.
class InputFingerprintsTest : public testing::Test {
 protected:
  void SetUp() override {
    MakeTestWorkspace(root_);
    std::string images = ReadText(root_ / "sparse/images.txt");
    int id = 4;
    for (const char* name : {"d.png", "e.png", "f.png", "g.png", "h.png"}) {
      images += std::to_string(id++) + " 1 0 0 0 -3 0 0 1 " + name + "\n\n";
      WriteText(root_ / "images" / name, ReadText(root_ / "images/a.png"));
      for (const MapType type : {MapType::kPhotometric, kGeometric}) {
        WriteTestMaps(root_, name, type, 5.f);
      }
    }
    WriteText(root_ / "sparse/images.txt", images);
    WriteText(root_ / "stereo/patch-match.cfg",
              "a.png\nleft/b.png\nleft/b.png\na.png, c.png\nc.png\n__all__\n");
  }

  // As a run would see it.
  InputState Result(int reference) const {
    const Workspace workspace(root_, kGeometric);
    return InputFingerprints(workspace).OfResult(reference);
  }
  // What has changed since of the three references, "" where nothing has.
  std::vector<std::string> Changes(const std::function<void()>& change) const {
    std::vector<InputState> before;
    for (const int reference : {0, 1, 2}) {
      before.push_back(Result(reference));
    }
    change();
    std::vector<std::string> changes;
    const Workspace workspace(root_, kGeometric);
    InputFingerprints inputs(workspace);
    for (const int reference : {0, 1, 2}) {
      const InputState& recorded = before[reference];
      changes.push_back(inputs.ChangesOfResult(reference, recorded));
      EXPECT_EQ(changes.back().empty(), inputs.OfResult(reference) == recorded);
    }
    return changes;
  }
  MapPaths Paths(const std::string& image, MapType type = kGeometric) const {
    return GetMapPaths(root_, image, type);
  }
  void Replace(const std::filesystem::path& path,
               const std::string& from,
               const std::string& to) const {
    std::string text = ReadText(root_ / path);
    ASSERT_NE(text.find(from), std::string::npos);
    WriteText(root_ / path, text.replace(text.find(from), from.size(), to));
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

using testing::ElementsAre;

constexpr const char* kOthers = "other images of the scene have changed";

TEST_F(InputFingerprintsTest, NamesWhatHasChanged) {
  EXPECT_THAT(Changes([] {}), ElementsAre("", "", ""));
  EXPECT_THAT(Changes([&] { Touch(root_ / "images/a.png"); }),
              ElementsAre("its photo has changed", kOthers, kOthers));
  EXPECT_THAT(Changes([&] {
                Touch(root_ / "images/c.png");
                Touch(Paths("c.png").normal);
                Touch(Paths("left/b.png", MapType::kPhotometric).depth);
              }),
              ElementsAre(kOthers,
                          "its maps have changed",
                          "its photo and its maps have changed"));
  // Images that are neither references nor sources do not count.
  WriteText(root_ / "stereo/patch-match.cfg",
            "a.png\nleft/b.png\nleft/b.png\na.png, c.png\n");
  const InputState before = Result(1);
  Touch(root_ / "images/d.png");
  EXPECT_EQ(Result(1), before);
  Touch(root_ / "images/c.png");
  EXPECT_NE(Result(0), before);
}

TEST_F(InputFingerprintsTest, RefiningChangesNothing) {
  EXPECT_THAT(Changes([&] {
                for (const MapType type : {MapType::kPhotometric, kGeometric}) {
                  WriteRefined(
                      Workspace(root_, type), 1, MakeRefinedMaps(42.f), {});
                }
              }),
              ElementsAre("", "", ""));
  // But new maps in the place of the refined ones do.
  EXPECT_THAT(Changes([&] {
                WriteTestMaps(root_, "left/b.png", kGeometric, 9.f);
                Touch(Paths("left/b.png").depth);
              }),
              ElementsAre(kOthers, "its maps have changed", kOthers));
}

TEST_F(InputFingerprintsTest, OfAnImageWithoutMapsNothingElseCounts) {
  const auto remove_maps = [&] {
    std::filesystem::remove(Paths("a.png").depth);
    std::filesystem::remove(Paths("a.png").normal);
  };
  EXPECT_THAT(Changes(remove_maps),
              ElementsAre("its maps have changed", kOthers, kOthers));
  EXPECT_THAT(Changes([&] {
                Touch(root_ / "images/a.png");
                Touch(Paths("a.png", MapType::kPhotometric).depth);
              }),
              ElementsAre("", "", ""));
}

TEST_F(InputFingerprintsTest, KeepsWhatItSawFirst) {
  const Workspace workspace(root_, kGeometric);
  InputFingerprints inputs(workspace);
  const InputState before = inputs.OfResult(0);
  Touch(root_ / "images/a.png");
  EXPECT_EQ(inputs.OfResult(0), before);
  EXPECT_NE(Result(0), before);
}

TEST_F(InputFingerprintsTest, ReadsOfOtherImagesWhatNobodyChanges) {
  std::map<int, InputState> views;
  const Workspace workspace(root_, kGeometric);
  {
    InputFingerprints inputs(workspace);
    for (const int image : {0, 1, 2}) {
      views[image] = inputs.OfView(image);
    }
  }
  const InputState before = Result(1);
  const auto expecting = [&](const std::vector<int>& own) {
    auto inputs = std::make_unique<InputFingerprints>(workspace);
    inputs->Expect(views, own);
    return inputs;
  };
  // Others are changing the maps of the first.
  Touch(Paths("a.png").depth);
  EXPECT_EQ(expecting({1, 2})->OfResult(1), before);
  ExpectError(ErrorCode::kMismatch,
              {"a.png: its maps have changed", "observe of all shards"},
              [&] {
                expecting({0, 1})->OfResult(1);
              });
  Touch(root_ / "images/c.png");
  ExpectError(ErrorCode::kMismatch,
              {"c.png: its photo has changed", "observe of all shards"},
              [&] { expecting({1})->OfResult(1); });
  // A record that is not whole.
  views[0].clear();
  ExpectError(ErrorCode::kMismatch, {"a.png: its "}, [&] {
    expecting({1, 2})->OfView(0);
  });
}

TEST(DescribeChanges, EndsAsTheNumberAsks) {
  EXPECT_EQ(DescribeChanges({{"its photo", false}}), "its photo has changed");
  EXPECT_EQ(DescribeChanges({{"its maps", true}}), "its maps have changed");
  EXPECT_EQ(DescribeChanges({{"its photo", false}, {"its camera", false}}),
            "its photo and its camera have changed");
  EXPECT_EQ(DescribeChanges({{"a", false}, {"b", true}, {"c", false}}),
            "a, b and c have changed");
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
