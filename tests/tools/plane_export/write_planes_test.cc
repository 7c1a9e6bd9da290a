// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/write_planes.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <sstream>

#include "tests/support/test_workspace.h"
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

using Json = nlohmann::json;

Eigen::Vector3d NormalOf(const PlaneFace& face) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (size_t i = 2; i < face.size(); ++i) {
    sum += 0.5 * (face[i - 1] - face[0]).cross(face[i] - face[0]);
  }
  return sum;
}

// A floor with a hole, a wall in two parts, and a plane that nobody sees.
ExportedPlanes MakePlanes() {
  ExportedPlanes planes;
  planes.type = "geometric";
  planes.num_images = 2;
  planes.vertical = {{0, 0, 1}, Vertical::Source::kFrame};
  planes.frames = {Eigen::Matrix3d::Identity()};
  ExportedPlane floor;
  floor.id = 0;
  floor.plane_class = PlaneClass::kFloor;
  floor.coordinates.origin = {1000000.0, 0.25, 3};
  floor.covariance.diagonal() << 1, 2, std::numeric_limits<double>::infinity();
  floor.area = 15.0;
  floor.num_pixels = 12;
  floor.share_measured = 0.75;
  floor.frame = 0;
  floor.axis = 2;
  floor.images = {{"left/a.png", 8}, {"b\xff.png", 4}};
  floor.meets = {2};
  floor.polygons = {
      {{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{{1, 1}, {1, 2}, {2, 2}, {2, 1}}}}};
  ExportedPlane unseen;
  unseen.id = 1;
  ExportedPlane wall;
  wall.id = 2;
  wall.plane_class = PlaneClass::kWall;
  wall.coordinates = {{0, 5, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
  wall.area = 3.5;
  wall.polygons = {{{{0, 0}, {3, 0}, {3, 1}, {0, 1}}, {}},
                   {{{9, 0}, {10, 0}, {10, 1}}, {}}};
  planes.planes = {floor, unseen, wall};
  return planes;
}

std::string Written(PlanesWriter put,
                    const ExportedPlanes& planes = MakePlanes()) {
  std::ostringstream out;
  put(planes, &out);
  return out.str();
}

void ExpectFaces(const std::vector<PlaneFace>& faces,
                 double area,
                 const Eigen::Vector3d& normal) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const PlaneFace& face : faces) {
    sum += NormalOf(face);
    EXPECT_GT(NormalOf(face).dot(normal), 0.0);
    EXPECT_TRUE(face.size() == 3 || face.size() == 4) << face.size();
  }
  EXPECT_NEAR((sum - area * normal).norm(), 0.0, 1e-7 * area);
}

// Stars with stars as holes.
TEST(MakeFaces, CoversDrawnPolygons) {
  for (uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Philox random(seed, 0, 0);
    ExportedPlane plane;
    double area = 0.0;
    const auto star = [&](double x, double radius) {
      Ring ring;
      const int num_points = 3 + static_cast<int>(20 * random.NextFloat());
      for (int i = 0; i < num_points; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / num_points;
        const double length = radius * (0.4 + 0.6 * random.NextFloat());
        ring.push_back(
            {x + length * std::cos(angle), length * std::sin(angle)});
      }
      for (size_t i = 0; i < ring.size(); ++i) {
        area += (radius > 10.0 ? 0.5 : -0.5) *
                Cross(ring[i], ring[(i + 1) % ring.size()]);
      }
      return ring;
    };
    for (const double x : {0.0, 250.0}) {
      PlanePolygon& polygon = plane.polygons.emplace_back();
      polygon.outline = star(x, 100.0);
      const Ring hole = star(x, 9.0);
      polygon.holes.push_back(Ring(hole.rbegin(), hole.rend()));
    }
    const std::vector<PlaneFace> faces = MakeFaces(plane);
    ExpectFaces(faces, area, {0, 0, 1});
    for (const PlaneFace& face : faces) {
      for (size_t i = 0; i < face.size(); ++i) {
        const PlaneFace corner = {
            face[i], face[(i + 1) % face.size()], face[(i + 2) % face.size()]};
        EXPECT_GT(NormalOf(corner).z(), -1e-4);
      }
    }
  }
}

TEST(PlanesWriter, IsReadFromTheName) {
  EXPECT_EQ(PlanesWriterFor("a/planes.JSON"), &PutPlanesJson);
  EXPECT_EQ(PlanesWriterFor("planes.obj"), &PutPlanesObj);
  EXPECT_EQ(PlanesWriterFor("planes.dxf"), &PutPlanesDxf);
  for (const char* path : {"planes", "planes.txt", "planes.", ".json"}) {
    ExpectError(ErrorCode::kBadOption, {"output_path", path, ".json"}, [&] {
      PlanesWriterFor(path);
    });
  }
}

TEST(PlanesJson, TellsEverything) {
  const Json json = Json::parse(Written(&PutPlanesJson));
  ASSERT_EQ(json["planes"].size(), 3u);
  EXPECT_EQ(json["planes"][0], Json::parse(R"({
    "id": 0, "class": "floor", "normal": [0, 0, 1], "offset": -3.0,
    "center": [1000000.0, 0.25, 3], "axis_s": [1, 0, 0], "axis_t": [0, 1, 0],
    "covariance": [[1, 0, 0], [0, 2, 0], [0, 0, null]],
    "area": 15.0, "resolution": 0.0, "share_measured": 0.75, "support": 0.0,
    "num_pixels": 12, "component": 0, "frame": 0, "axis": 2, "meets": [2],
    "images": [{"name": "left/a.png", "num_pixels": 8},
               {"name": "b\ufffd.png", "num_pixels": 4}],
    "polygons": [{
      "outline": [[1000000, 0.25, 3], [1000004, 0.25, 3], [1000004, 4.25, 3],
                  [1000000, 4.25, 3]],
      "holes": [[[1000001, 1.25, 3], [1000001, 2.25, 3], [1000002, 2.25, 3],
                 [1000002, 1.25, 3]]]}]})"));
  EXPECT_TRUE(json["planes"][1]["frame"].is_null());
  EXPECT_TRUE(json["planes"][1]["polygons"].empty());
  EXPECT_EQ(json["planes"][2]["polygons"].size(), 2u);
  Json head = json;
  head.erase("planes");
  EXPECT_EQ(head, Json::parse(R"({
    "format": "tsar_planes", "version": 1, "maps": "geometric",
    "num_images": 2, "unit": "model",
    "from_model": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "vertical": [0, 0, 1], "vertical_from": "manhattan_frame",
    "frames": [[[1, 0, 0], [0, 1, 0], [0, 0, 1]]]})"));
  const Json none = Json::parse(Written(&PutPlanesJson, {}));
  EXPECT_TRUE(none["vertical"].is_null());
  EXPECT_EQ(none["vertical_from"], "none");
  EXPECT_TRUE(none["planes"].empty());
}

// A triangle at z = 3, twice.
ExportedPlanes MakeTriangles() {
  ExportedPlane wall;
  wall.plane_class = PlaneClass::kWall;
  wall.coordinates.origin.z() = 3;
  wall.polygons = {{{{0, 0}, {2, 0}, {2, 1}}, {}}};
  ExportedPlanes planes;
  planes.planes = {ExportedPlane(), wall, wall};
  planes.planes[2].id = 7;
  return planes;
}

// Indices count from 1 through the file.
TEST(PlanesObj, HasAGroupForEachPlaneWithFaces) {
  const std::string corners = "v 2 1 3\nv 0 0 3\nv 2 0 3\n";
  EXPECT_EQ(Written(&PutPlanesObj, MakeTriangles()),
            "# planes of the scene, by tsar_planes\n"
            "g plane_0_wall\nvn 0 0 1\n" +
                corners +
                "f 1//1 2//1 3//1\n"
                "g plane_7_wall\nvn 0 0 1\n" +
                corners + "f 4//2 5//2 6//2\n");
}

// 3DFACE repeats the last corner of a triangle.
TEST(PlanesDxf, HasFacesAndOutlinesInLayers) {
  ExportedPlanes planes = MakeTriangles();
  planes.planes.pop_back();
  std::string text = Written(&PutPlanesDxf, planes);
  for (size_t at = 0; (at = text.find('\n', at)) != std::string::npos;) {
    text[at] = ' ';
  }
  const auto layer = [](const std::string& name, int color) {
    return "  0 LAYER   2 " + name + "  70 0  62 " + std::to_string(color) +
           "   6 CONTINUOUS ";
  };
  const auto point = [](int first, int x, int y) {
    return " " + std::to_string(first) + " " + std::to_string(x) + "  " +
           std::to_string(first + 10) + " " + std::to_string(y) + "  " +
           std::to_string(first + 20) + " 3 ";
  };
  const auto vertex = [&](int x, int y) {
    return "  0 VERTEX   8 WALL " + point(10, x, y) + " 70 32 ";
  };
  EXPECT_EQ(
      text,
      "  0 SECTION   2 HEADER   9 $ACADVER   1 AC1009   9 $INSUNITS  70 0   "
      "0 ENDSEC   0 SECTION   2 TABLES   0 TABLE   2 LAYER  70 4 " +
          layer("FLOOR", 3) + layer("CEILING", 5) + layer("WALL", 1) +
          layer("OTHER", 7) +
          "  0 ENDTAB   0 ENDSEC   0 SECTION   2 ENTITIES "
          "  0 3DFACE   8 WALL " +
          point(10, 2, 1) + point(11, 0, 0) + point(12, 2, 0) +
          point(13, 2, 0) +
          "  0 POLYLINE   8 WALL  66 1  10 0  20 0  30 0  70 9 " +
          vertex(0, 0) + vertex(2, 0) + vertex(2, 1) +
          "  0 SEQEND   8 WALL   0 ENDSEC   0 EOF ");
}

TEST(ScaleToMeters, ScalesLengthsAndNoAngles) {
  ExportedPlanes planes = MakePlanes();
  ExportedPlane& floor = planes.planes[0];
  floor.cell = 0.5;
  floor.covariance << 1, 2, 3, 2, 5, 6, 3, 6, 9;
  ScaleToMeters(2.0, &planes);
  const Json json = Json::parse(Written(&PutPlanesJson, planes));
  EXPECT_EQ(json["unit"], "meter");
  EXPECT_EQ(json["from_model"], Json({{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}));
  const Json& plane = json["planes"][0];
  EXPECT_EQ(plane["offset"], -6.0);
  EXPECT_EQ(plane["area"], 60.0);
  EXPECT_EQ(plane["resolution"], 1.0);
  EXPECT_EQ(plane["covariance"], Json({{1, 2, 6}, {2, 5, 12}, {6, 12, 36}}));
  EXPECT_EQ(plane["polygons"][0]["outline"][2], Json({2000008.0, 8.5, 6.0}));
  EXPECT_EQ(plane["polygons"][0]["holes"][0][0], Json({2000002.0, 2.5, 6.0}));
}

// Whatever is up in the model, y up is z up seen by (x, z, -y).
TEST(TurnUp, TurnsTheVerticalIntoTheAxis) {
  for (const Eigen::Vector3d& up :
       {Eigen::Vector3d(0, 0, 1), {0, 1, 0}, {0, -1, 0}, {0.6, -0.48, 0.64}}) {
    ExportedPlanes planes = MakePlanes();
    planes.vertical.up = up;
    ExportedPlanes with_z = planes;
    TurnUp(UpAxis::kZ, &with_z);
    TurnUp(UpAxis::kY, &planes);
    EXPECT_EQ(planes.vertical.up, Eigen::Vector3d(0, 1, 0));
    EXPECT_TRUE((with_z.from_model * up).isApprox(Eigen::Vector3d(0, 0, 1)));
    const auto expect_turned = [](const auto& by_z, const auto& by_y) {
      Eigen::Matrix3d rotation;
      rotation << 1, 0, 0, 0, 0, 1, 0, -1, 0;
      EXPECT_TRUE(by_y.isApprox(rotation * by_z));
    };
    expect_turned(with_z.from_model, planes.from_model);
    expect_turned(with_z.frames[0], planes.frames[0]);
    for (size_t i = 0; i < planes.planes.size(); ++i) {
      const PlaneCoordinates& z = with_z.planes[i].coordinates;
      const PlaneCoordinates& y = planes.planes[i].coordinates;
      expect_turned(z.normal, y.normal);
      expect_turned(z.ToWorld({2, 3}), y.ToWorld({2, 3}));
    }
  }
}

TEST(TurnUp, NeedsAVertical) {
  ExportedPlanes planes = MakePlanes();
  planes.vertical = {};
  TurnUp(UpAxis::kModel, &planes);
  ExpectError(ErrorCode::kUnsupported, {"up", "leave the option out"}, [&] {
    TurnUp(UpAxis::kZ, &planes);
  });
}

}  // namespace
}  // namespace tsar
