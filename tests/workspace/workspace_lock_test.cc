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

TEST(WorkspaceLockTest, WritersRefuseFoldersThatAreLinksOut) {
  const TemporaryFolder folder;
  const auto root = folder.Path() / "dense";
  const auto link = root / "stereo/depth_maps/left";
  std::filesystem::create_directories(folder.Path() / "dense_2/left");
  std::filesystem::create_directories(root / "stereo/depth_maps");
  std::filesystem::create_directory_symlink(folder.Path() / "dense_2/left",
                                            link);
  ExpectError(ErrorCode::kUnsupported, {link.string(), "dense_2"}, [&] {
    WorkspaceLock lock(root);
  });
  EXPECT_FALSE(std::filesystem::exists(root / "stereo/tsar"));
  { const WorkspaceLock lock(root, WorkspaceLock::Mode::kShared); }
  // Links that stay inside, and those to files, are nobody else's.
  std::filesystem::remove(link);
  std::filesystem::create_directories(root / "stereo/elsewhere");
  std::filesystem::create_directory_symlink(root / "stereo/elsewhere", link);
  WriteText(folder.Path() / "map", "");
  std::filesystem::create_symlink(folder.Path() / "map",
                                  root / "stereo/depth_maps/a.bin");
  const WorkspaceLock lock(root);
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
