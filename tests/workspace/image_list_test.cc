// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/image_list.h"

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

TEST_F(ImageListTest, ReadsNamesInTheirOrder) {
  EXPECT_THAT(Read("left/b c.png\n\n  a.png \n"),
              ElementsAre(Pair(1, 1), Pair(0, 3)));
  EXPECT_THAT(Read("\xC3\xA9.png"), ElementsAre(Pair(2, 1)));
}

TEST_F(ImageListTest, ReadsWhatEditorsOfOtherSystemsWrite) {
  EXPECT_THAT(Read("\xEF\xBB\xBF"
                   "a.png\r\nleft/b c.png\r\n"),
              ElementsAre(Pair(0, 1), Pair(1, 2)));
}

TEST_F(ImageListTest, KeepsWhatIsThereTwice) {
  EXPECT_THAT(Read("a.png\na.png\n"), ElementsAre(Pair(0, 1), Pair(0, 2)));
}

TEST_F(ImageListTest, NamesTheLineOfAnUnknownName) {
  ExpectRefused("a.png\r\n\r\nb.png\r\n",
                ErrorCode::kMismatch,
                "line 3 names b.png, which is not in the sparse model");
  // Not a comment: names may begin so.
  ExpectRefused("# a.png\n", ErrorCode::kMismatch, "line 1 names # a.png");
  ExpectRefused("A.png\n", ErrorCode::kMismatch, "line 1 names A.png");
}

TEST_F(ImageListTest, RefusesListsOfNothing) {
  for (const char* text : {"", "\n \r\n\t\n", "\xEF\xBB\xBF"}) {
    ExpectRefused(text, ErrorCode::kMismatch, "the list names no image");
  }
}

TEST_F(ImageListTest, RefusesFilesThatAreNoText) {
  ExpectRefused(std::string("a.png\n\x89PNG\x00\x01", 12),
                ErrorCode::kCorrupt,
                "line 2 is no image name; give a text file");
  ExpectRefused(std::string(100000, 'x'),
                ErrorCode::kCorrupt,
                "line 1 is no image name; give a text file");
}

TEST_F(ImageListTest, NamesTheOptionWhereThereIsNoFile) {
  for (const std::filesystem::path& path : {path_, folder_.Path()}) {
    ExpectError(ErrorCode::kNotFound,
                {path.string(), "check --image_list_path"},
                [&] { ReadImageList(path, model_, "--image_list_path"); });
  }
}

}  // namespace
}  // namespace tsar
