// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/folder.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/run/store/workspace_lock.h"

#include <csignal>
#include <utility>

#include "tests/support/test_workspace.h"
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tsar {
namespace {

class FolderTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(root_ / "stereo/maps");
    std::filesystem::create_directories(outside_);
    WriteText(outside_ / "precious", "precious");
  }
  ContainedPath Path(const std::string& relative) const {
    return {root_, relative};
  }
  void ExpectLeadsOut(const ContainedPath& folder,
                      const std::filesystem::path& link) {
    SCOPED_TRACE(folder.string());
    const std::vector<std::string> texts = {link.string(), "leads out"};
    const ContainedPath file = folder / "file";
    ExpectError(ErrorCode::kUnsupported, texts, [&] { Folder open(folder); });
    ExpectError(
        ErrorCode::kUnsupported, texts, [&] { Folder::OpenIfThere(folder); });
    ExpectError(ErrorCode::kUnsupported, texts, [&] { CreateFolders(folder); });
    ExpectError(ErrorCode::kUnsupported, texts, [&] { AtomicFile open(file); });
    ExpectError(ErrorCode::kUnsupported, texts, [&] { RemoveFile(file); });
    ExpectError(ErrorCode::kUnsupported, texts, [&] {
      LinkOrCopyFile(outside_ / "precious", file);
    });
    ExpectError(ErrorCode::kUnsupported, texts, [&] {
      RenameFile(file, Path("stereo/file"));
    });
    ExpectError(ErrorCode::kUnsupported, texts, [&] {
      RenameFile(Path("stereo/file"), file);
    });
    ExpectError(
        ErrorCode::kUnsupported, texts, [&] { RemoveTemporaries(folder); });
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
  const std::filesystem::path outside_ = folder_.Path() / "outside";
};

TEST_F(FolderTest, NoLinkLeadsOut) {
  WriteText(root_ / "stereo/file", "file");
  for (const auto& [link, folder] :
       {std::pair("stereo/link", "stereo/link"),
        std::pair("stereo/above", "stereo/above/maps/left"),
        std::pair("stereo/maps/left", "stereo/maps/left/deep")}) {
    for (const std::filesystem::path& target :
         {outside_, std::filesystem::path("../../outside")}) {
      std::filesystem::remove(root_ / link);
      std::filesystem::create_directory_symlink(
          std::filesystem::weakly_canonical(root_ / "stereo" / target),
          root_ / link);
      ExpectLeadsOut(Path(folder), root_ / link);
    }
  }
  EXPECT_EQ(ReadText(outside_ / "precious"), "precious");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(outside_),
                          std::filesystem::directory_iterator()),
            1);
  ExpectError(ErrorCode::kIo, {".."}, [&] { Folder(Path("stereo/../..")); });
}

TEST_F(FolderTest, LinksThatStayInsideAndThoseOfTheUserAreFollowed) {
  std::filesystem::create_directory_symlink(root_ / "stereo/maps",
                                            root_ / "stereo/link");
  std::filesystem::create_directory_symlink(root_, folder_.Path() / "alias");
  const ContainedPath path(folder_.Path() / "alias", "stereo/link/left/file");
  CreateFolders(path.Parent());
  AtomicFile file(path);
  file.Stream() << "text";
  file.Commit();
  EXPECT_EQ(ReadText(root_ / "stereo/maps/left/file"), "text");
}

// The folder is the one that was opened, whatever becomes of its name.
TEST_F(FolderTest, AFolderThatBecomesALinkIsNotFollowed) {
  AtomicFile file(Path("stereo/maps/file"));
  file.Stream() << "text";
  std::filesystem::rename(root_ / "stereo/maps", root_ / "stereo/moved");
  std::filesystem::create_directory_symlink(outside_, root_ / "stereo/maps");
  file.Commit();
  EXPECT_EQ(ReadText(root_ / "stereo/moved/file"), "text");
  EXPECT_FALSE(std::filesystem::exists(outside_ / "file"));
}

TEST_F(FolderTest, CreatesAlsoWhatTheUserNamed) {
  const ContainedPath path(folder_.Path() / "new/deep", "stereo/maps");
  CreateFolders(path);
  EXPECT_TRUE(std::filesystem::is_directory(path.Path()));
  WriteText(folder_.Path() / "file", "");
  ExpectError(ErrorCode::kIo, {"Not a directory"}, [&] {
    CreateFolders({folder_.Path() / "file", "stereo"});
  });
}

TEST_F(FolderTest, ListsATreeWithoutFollowingLinks) {
  WriteText(root_ / "stereo/maps/left/a", "");
  WriteText(root_ / "stereo/maps/b", "");
  WriteText(root_ / "stereo/maps/lost+found/c", "");
  std::filesystem::create_directory_symlink(outside_,
                                            root_ / "stereo/maps/link");
  std::vector<std::string> found;
  for (const TreeEntry& entry : ListTree(Path("stereo/maps"))) {
    found.push_back(entry.path.Relative().string() + (entry.is_folder ? "/"
                                                      : entry.is_link ? "@"
                                                                      : ""));
  }
  EXPECT_THAT(found,
              testing::ElementsAre("stereo/maps/b",
                                   "stereo/maps/left/",
                                   "stereo/maps/link@",
                                   "stereo/maps/left/a"));
  EXPECT_TRUE(ListTree(Path("stereo/none")).empty());
}

// Of more levels than there are descriptors.
TEST_F(FolderTest, WalksAndRemovesDeepTrees) {
  constexpr int kNumLevels = 200;
  std::filesystem::path deep = root_ / "stereo/maps";
  for (int i = 0; i < kNumLevels; ++i) {
    deep /= "x";
  }
  CreateFolders(ContainedPath(root_, deep.lexically_relative(root_)));
  std::filesystem::create_directory_symlink(outside_, deep / "link");
  WriteText(deep / "file.tsar_tmp", "half");
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 64;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &small), 0);
  EXPECT_EQ(ListTree(Path("stereo/maps")).size(),
            static_cast<size_t>(kNumLevels) + 2);
  ExpectError(ErrorCode::kUnsupported, {"link", "leads out"}, [&] {
    RequireFoldersInside(root_);
  });
  RemoveTemporaries(Path("stereo"));
  EXPECT_FALSE(std::filesystem::exists(deep / "file.tsar_tmp"));
  RemoveTree(Path("stereo/maps"));
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_FALSE(std::filesystem::exists(root_ / "stereo/maps"));
  EXPECT_EQ(ReadText(outside_ / "precious"), "precious");
}

TEST_F(FolderTest, WhatCannotBeListedIsAnError) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer needs descriptors of its own";
#endif
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const int next = dup(0);  // The lowest number that is free.
  close(next);
  for (int num_free = 0; num_free < 3; ++num_free) {
    rlimit small = before;
    small.rlim_cur = static_cast<rlim_t>(next + num_free);
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &small), 0);
    std::string message;
    try {
      ListTree(Path("stereo"));
    } catch (const Error& error) {
      message = error.what();
    }
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
    if (num_free < 2) {
      EXPECT_NE(message.find("Too many open files"), std::string::npos)
          << num_free << ": " << message;
    }
  }
}

TEST_F(FolderTest, WrittenFilesKeepPermissions) {
  const ContainedPath path = Path("stereo/maps/file");
  const auto mode_of = [&] {
    struct stat state = {};
    stat(path.string().c_str(), &state);
    return state.st_mode & 07777;
  };
  const mode_t mask = umask(022);
  const auto write = [&] {
    AtomicFile file(path);
    file.Stream() << "text";
    file.Commit();
  };
  write();
  EXPECT_EQ(mode_of(), 0644u);
  for (const mode_t mode : {0600, 0664, 0777, 0440}) {
    ASSERT_EQ(chmod(path.string().c_str(), mode), 0);
    write();
    EXPECT_EQ(mode_of(), mode);
    CopyFile(path, Path("stereo/maps/copy"));
    struct stat state = {};
    stat((root_ / "stereo/maps/copy").c_str(), &state);
    EXPECT_EQ(state.st_mode & 07777, mode);
  }
  umask(mask);
}

}  // namespace
}  // namespace tsar
