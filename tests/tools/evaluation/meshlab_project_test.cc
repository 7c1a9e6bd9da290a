// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/meshlab_project.h"

#include "colmap_tsar/tools/evaluation/tolerances.h"

#include <limits>

#include "tests/support/test_files.h"

namespace tsar {
namespace {

TEST(Tolerances, AreReadFromAList) {
  EXPECT_EQ(ParseTolerances("0.02"), std::vector<double>{0.02});
  EXPECT_EQ(ParseTolerances("1e-3,0.5,2"),
            (std::vector<double>{0.001, 0.5, 2}));
}

TEST(Tolerances, ListsThatAreNoneAreErrors) {
  for (const char* text : {"",
                           "0.1,",
                           ",0.1",
                           "0.1 0.2",
                           "x",
                           "0.2,0.1",
                           "0.1,0.1",
                           "0",
                           "-1",
                           "nan",
                           "0.1,inf"}) {
    EXPECT_EQ(CodeOf([&] { ParseTolerances(text); }), ErrorCode::kBadOption)
        << text;
  }
  EXPECT_EQ(CodeOf([] { CheckTolerances({}); }), ErrorCode::kBadOption);
}

TEST(HarmonicMean, IsNearTheSmallerAndZeroWithoutAny) {
  EXPECT_DOUBLE_EQ(HarmonicMean(0.5, 0.5), 0.5);
  EXPECT_DOUBLE_EQ(HarmonicMean(1, 0.25), 0.4);
  EXPECT_EQ(HarmonicMean(1, 0), 0);
  EXPECT_EQ(HarmonicMean(0, 0), 0);
}

const char kMatrix[] = "0 -1 0 2.5\n1 0 0 -3\n0 0 1 1e-1\n0 0 0 1 ";

std::string Mesh(const std::string& attributes, const std::string& matrix) {
  return "<MLMesh " + attributes + "><MLMatrix44>\n" + matrix +
         "\n</MLMatrix44></MLMesh>";
}

std::string Project(const std::string& meshes) {
  return "<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n <MeshGroup>\n" +
         meshes + "\n </MeshGroup>\n <RasterGroup/>\n</MeshLabProject>\n";
}

class MeshlabProjectTest : public FolderTest {
 protected:
  std::vector<MeshlabScan> Read(const std::string& content) {
    return ReadMeshlabProject(Write("scans.mlp", content));
  }
};

TEST_F(MeshlabProjectTest, ReadsFilesAndPoses) {
  const auto scans = Read(Project(
      Mesh("label=\"a\" filename=\"a.ply\"", kMatrix) +
      Mesh("filename=\"/far/b.ply\"", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1")));
  ASSERT_EQ(scans.size(), 2u);
  EXPECT_EQ(scans[0].path, folder_ / "a.ply");
  Eigen::Matrix4d expected;
  expected << 0, -1, 0, 2.5, 1, 0, 0, -3, 0, 0, 1, 0.1, 0, 0, 0, 1;
  EXPECT_EQ(scans[0].world_from_scan, expected);
  EXPECT_EQ(scans[1].path, "/far/b.ply");
  EXPECT_TRUE(scans[1].world_from_scan.isIdentity(0));
}

TEST_F(MeshlabProjectTest, RefusesWhatIsNoProjectOfScans) {
  EXPECT_EQ(CodeOf([&] { ReadMeshlabProject(folder_ / "none.mlp"); }),
            ErrorCode::kNotFound);
  const std::string ply = "filename=\"a.ply\"";
  std::string deep;  // The parser is recursive.
  for (int i = 0; i < 1000000; ++i) {
    deep += "<a>";
  }
  const std::pair<std::string, ErrorCode> cases[] = {
      {"", ErrorCode::kCorrupt},
      {"ply\n", ErrorCode::kCorrupt},
      {"<MeshLabProject><MeshGroup>", ErrorCode::kCorrupt},
      {"<Other/>", ErrorCode::kCorrupt},
      {deep, ErrorCode::kCorrupt},
      {Project(""), ErrorCode::kCorrupt},
      {Project(Mesh("label=\"a\"", kMatrix)), ErrorCode::kCorrupt},
      {Project(Mesh("filename=\"\"", kMatrix)), ErrorCode::kCorrupt},
      {Project("<MLMesh " + ply + "/>"), ErrorCode::kCorrupt},
      {Project(Mesh(ply, "1 0 0 0 0 1 0 0")), ErrorCode::kCorrupt},
      {Project(Mesh(ply, "one two")), ErrorCode::kCorrupt},
      // Matrices that are not rigid motions.
      {Project(Mesh(ply, "2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1")),
       ErrorCode::kUnsupported},
      {Project(Mesh(ply, "-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1")),
       ErrorCode::kUnsupported},
      {Project(Mesh(ply, "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2")),
       ErrorCode::kUnsupported}};
  for (const auto& [content, code] : cases) {
    EXPECT_EQ(CodeOf([&] { Read(content); }), code) << content.substr(0, 500);
  }
}

}  // namespace
}  // namespace tsar
