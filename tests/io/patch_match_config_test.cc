// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/image_lists.h"
#include "colmap_tsar/io/source_selector.h"

#include <cmath>
#include <numbers>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Cameras at the given x that look along z; no points yet.
SparseModel MakeModel(const std::vector<double>& positions) {
  SparseModel model;
  for (size_t i = 0; i < positions.size(); ++i) {
    SparseModel::ModelImage image;
    image.name = "v";
    image.name += std::to_string(i);
    image.name += ".jpg";
    image.camera.translation = Eigen::Vector3d(-positions[i], 0, 0);
    model.images.push_back(image);
  }
  model.IndexNames();
  return model;
}

void AddPoint(const Eigen::Vector3d& position,
              const std::vector<size_t>& images,
              SparseModel* model) {
  for (const size_t image : images) {
    model->images[image].point_indices.push_back(
        static_cast<int>(model->points.size()));
  }
  model->points.push_back(position);
}

class PatchMatchConfigTest : public testing::Test {
 protected:
  std::vector<StereoProblem> Read(const std::string& text) {
    WriteText(path_, text);
    return ReadPatchMatchConfig(path_, model_);
  }
  void ExpectRefused(ErrorCode code,
                     const std::string& text,
                     const std::string& message) {
    SCOPED_TRACE(text);
    ExpectError(code, {path_.string(), message}, [&] { Read(text); });
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / "patch-match.cfg";
  SparseModel model_ = MakeModel({0, 1, 2, 3});
};

TEST_F(PatchMatchConfigTest, ReadsAllThreeForms) {
  AddPoint({0, 0, 5}, {1, 3}, &model_);
  const std::vector<StereoProblem> problems = Read(
      "# comment\n\n  v2.jpg  \r\n__all__\r\n# another\nv1.jpg\n"
      "__auto__, 20\n\t\nv0.jpg\nv3.jpg,v1.jpg ; v2.jpg");
  ASSERT_EQ(problems.size(), 3u);
  EXPECT_EQ(problems[0].reference, 2);
  EXPECT_THAT(problems[0].sources, ElementsAre(0, 1, 3));
  EXPECT_EQ(problems[1].reference, 1);
  EXPECT_THAT(problems[1].sources, ElementsAre(3));
  EXPECT_EQ(problems[2].reference, 0);
  EXPECT_THAT(problems[2].sources, ElementsAre(3, 1, 2));
}

TEST_F(PatchMatchConfigTest, KeepsReferencesWithoutOverlap) {
  const std::vector<StereoProblem> problems = Read("v0.jpg\n__auto__, 5\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0].sources, IsEmpty());
  EXPECT_EQ(problems[0].without_sources,
            "no other image shares enough of its sparse points");
}

TEST_F(PatchMatchConfigTest, ImagesWithoutPoseAreNotThere) {
  model_.without_pose = {"lost.jpg"};
  const std::vector<StereoProblem> problems =
      Read("lost.jpg\n__all__\nv1.jpg\nlost.jpg, v3.jpg\nv2.jpg\nlost.jpg\n");
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(problems[0].reference, 1);
  EXPECT_THAT(problems[0].sources, ElementsAre(3));
  EXPECT_EQ(problems[1].reference, 2);
  EXPECT_THAT(problems[1].sources, IsEmpty());
}

TEST_F(PatchMatchConfigTest, CopiesOfAViewAreNoSources) {
  model_ = MakeModel({0, 0, 0, 1});
  AddPoint({0, 0, 5}, {0, 1, 2, 3}, &model_);
  const std::vector<StereoProblem> problems = Read(
      "v0.jpg\n__all__\nv1.jpg\nv0.jpg, v2.jpg\nv3.jpg\nv2.jpg, v1.jpg\n"
      "v2.jpg\n__auto__, 20\n");
  EXPECT_THAT(problems[0].sources, ElementsAre(3));
  EXPECT_EQ(problems[0].without_sources, "");
  EXPECT_THAT(problems[1].sources, IsEmpty());
  EXPECT_THAT(problems[1].without_sources,
              testing::HasSubstr("from nearly the same place"));
  EXPECT_THAT(problems[2].sources, ElementsAre(2));
  EXPECT_THAT(problems[3].sources, ElementsAre(3));
}

TEST_F(PatchMatchConfigTest, NamesTheLineThatIsWrong) {
  constexpr ErrorCode kMismatch = ErrorCode::kMismatch;
  constexpr ErrorCode kCorrupt = ErrorCode::kCorrupt;
  ExpectError(ErrorCode::kNotFound, {path_.string()}, [&] {
    ReadPatchMatchConfig(path_, model_);
  });
  EXPECT_THAT(Read("# nothing\n"), IsEmpty());
  ExpectRefused(
      kMismatch, "# comment\nabsent.jpg\n__all__\n", "line 2 names absent.jpg");
  ExpectRefused(
      kMismatch, "v0.jpg\n\nv1.jpg, absent.jpg\n", "line 3 names absent.jpg");
  ExpectRefused(kCorrupt, "v0.jpg\n__all__\nv1.jpg\n# end\n", "line 3");
  ExpectRefused(kCorrupt, "v0.jpg\n__all__\nv0.jpg\n__all__\n", "line 3");
  ExpectRefused(kCorrupt, "v0.jpg\nv1.jpg, v0.jpg\n", "line 2");
  ExpectRefused(kCorrupt, "v0.jpg\nv1.jpg, v1.jpg\n", "line 2");
  ExpectRefused(kCorrupt, "v0.jpg\n,;\n", "line 2");
  for (const char* number : {"", "0", "-3", "3x", "3, 4", "99999999999"}) {
    ExpectRefused(kCorrupt,
                  std::string("v0.jpg\n__auto__, ") + number + "\n",
                  "line 2 must have the form");
  }
}

TEST(SourceSelectorTest, OrdersByTheNumberOfSharedPoints) {
  SparseModel model = MakeModel({0, 1, 2, 3, 4});
  const Eigen::Vector3d point(0, 0, 5);
  AddPoint(point, {0, 1, 2, 4}, &model);
  AddPoint(point, {0, 2}, &model);
  AddPoint(point, {0, 2, 4}, &model);
  AddPoint(point, {3, 1}, &model);
  const SourceSelector selector(model, 1.0);
  EXPECT_THAT(selector.SelectSources(0, 20), ElementsAre(2, 4, 1));
  EXPECT_THAT(selector.SelectSources(0, 2), ElementsAre(2, 4));
  EXPECT_THAT(selector.SelectSources(3, 20), ElementsAre(1));
  // Equal counts go by index; repeated observations count.
  model = MakeModel({0, 1, 2, 3});
  AddPoint(point, {3, 1, 0, 2}, &model);
  EXPECT_THAT(SourceSelector(model, 1.0).SelectSources(1, 20),
              ElementsAre(0, 2, 3));
  AddPoint(point, {1, 3, 3}, &model);
  EXPECT_THAT(SourceSelector(model, 1.0).SelectSources(1, 20),
              ElementsAre(3, 0, 2));
}

// At depth z on the axis, the triangulation angle from x is atan(x / z).
TEST(SourceSelectorTest, ComparesTheAngleWithTheMinimum) {
  const double tan1 = std::tan(std::numbers::pi / 180.0);
  SparseModel model = MakeModel({0, 0.999 * tan1, 1.001 * tan1});
  AddPoint({0, 0, 1}, {0, 1, 2}, &model);
  EXPECT_THAT(SourceSelector(model, 1.0).SelectSources(0, 20), ElementsAre(2));
  // The two see the point from nearly the same place.
  EXPECT_THAT(SourceSelector(model, 0.9).SelectSources(0, 20), ElementsAre(1));
}

TEST(SourceSelectorTest, ChoosesOneOfSeveralImagesFromOnePlace) {
  // Frames of a video that stands still twice: 3 and 4, 5 and 6.
  SparseModel model = MakeModel({0, 0.001, 1, 2, 2.001, 3, 3});
  AddPoint({0, 0, 5}, {0, 1, 2, 3, 4, 5, 6}, &model);
  const SourceSelector selector(model, 1.0);
  EXPECT_THAT(selector.SelectSources(0, 20), ElementsAre(2, 3, 5));
  EXPECT_THAT(selector.SelectSources(0, 2), ElementsAre(2, 3));
  EXPECT_THAT(selector.SelectSources(4, 20), ElementsAre(0, 2, 5));
  EXPECT_THAT(selector.SelectIndependent(0, {6, 1, 4, 5, 3, 2}),
              ElementsAre(6, 4, 2));
  // The viewpoint of a view that sees no points cannot be compared.
  model.images[0].point_indices.clear();
  EXPECT_THAT(SourceSelector(model, 1.0).SelectIndependent(0, {1, 3, 4}),
              ElementsAre(1, 3, 4));
}

// Among n angles, the one of rank round(0.75 (n - 1)) counts. Near points have
// large angles, far points small ones.
TEST(SourceSelectorTest, TakesThe75thPercentileOfTheAngles) {
  const auto selected = [](int num_near, int num_far) {
    SparseModel model = MakeModel({0, 1});
    for (int i = 0; i < num_near; ++i) {
      AddPoint({0, 0, 5}, {0, 1}, &model);
    }
    for (int i = 0; i < num_far; ++i) {
      AddPoint({0, 0, 1e4}, {0, 1}, &model);
    }
    return !SourceSelector(model, 1.0).SelectSources(0, 20).empty();
  };
  // Five angles: rank 3, so two large ones are needed.
  EXPECT_FALSE(selected(1, 4));
  EXPECT_TRUE(selected(2, 3));
  // Three angles: rank round(1.5) = 2, the largest.
  EXPECT_TRUE(selected(1, 2));
}

// Cameras that face each other see a point under an obtuse angle, which locates
// it as badly as the acute one.
TEST(SourceSelectorTest, ObtuseAnglesCountAsTheirSupplement) {
  SparseModel model = MakeModel({-1, 1});
  AddPoint({0, 0, 1e-4}, {0, 1}, &model);
  EXPECT_THAT(SourceSelector(model, 1.0).SelectSources(0, 20), IsEmpty());
}

}  // namespace
}  // namespace tsar
