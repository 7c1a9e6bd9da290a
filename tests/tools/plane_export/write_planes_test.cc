// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/write_planes.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
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

std::string Written(void (*put)(const ExportedPlanes&, std::ostream*),
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

TEST(PlaneFormat, IsReadFromTheName) {
  EXPECT_EQ(ParsePlaneFormat("a/planes.JSON"), PlaneFormat::kJson);
  EXPECT_EQ(ParsePlaneFormat("planes.obj"), PlaneFormat::kObj);
  EXPECT_EQ(ParsePlaneFormat("planes.dxf"), PlaneFormat::kDxf);
  for (const char* path : {"planes", "planes.txt", "planes.", ".json"}) {
    ExpectError(ErrorCode::kBadOption, {"output_path", path, ".json"}, [&] {
      ParsePlaneFormat(path);
    });
  }
}

TEST(PlanesJson, TellsEverything) {
  const Json json = Json::parse(Written(&PutPlanesJson));
  EXPECT_EQ(json["format"], "tsar_planes");
  EXPECT_EQ(json["version"], 1);
  EXPECT_EQ(json["maps"], "geometric");
  EXPECT_EQ(json["num_images"], 2);
  EXPECT_EQ(json["vertical"], Json({0, 0, 1}));
  EXPECT_EQ(json["vertical_from"], "manhattan_frame");
  EXPECT_EQ(json["frames"][0][1], Json({0, 1, 0}));
  ASSERT_EQ(json["planes"].size(), 3u);
  const Json& floor = json["planes"][0];
  EXPECT_EQ(floor["id"], 0);
  EXPECT_EQ(floor["class"], "floor");
  EXPECT_EQ(floor["normal"], Json({0, 0, 1}));
  EXPECT_EQ(floor["offset"], -3.0);
  EXPECT_EQ(floor["covariance"], Json({{1, 0, 0}, {0, 2, 0}, {0, 0, nullptr}}));
  EXPECT_EQ(floor["area"], 15.0);
  EXPECT_EQ(floor["share_measured"], 0.75);
  EXPECT_EQ(floor["frame"], 0);
  EXPECT_EQ(floor["axis"], 2);
  EXPECT_EQ(floor["meets"], Json({2}));
  EXPECT_EQ(floor["images"][0],
            Json({{"name", "left/a.png"}, {"num_pixels", 8}}));
  EXPECT_EQ(floor["polygons"][0]["outline"][2], Json({1000004.0, 4.25, 3.0}));
  EXPECT_EQ(floor["polygons"][0]["holes"][0].size(), 4u);
  EXPECT_TRUE(json["planes"][1]["frame"].is_null());
  EXPECT_TRUE(json["planes"][1]["polygons"].empty());
  EXPECT_EQ(json["planes"][2]["polygons"].size(), 2u);
}

TEST(PlanesJson, KnowsNoVertical) {
  ExportedPlanes planes;
  const Json json = Json::parse(Written(&PutPlanesJson, planes));
  EXPECT_TRUE(json["vertical"].is_null());
  EXPECT_EQ(json["vertical_from"], "none");
  EXPECT_TRUE(json["planes"].empty());
}

TEST(PlanesObj, HasAGroupForEachPlane) {
  std::istringstream in(Written(&PutPlanesObj));
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;
  std::map<std::string, std::vector<PlaneFace>> groups;
  std::string group;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "g") {
      words >> group;
    } else if (kind == "v" || kind == "vn") {
      Eigen::Vector3d vector;
      words >> vector.x() >> vector.y() >> vector.z();
      (kind == "v" ? points : normals).push_back(vector);
    } else if (kind == "f") {
      PlaneFace& face = groups[group].emplace_back();
      size_t point = 0;
      size_t normal = 0;
      char slash = '\0';
      while (words >> point >> slash >> slash >> normal) {
        face.push_back(points.at(point - 1));
        EXPECT_EQ(normal, normals.size());
      }
      continue;
    } else {
      EXPECT_EQ(kind, "#");
    }
    EXPECT_FALSE(words.fail()) << line;
  }
  ASSERT_EQ(groups.size(), 2u);
  ExpectFaces(groups["plane_0_floor"], 15.0, {0, 0, 1});
  ExpectFaces(groups["plane_2_wall"], 3.5, {0, -1, 0});
}

// A DXF file as its pairs of code and value.
std::vector<std::pair<int, std::string>> ReadDxf(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::pair<int, std::string>> pairs;
  std::string code;
  std::string value;
  while (std::getline(in, code)) {
    EXPECT_TRUE(static_cast<bool>(std::getline(in, value)));
    EXPECT_EQ(code.size(), 3u);
    pairs.emplace_back(std::stoi(code), value);
  }
  return pairs;
}

TEST(PlanesDxf, HasFacesAndOutlinesInLayers) {
  const auto pairs = ReadDxf(Written(&PutPlanesDxf));
  ASSERT_GT(pairs.size(), 10u);
  EXPECT_EQ(pairs[3], std::pair(1, std::string("AC1009")));
  EXPECT_EQ(pairs[4], std::pair(9, std::string("$INSUNITS")));
  EXPECT_EQ(pairs[5], std::pair(70, std::string("0")));
  EXPECT_EQ(pairs.back(), std::pair(0, std::string("EOF")));
  int num_open_sections = 0;
  std::vector<std::string> layers;
  std::map<std::string, std::vector<PlaneFace>> faces;
  std::map<std::string, std::vector<int>> outlines;  // Numbers of corners.
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].first != 0) {
      continue;
    }
    const std::string& kind = pairs[i].second;
    std::map<int, std::string> values;
    for (size_t j = i + 1; j < pairs.size() && pairs[j].first != 0; ++j) {
      values[pairs[j].first] = pairs[j].second;
    }
    if (kind == "SECTION") {
      ++num_open_sections;
    } else if (kind == "ENDSEC") {
      --num_open_sections;
    } else if (kind == "LAYER") {
      layers.push_back(values[2]);
    } else if (kind == "3DFACE") {
      const auto corner = [&](int number) {
        return Eigen::Vector3d(std::stod(values.at(10 + number)),
                               std::stod(values.at(20 + number)),
                               std::stod(values.at(30 + number)));
      };
      PlaneFace face = {corner(0), corner(1), corner(2), corner(3)};
      if (face[2] == face[3]) {
        face.pop_back();
      }
      faces[values[8]].push_back(face);
    } else if (kind == "POLYLINE") {
      EXPECT_EQ(values[66], "1");
      EXPECT_EQ(values[70], "9");
      outlines[values[8]].push_back(0);
    } else if (kind == "VERTEX") {
      EXPECT_EQ(values[70], "32");
      ++outlines.at(values[8]).back();
    }
  }
  EXPECT_EQ(num_open_sections, 0);
  EXPECT_EQ(layers,
            (std::vector<std::string>{"FLOOR", "CEILING", "WALL", "OTHER"}));
  EXPECT_EQ(faces.size(), 2u);
  ExpectFaces(faces["FLOOR"], 15.0, {0, 0, 1});
  ExpectFaces(faces["WALL"], 3.5, {0, -1, 0});
  EXPECT_EQ(outlines["FLOOR"], (std::vector<int>{4, 4}));
  EXPECT_EQ(outlines["WALL"], (std::vector<int>{4, 3}));
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

TEST(WritePlanes, WritesEmptyFilesOfAllFormats) {
  TemporaryFolder folder;
  for (const char* name : {"planes.json", "planes.obj", "planes.dxf"}) {
    const std::filesystem::path path = folder.Path() / name;
    const PlaneFormat format = ParsePlaneFormat(path.string());
    WritePlanes(UserPath(path), format, {});
    const std::string empty = ReadText(path);
    EXPECT_FALSE(empty.empty());
    WritePlanes(UserPath(path), format, MakePlanes());
    EXPECT_GT(ReadText(path).size(), empty.size());
  }
}

}  // namespace
}  // namespace tsar
