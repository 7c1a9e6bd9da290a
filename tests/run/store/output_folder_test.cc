// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/output_folder.h"

#include "colmap_tsar/base/error.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

namespace fs = std::filesystem;

constexpr OutputFolderKind kReport = {"report",
                                      "a report",
                                      "tsar_report",
                                      "report_path",
                                      "data/report.js",
                                      "data/files.txt",
                                      "unfinished_page"};

class OutputFolderTest : public testing::Test {
 protected:
  void WritePageWith(const std::string& text, bool overwrite = false) const {
    OutputFolder folder(kReport, path_, overwrite);
    WriteText(folder.Temporary() / kReport.known_file, text);
    folder.Commit();
  }
  // Expects an error with these texts, and every file as it was.
  template <typename Function>
  void ExpectUntouched(const std::vector<std::string>& texts,
                       Function function) const {
    const auto before = ReadTree(parent_.Path());
    ExpectError(ErrorCode::kUnsupported, texts, function);
    EXPECT_TRUE(ReadTree(parent_.Path()) == before);
  }
  size_t NumEntries() const {
    return static_cast<size_t>(
        std::distance(fs::directory_iterator(parent_.Path()), {}));
  }

  TemporaryFolder parent_;
  const fs::path path_ = parent_.Path() / "report";
};

TEST_F(OutputFolderTest, AppearsAsAWholeWithTheListOfItsFiles) {
  for (const bool is_there : {false, true}) {
    fs::remove_all(path_);
    if (is_there) {
      fs::create_directories(path_);
    }
    {
      OutputFolder folder(kReport, path_ / "", false);
      WriteText(folder.Temporary() / kReport.known_file, "new");
      WriteText(folder.Temporary() / "images/a/b.png", "");
      EXPECT_FALSE(fs::exists(path_ / kReport.known_file));
      folder.Commit();
    }
    EXPECT_EQ(ReadText(path_ / kReport.known_file), "new");
    EXPECT_EQ(ReadText(path_ / kReport.list_file),
              "data/report.js\nimages/a/b.png\ndata/files.txt\n");
    EXPECT_EQ(NumEntries(), 1u);
  }
}

TEST_F(OutputFolderTest, LeavesNothingWithoutCommit) {
  { OutputFolder folder(kReport, path_, false); }
  EXPECT_EQ(NumEntries(), 0u);
}

TEST_F(OutputFolderTest, ReplacesAFolderOnlyWhenAsked) {
  WritePageWith("old");
  ExpectError(ErrorCode::kUnsupported, {"report", "overwrite 1"}, [&] {
    OutputFolder(kReport, path_, false);
  });
  {
    OutputFolder folder(kReport, path_, true);
    EXPECT_EQ(ReadText(path_ / kReport.known_file), "old");
  }
  EXPECT_EQ(ReadText(path_ / kReport.known_file), "old");
  {
    OutputFolder folder(kReport, path_, true);
    WriteText(folder.Temporary() / kReport.known_file, "old");
    WriteText(folder.Temporary() / "images/of_the_old_page.png", "");
    folder.Commit();
  }
  WritePageWith("new", true);
  EXPECT_EQ(ReadText(path_ / kReport.known_file), "new");
  EXPECT_FALSE(fs::exists(path_ / "images"));
  EXPECT_FALSE(fs::exists(path_ / kReport.unfinished_file));
  EXPECT_EQ(NumEntries(), 1u);
}

TEST_F(OutputFolderTest, NeverTouchesAnythingElse) {
  WriteText(path_ / "thesis.tex", "years of work");
  for (const bool overwrite : {false, true}) {
    ExpectUntouched({"report", "report_path"},
                    [&] { OutputFolder(kReport, path_, overwrite); });
  }
  const fs::path file = parent_.Path() / "file";
  WriteText(file, "");
  ExpectUntouched({"file"}, [&] { OutputFolder(kReport, file, true); });
}

TEST_F(OutputFolderTest, NeverTouchesWhatIsBesideOrBelowIt) {
  const auto write_page = [&] {
    fs::remove_all(path_);
    OutputFolder folder(kReport, path_, false);
    WriteText(folder.Temporary() / kReport.known_file, "old");
    WriteText(folder.Temporary() / "images/0/photo.jpg", "");
    folder.Commit();
  };
  for (const char* name : {"thesis.tex",
                           "data/thesis.tex",
                           "images/thesis.tex",
                           "images/mine/thesis.tex",
                           "data/report.js.orig"}) {
    write_page();
    WriteText(path_ / name, "years of work");
    ExpectUntouched({name, "not of the report", "move it", "report_path"},
                    [&] { OutputFolder(kReport, path_, true); });
  }
}

TEST_F(OutputFolderTest, NeverTouchesWhatCameMeanwhile) {
  WritePageWith("old");
  OutputFolder folder(kReport, path_, true);
  WriteText(folder.Temporary() / kReport.known_file, "new");
  WriteText(path_ / "data/thesis.tex", "years of work");
  ExpectError(
      ErrorCode::kUnsupported, {"data/thesis.tex"}, [&] { folder.Commit(); });
  EXPECT_EQ(ReadText(path_ / kReport.known_file), "old");
  EXPECT_EQ(ReadText(path_ / "data/thesis.tex"), "years of work");
}

TEST_F(OutputFolderTest, ReplacesNoneWithoutItsWholeList) {
  WritePageWith("old");
  const std::string list = ReadText(path_ / kReport.list_file);
  fs::remove(path_ / kReport.list_file);
  const std::vector<std::string> texts = {
      "report", kReport.list_file, "move or delete it", "report_path"};
  ExpectUntouched(texts, [&] { OutputFolder(kReport, path_, true); });
  for (const std::string& part :
       {std::string(), list.substr(0, list.size() / 2), std::string("/a\n")}) {
    WriteText(path_ / kReport.list_file, part);
    ExpectUntouched(texts, [&] { OutputFolder(kReport, path_, true); });
  }
  // A list may name files that do not exist.
  WriteText(path_ / kReport.list_file, "/etc/passwd\n../../a\n" + list);
  WritePageWith("new", true);
  EXPECT_EQ(ReadText(path_ / kReport.known_file), "new");
}

TEST_F(OutputFolderTest, FollowsNoLinks) {
  const fs::path mine = parent_.Path() / "mine";
  const fs::path link = parent_.Path() / "link";
  WritePageWith("old");
  fs::create_directories(mine);
  fs::create_directory_symlink(mine, link);
  ExpectUntouched({"link", "is a link"},
                  [&] { OutputFolder(kReport, link, true); });
  // A link in the place of the page, and in that of one of its folders.
  fs::remove(link);
  fs::create_directory_symlink(path_, link);
  ExpectUntouched({"link", "is a link"},
                  [&] { OutputFolder(kReport, link, true); });
  fs::remove(mine);
  fs::rename(path_ / "data", mine);
  fs::create_directory_symlink(mine, path_ / "data");
  ExpectUntouched({"report/data"}, [&] { OutputFolder(kReport, path_, true); });
  fs::remove(path_ / "data");
  fs::rename(mine, path_ / "data");
  // Even under the name of one of its files.
  fs::rename(path_ / kReport.known_file, mine);
  fs::create_symlink(mine, path_ / kReport.known_file);
  ExpectUntouched({kReport.known_file},
                  [&] { OutputFolder(kReport, path_, true); });
}

TEST_F(OutputFolderTest, NeverTouchesOthersFoldersBesideIt) {
  WritePageWith("old");
  const fs::path temporary = path_.string() + ".tsar_tmp";
  WriteText(temporary / "thesis.tex", "years of work");
  ExpectUntouched({"report.tsar_tmp",
                   "no unfinished report",
                   "give another folder than " + path_.string() + " as ",
                   "or move it away"},
                  [&] { OutputFolder(kReport, path_, true); });
  fs::remove_all(temporary);
  WriteText(temporary, "years of work");
  ExpectUntouched({"report.tsar_tmp"},
                  [&] { OutputFolder(kReport, path_, true); });
  fs::remove(temporary);
  // Not even one that holds the marker, where it is a link.
  WriteText(parent_.Path() / "mine" / kReport.unfinished_file, "");
  fs::create_directory_symlink(parent_.Path() / "mine", temporary);
  ExpectUntouched({"report.tsar_tmp"},
                  [&] { OutputFolder(kReport, path_, true); });
}

TEST_F(OutputFolderTest, IsWrittenByOneProgramAtATime) {
  const OutputFolder first(kReport, path_, false);
  ExpectUntouched({"another tsar_report", "wait"},
                  [&] { OutputFolder(kReport, path_, false); });
}

// As soon as a folder is complete, the next one may be begun.
TEST_F(OutputFolderTest, RemovesNoFolderOfAnotherProgram) {
  std::optional<OutputFolder> first(std::in_place, kReport, path_, false);
  WriteText(first->Temporary() / kReport.known_file, "first");
  first->Commit();
  OutputFolder second(kReport, path_, true);
  WriteText(second.Temporary() / kReport.known_file, "second");
  first.reset();
  second.Commit();
  EXPECT_EQ(ReadText(path_ / kReport.known_file), "second");
  // Only the program that replaced the former folder removes it.
  ExpectError(ErrorCode::kUnsupported, {"another tsar_report"}, [&] {
    OutputFolder(kReport, path_, true);
  });
}

}  // namespace
}  // namespace tsar
