// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/image_lists.h"
#include "colmap_tsar/io/sparse_model.h"

#include <utility>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

class ImageListTest : public testing::Test {
 protected:
  ImageListTest() {
    for (const char* name : {"a.png", "left/b c.png", "\xC3\xA9.png"}) {
      model_.images.emplace_back();
      model_.images.back().name = name;
    }
    model_.IndexNames();
  }
  std::vector<std::pair<int, int>> Read(const std::string& text) const {
    WriteText(path_, text);
    std::vector<std::pair<int, int>> images;
    for (const ListedImage& listed :
         ReadImageList(path_, model_, "--image_list_path")) {
      images.emplace_back(listed.image, listed.line);
    }
    return images;
  }
  void ExpectRefused(const std::string& text,
                     ErrorCode code,
                     const std::string& message) const {
    ExpectError(code, {path_.string() + ": " + message}, [&] { Read(text); });
  }

  TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.Path() / "list.txt";
  SparseModel model_;
};

using testing::ElementsAre;
using testing::Pair;

// With blanks, empty lines, and other systems' line ends and byte order marks.
TEST_F(ImageListTest, ReadsNamesInTheirOrder) {
  EXPECT_THAT(Read("left/b c.png\n\n  a.png \na.png"),
              ElementsAre(Pair(1, 1), Pair(0, 3), Pair(0, 4)));
  model_.without_pose = {"lost.png"};
  EXPECT_THAT(Read("lost.png\na.png"), ElementsAre(Pair(0, 2)));
  EXPECT_THAT(Read("\xEF\xBB\xBF"
                   "\xC3\xA9.png\r\nleft/b c.png\r\n"),
              ElementsAre(Pair(2, 1), Pair(1, 2)));
}

TEST_F(ImageListTest, NamesTheLineThatIsWrong) {
  constexpr ErrorCode kMismatch = ErrorCode::kMismatch;
  constexpr ErrorCode kCorrupt = ErrorCode::kCorrupt;
  ExpectRefused("a.png\r\n\r\nb.png\r\n",
                kMismatch,
                "line 3 names b.png, which is not in the sparse model");
  ExpectRefused("left/b",
                kMismatch,
                "line 1 names left/b, which is not in the sparse model; it has "
                "\"left/b c.png\", with text behind the name");
  // Not a comment: a name may begin with this.
  ExpectRefused("# a.png\n", kMismatch, "line 1 names # a.png");
  for (const char* text : {"", "\n \r\n\t\n", "\xEF\xBB\xBF"}) {
    ExpectRefused(text, kMismatch, "the list names no image");
  }
  ExpectRefused(std::string("a.png\n\x89PNG\x00\x01", 12),
                kCorrupt,
                "line 2 is no image name; give a text file");
  ExpectRefused(std::string(100000, 'x'), kCorrupt, "line 1 is no image name");
  ExpectError(ErrorCode::kNotFound,
              {folder_.Path().string(), "check --image_list_path"},
              [&] {
                ReadImageList(
                    folder_.Path() / "none", model_, "--image_list_path");
              });
  ExpectError(ErrorCode::kIo, {folder_.Path().string(), "folder"}, [&] {
    ReadImageList(folder_.Path(), model_, "--image_list_path");
  });
}

class WorkspaceModelTest : public testing::Test {
 protected:
  // A model whose one image has this name.
  static void WriteModel(const std::filesystem::path& folder,
                         const std::string& image) {
    WriteText(folder / "cameras.txt", "1 PINHOLE 8 6 10 10 4 3\n");
    WriteText(folder / "images.txt", "1 1 0 0 0 0 0 0 1 " + image + "\n\n");
    WriteText(folder / "points3D.txt", "");
  }
  std::string ImageName() const {
    return ReadWorkspaceModel(FindModelFolder(root_)).images.at(0).name;
  }
  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
  const std::filesystem::path sparse_ = root_ / "sparse";
};

TEST_F(WorkspaceModelTest, LiesInSparseOrInTheFolder0) {
  ExpectError(ErrorCode::kNotFound,
              {sparse_.string() + ": no sparse model", "folder 0"},
              [&] { FindModelFolder(root_); });
  WriteModel(sparse_ / "0", "nested.png");
  EXPECT_EQ(FindModelFolder(root_), sparse_ / "0");
  EXPECT_EQ(ImageName(), "nested.png");
  // An incomplete model is not replaced by one that may be different.
  WriteText(sparse_ / "cameras.bin", "");
  ExpectError(ErrorCode::kNotFound,
              {sparse_.string() + ": the sparse model is not complete"},
              [&] { ImageName(); });
  WriteModel(sparse_, "own.png");
  EXPECT_EQ(ImageName(), "own.png");
}

TEST_F(WorkspaceModelTest, NamesTheFolderOfNamesThatLeadOut) {
  WriteModel(sparse_ / "0", "../a.png");
  ExpectError(ErrorCode::kUnsupported,
              {(sparse_ / "0").string() + ": ", "../a.png leads out"},
              [&] { ImageName(); });
}

}  // namespace
}  // namespace tsar
