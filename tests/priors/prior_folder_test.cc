// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/prior_folder.h"

#include "colmap_tsar/priors/depth_prior.h"

#include <string>
#include <vector>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

namespace fs = std::filesystem;

class PriorFolderTest : public testing::Test {
 protected:
  void Write(const std::vector<std::string>& files) const {
    for (const std::string& file : files) {
      fs::create_directories((root_ / file).parent_path());
      WriteText(root_ / file, "");
    }
  }
  PriorFolder Find(const std::vector<std::string>& names) const {
    return PriorFolder(root_, PriorType::kMetric, names);
  }
  static std::string WarningOf(const PriorFolder& folder) {
    testing::internal::CaptureStderr();
    folder.WarnOfStrayFiles();
    return testing::internal::GetCapturedStderr();
  }
  void ExpectFiles(const PriorFiles& files,
                   const std::string& depth,
                   const std::string& normals) const {
    EXPECT_EQ(files.depth, depth.empty() ? fs::path() : root_ / depth);
    EXPECT_EQ(files.normals, normals.empty() ? fs::path() : root_ / normals);
  }

  TemporaryFolder folder_;
  const fs::path root_ = folder_.Path() / "priors";
};

TEST_F(PriorFolderTest, FindsFilesByTheNamesOfImages) {
  Write({"a.jpg.npy",
         "a.normal.EXR",
         "left/b c.tiff",
         "left/b c.png.normal.png",
         "c.pfm",
         "d.JPG.normal.tif"});
  const PriorFolder priors =
      Find({"a.jpg", "left/b c.png", "c.JPG", "d.JPG", "left/a.jpg", "e"});
  ExpectFiles(priors.FilesOf(0), "a.jpg.npy", "a.normal.EXR");
  ExpectFiles(priors.FilesOf(1), "left/b c.tiff", "left/b c.png.normal.png");
  ExpectFiles(priors.FilesOf(2), "c.pfm", "");
  ExpectFiles(priors.FilesOf(3), "", "d.JPG.normal.tif");
  for (const int without : {4, 5}) {
    EXPECT_FALSE(priors.HasPrior(without));
    ExpectFiles(priors.FilesOf(without), "", "");
  }
  EXPECT_TRUE(priors.HasPrior(3));
  EXPECT_EQ(priors.Type(), PriorType::kMetric);
  EXPECT_EQ(priors.Count({0, 3, 4}), 2);
  EXPECT_EQ(WarningOf(priors), "");
}

TEST_F(PriorFolderTest, WithoutAFolderNoImageHasAPrior) {
  const PriorFolder none;
  EXPECT_FALSE(none.HasPrior(3));
  EXPECT_EQ(none.Count({0, 1}), std::nullopt);
  EXPECT_EQ(WarningOf(none), "");
}

TEST_F(PriorFolderTest, RefusesTwoFilesOfOneKind) {
  for (const auto& [first, second] :
       {std::pair("a.jpg.npy", "a.npy"),
        std::pair("a.exr", "a.npy"),
        std::pair("a.NPY", "a.npy"),
        std::pair("a.jpg.normal.png", "a.normal.png")}) {
    fs::remove_all(root_);
    Write({first, second});
    ExpectError(ErrorCode::kMismatch,
                {(root_ / first).string(),
                 (root_ / second).string(),
                 "of the image a.jpg",
                 "take one of the two away"},
                [&] { Find({"a.jpg"}); });
  }
}

TEST_F(PriorFolderTest, RefusesFilesThatMayBeOfTwoImages) {
  Write({"a.npy"});
  ExpectError(
      ErrorCode::kMismatch,
      {(root_ / "a.npy").string() + ": may be of the image a.jpg or of a.png",
       "put the image's extension"},
      [&] {
        Find({"a.jpg", "a.png"});
      });
  fs::remove_all(root_);
  Write({"a.normal.npy"});
  ExpectError(ErrorCode::kMismatch, {"a.normal.png", "a.jpg"}, [&] {
    Find({"a.jpg", "a.normal.png"});
  });
  fs::remove_all(root_);
  Write({"a.jpg.npy", "a.png.npy", "a.jpg.normal.npy"});
  const PriorFolder priors = Find({"a.jpg", "a.png", "a.normal.png"});
  ExpectFiles(priors.FilesOf(0), "a.jpg.npy", "a.jpg.normal.npy");
  ExpectFiles(priors.FilesOf(1), "a.png.npy", "");
}

TEST_F(PriorFolderTest, RefusesFoldersWithoutAny) {
  ExpectError(ErrorCode::kNotFound,
              {root_.string() + ": there is no such folder", "prior_path"},
              [&] { Find({"a.jpg"}); });
  WriteText(root_, "");
  ExpectError(
      ErrorCode::kNotFound, {"no such folder"}, [&] { Find({"a.jpg"}); });
  fs::remove(root_);
  Write({"b.npy", "a.jpg", "a.txt", "sub/a.npy"});
  ExpectError(ErrorCode::kNotFound,
              {root_.string() + ": holds no depth prior of any image",
               "left/a.jpg would be left/a.jpg.npy or left/a.npy",
               "left/a.jpg.normal.npy or left/a.normal.npy",
               "prior_path"},
              [&] {
                Find({"left/a.jpg", "c.png"});
              });
  ExpectError(ErrorCode::kNotFound, {"of any image; check"}, [&] { Find({}); });
}

TEST_F(PriorFolderTest, WarnsOfFilesOfNoImage) {
  Write({"a.npy", "z.npy", "left/a.png", "notes.txt"});
  fs::create_directories(root_ / "folder.png");
  EXPECT_THAT(WarningOf(Find({"a.jpg"})),
              testing::HasSubstr(root_.string() +
                                 ": 2 files belong to no image, such as " +
                                 (root_ / "left/a.png").string()));
  EXPECT_THAT(WarningOf(Find({"a.jpg", "left/a.jpg"})),
              testing::HasSubstr(": 1 file belongs to no image, such as " +
                                 (root_ / "z.npy").string()));
}

}  // namespace
}  // namespace tsar
