// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/restore.h"

#include "tests/run/store/write_back_testing.h"
#include "tests/support/write_refined.h"

namespace tsar {
namespace {

constexpr MapType kType = MapType::kGeometric;

// Which of the two maps a refinement leaves with the bytes that it had.
struct Unchanged {
  bool depth = false;
  bool normal = false;
};

class InterruptedRestoreTest : public WriteBackTest {
 protected:
  // A workspace with one refined image.
  void Begin(const Unchanged& unchanged) {
    std::filesystem::remove_all(root_);
    MakeTestWorkspace(root_);
    original_depth_ = ReadText(Paths().depth);
    original_normal_ = ReadText(Paths().normal);
    Refine(unchanged);
    ASSERT_EQ(ReadText(Paths().depth) == original_depth_, unchanged.depth);
    ASSERT_EQ(ReadText(Paths().normal) == original_normal_, unchanged.normal);
  }
  void Refine(const Unchanged& unchanged) {
    const Workspace workspace(root_, kType);
    const DepthNormal originals = workspace.ReadOriginalMaps(0, kType);
    RefinedMaps maps = MakeRefinedMaps(42.f);
    if (unchanged.depth) {
      maps.depth = originals.depth;
    }
    if (unchanged.normal) {
      maps.normal = originals.normal;
    }
    WriteRefined(workspace, 0, maps, Record());
  }
  MapPaths Paths() const { return GetMapPaths(root_, "a.png", kType); }

  // What a restoration has done of its work when it is killed.
  void PutBackDepth() const {
    std::filesystem::rename(Paths().original_depth.Path(),
                            Paths().depth.Path());
  }
  void PutBackNormal() const {
    std::filesystem::rename(Paths().original_normal.Path(),
                            Paths().normal.Path());
  }
  bool HasOriginals() const {
    return ReadText(Paths().depth) == original_depth_ &&
           ReadText(Paths().normal) == original_normal_;
  }
  void ExpectToFinish(int num_restored) const {
    const RestoreResult result = Restore(root_);
    EXPECT_EQ(result.num_restored, num_restored);
    EXPECT_TRUE(result.superseded.empty());
    EXPECT_TRUE(result.kept.empty());
    EXPECT_TRUE(result.conflicts.empty());
    EXPECT_TRUE(HasOriginals());
    EXPECT_FALSE(std::filesystem::exists(Paths().confidence.Path()));
    EXPECT_FALSE(std::filesystem::exists(root_ / "stereo/tsar"));
  }

  std::string original_depth_;
  std::string original_normal_;
};

TEST_F(InterruptedRestoreTest, FinishesAlsoWhereARefinedMapIsTheOriginal) {
  for (const Unchanged unchanged : {Unchanged{false, false},
                                    Unchanged{true, false},
                                    Unchanged{false, true},
                                    Unchanged{true, true}}) {
    SCOPED_TRACE(testing::Message()
                 << unchanged.depth << " and " << unchanged.normal);
    Begin(unchanged);
    ExpectToFinish(1);
    Begin(unchanged);
    PutBackNormal();
    ExpectToFinish(1);
    Begin(unchanged);
    PutBackDepth();
    ExpectToFinish(1);
    Begin(unchanged);
    PutBackNormal();
    PutBackDepth();
    ExpectToFinish(0);
  }
}

// A refinement may follow instead of the rest of the restoration.
TEST_F(InterruptedRestoreTest, LeavesOriginalsThatCanBeRefined) {
  Begin({.depth = false, .normal = true});
  PutBackNormal();
  const OriginalMaps originals = FindOriginals(Paths());
  EXPECT_EQ(originals.depth.state, OriginalState::kStored);
  EXPECT_EQ(originals.normal.state, OriginalState::kInPlace);
  Refine({.depth = false, .normal = false});
  EXPECT_EQ(ReadText(Paths().original_depth), original_depth_);
  EXPECT_EQ(ReadText(Paths().original_normal), original_normal_);
  ExpectToFinish(1);
}

// What is not the original by its bytes is none, whatever the other map is.
TEST_F(InterruptedRestoreTest, LeavesRefinedMapsWhoseOriginalIsGone) {
  Begin({.depth = false, .normal = true});
  const std::string refined = ReadText(Paths().depth);
  std::filesystem::remove(Paths().original_depth.Path());
  const RestoreResult result = Restore(root_);
  EXPECT_EQ(result.num_restored, 0);
  EXPECT_THAT(result.lost, testing::ElementsAre(Paths().depth.Path()));
  EXPECT_EQ(ReadText(Paths().depth), refined);
  EXPECT_TRUE(std::filesystem::exists(Paths().record.Path()));
  ExpectError(ErrorCode::kMismatch, {Paths().depth.string(), "is gone"}, [&] {
    FindOriginals(Paths());
  });
}

}  // namespace
}  // namespace tsar
