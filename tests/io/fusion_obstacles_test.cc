// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/sparse_model.h"

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class FusionObstaclesTest : public testing::Test {
 protected:
  FusionObstaclesTest() {
    for (const char* name : {"cameras", "images", "points3D"}) {
      WriteText(folder_.Path() / (name + std::string(".txt")), "");
    }
  }

  // For one camera at this center, which sees a point 4 units in front of it.
  std::vector<std::string> Find(const Eigen::Vector3d& center,
                                const std::string& name = "a.jpg") const {
    SparseModel model;
    SparseModel::ModelImage image;
    image.name = name;
    image.camera.fx = 1000.0;
    image.camera.translation = -center;
    image.point_indices = {0};
    model.images = {image};
    model.points = {center + Eigen::Vector3d(0, 0, 4)};
    return FindFusionObstacles(model, folder_.Path());
  }

  const TemporaryFolder folder_;
};

// A step of single precision at 2^15 is 2^-8, of which half is the most that
// rounding moves a point: at a 250th of a unit per pixel, half a pixel.
TEST_F(FusionObstaclesTest, CoordinatesThatAreRoundedByPixels) {
  EXPECT_THAT(Find({0, 0, 0}), IsEmpty());
  EXPECT_THAT(Find({16000, 0, 0}), IsEmpty());
  EXPECT_THAT(Find({0, -32768, 0}),
              ElementsAre(AllOf(HasSubstr("3.28e+04 units from the origin"),
                                HasSubstr("off by up to 0.49 pixels"),
                                HasSubstr("model_transformer"))));
}

TEST_F(FusionObstaclesTest, NamesWithSpacesInText) {
  EXPECT_THAT(Find({0, 0, 0}, "my set/a (2).jpg"),
              ElementsAre(AllOf(HasSubstr("\"my set/a (2).jpg\""),
                                HasSubstr("use tsar_fuse"))));
  for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"}) {
    WriteText(folder_.Path() / name, "");
  }
  EXPECT_THAT(Find({0, 0, 0}, "my set/a (2).jpg"), IsEmpty());
}

}  // namespace
}  // namespace tsar
