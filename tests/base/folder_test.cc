// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/folder.h"

#include "colmap_tsar/base/atomic_file.h"

#include <utility>

#include "tests/support/test_workspace.h"
#include <sys/stat.h>

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
    ExpectError(ErrorCode::kUnsupported, texts, [&] { ListFolder(folder); });
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
  for (const std::string& path :
       {std::string("stereo/../.."), outside_.string()}) {
    ExpectError(ErrorCode::kUnsupported, {"leads out"}, [&] {
      AtomicFile(Path(path) / "file");
    });
  }
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

TEST_F(FolderTest, CreatesAlsoWhatTheUserNamed) {
  const ContainedPath path(folder_.Path() / "new/deep", "stereo/maps");
  CreateFolders(path);
  EXPECT_TRUE(std::filesystem::is_directory(path.Path()));
}

TEST_F(FolderTest, ListsATreeWithoutFollowingLinks) {
  WriteText(root_ / "stereo/maps/left/a", "");
  WriteText(root_ / "stereo/maps/b", "");
  WriteText(root_ / "stereo/maps/lost+found/c", "");
  std::filesystem::create_directory_symlink(outside_,
                                            root_ / "stereo/maps/link");
  std::vector<std::string> found;
  for (const FolderEntry& entry : ListTree(Path("stereo/maps"))) {
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

TEST_F(FolderTest, RemovesWhatIsInsideAlone) {
  WriteText(root_ / "stereo/maps/left/file", "");
  std::filesystem::create_directory_symlink(outside_,
                                            root_ / "stereo/maps/left/link");
  RemoveTree(Path("stereo/maps"));
  EXPECT_FALSE(std::filesystem::exists(root_ / "stereo/maps"));
  EXPECT_EQ(ReadText(outside_ / "precious"), "precious");
}

// Its content would appear to be missing.
TEST_F(FolderTest, WhatCannotBeListedIsAnError) {
  WriteText(root_ / "stereo/file", "");
  ExpectError(ErrorCode::kIo, {"stereo/file", "Not a directory"}, [&] {
    ListTree(Path("stereo/file"));
  });
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
