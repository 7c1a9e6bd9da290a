// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/workspace_model.h"

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

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
  void ExpectMissing(const std::filesystem::path& folder,
                     std::vector<std::string> texts) const {
    texts.push_back(folder.string() + ": ");
    ExpectError(ErrorCode::kNotFound, texts, [&] { FindModelFolder(root_); });
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
  const std::filesystem::path sparse_ = root_ / "sparse";
};

TEST_F(WorkspaceModelTest, IsFoundInTheFolder0) {
  WriteModel(sparse_ / "0", "nested.png");
  EXPECT_EQ(FindModelFolder(root_), sparse_ / "0");
  EXPECT_EQ(ImageName(), "nested.png");
}

TEST_F(WorkspaceModelTest, TheOneInSparseItselfWins) {
  WriteModel(sparse_ / "0", "nested.png");
  WriteModel(sparse_, "own.png");
  EXPECT_EQ(FindModelFolder(root_), sparse_);
  EXPECT_EQ(ImageName(), "own.png");
}

TEST_F(WorkspaceModelTest, NamesThePlacesWhereNeitherHasOne) {
  ExpectMissing(sparse_, {"no sparse model", "folder 0", "image_undistorter"});
  // Neither other numbers nor other files are models.
  WriteModel(sparse_ / "1", "other.png");
  WriteText(sparse_ / "0/points3D.ply", "ply\n");
  WriteText(sparse_ / "rigs.bin", "");
  ExpectMissing(sparse_, {"no sparse model"});
  std::filesystem::remove_all(sparse_ / "0");
  WriteText(sparse_ / "0", "a file");
  ExpectMissing(sparse_, {"no sparse model"});
}

TEST_F(WorkspaceModelTest, NamesTheFilesThatAModelLacks) {
  WriteModel(sparse_ / "0", "nested.png");
  std::filesystem::remove(sparse_ / "0/points3D.txt");
  ExpectMissing(sparse_ / "0", {"points3D.txt is missing"});
  // Of two incomplete ones, those of the one that lacks less.
  WriteText(sparse_ / "0/cameras.bin", "");
  ExpectMissing(sparse_ / "0", {"points3D.txt is missing"});
}

TEST_F(WorkspaceModelTest, AnIncompleteOneInSparseDoesNotGiveWay) {
  WriteModel(sparse_ / "0", "nested.png");
  WriteText(sparse_ / "cameras.bin", "");
  ExpectMissing(sparse_,
                {"not complete: images.bin, points3D.bin are missing"});
}

TEST_F(WorkspaceModelTest, NamesTheFolderOfNamesThatLeadOut) {
  WriteModel(sparse_ / "0", "../a.png");
  ExpectError(ErrorCode::kUnsupported,
              {(sparse_ / "0").string() + ": ", "../a.png leads out"},
              [&] { ImageName(); });
}

TEST_F(WorkspaceModelTest, NamesTheFileOfDistortedCameras) {
  WriteModel(sparse_ / "0", "a.png");
  WriteText(sparse_ / "0/cameras.txt", "1 OPENCV 8 6 10 10 4 3 0 0 0 0\n");
  ExpectError(ErrorCode::kUnsupported,
              {(sparse_ / "0/cameras.txt").string() + ": ", "OPENCV"},
              [&] { ImageName(); });
}

}  // namespace
}  // namespace tsar
