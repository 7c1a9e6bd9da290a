// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/atomic_file.h"

#include "colmap_tsar/base/folder.h"

#include <chrono>
#include <csignal>
#include <functional>
#include <new>
#include <vector>

#include "tests/support/test_workspace.h"
#include <sys/resource.h>
#include <unistd.h>

namespace tsar {
namespace {

size_t NumEntries(const std::filesystem::path& folder) {
  const std::filesystem::directory_iterator entries(folder);
  return static_cast<size_t>(std::distance(begin(entries), end(entries)));
}

TEST(AtomicFileTest, ShowsTheOldContentUntilTheCommit) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "file";
  WriteText(path, "old");
  AtomicFile file(UserPath(path));
  file.Stream() << "new";
  EXPECT_EQ(ReadText(path), "old");
  file.Prepare();
  EXPECT_EQ(ReadText(path), "old");
  file.Commit();
  EXPECT_EQ(ReadText(path), "new");
  EXPECT_EQ(NumEntries(folder.Path()), 1u);
}

TEST(AtomicFileTest, LeavesNothingBehindWithoutCommit) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "file";
  {
    AtomicFile file(UserPath(path));
    file.Stream() << "new";
    file.Prepare();
  }
  EXPECT_EQ(NumEntries(folder.Path()), 0u);
}

TEST(AtomicFileTest, WritesMoreThanItsBuffer) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "file";
  std::string text;
  AtomicFile file(UserPath(path));
  for (int i = 0; i < 300; ++i) {
    const std::string piece(static_cast<size_t>(i * 13 % 1000),
                            static_cast<char>('a' + i % 26));
    file.Stream() << piece;
    text += piece;
  }
  const std::string large(200000, 'x');
  file.Stream() << large << "end";
  file.Commit();
  EXPECT_EQ(ReadText(path), text + large + "end");
}

// The data of an empty vector: the sanitizers see a null pointer copied from.
TEST(AtomicFileTest, WritesNothingFromNowhere) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "file";
  AtomicFile file(UserPath(path));
  file.Stream() << "a";
  file.Stream().write(nullptr, 0);
  file.Stream() << "b";
  file.Commit();
  EXPECT_EQ(ReadText(path), "ab");
}

// A killed program may have left its temporary, even as a link.
TEST(AtomicFileTest, TakesThePlaceOfALeftTemporary) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "file";
  const auto victim = folder.Path() / "victim";
  WriteText(victim, "untouched");
  std::filesystem::create_symlink(victim,
                                  path.string() + AtomicFile::kTemporarySuffix);
  AtomicFile file(UserPath(path));
  file.Stream() << "new";
  file.Commit();
  EXPECT_EQ(ReadText(path), "new");
  EXPECT_EQ(ReadText(victim), "untouched");
  EXPECT_EQ(NumEntries(folder.Path()), 2u);
}

TEST(AtomicFileTest, NamesTheFileWhereTheFolderIsNone) {
  const TemporaryFolder folder;
  WriteText(folder.Path() / "file", "");
  const auto path = folder.Path() / "file" / "below";
  ExpectError(ErrorCode::kIo,
              {path.parent_path().string() + ": the folder", "Not a directory"},
              [&] { AtomicFile file(UserPath(path)); });
  ExpectError(ErrorCode::kIo, {path.string(), "Not a directory"}, [&] {
    CreateFolders(UserPath(path));
  });
}

TEST(AtomicFileTest, NamesTheFileWhereTheFolderIsReadOnly) {
  if (geteuid() == 0) {
    GTEST_SKIP() << "the superuser may write everywhere";
  }
  const TemporaryFolder folder;
  std::filesystem::permissions(
      folder.Path(),
      std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const auto path = folder.Path() / "file";
  ExpectError(ErrorCode::kIo, {path.string(), "Permission denied"}, [&] {
    AtomicFile file(UserPath(path));
  });
  std::filesystem::permissions(folder.Path(),
                               std::filesystem::perms::owner_all);
}

TEST(AtomicFileTest, KeepsTheOldFileWhereARenameFails) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "taken";
  AtomicFile file(UserPath(path));
  WriteText(path / "inside", "");
  ExpectError(ErrorCode::kIo,
              {path.string(), "directory", "move the folder of this name"},
              [&] { file.Commit(); });
  EXPECT_EQ(NumEntries(folder.Path()), 1u);
}

// A folder is told of before the content is computed, and stays.
TEST(AtomicFileTest, RefusesTheNameOfAFolder) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "taken";
  WriteText(path / "inside", "");
  WriteText(folder.Path() / "source", "one");
  const std::vector<std::function<void()>> attempts = {
      [&] { AtomicFile file(UserPath(path)); },
      [&] { LinkOrCopyFile(folder.Path() / "source", UserPath(path)); },
      [&] { CopyFile(folder.Path() / "source", UserPath(path)); },
      [&] { RemoveFile(UserPath(path)); }};
  for (const std::function<void()>& attempt : attempts) {
    ExpectError(ErrorCode::kIo,
                {path.string(), "directory", "move the folder of this name"},
                attempt);
    EXPECT_TRUE(std::filesystem::exists(path / "inside"));
    EXPECT_EQ(NumEntries(folder.Path()), 2u);
  }
}

TEST(AtomicFileTest, NamesTheFolderUnderItsTemporaryName) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "file";
  const auto taken = folder.Path() / "file.tsar_tmp";
  WriteText(taken / "inside", "");
  WriteText(folder.Path() / "source", "one");
  const std::vector<std::function<void()>> attempts = {
      [&] { AtomicFile file(UserPath(path)); },
      [&] { LinkOrCopyFile(folder.Path() / "source", UserPath(path)); },
      [&] { CopyFile(folder.Path() / "source", UserPath(path)); }};
  for (const std::function<void()>& attempt : attempts) {
    ExpectError(ErrorCode::kIo,
                {taken.string(), "directory", "move the folder of this name"},
                attempt);
    EXPECT_TRUE(std::filesystem::exists(taken / "inside"));
    EXPECT_EQ(NumEntries(folder.Path()), 2u);
  }
}

// A limit on the size of files fails in the same place as a full disk.
TEST(AtomicFileTest, KeepsTheOldFileWhereWritingFails) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "file";
  WriteText(path, "old");
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 100000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  ExpectError(ErrorCode::kIo, {path.string(), "File too large"}, [&] {
    AtomicFile file(UserPath(path));
    file.Stream() << std::string(200000, 'x') << "more";
    file.Commit();
  });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(ReadText(path), "old");
  EXPECT_EQ(NumEntries(folder.Path()), 1u);
}

// All that the stream tells of memory that it lacked.
TEST(AtomicFileTest, AStreamThatLacksMemoryIsNoFullDisk) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "file";
  WriteText(path, "old");
  {
    AtomicFile file(UserPath(path));
    file.Stream() << "new";
    file.Stream().setstate(std::ios::badbit);
    EXPECT_THROW(file.Commit(), std::bad_alloc);
  }
  EXPECT_EQ(ReadText(path), "old");
  EXPECT_EQ(NumEntries(folder.Path()), 1u);
}

TEST(LinkOrCopyFileTest, GivesTheSameContentAndReplaces) {
  const TemporaryFolder folder;
  const auto source = folder.Path() / "source";
  const auto target = folder.Path() / "new" / "target";
  WriteText(source, "one");
  LinkOrCopyFile(source, UserPath(target));
  EXPECT_EQ(ReadText(target), "one");
  // Once more onto itself, which rename() alone would leave half done.
  LinkOrCopyFile(source, UserPath(target));
  EXPECT_EQ(NumEntries(target.parent_path()), 1u);
  WriteText(source, "two");
  EXPECT_EQ(ReadText(target), "one");
  LinkOrCopyFile(source, UserPath(target));
  EXPECT_EQ(ReadText(target), "two");
}

TEST(LinkOrCopyFileTest, LinksTheFileBehindASymbolicLink) {
  const TemporaryFolder folder;
  WriteText(folder.Path() / "source", "one");
  std::filesystem::create_symlink("source", folder.Path() / "link");
  const auto target = folder.Path() / "new" / "target";
  LinkOrCopyFile(folder.Path() / "link", UserPath(target));
  EXPECT_FALSE(std::filesystem::is_symlink(target));
  EXPECT_EQ(ReadText(target), "one");
}

TEST(CopyFileTest, CopiesAlsoEmptyFiles) {
  const TemporaryFolder folder;
  for (const std::string& text : {std::string(), std::string(70000, 'x')}) {
    WriteText(folder.Path() / "source", text);
    CopyFile(folder.Path() / "source", UserPath(folder.Path() / "target"));
    EXPECT_EQ(ReadText(folder.Path() / "target"), text);
  }
  const auto missing = folder.Path() / "missing";
  ExpectError(ErrorCode::kIo, {missing.string()}, [&] {
    CopyFile(missing, UserPath(folder.Path() / "target"));
  });
}

// The system finds nothing at the first address of the memory of a process.
TEST(CopyFileTest, ADiskThatFailsIsNotTheEndOfTheFile) {
  const TemporaryFolder folder;
  const auto target = folder.Path() / "target";
  WriteText(target, "old");
  ExpectError(ErrorCode::kIo, {"/proc/self/mem: cannot be read"}, [&] {
    CopyFile("/proc/self/mem", UserPath(target));
  });
  EXPECT_EQ(ReadText(target), "old");
  EXPECT_EQ(NumEntries(folder.Path()), 1u);
}

TEST(CopyFileTest, KeepsTheTimeWhereItIsToldTo) {
  const TemporaryFolder folder;
  const std::filesystem::path source = folder.Path() / "source";
  WriteText(source, "content");
  const auto time =
      std::filesystem::last_write_time(source) - std::chrono::hours(5);
  std::filesystem::last_write_time(source, time);
  CopyFile(source, UserPath(folder.Path() / "same"), true);
  EXPECT_EQ(std::filesystem::last_write_time(folder.Path() / "same"), time);
  EXPECT_EQ(ReadText(folder.Path() / "same"), "content");
  CopyFile(source, UserPath(folder.Path() / "newer"));
  EXPECT_NE(std::filesystem::last_write_time(folder.Path() / "newer"), time);
}

TEST(RenameFileTest, RemovesTheOldNameAlsoBetweenLinks) {
  const TemporaryFolder folder;
  WriteText(folder.Path() / "a", "text");
  std::filesystem::create_hard_link(folder.Path() / "a", folder.Path() / "b");
  RenameFile(UserPath(folder.Path() / "a"), UserPath(folder.Path() / "b"));
  EXPECT_EQ(NumEntries(folder.Path()), 1u);
  EXPECT_EQ(ReadText(folder.Path() / "b"), "text");
}

TEST(AtomicFileTest, RemovesTemporariesAndNothingElse) {
  const TemporaryFolder folder;
  const std::filesystem::path root = folder.Path() / "maps";
  RemoveTemporaries(UserPath(root));  // No such folder.
  const std::filesystem::path kept = root / "left.tsar_tmp" / "b.bin";
  WriteText(kept, "map");
  WriteText(root / "left.tsar_tmp" / "b.bin.tsar_tmp", "half");
  WriteText(root / "a.bin.tsar_tmp", "half");
  WriteText(folder.Path() / "precious", "precious");
  std::filesystem::create_symlink(folder.Path() / "precious",
                                  root / "c.bin.tsar_tmp");
  std::filesystem::create_symlink(root / "d.bin.tsar_tmp",
                                  root / "d.bin.tsar_tmp");
  RemoveTemporaries(UserPath(root));
  EXPECT_EQ(ReadText(kept), "map");
  EXPECT_EQ(NumEntries(kept.parent_path()), 1u);
  EXPECT_EQ(NumEntries(root), 1u);
  EXPECT_EQ(ReadText(folder.Path() / "precious"), "precious");
}

}  // namespace
}  // namespace tsar
