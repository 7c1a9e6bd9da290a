// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/export_planes.h"

#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/scene_model_file.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "tests/support/room_workspace.h"
#include "tests/support/test_workspace.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

class ExportPlanesTest : public testing::Test {
 protected:
  ExportedPlanes Export(double min_area = 0.0) const {
    std::ostringstream output;
    Progress progress(output, false);
    return ExportPlanes(
        Workspace(room_.root, MapType::kGeometric), min_area, progress);
  }
  void ExpectFailure(ErrorCode code,
                     const std::vector<std::string>& texts) const {
    ExpectError(code, texts, [&] { Export(); });
  }
  std::filesystem::path PlanesPath() const {
    return GetMapPaths(room_.root, "v3.png", MapType::kGeometric).planes;
  }
  static void WritePlaneMap(const std::filesystem::path& path, int value) {
    cv::imwrite(path.string(),
                cv::Mat(RoomWorkspace::kHeight,
                        RoomWorkspace::kWidth,
                        CV_16UC1,
                        cv::Scalar(value)));
  }

  void ExpectAreasOfTheRoom(const ExportedPlanes& exported) const {
    ASSERT_EQ(exported.planes.size(), size_t{RoomWorkspace::kNumPlanes});
    const double areas[] = {20.0, 20.0, 10.0, 10.0, 12.5, 10.85, 0.0};
    for (size_t p = 0; p < exported.planes.size(); ++p) {
      SCOPED_TRACE(p);
      EXPECT_EQ(exported.planes[p].id, static_cast<int>(p));
      EXPECT_NEAR(exported.planes[p].area, areas[p], 0.03 * areas[p]);
    }
    const ExportedPlane& back = exported.planes[RoomWorkspace::kBack];
    ASSERT_EQ(back.polygons.size(), 1u);
    ASSERT_EQ(back.polygons[0].holes.size(), 1u);
    EXPECT_NEAR(back.polygons[0].area, 10.85, 0.1);
    for (const int p : {RoomWorkspace::kFloor,
                        RoomWorkspace::kCeiling,
                        RoomWorkspace::kLeft,
                        RoomWorkspace::kRight,
                        RoomWorkspace::kFront}) {
      ASSERT_EQ(exported.planes[p].polygons.size(), 1u) << p;
      EXPECT_TRUE(exported.planes[p].polygons[0].holes.empty()) << p;
    }
  }

  TemporaryFolder folder_;
  RoomWorkspace room_{folder_.Path() / "dense"};
};

// Wrong labels here and there, a world that stands askew, and far away.
TEST_F(ExportPlanesTest, MeasuresTheRoomWithNoiseAnywhere) {
  room_.num_wrong_per_mille = 20;
  room_.pose.rotate(
      Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 2, 3).normalized()));
  room_.pose.pretranslate(Eigen::Vector3d(4.5e5, 5.1e6, 300.0));
  room_.Write();
  const ExportedPlanes exported = Export();
  ExpectAreasOfTheRoom(exported);
  EXPECT_EQ(exported.planes[RoomWorkspace::kFloor].plane_class,
            PlaneClass::kFloor);
}

TEST_F(ExportPlanesTest, DescribesThePlanes) {
  room_.Write();
  const ExportedPlanes exported = Export();
  ExpectAreasOfTheRoom(exported);
  EXPECT_EQ(exported.type, "geometric");
  EXPECT_EQ(exported.num_images, RoomWorkspace::kNumImages);
  EXPECT_EQ(exported.vertical.source, Vertical::Source::kFrame);
  EXPECT_NEAR(exported.vertical.up.y(), -1.0, 1e-12);
  const Eigen::Vector3d inside = room_.Point(2.5, 0, 2);
  for (const ExportedPlane& plane : exported.planes) {
    SCOPED_TRACE(plane.id);
    const ModelPlane model = room_.Model().planes[plane.id];
    EXPECT_EQ(plane.plane_class,
              plane.id == RoomWorkspace::kFloor     ? PlaneClass::kFloor
              : plane.id == RoomWorkspace::kCeiling ? PlaneClass::kCeiling
              : plane.id == RoomWorkspace::kUnseen  ? PlaneClass::kOther
                                                    : PlaneClass::kWall);
    const PlaneCoordinates& axes = plane.coordinates;
    EXPECT_NEAR((axes.axis_s.cross(axes.axis_t) - axes.normal).norm(), 0, 1e-9);
    EXPECT_EQ(plane.frame, plane.id == RoomWorkspace::kFloor ? 0 : -1);
    // The normal may be turned, and with it one axis.
    const double side = axes.normal.dot(model.plane.normal);
    EXPECT_NEAR(std::abs(side), 1.0, 1e-12);
    EXPECT_NEAR(plane.Offset(), side * model.plane.offset, 1e-9);
    EXPECT_NEAR(plane.covariance(0, 1),
                axes.axis_t.dot(model.axis_t) * model.covariance(0, 1),
                1e-12);
    EXPECT_NEAR(plane.covariance(0, 2), side * model.covariance(0, 2), 1e-12);
    if (plane.id == RoomWorkspace::kUnseen) {
      EXPECT_TRUE(plane.images.empty());
      EXPECT_TRUE(plane.polygons.empty());
      EXPECT_TRUE(plane.meets.empty());
      continue;
    }
    EXPECT_GT(axes.normal.dot(inside - axes.origin), 0.0);
    EXPECT_GT(plane.polygons[0].area, 0.0);
    EXPECT_NEAR(plane.share_measured, 0.75, 0.02);
    EXPECT_EQ(plane.meets.size(), 4u);
    int64_t num_pixels = 0;
    for (const ExportedPlane::Sighting& sighting : plane.images) {
      num_pixels += sighting.num_pixels;
    }
    EXPECT_EQ(num_pixels, plane.num_pixels);
    EXPECT_GT(plane.images.size(), 3u);
    // Walls, floor and ceiling are rectangles between the very same corners.
    const Ring& outline = plane.polygons[0].outline;
    EXPECT_EQ(outline.size(), 4u);
    for (const Eigen::Vector2d& corner : outline) {
      const Eigen::Vector3d point = axes.ToWorld(corner);
      EXPECT_NEAR(std::abs(point.x() - 2.5), 2.5, 1e-9);
      EXPECT_NEAR(std::abs(point.y()), 1.25, 1e-9);
      EXPECT_NEAR(std::abs(point.z() - 2.0), 2.0, 1e-9);
    }
  }
  const ExportedPlanes large = Export(11.5);
  ASSERT_EQ(large.planes.size(), 3u);
  EXPECT_EQ(large.planes[2].id, RoomWorkspace::kFront);
}

TEST_F(ExportPlanesTest, WantsARefinedWorkspaceWithPlanes) {
  room_.Write();
  std::filesystem::remove(GetSceneModelPath(room_.root).Path());
  ExpectFailure(ErrorCode::kNotFound,
                {room_.root.string(), "without keeping the planes"});
  std::filesystem::remove_all(room_.root / "stereo/provenance_maps");
  ExpectFailure(ErrorCode::kNotFound,
                {room_.root.string(), "no refined geometric maps"});
}

TEST_F(ExportPlanesTest, TakesAModelWithoutPlanes) {
  room_.Write();
  WriteSceneModel(GetSceneModelPath(room_.root), "", {});
  ExpectFailure(ErrorCode::kMismatch, {"plane_maps", "of 0"});
  for (const auto& map :
       std::filesystem::directory_iterator(room_.root / "stereo/plane_maps")) {
    WritePlaneMap(map.path(), 0);
  }
  EXPECT_TRUE(Export().planes.empty());
}

TEST_F(ExportPlanesTest, RefusesMapsThatDoNotFit) {
  room_.Write();
  const std::string good = ReadText(PlanesPath());
  cv::imwrite(PlanesPath().string(), cv::Mat(9, 9, CV_16UC1, cv::Scalar(1)));
  ExpectFailure(ErrorCode::kMismatch, {PlanesPath().string(), "another size"});
  WriteText(PlanesPath(), good.substr(0, good.size() / 2));
  ExpectFailure(ErrorCode::kCorrupt, {PlanesPath().string()});
  WritePlaneMap(PlanesPath(), RoomWorkspace::kNumPlanes + 1);
  ExpectFailure(ErrorCode::kMismatch,
                {PlanesPath().string(), "names plane 7 of 7"});
  WriteText(GetSceneModelPath(room_.root).Path(), "planes");
  ExpectFailure(ErrorCode::kCorrupt, {"planes.bin"});
}

// Their numbers mean other planes there.
TEST_F(ExportPlanesTest, RefusesThePlanesOfAnotherRun) {
  room_.Write();
  const MapPaths paths = GetMapPaths(room_.root, "v3.png", MapType::kGeometric);
  ImageRecord record = ReadRecord(paths.record).value();
  record.planes = "1";
  WriteRecord(paths.record, record);
  ExpectFailure(ErrorCode::kMismatch,
                {"planes.bin", PlanesPath().string(), "run tsar_refine again"});
  record.planes = std::to_string(
      ReadScenePlanesFingerprint(GetSceneModelPath(room_.root)).value());
  WriteRecord(paths.record, record);
  EXPECT_EQ(Export().planes.size(), size_t{RoomWorkspace::kNumPlanes});
}

TEST_F(ExportPlanesTest, CanBeStopped) {
  room_.Write();
  std::ostringstream output;
  Progress progress(output, false);
  int num_asked = 0;
  progress.SetStop([&] { return ++num_asked > 3; });
  ExpectError(ErrorCode::kInterrupted, {"nothing was written"}, [&] {
    ExportPlanes(Workspace(room_.root, MapType::kGeometric), 0.0, progress);
  });
}

}  // namespace
}  // namespace tsar
