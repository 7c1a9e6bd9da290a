// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/write_planes.h"

#include "colmap_tsar/base/label_color.h"
#include "colmap_tsar/io/ply.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <sstream>

#include "tests/support/test_workspace.h"
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

using Json = nlohmann::json;
using Triangle = std::array<Eigen::Vector3d, 3>;

Eigen::Vector3d NormalOf(const Triangle& triangle) {
  return 0.5 * (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
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

void ExpectTriangles(const std::vector<Triangle>& triangles,
                     double area,
                     const Eigen::Vector3d& normal) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Triangle& triangle : triangles) {
    sum += NormalOf(triangle);
    EXPECT_GT(NormalOf(triangle).dot(normal), 0.0);
  }
  EXPECT_NEAR((sum - area * normal).norm(), 0.0, 1e-6);
}

TEST(PlaneFormat, IsGivenOrReadFromTheName) {
  EXPECT_EQ(ParsePlaneFormat("", "a/planes.JSON"), PlaneFormat::kJson);
  EXPECT_EQ(ParsePlaneFormat("", "planes.ply"), PlaneFormat::kPly);
  EXPECT_EQ(ParsePlaneFormat("", "planes.obj"), PlaneFormat::kObj);
  EXPECT_EQ(ParsePlaneFormat("dxf", "planes.txt"), PlaneFormat::kDxf);
  EXPECT_EQ(ParsePlaneFormat("", "planes.glb"), PlaneFormat::kGlb);
  for (const char* path : {"planes", "planes.txt", "planes.", ".json"}) {
    ExpectError(ErrorCode::kBadOption, {"output_path", path, ".json"}, [&] {
      ParsePlaneFormat("", path);
    });
  }
  ExpectError(ErrorCode::kBadOption, {"format", "'stl'", "dxf"}, [] {
    ParsePlaneFormat("stl", "planes.stl");
  });
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

TEST(PlanesPly, HasColoredTriangles) {
  std::istringstream in(Written(&PutPlanesPly));
  std::string word;
  size_t num_points = 0;
  size_t num_faces = 0;
  while (in >> word && word != "end_header") {
    if (word == "vertex") {
      in >> num_points;
    } else if (word == "face") {
      in >> num_faces;
    }
  }
  ASSERT_EQ(num_points, 8u + 4u + 3u);
  std::vector<Eigen::Vector3d> points(num_points);
  for (size_t i = 0; i < num_points; ++i) {
    int red = 0;
    int green = 0;
    int blue = 0;
    in >> points[i].x() >> points[i].y() >> points[i].z() >> red >> green >>
        blue;
    const Rgb color = LabelColor(i < 8 ? 0 : 2);
    EXPECT_EQ(red, color.r);
    EXPECT_EQ(green, color.g);
    EXPECT_EQ(blue, color.b);
  }
  std::map<int, std::vector<Triangle>> triangles;
  for (size_t i = 0; i < num_faces; ++i) {
    size_t count = 0;
    size_t corners[3] = {};
    int plane = -1;
    in >> count >> corners[0] >> corners[1] >> corners[2] >> plane;
    ASSERT_EQ(count, 3u);
    triangles[plane].push_back(
        {points.at(corners[0]), points.at(corners[1]), points.at(corners[2])});
  }
  EXPECT_TRUE(static_cast<bool>(in));
  ASSERT_EQ(triangles.size(), 2u);
  ExpectTriangles(triangles[0], 15.0, {0, 0, 1});
  ExpectTriangles(triangles[2], 3.5, {0, -1, 0});
}

TEST(PlanesPly, IsReadAsACloud) {
  TemporaryFolder folder;
  const std::filesystem::path path = folder.Path() / "planes.ply";
  WritePlanes(UserPath(path), PlaneFormat::kPly, MakePlanes());
  const PlyCloud cloud = ReadPlyCloud(path, 100);
  ASSERT_EQ(cloud.points.size(), 15u);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3d(1000000.0, 0.25, 3));
  EXPECT_EQ(cloud.colors.size(), 15u);
}

TEST(PlanesObj, HasAGroupForEachPlane) {
  std::istringstream in(Written(&PutPlanesObj));
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;
  std::map<std::string, std::vector<Triangle>> groups;
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
      Triangle triangle;
      for (Eigen::Vector3d& corner : triangle) {
        size_t point = 0;
        size_t normal = 0;
        char slash = '\0';
        words >> point >> slash >> slash >> normal;
        corner = points.at(point - 1);
        EXPECT_EQ(normal, normals.size());
      }
      groups[group].push_back(triangle);
    } else {
      EXPECT_EQ(kind, "#");
    }
    EXPECT_FALSE(words.fail()) << line;
  }
  ASSERT_EQ(groups.size(), 2u);
  ExpectTriangles(groups["plane_0_floor"], 15.0, {0, 0, 1});
  ExpectTriangles(groups["plane_2_wall"], 3.5, {0, -1, 0});
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
  EXPECT_EQ(pairs.back(), std::pair(0, std::string("EOF")));
  int num_open_sections = 0;
  std::vector<std::string> layers;
  std::map<std::string, std::vector<Triangle>> faces;
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
      EXPECT_EQ(corner(2), corner(3));
      faces[values[8]].push_back({corner(0), corner(1), corner(2)});
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
  ExpectTriangles(faces["FLOOR"], 15.0, {0, 0, 1});
  ExpectTriangles(faces["WALL"], 3.5, {0, -1, 0});
  EXPECT_EQ(outlines["FLOOR"], (std::vector<int>{4, 4}));
  EXPECT_EQ(outlines["WALL"], (std::vector<int>{4, 3}));
}

TEST(PlanesDxf, TellsItsUnit) {
  const auto unit_of = [](const ExportedPlanes& planes) {
    const auto pairs = ReadDxf(Written(&PutPlanesDxf, planes));
    EXPECT_EQ(pairs[4], std::pair(9, std::string("$INSUNITS")));
    return pairs[5];
  };
  ExportedPlanes planes = MakePlanes();
  EXPECT_EQ(unit_of(planes), std::pair(70, std::string("0")));
  ScaleToMeters(2.0, &planes);
  EXPECT_EQ(unit_of(planes), std::pair(70, std::string("6")));
}

// A file as the specification of glTF 2.0 describes it: fails the test where it
// breaks the structure, and returns the JSON and the binary chunk.
std::pair<Json, std::string> ReadGlb(const std::string& text) {
  const auto number_at = [&](size_t offset) {
    uint32_t number = 0;
    EXPECT_LE(offset + sizeof(number), text.size());
    text.copy(reinterpret_cast<char*>(&number), sizeof(number), offset);
    return size_t{number};
  };
  EXPECT_EQ(text.substr(0, 4), "glTF");
  EXPECT_EQ(number_at(4), 2u);
  EXPECT_EQ(number_at(8), text.size());
  std::vector<std::string> chunks;
  size_t offset = 12;
  while (offset < text.size()) {
    const size_t length = number_at(offset);
    EXPECT_EQ(length % 4, 0u);
    EXPECT_EQ(text.substr(offset + 4, 4),
              chunks.empty() ? "JSON" : std::string("BIN\0", 4));
    chunks.push_back(text.substr(offset + 8, length));
    EXPECT_EQ(chunks.back().size(), length);
    offset += 8 + length;
  }
  EXPECT_EQ(offset, text.size());
  chunks.resize(2);
  return {Json::parse(chunks[0]), chunks[1]};
}

// The numbers of an accessor, checked against its view and the buffer.
template <typename T>
std::vector<T> ReadAccessor(const Json& gltf,
                            const std::string& data,
                            const Json& index,
                            int component_type,
                            const std::string& type,
                            int target) {
  const Json& accessor = gltf["accessors"].at(index.get<size_t>());
  EXPECT_EQ(accessor["componentType"], component_type);
  EXPECT_EQ(accessor["type"], type);
  const size_t num_components =
      type == "SCALAR" ? 1 : static_cast<size_t>(type.back() - '0');
  std::vector<T> values(accessor["count"].get<size_t>() * num_components);
  const Json& view =
      gltf["bufferViews"].at(accessor["bufferView"].get<size_t>());
  const size_t offset = view["byteOffset"].get<size_t>();
  EXPECT_EQ(view["buffer"], 0);
  EXPECT_EQ(view["target"], target);
  EXPECT_EQ(view["byteLength"], values.size() * sizeof(T));
  EXPECT_EQ(offset % 4, 0u);
  EXPECT_LE(offset + values.size() * sizeof(T),
            gltf["buffers"][0]["byteLength"].get<size_t>());
  data.copy(reinterpret_cast<char*>(values.data()),
            values.size() * sizeof(T),
            offset);
  if (accessor.contains("min")) {
    for (size_t c = 0; c < num_components; ++c) {
      T low = values[c];
      T high = values[c];
      for (size_t i = c; i < values.size(); i += num_components) {
        low = std::min(low, values[i]);
        high = std::max(high, values[i]);
      }
      EXPECT_EQ(accessor["min"][c].get<T>(), low);
      EXPECT_EQ(accessor["max"][c].get<T>(), high);
    }
  }
  return values;
}

// The level of sRGB of linear light.
int LevelOf(uint16_t linear) {
  const double light = linear / 65535.0;
  return static_cast<int>(
      std::lround(255.0 * (light <= 0.0031308
                               ? 12.92 * light
                               : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055)));
}

TEST(PlanesGlb, HasAMeshForEachPlaneWithYUp) {
  const auto [gltf, data] = ReadGlb(Written(&PutPlanesGlb));
  EXPECT_EQ(gltf["asset"]["version"], "2.0");
  ASSERT_EQ(gltf["buffers"].size(), 1u);
  EXPECT_FALSE(gltf["buffers"][0].contains("uri"));
  EXPECT_LT(data.size() - gltf["buffers"][0]["byteLength"].get<size_t>(), 4u);
  EXPECT_EQ(gltf["scenes"].at(gltf["scene"].get<size_t>())["nodes"],
            Json({0, 1}));
  ASSERT_EQ(gltf["nodes"].size(), 2u);
  ASSERT_EQ(gltf["meshes"].size(), 2u);
  const std::vector<std::string> names = {"plane_0_floor", "plane_2_wall"};
  const std::vector<size_t> num_points = {8, 7};
  std::vector<std::vector<Triangle>> triangles(2);
  for (size_t i = 0; i < 2; ++i) {
    const Json& node = gltf["nodes"][i];
    const Json& mesh = gltf["meshes"].at(node["mesh"].get<size_t>());
    EXPECT_EQ(node["name"], names[i]);
    EXPECT_EQ(mesh["name"], names[i]);
    ASSERT_EQ(mesh["primitives"].size(), 1u);
    const Json& primitive = mesh["primitives"][0];
    EXPECT_LT(primitive["material"].get<size_t>(), gltf["materials"].size());
    const Json& position = primitive["attributes"]["POSITION"];
    EXPECT_TRUE(gltf["accessors"].at(position.get<size_t>()).contains("min"));
    const auto positions =
        ReadAccessor<float>(gltf, data, position, 5126, "VEC3", 34962);
    ASSERT_EQ(positions.size(), 3 * num_points[i]);
    const Json& color = primitive["attributes"]["COLOR_0"];
    EXPECT_EQ(gltf["accessors"].at(color.get<size_t>())["normalized"], true);
    const auto colors =
        ReadAccessor<uint16_t>(gltf, data, color, 5123, "VEC4", 34962);
    ASSERT_EQ(colors.size(), 4 * num_points[i]);
    const Rgb expected = LabelColor(i == 0 ? 0 : 2);
    for (size_t c = 0; c < colors.size(); c += 4) {
      EXPECT_EQ(LevelOf(colors[c]), expected.r);
      EXPECT_EQ(LevelOf(colors[c + 1]), expected.g);
      EXPECT_EQ(LevelOf(colors[c + 2]), expected.b);
      EXPECT_EQ(colors[c + 3], 65535);
    }
    const auto indices = ReadAccessor<uint32_t>(
        gltf, data, primitive["indices"], 5125, "SCALAR", 34963);
    ASSERT_EQ(indices.size() % 3, 0u);
    for (size_t corner = 0; corner < indices.size(); ++corner) {
      ASSERT_LT(indices[corner], num_points[i]);
      if (corner % 3 == 0) {
        triangles[i].emplace_back();
      }
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<size_t>(axis);
        triangles[i].back()[corner % 3][axis] =
            node["translation"][a].get<double>() +
            positions[3 * indices[corner] + a];
      }
    }
  }
  ExpectTriangles(triangles[0], 15.0, {0, 1, 0});
  ExpectTriangles(triangles[1], 3.5, {0, 0, 1});
  // From (1000000, 0.25, 3), with z up.
  EXPECT_NEAR(triangles[0][0][0].y(), 3.0, 1e-9);
  EXPECT_EQ(gltf["nodes"][0]["translation"][0], 1000000.0);
}

// Whatever is up in the model and what was turned before, a file has the
// heading of the one with z up, of which a program makes y up by (x, z, -y).
TEST(PlanesGlb, HasTheHeadingOfTheOtherFormats) {
  for (const Eigen::Vector3d& up :
       {Eigen::Vector3d(0, 0, 1), {0, 1, 0}, {0, -1, 0}, {0.6, -0.48, 0.64}}) {
    ExportedPlanes planes = MakePlanes();
    planes.vertical.up = up;
    planes.planes[0].coordinates.origin = {7, 0.25, 3};
    ExportedPlanes with_z = planes;
    TurnUp(UpAxis::kZ, &with_z);
    ExportedPlanes with_y = planes;
    TurnUp(UpAxis::kY, &with_y);
    for (const size_t i : {size_t{0}, size_t{2}}) {
      const PlaneCoordinates& z = with_z.planes[i].coordinates;
      const PlaneCoordinates& y = with_y.planes[i].coordinates;
      for (const auto& [a, b] : {std::pair(z.origin, y.origin),
                                 std::pair(z.normal, y.normal),
                                 std::pair(z.axis_s, y.axis_s)}) {
        EXPECT_NEAR(
            (b - Eigen::Vector3d(a.x(), a.z(), -a.y())).norm(), 0, 1e-12);
      }
    }
    const std::vector<ExportedPlanes> all = {planes, with_z, with_y};
    for (const ExportedPlanes& turned : all) {
      const Json gltf = ReadGlb(Written(&PutPlanesGlb, turned)).first;
      for (size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(gltf["nodes"][1]["translation"][axis].get<double>(),
                    with_y.planes[2].coordinates.origin[static_cast<int>(axis)],
                    1e-6);
      }
    }
  }
}

TEST(PlanesGlb, LeavesTheAxesWithoutAVertical) {
  ExportedPlanes planes = MakePlanes();
  planes.vertical = {};
  const Json gltf = ReadGlb(Written(&PutPlanesGlb, planes)).first;
  EXPECT_EQ(gltf["nodes"][0]["translation"], Json({1000000.0, 0.25, 3.0}));
}

// Lists may not be empty in glTF, and a buffer has at least one byte.
TEST(PlanesGlb, HasNoListsWithoutPlanes) {
  const auto [gltf, data] = ReadGlb(Written(&PutPlanesGlb, {}));
  EXPECT_EQ(gltf.size(), 1u);
  EXPECT_EQ(gltf["asset"]["version"], "2.0");
  EXPECT_TRUE(data.empty());
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

TEST(TurnUp, TurnsTheVerticalIntoTheAxis) {
  const ExportedPlanes original = MakePlanes();
  ExportedPlanes planes = original;
  TurnUp(UpAxis::kY, &planes);  // From z: by a quarter about -x.
  Eigen::Matrix3d rotation;
  rotation << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  EXPECT_TRUE(planes.from_model.isApprox(rotation));
  EXPECT_TRUE(planes.frames[0].isApprox(rotation));
  EXPECT_EQ(planes.vertical.up, Eigen::Vector3d(0, 1, 0));
  for (size_t i = 0; i < planes.planes.size(); ++i) {
    const PlaneCoordinates& before = original.planes[i].coordinates;
    const PlaneCoordinates& after = planes.planes[i].coordinates;
    EXPECT_TRUE(after.normal.isApprox(rotation * before.normal));
    EXPECT_TRUE(
        after.ToWorld({2, 3}).isApprox(rotation * before.ToWorld({2, 3})));
  }
  planes = original;
  TurnUp(UpAxis::kZ, &planes);
  EXPECT_EQ(Written(&PutPlanesJson, planes), Written(&PutPlanesJson));
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
  for (const std::string& name : PlaneFormatNames()) {
    const std::filesystem::path path = folder.Path() / ("planes." + name);
    const PlaneFormat format = ParsePlaneFormat(name, path.string());
    WritePlanes(UserPath(path), format, {});
    const std::string empty = ReadText(path);
    EXPECT_FALSE(empty.empty());
    WritePlanes(UserPath(path), format, MakePlanes());
    EXPECT_GT(ReadText(path).size(), empty.size());
  }
}

}  // namespace
}  // namespace tsar
