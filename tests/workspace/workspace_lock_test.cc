// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/workspace_lock.h"

#include <thread>
#include <vector>

#include "tests/workspace/test_workspace.h"

namespace tsar {
namespace {

TEST(WorkspaceLockTest, RefusesASecondHolderUntilTheFirstIsGone) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.Path() / "stereo");
  const auto path = folder.Path() / "stereo/tsar/lock";
  {
    const WorkspaceLock lock(folder.Path());
    EXPECT_TRUE(std::filesystem::exists(path));
    for (int i = 0; i < 2; ++i) {
      ExpectError(ErrorCode::kUnsupported, {path.string()}, [&] {
        WorkspaceLock second(folder.Path());
      });
    }
    EXPECT_TRUE(std::filesystem::exists(path));
  }
  EXPECT_FALSE(std::filesystem::exists(folder.Path() / "stereo/tsar"));
  const WorkspaceLock again(folder.Path());
}

TEST(WorkspaceLockTest, ReadersShareItWithoutWriters) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.Path() / "stereo");
  const auto path = folder.Path() / "stereo/tsar/lock";
  {
    const WorkspaceLock first(folder.Path(), WorkspaceLock::Mode::kShared);
    { const WorkspaceLock second(folder.Path(), WorkspaceLock::Mode::kShared); }
    EXPECT_TRUE(std::filesystem::exists(path));
    ExpectError(ErrorCode::kUnsupported, {path.string()}, [&] {
      WorkspaceLock writer(folder.Path());
    });
  }
  EXPECT_FALSE(std::filesystem::exists(folder.Path() / "stereo/tsar"));
  const WorkspaceLock writer(folder.Path());
  ExpectError(ErrorCode::kUnsupported, {path.string()}, [&] {
    WorkspaceLock reader(folder.Path(), WorkspaceLock::Mode::kShared);
  });
}

TEST(WorkspaceLockTest, ReadersComeAndGoSideBySide) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.Path() / "stereo");
  {
    std::vector<std::jthread> readers;
    for (int i = 0; i < 4; ++i) {
      readers.emplace_back([&] {
        for (int j = 0; j < 300; ++j) {
          EXPECT_NO_THROW(
              WorkspaceLock(folder.Path(), WorkspaceLock::Mode::kShared));
        }
      });
    }
  }
  EXPECT_FALSE(std::filesystem::exists(folder.Path() / "stereo/tsar"));
  const WorkspaceLock writer(folder.Path());
}

TEST(WorkspaceLockTest, ReadersNeedNoPermissionToWrite) {
  const TemporaryFolder folder;
  WriteText(folder.Path() / "stereo/tsar", "a file");
  const WorkspaceLock reader(folder.Path(), WorkspaceLock::Mode::kShared);
  EXPECT_EQ(ReadText(folder.Path() / "stereo/tsar"), "a file");
}

TEST(WorkspaceLockTest, TakesOverAFileThatAKilledProgramLeft) {
  const TemporaryFolder folder;
  WriteText(folder.Path() / "stereo/tsar/lock", "");
  WriteText(folder.Path() / "stereo/tsar/manifest.json", "{}");
  { const WorkspaceLock lock(folder.Path()); }
  EXPECT_TRUE(
      std::filesystem::exists(folder.Path() / "stereo/tsar/manifest.json"));
}

TEST(WorkspaceLockTest, NeedsAWorkspace) {
  const TemporaryFolder folder;
  ExpectError(ErrorCode::kNotFound, {(folder.Path() / "stereo").string()}, [&] {
    WorkspaceLock lock(folder.Path());
  });
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path()));
  WriteText(folder.Path() / "stereo/tsar", "a file");
  ExpectError(ErrorCode::kIo, {(folder.Path() / "stereo/tsar").string()}, [&] {
    WorkspaceLock lock(folder.Path());
  });
}

}  // namespace
}  // namespace tsar
