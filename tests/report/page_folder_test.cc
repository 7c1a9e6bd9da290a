// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/page_folder.h"

#include "colmap_tsar/base/error.h"

#include <filesystem>

#include "tests/workspace/test_workspace.h"

namespace tsar {
namespace {

namespace fs = std::filesystem;

class PageFolderTest : public testing::Test {
 protected:
  void WritePageWith(const std::string& text, bool overwrite = false) const {
    PageFolder folder(path_, overwrite);
    WriteText(folder.Temporary() / kPageDataFile, text);
    folder.Commit();
  }
  size_t NumEntries() const {
    return static_cast<size_t>(
        std::distance(fs::directory_iterator(parent_.Path()), {}));
  }

  TemporaryFolder parent_;
  const fs::path path_ = parent_.Path() / "report";
};

TEST_F(PageFolderTest, AppearsAsAWhole) {
  {
    PageFolder folder(path_, false);
    WriteText(folder.Temporary() / kPageDataFile, "new");
    EXPECT_FALSE(fs::exists(path_));
    folder.Commit();
  }
  EXPECT_EQ(ReadText(path_ / kPageDataFile), "new");
  EXPECT_EQ(NumEntries(), 1u);
}

TEST_F(PageFolderTest, LeavesNothingWithoutCommit) {
  { PageFolder folder(path_, false); }
  EXPECT_EQ(NumEntries(), 0u);
}

TEST_F(PageFolderTest, ReplacesAPageOnlyWhenAsked) {
  WritePageWith("old");
  ExpectError(ErrorCode::kUnsupported, {"report", "--overwrite 1"}, [&] {
    PageFolder(path_, false);
  });
  {
    PageFolder folder(path_, true);
    EXPECT_EQ(ReadText(path_ / kPageDataFile), "old");
  }
  EXPECT_EQ(ReadText(path_ / kPageDataFile), "old");
  WriteText(path_ / "images" / "of_the_old_page.png", "");
  WritePageWith("new", true);
  EXPECT_EQ(ReadText(path_ / kPageDataFile), "new");
  EXPECT_FALSE(fs::exists(path_ / "images"));
  EXPECT_EQ(NumEntries(), 1u);
}

TEST_F(PageFolderTest, NeverTouchesAnythingElse) {
  WriteText(path_ / "thesis.tex", "years of work");
  for (const bool overwrite : {false, true}) {
    ExpectError(ErrorCode::kUnsupported, {"--report_path"}, [&] {
      PageFolder(path_, overwrite);
    });
  }
  EXPECT_EQ(ReadText(path_ / "thesis.tex"), "years of work");
  WriteText(path_ / kPageDataFile, "old");
  ExpectError(ErrorCode::kUnsupported, {"report", "beside", "move them"}, [&] {
    PageFolder(path_, true);
  });
  EXPECT_EQ(ReadText(path_ / "thesis.tex"), "years of work");
  const fs::path file = parent_.Path() / "file";
  WriteText(file, "");
  ExpectError(
      ErrorCode::kUnsupported, {"file"}, [&] { PageFolder(file, true); });
}

TEST_F(PageFolderTest, TakesAnEmptyFolderAndASeparatorAtTheEnd) {
  fs::create_directories(path_);
  PageFolder folder(path_ / "", false);
  WriteText(folder.Temporary() / kPageDataFile, "new");
  folder.Commit();
  EXPECT_EQ(ReadText(path_ / kPageDataFile), "new");
}

TEST_F(PageFolderTest, ForgetsWhatAKilledProgramLeft) {
  WriteText(path_.string() + ".tsar_tmp/half.png", "");
  WritePageWith("new");
  EXPECT_FALSE(fs::exists(path_ / "half.png"));
}

}  // namespace
}  // namespace tsar
