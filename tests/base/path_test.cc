// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/path.h"

#include "tests/support/test_workspace.h"
#include <unistd.h>

namespace tsar {
namespace {

namespace fs = std::filesystem;

TEST(Path, TellsWhatIsThere) {
  const TemporaryFolder folder;
  const fs::path file = folder.Path() / "file";
  WriteText(file, "text");
  fs::create_symlink("file", folder.Path() / "link");
  fs::create_symlink("nowhere", folder.Path() / "dangling");
  for (const char* name : {"file", "link"}) {
    EXPECT_TRUE(Exists(folder.Path() / name)) << name;
    EXPECT_TRUE(IsFile(folder.Path() / name)) << name;
  }
  EXPECT_TRUE(Exists(folder.Path()));
  EXPECT_FALSE(IsFile(folder.Path()));
  for (const std::string& name : {std::string("missing"),
                                  std::string("dangling"),
                                  std::string("missing/too"),
                                  std::string("file/in"),
                                  std::string(300, 'x')}) {
    EXPECT_FALSE(Exists(folder.Path() / name)) << name;
    EXPECT_FALSE(IsFile(folder.Path() / name)) << name;
    EXPECT_EQ(fs::exists(SymlinkStatus(folder.Path() / name)),
              name == "dangling");
  }
}

// A loop of links has no answer, not even for the superuser.
TEST(Path, WhatHasNoAnswerIsNotMissing) {
  const TemporaryFolder folder;
  const fs::path loop = folder.Path() / "loop";
  fs::create_symlink("loop", loop);
  for (const fs::path& path : {loop, loop / "in"}) {
    ExpectError(ErrorCode::kIo, {path.string()}, [&] { Exists(path); });
    ExpectError(ErrorCode::kIo, {path.string()}, [&] { IsFile(path); });
  }
}

TEST(Path, WhatMayNotBeLookedAtIsNotMissing) {
  if (geteuid() == 0) {
    GTEST_SKIP() << "the superuser may look into every folder";
  }
  const TemporaryFolder folder;
  const fs::path closed = folder.Path() / "closed";
  fs::create_directory(closed);
  WriteText(closed / "file", "text");
  fs::permissions(closed, fs::perms::none);
  ExpectError(ErrorCode::kIo, {(closed / "file").string(), "denied"}, [&] {
    Exists(closed / "file");
  });
  fs::permissions(closed, fs::perms::owner_all);
}

TEST(Path, IsWithinAFolderByNamesAlone) {
  EXPECT_TRUE(IsWithin("/a/b", "/a/b"));
  EXPECT_TRUE(IsWithin("/a/b/c", "/a/b"));
  EXPECT_FALSE(IsWithin("/a/bc", "/a/b"));
  EXPECT_FALSE(IsWithin("/a", "/a/b"));
}

}  // namespace
}  // namespace tsar
