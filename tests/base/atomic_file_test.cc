// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/atomic_file.h"

#include "colmap_tsar/base/folder.h"

#include <chrono>
#include <csignal>
#include <functional>
#include <vector>

#include "tests/support/test_workspace.h"
#include <sys/resource.h>

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
  {
    AtomicFile file(UserPath(path));
    file.Stream() << "dropped";
    file.Prepare();
  }
  EXPECT_EQ(NumEntries(folder.Path()), 1u);
  AtomicFile file(UserPath(path));
  // More than one buffer holds, in pieces; then the data of an empty vector.
  std::string text;
  for (int i = 0; i < 300; ++i) {
    text += std::string(static_cast<size_t>(i * 13 % 1000),
                        static_cast<char>('a' + i % 26));
    file.Stream() << text.substr(text.size() - i * 13 % 1000);
  }
  file.Stream().write(nullptr, 0);
  const std::string large(200000, 'x');
  file.Stream() << large << "end";
  file.Stream().seekp(0);
  file.Stream() << "begin";
  text = "begin" + (text + large + "end").substr(5);
  file.Prepare();
  EXPECT_EQ(ReadText(path), "old");
  file.Commit();
  EXPECT_EQ(ReadText(path), text);
  EXPECT_EQ(NumEntries(folder.Path()), 1u);
}

// A killed program may have left its temporary file; it may even be a link.
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

// The mark of this program's temporary files is removed from complete files.
TEST(AtomicFileTest, AUsersFileOfTheTemporarysNameStays) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "file";
  const auto temporary = folder.Path() / "file.tsar_tmp";
  const auto perms = [](const std::filesystem::path& of) {
    return std::filesystem::status(of).permissions();
  };
  WriteText(temporary, "mine");
  ExpectError(ErrorCode::kUnsupported,
              {temporary.string(), "move it away"},
              [&] { AtomicFile file(UserPath(path)); });
  EXPECT_EQ(ReadText(temporary), "mine");
  EXPECT_EQ(NumEntries(folder.Path()), 1u);
  // Left behind by a killed program.
  std::filesystem::remove(temporary);
  WriteText(path, "old");
  AtomicFile file(UserPath(path));
  file.Stream() << "new";
  file.Prepare();
  std::filesystem::copy_file(temporary, folder.Path() / "killed.tsar_tmp");
  EXPECT_NE(perms(temporary) & std::filesystem::perms::sticky_bit,
            std::filesystem::perms::none);
  std::filesystem::permissions(folder.Path() / "killed.tsar_tmp",
                               perms(temporary));
  file.Commit();
  EXPECT_EQ(perms(path) & std::filesystem::perms::sticky_bit,
            std::filesystem::perms::none);
  AtomicFile again(UserPath(folder.Path() / "killed"));
  again.Commit();
  EXPECT_EQ(NumEntries(folder.Path()), 2u);
}

// Not even if the first is complete and the second has just begun.
TEST(AtomicFileTest, RefusesAFileThatAnotherProgramWrites) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "file";
  AtomicFile first(UserPath(path));
  first.Stream() << "first";
  const auto refuses = [&] {
    ExpectError(ErrorCode::kUnsupported,
                {path.string(), "another program is writing"},
                [&] { AtomicFile second(UserPath(path)); });
  };
  refuses();
  first.Prepare();
  refuses();
  first.Commit();
  EXPECT_EQ(ReadText(path), "first");
  AtomicFile third(UserPath(path));
  EXPECT_EQ(NumEntries(folder.Path()), 2u);
}

TEST(AtomicFileTest, NamesTheFileWhereTheFolderIsNone) {
  const TemporaryFolder folder;
  WriteText(folder.Path() / "file", "");
  const auto path = folder.Path() / "file" / "below";
  ExpectError(ErrorCode::kIo, {path.string(), "Not a directory"}, [&] {
    AtomicFile file(UserPath(path));
  });
  ExpectError(ErrorCode::kIo, {path.string(), "Not a directory"}, [&] {
    CreateFolders(UserPath(path));
  });
}

// A folder with the file's name, or its temporary name, is reported before the
// content is computed, and stays.
TEST(AtomicFileTest, RefusesTheNameOfAFolder) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "file";
  WriteText(folder.Path() / "source", "one");
  const std::vector<std::function<void()>> attempts = {
      [&] { AtomicFile file(UserPath(path)); },
      [&] { LinkOrCopyFile(folder.Path() / "source", UserPath(path)); },
      [&] { CopyFile(folder.Path() / "source", UserPath(path)); }};
  for (const char* name : {"file", "file.tsar_tmp"}) {
    const auto taken = folder.Path() / name;
    WriteText(taken / "inside", "");
    for (const std::function<void()>& attempt : attempts) {
      ExpectError(ErrorCode::kIo,
                  {taken.string(), "directory", "move the folder of this name"},
                  attempt);
      EXPECT_TRUE(std::filesystem::exists(taken / "inside"));
      EXPECT_EQ(NumEntries(folder.Path()), 2u);
    }
    std::filesystem::remove_all(taken);
  }
  // A folder that was created meanwhile.
  AtomicFile file(UserPath(path));
  WriteText(path / "inside", "");
  ExpectError(
      ErrorCode::kIo, {path.string(), "directory"}, [&] { file.Commit(); });
  ExpectError(
      ErrorCode::kIo, {path.string()}, [&] { RemoveFile(UserPath(path)); });
  EXPECT_TRUE(std::filesystem::exists(path / "inside"));
}

// A limit on file sizes fails in the same place as a full disk.
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

TEST(LinkOrCopyFileTest, GivesTheSameContentAndReplaces) {
  const TemporaryFolder folder;
  const auto source = folder.Path() / "source";
  const auto target = folder.Path() / "new" / "target";
  WriteText(source, "one");
  std::filesystem::create_symlink("source", folder.Path() / "link");
  LinkOrCopyFile(folder.Path() / "link", UserPath(target));
  EXPECT_FALSE(std::filesystem::is_symlink(target));
  EXPECT_EQ(ReadText(target), "one");
  // Again onto itself, which rename() alone would leave half done.
  LinkOrCopyFile(source, UserPath(target));
  EXPECT_EQ(NumEntries(target.parent_path()), 1u);
  WriteText(source, "two");
  EXPECT_EQ(ReadText(target), "one");
  LinkOrCopyFile(source, UserPath(target));
  EXPECT_EQ(ReadText(target), "two");
}

TEST(CopyFileTest, KeepsTheTimeWhereItIsToldTo) {
  const TemporaryFolder folder;
  const auto source = folder.Path() / "source";
  const auto target = folder.Path() / "target";
  for (const std::string& text : {std::string(), std::string(70000, 'x')}) {
    WriteText(source, text);
    const auto time =
        std::filesystem::last_write_time(source) - std::chrono::hours(5);
    std::filesystem::last_write_time(source, time);
    CopyFile(source, UserPath(target), true);
    EXPECT_EQ(std::filesystem::last_write_time(target), time);
    EXPECT_EQ(ReadText(target), text);
    CopyFile(source, UserPath(target));
    EXPECT_NE(std::filesystem::last_write_time(target), time);
  }
}

TEST(RenameFileTest, RemovesTheOldNameAlsoBetweenLinks) {
  const TemporaryFolder folder;
  WriteText(folder.Path() / "a", "text");
  std::filesystem::create_hard_link(folder.Path() / "a", folder.Path() / "b");
  RenameFile(UserPath(folder.Path() / "a"), UserPath(folder.Path() / "b"));
  EXPECT_EQ(NumEntries(folder.Path()), 1u);
  EXPECT_EQ(ReadText(folder.Path() / "b"), "text");
  // Two paths of one file, through a link to a folder: the file would be lost.
  std::filesystem::create_directory_symlink(".", folder.Path() / "same");
  ExpectError(ErrorCode::kUnsupported, {"is the same file as"}, [&] {
    RenameFile({folder.Path(), "same/b"}, {folder.Path(), "b"});
  });
  EXPECT_EQ(ReadText(folder.Path() / "b"), "text");
}

}  // namespace
}  // namespace tsar
