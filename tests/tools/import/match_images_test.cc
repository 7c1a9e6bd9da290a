// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/match_images.h"

#include "tests/support/external_writers.h"
#include "tests/support/test_workspace.h"
#include <sys/stat.h>

namespace tsar {
namespace {

class MatchImagesTest : public testing::Test {
 protected:
  MatchImagesTest() {
    for (const char* name : {"b.jpg", "sub/c.jpg", "a.jpg"}) {
      AddImage(name);
    }
    options_.input_path = folder_.Path() / "in";
    std::filesystem::create_directories(options_.input_path);
  }

  void AddImage(const char* name) {
    model_.images.emplace_back().name = name;
    model_.IndexNames();
  }

  void Write(const std::string& name, const std::string& text = "x") const {
    WriteText(options_.input_path / name, text);
  }

  void WriteDmap(const std::string& name, const std::string& stored) const {
    DmapContent content;
    content.image_name = stored;
    content.depth = Image<float>(2, 1, 1.f);
    Write(name, DmapBytes(content));
  }

  // "IMAGE: DEPTH NORMAL CAMERA" with the files' last two names.
  std::vector<std::string> Match() const {
    std::vector<std::string> lines;
    for (const ExternalFiles& files : MatchImages(options_, model_).files) {
      std::string line = model_.images[files.image].name + ":";
      for (const auto* path : {&files.depth, &files.normal, &files.camera}) {
        if (!path->empty()) {
          line += " " + path->parent_path().filename().string() + "/" +
                  path->filename().string();
        }
      }
      lines.push_back(line);
    }
    return lines;
  }

  void ExpectRefused(const std::vector<std::string>& texts,
                     ErrorCode code = ErrorCode::kMismatch) const {
    ExpectError(code, texts, [&] { Match(); });
  }

  TemporaryFolder folder_;
  SparseModel model_;
  MatchOptions options_;
};

TEST_F(MatchImagesTest, FindsNumberedFolders) {
  Write("ACMP/2333_00000000/depths.dmb");
  Write("ACMP/2333_00000002/depths.dmb");
  Write("ACMP/2333_00000002/depths_geom.dmb");
  Write("ACMP/2333_00000002/normals.dmb");
  // Files of Gipuma.
  Write("ACMP/2333__00000001/disp.dmb");
  Write("ACMP/empty_00000001/other.txt");
  Write("ACMP/ACMP_model.ply");
  Write("cams/00000002_cam.txt");
  Write("images/00000000.jpg");
  Write("pair.txt");
  EXPECT_THAT(
      Match(),
      testing::ElementsAre(
          "b.jpg: 2333_00000000/depths.dmb",
          "sub/c.jpg: 2333__00000001/disp.dmb",
          "a.jpg: 2333_00000002/depths_geom.dmb 2333_00000002/normals.dmb "
          "cams/00000002_cam.txt"));
  options_.type = MapType::kPhotometric;
  options_.input_path = options_.input_path / "ACMP" / "." / "";
  EXPECT_EQ(Match()[2],
            "a.jpg: 2333_00000002/depths.dmb cams/00000002_cam.txt");
}

TEST_F(MatchImagesTest, RefusesNumberedFoldersThatAreUnclear) {
  ExpectRefused({"in:", "2333_00000000"}, ErrorCode::kNotFound);
  Write("ACMM/2333_00000000/depths.dmb");
  Write("ACMP/2333_00000000/depths.dmb");
  ExpectRefused({"ACMM", "ACMP", "input_path"});
  std::filesystem::remove_all(options_.input_path / "ACMP");
  Write("ACMM/other_00000000/depths.dmb");
  ExpectRefused({"other_00000000", "b.jpg", "2333_00000000"});
  std::filesystem::remove_all(options_.input_path / "ACMM/other_00000000");
  Write("ACMM/2333_00000003/depths.dmb");
  ExpectRefused({"2333_00000003", "images 0 to 2", "image_list"});
}

TEST_F(MatchImagesTest, FindsOpenMvsMapsByStoredName) {
  options_.format = ExternalFormat::kOpenMvs;
  WriteDmap("depth0005.dmap", "C:\\work\\images\\sub\\c.jpg");
  WriteDmap("depth0006.dmap", "undistorted/b.png");
  WriteDmap("depth0007.dmap", "images/other.jpg");
  WriteDmap("depth0008.dmap", "a.jpg");
  Write("depth0008.geo.dmap", "not read");
  Write("scene.mvs");
  EXPECT_THAT(Match(),
              testing::ElementsAre("b.jpg: in/depth0006.dmap",
                                   "sub/c.jpg: in/depth0005.dmap",
                                   "a.jpg: in/depth0008.dmap"));
  EXPECT_EQ(MatchImages(options_, model_).num_without_image, 1);
  WriteDmap("depth0009.dmap", "again/a.jpg");
  ExpectRefused({"depth0009.dmap", "a.jpg", "depth0008.dmap"});
}

TEST_F(MatchImagesTest, TellsOpenMvsNamesThatFitNoneOrSeveral) {
  options_.format = ExternalFormat::kOpenMvs;
  WriteDmap("depth0001.dmap", "images/00001.jpg");
  ExpectRefused({"images/00001.jpg", "image_list"}, ErrorCode::kNotFound);
  options_.image_list = folder_.Path() / "list.txt";
  WriteText(options_.image_list, "b.jpg\na.jpg\n");
  EXPECT_THAT(Match(), testing::ElementsAre("a.jpg: in/depth0001.dmap"));
  options_.image_list.clear();
  AddImage("other/a.jpg");
  WriteDmap("depth0001.dmap", "a.png");
  ExpectRefused({"depth0001.dmap", "a.jpg", "other/a.jpg"});
}

TEST_F(MatchImagesTest, FindsDepthImagesByName) {
  options_.format = ExternalFormat::kDepth;
  options_.normal_path = folder_.Path() / "normals";
  Write("a.png");
  Write("sub/c.jpg.npy");
  Write("c.png");
  Write("sub/b.png");
  Write("b.jpg");
  WriteText(options_.normal_path / "a.exr", "x");
  ExpectRefused({options_.normal_path.string(), "c.jpg.npy"},
                ErrorCode::kNotFound);
  WriteText(options_.normal_path / "sub/c.exr", "x");
  EXPECT_THAT(Match(),
              testing::ElementsAre("sub/c.jpg: sub/c.jpg.npy sub/c.exr",
                                   "a.jpg: in/a.png normals/a.exr"));
  EXPECT_EQ(MatchImages(options_, model_).num_without_image, 2);
  Write("a.jpg.pfm");
  ExpectRefused({"a.png", "a.jpg", "a.jpg.pfm"});
  AddImage("a.bmp");
  options_.normal_path.clear();
  ExpectRefused({"a.png", "a.jpg", "a.bmp", "extension"});
  std::filesystem::remove(options_.input_path / "a.png");
  EXPECT_EQ(Match()[1], "a.jpg: in/a.jpg.pfm");
}

TEST_F(MatchImagesTest, FindsNumberedDepthImagesByList) {
  options_.format = ExternalFormat::kDepth;
  Write("frame_00.tif");
  Write("frame_01.tif");
  ExpectRefused({"such as b.png", "image_list"}, ErrorCode::kNotFound);
  options_.image_list = folder_.Path() / "list.txt";
  WriteText(options_.image_list, "sub/c.jpg\nb.jpg\n");
  EXPECT_THAT(Match(),
              testing::ElementsAre("b.jpg: in/frame_01.tif",
                                   "sub/c.jpg: in/frame_00.tif"));
  WriteText(options_.image_list, "b.jpg\nb.jpg\n");
  ExpectRefused({"list.txt: line 2 names b.jpg a second time"});
}

// Its image would count as one without a map.
TEST_F(MatchImagesTest, RefusesWhatHasTheNameOfAMapAndIsNoFile) {
  const auto expect_refused = [&](const std::filesystem::path& path) {
    const auto expect = [&](const std::string& what) {
      ExpectRefused({path.string(), what}, ErrorCode::kUnsupported);
      std::filesystem::remove(path);
    };
    std::filesystem::remove(path);
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    expect("it is a FIFO");
    std::filesystem::create_directory(path);
    expect("it is a folder");
    std::filesystem::create_symlink("/nowhere", path);
    expect("a link that leads nowhere");
    std::filesystem::create_symlink("/dev/null", path);
    expect("it is a device");
  };
  options_.format = ExternalFormat::kDepth;
  Write("a.npy");
  expect_refused(options_.input_path / "b.npy");
  // It belongs to no image of the model.
  std::filesystem::create_directory(options_.input_path / "d.npy");
  EXPECT_THAT(Match(), testing::ElementsAre("a.jpg: in/a.npy"));
  options_.format = ExternalFormat::kAcm;
  Write("ACMM/2333_00000000/depths.dmb");
  Write("ACMM/2333_00000001/depths.dmb");
  expect_refused(options_.input_path / "ACMM/2333_00000001/depths.dmb");
  expect_refused(options_.input_path / "ACMM/2333_00000000/normals.dmb");
}

}  // namespace
}  // namespace tsar
