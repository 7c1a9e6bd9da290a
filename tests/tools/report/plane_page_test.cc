// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/label_color.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"
#include "colmap_tsar/tools/plane_export/write_planes.h"
#include "colmap_tsar/tools/report/page_data.h"
#include "colmap_tsar/tools/report/write_page.h"

#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "tests/support/room_workspace.h"
#include "tests/support/test_workspace.h"
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

ExportedPlane MakePlane(int id, const Eigen::Vector3d& normal, double area) {
  ExportedPlane plane;
  plane.id = id;
  plane.area = area;
  plane.coordinates.normal = normal.normalized();
  plane.coordinates.axis_s = plane.coordinates.normal.unitOrthogonal();
  plane.coordinates.axis_t =
      plane.coordinates.normal.cross(plane.coordinates.axis_s);
  return plane;
}

// As a page has it.
std::string ColorText(const Rgb& color) {
  char text[8];
  std::snprintf(text, sizeof(text), "#%02x%02x%02x", color.r, color.g, color.b);
  return text;
}

Vertical UpIsZ() {
  return {Eigen::Vector3d::UnitZ(), Vertical::Source::kCameras};
}

TEST(PlanePage, ListsTheLargestFirst) {
  ExportedPlanes planes;
  planes.planes = {MakePlane(2, {0, 0, 1}, 1.0),
                   MakePlane(5, {0, 0, 1}, 7.0),
                   MakePlane(6, {0, 0, 1}, 1.0)};
  planes.planes[1].images = {{"a.png", 10}, {"b.png", 20}};
  planes.planes[1].share_measured = 0.25;
  planes.planes[1].plane_class = PlaneClass::kCeiling;
  const PlanePage page = MakePlanePage(planes, Eigen::Vector3d::Zero());
  ASSERT_EQ(page.planes.size(), 3u);
  EXPECT_EQ(page.planes[0].id, 5);
  EXPECT_EQ(page.planes[0].area, 7.0);
  EXPECT_EQ(page.planes[0].num_images, 2);
  EXPECT_EQ(page.planes[0].share_measured, 0.25);
  EXPECT_EQ(page.planes[0].plane_class, PlaneClass::kCeiling);
  EXPECT_EQ(page.planes[1].id, 2);
  EXPECT_EQ(page.planes[2].id, 6);
}

TEST(PlanePage, TiltIsToTheNearerOfLevelAndUpright) {
  const std::pair<Eigen::Vector3d, double> cases[] = {
      {{0, 0, -1}, 0.0},
      {{0, 1, 0}, 0.0},
      {{0, std::sin(0.1), std::cos(0.1)}, 0.1},
      {{0, std::cos(0.2), -std::sin(0.2)}, 0.2}};
  for (const auto& [normal, radians] : cases) {
    ExportedPlanes planes;
    planes.planes = {MakePlane(0, normal, 1.0)};
    EXPECT_FALSE(MakePlanePage(planes, Eigen::Vector3d::Zero()).planes[0].tilt);
    planes.vertical = UpIsZ();
    const PlanePage page = MakePlanePage(planes, Eigen::Vector3d::Zero());
    EXPECT_NEAR(page.planes[0].tilt.value(), radians * 180.0 / M_PI, 1e-6);
  }
}

TEST(PlanePage, SigmaIsThatOfTheOffset) {
  ExportedPlanes planes;
  planes.planes = {MakePlane(0, {0, 0, 1}, 2.0), MakePlane(1, {0, 0, 1}, 1.0)};
  planes.planes[0].covariance.diagonal() << 1.0, 4.0, 0.25;
  planes.planes[1].covariance(2, 2) = std::numeric_limits<double>::infinity();
  const PlanePage page = MakePlanePage(planes, Eigen::Vector3d::Zero());
  EXPECT_EQ(page.planes[0].sigma, 0.5);
  EXPECT_FALSE(page.planes[1].sigma);
}

TEST(PlanePage, MeshesAreFarFromTheOriginAndFaceTheNormal) {
  const Eigen::Vector3d origin(4.5e5, 5.1e6, 300.0);
  ExportedPlanes planes;
  for (const int id : {3, 8}) {
    planes.planes.push_back(MakePlane(id, {1, 2, id - 5.0}, 10.0 - id));
    planes.planes.back().coordinates.origin = origin + Eigen::Vector3d(1, 2, 3);
    planes.planes.back().polygons = {{{{0, 0}, {2, 0}, {2, 1}, {0, 1}}, {}}};
  }
  const PlanePage page = MakePlanePage(planes, origin);
  ASSERT_EQ(page.mesh.NumPoints(), 12u);
  for (size_t p = 0; p < 2; ++p) {
    EXPECT_EQ(page.planes[p].num_vertices, 6);
    EXPECT_EQ(page.planes[p].first_vertex, static_cast<int64_t>(6 * p));
    for (size_t i = 6 * p; i < 6 * p + 6; i += 3) {
      Eigen::Matrix3f corners;
      for (size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(ColorText(page.mesh.colors[i + k]),
                  ColorText(LabelColor(page.planes[p].id)));
        corners.col(static_cast<Eigen::Index>(k)) =
            Eigen::Map<const Eigen::Vector3f>(
                &page.mesh.positions[3 * (i + k)]);
      }
      EXPECT_LT(corners.norm(), 15.f);
      const Eigen::Vector3f turned =
          (corners.col(1) - corners.col(0))
              .cross(Eigen::Vector3f(corners.col(2) - corners.col(0)));
      EXPECT_NEAR(turned.dot(planes.planes[p].coordinates.normal.cast<float>()),
                  2.f,
                  1e-4f);
    }
  }
}

class PlanesOnPageTest : public testing::Test {
 protected:
  void SetUp() override {
    room_.Write();
    options_.report_path = folder_.Path() / "report";
    options_.overwrite = true;
  }

  nlohmann::json Write() const {
    std::ostringstream out;
    Progress progress(out, false);
    WritePage(
        Workspace(room_.root, MapType::kGeometric), options_, progress, [] {
          return false;
        });
    const std::string script =
        ReadText(options_.report_path / "data/report.js");
    const size_t begin = script.find('{');
    return nlohmann::json::parse(
        script.substr(begin, script.rfind('}') + 1 - begin));
  }

  bool IsThere(const std::string& file) const {
    return fs::exists(options_.report_path / file);
  }

  fs::path PlanesPath() const {
    return GetMapPaths(room_.root, "v3.png", MapType::kGeometric).planes;
  }

  TemporaryFolder folder_;
  RoomWorkspace room_{folder_.Path() / "dense"};
  PageOptions options_;
};

TEST_F(PlanesOnPageTest, ListsThePlanesOfTheScene) {
  const nlohmann::json planes = Write()["planes"];
  ASSERT_EQ(planes.size(), size_t{RoomWorkspace::kNumPlanes});
  double area = 1e9;
  int64_t num_vertices = 0;
  std::set<int> ids;
  for (const nlohmann::json& plane : planes) {
    const int id = plane["id"];
    SCOPED_TRACE(id);
    ids.insert(id);
    EXPECT_LE(plane["area"], area);
    area = plane["area"];
    num_vertices += plane["count"].get<int64_t>();
    if (id == RoomWorkspace::kUnseen) {
      EXPECT_EQ(plane["count"], 0);
      EXPECT_EQ(plane["images"], 0);
      continue;
    }
    EXPECT_EQ(plane["class"],
              id == RoomWorkspace::kFloor     ? "floor"
              : id == RoomWorkspace::kCeiling ? "ceiling"
                                              : "wall");
    // Half of the cameras look to either side.
    const bool is_side =
        id == RoomWorkspace::kLeft || id == RoomWorkspace::kRight;
    EXPECT_EQ(plane["images"], RoomWorkspace::kNumImages / (is_side ? 2 : 1));
    EXPECT_NEAR(plane["measured"], 0.75, 0.02);
    EXPECT_NEAR(plane["tilt"], 0.0, 1e-6);
    EXPECT_NEAR(plane["sigma"], std::sqrt(3.0), 1e-9);
    EXPECT_GE(plane["count"], 6);
  }
  EXPECT_EQ(ids.size(), planes.size());
  // A call, and 4 letters for each 3 of the 15 bytes of a vertex.
  const std::string mesh =
      ReadText(options_.report_path / "data/points_planes.js");
  EXPECT_EQ(mesh.find("tsarPoints(\"planes\", \""), 0u);
  EXPECT_EQ(mesh.size(),
            std::string("tsarPoints(\"planes\", \"\");\n").size() +
                static_cast<size_t>(20 * num_vertices));
}

// The picture, the list and tsar_planes agree.
TEST_F(PlanesOnPageTest, APlaneHasOneColor) {
  const nlohmann::json data = Write();
  const nlohmann::json& image = data["images"][3];
  EXPECT_EQ(image["has_planes"], true);
  const cv::Mat picture =
      cv::imread((options_.report_path / "images" /
                  image["folder"].get<std::string>() / "planes.png")
                     .string());
  const cv::Mat numbers =
      cv::imread(PlanesPath().string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(picture.size(), numbers.size());
  std::map<int, std::string> colors = {{0, "#000000"}};
  for (const nlohmann::json& plane : data["planes"]) {
    colors[plane["id"].get<int>() + 1] = plane["color"];
  }
  std::set<int> seen;
  for (int y = 0; y < numbers.rows; ++y) {
    for (int x = 0; x < numbers.cols; ++x) {
      const auto& bgr = picture.at<cv::Vec3b>(y, x);
      const int number = numbers.at<uint16_t>(y, x);
      ASSERT_EQ(colors.at(number), ColorText({bgr[2], bgr[1], bgr[0]}));
      seen.insert(number);
    }
  }
  EXPECT_GE(seen.size(), 4u);

  std::ostringstream ply;
  Progress progress(ply, false);
  const ExportedPlanes exported = ExportPlanes(
      Workspace(room_.root, MapType::kGeometric), {}, progress, [] {
        return false;
      });
  ply.str("");
  PutPlanesPly(exported, &ply);
  for (const ExportedPlane& plane : exported.planes) {
    if (!plane.polygons.empty()) {
      const Rgb color = LabelColor(plane.id);
      char line[32];
      std::snprintf(
          line, sizeof(line), " %d %d %d\n", color.r, color.g, color.b);
      EXPECT_THAT(ply.str(), testing::HasSubstr(line));
      EXPECT_EQ(colors.at(plane.id + 1), ColorText(color));
    }
  }
}

TEST_F(PlanesOnPageTest, WithoutAModelThereAreNone) {
  Write();
  EXPECT_TRUE(IsThere("data/points_planes.js"));
  fs::remove(room_.root / "stereo/tsar/planes.bin");
  const nlohmann::json data = Write();
  EXPECT_FALSE(data.contains("planes"));
  EXPECT_EQ(data["images"].size(), size_t{RoomWorkspace::kNumImages});
  EXPECT_EQ(data["images"][0]["has_planes"], false);
  EXPECT_FALSE(IsThere("data/points_planes.js"));
  EXPECT_FALSE(IsThere("images/00000_v0.png/planes.png"));
}

TEST_F(PlanesOnPageTest, AnImageWithoutAPlaneMapHasNoPicture) {
  fs::remove(PlanesPath());
  const nlohmann::json data = Write();
  EXPECT_EQ(data["images"][3]["has_planes"], false);
  EXPECT_EQ(data["images"][2]["has_planes"], true);
  EXPECT_EQ(data["planes"][0]["images"], RoomWorkspace::kNumImages - 1);
}

TEST_F(PlanesOnPageTest, DamagedFilesAreOneErrorAndNoPage) {
  const std::string map = ReadText(PlanesPath());
  WriteText(PlanesPath(), map.substr(0, map.size() / 2));
  ExpectError(ErrorCode::kCorrupt, {"v3.png.geometric.png"}, [&] { Write(); });
  cv::imwrite(PlanesPath().string(), cv::Mat::zeros(7, 5, CV_16U));
  ExpectError(ErrorCode::kMismatch, {"v3.png.geometric.png"}, [&] { Write(); });
  WriteText(PlanesPath(), map);
  WriteText(room_.root / "stereo/tsar/planes.bin", "planes");
  ExpectError(ErrorCode::kCorrupt, {"planes.bin"}, [&] { Write(); });
  EXPECT_FALSE(fs::exists(options_.report_path));
}

}  // namespace
}  // namespace tsar
