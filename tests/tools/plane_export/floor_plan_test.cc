// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/floor_plan.h"

#include "colmap_tsar/tools/plane_export/export_planes.h"

#include <cmath>
#include <numbers>
#include <regex>
#include <sstream>
#include <vector>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

// A wall at y = -2 that runs along x, with z up.
ExportedPlane MakeWall(int id) {
  ExportedPlane wall;
  wall.id = id;
  wall.plane_class = PlaneClass::kWall;
  wall.coordinates = {{100, -2, 5}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
  wall.polygons = {{{{0, 0}, {3, 0}, {3, 1}, {0, 1}}, {}}};
  return wall;
}

// The wall leans by an angle.
void Lean(double degrees, ExportedPlane* wall) {
  const double angle = degrees * std::numbers::pi / 180.0;
  wall->coordinates.axis_t = {0, std::sin(angle), std::cos(angle)};
  wall->coordinates.normal =
      wall->coordinates.axis_s.cross(wall->coordinates.axis_t);
}

ExportedPlanes MakePlanes(const std::vector<ExportedPlane>& list) {
  ExportedPlanes planes;
  planes.vertical = {{0, 0, 1}, Vertical::Source::kFrame};
  planes.planes = list;
  return planes;
}

// The numbers of the attributes of the lines of a picture.
std::vector<std::vector<double>> LinesOf(const std::string& svg) {
  const std::regex line(
      "<line x1=\"([^\"]*)\" y1=\"([^\"]*)\" x2=\"([^\"]*)\" "
      "y2=\"([^\"]*)\"/>");
  std::vector<std::vector<double>> lines;
  for (std::sregex_iterator match(svg.begin(), svg.end(), line), end;
       match != end;
       ++match) {
    auto& numbers = lines.emplace_back();
    for (size_t i = 1; i <= 4; ++i) {
      numbers.push_back(std::stod((*match)[i]));
    }
  }
  return lines;
}

std::string Written(PlanWriter put, const FloorPlan& plan) {
  std::ostringstream out;
  put(plan, &out);
  return out.str();
}

TEST(FloorPlan, HasTheExtentOfEachPartOfAWall) {
  ExportedPlane wall = MakeWall(7);
  // Behind a gap; and one that overlaps the first one in the plan.
  wall.polygons.push_back({{{9, 0}, {10, 0}, {10, 1}}, {}});
  wall.polygons.push_back({{{2, 2}, {5, 2}, {5, 3}}, {}});
  ExportedPlanes planes = MakePlanes({wall});
  TurnUp(UpAxis::kY, &planes);  // Whatever is up.
  const FloorPlan plan = MakeFloorPlan(planes);
  ASSERT_EQ(plan.walls.size(), 1u);
  EXPECT_EQ(plan.walls[0].id, 7);
  EXPECT_FALSE(plan.in_meters);
  ASSERT_EQ(plan.walls[0].segments.size(), 2u);
  const auto& [begin, end] = plan.walls[0].segments[0];
  EXPECT_TRUE(begin.isApprox(Eigen::Vector2d(100, -2)));
  EXPECT_TRUE(end.isApprox(Eigen::Vector2d(105, -2)));
  const auto& [begin_behind, end_behind] = plan.walls[0].segments[1];
  EXPECT_TRUE(begin_behind.isApprox(Eigen::Vector2d(109, -2)));
  EXPECT_TRUE(end_behind.isApprox(Eigen::Vector2d(110, -2)));
}

TEST(FloorPlan, HasNoPlanesThatLean) {
  ExportedPlane straight = MakeWall(0);
  Lean(4.9, &straight);
  ExportedPlane leaning = MakeWall(1);
  Lean(-5.1, &leaning);
  ExportedPlane unseen = MakeWall(2);
  unseen.polygons.clear();
  ExportedPlane other = MakeWall(3);
  other.plane_class = PlaneClass::kOther;
  ExportedPlanes planes = MakePlanes({straight, leaning, unseen, other});
  const FloorPlan plan = MakeFloorPlan(planes);
  ASSERT_EQ(plan.walls.size(), 1u);
  EXPECT_EQ(plan.walls[0].id, 0);
  EXPECT_EQ(plan.num_leaning, 1);
  planes.planes.erase(planes.planes.begin());
  ExpectError(ErrorCode::kNotFound,
              {"plan_path", "no plane is a wall (within 5 degrees"},
              [&] { MakeFloorPlan(planes); });
  planes.vertical = {};
  ExpectError(ErrorCode::kUnsupported,
              {"plan_path", "nothing tells what is up"},
              [&] { MakeFloorPlan(planes); });
}

TEST(FloorPlan, IsAPictureWithAScaleBar) {
  ExportedPlane side = MakeWall(1);
  side.coordinates = {{100, -2, 5}, {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}};
  ExportedPlanes planes = MakePlanes({MakeWall(0), side});
  const std::string svg = Written(&PutPlanSvg, MakeFloorPlan(planes));
  // Both walls are 3 long and meet at (100, -2), the top left corner: y is down
  // in pictures.
  const auto lines = LinesOf(svg);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0], (std::vector<double>{0, 0, 3, 0}));
  EXPECT_EQ(lines[1], (std::vector<double>{0, 0, 0, 3}));
  EXPECT_NEAR(lines[2][2] - lines[2][0], 0.5, 1e-12);
  EXPECT_THAT(svg, testing::HasSubstr("x = 100, y = -2 "));
  EXPECT_THAT(svg, testing::HasSubstr("<g id=\"plane_1\">"));
  EXPECT_THAT(svg, testing::HasSubstr(">0.5 units</text>"));
  ScaleToMeters(20.0, &planes);
  const std::string meters = Written(&PutPlanSvg, MakeFloorPlan(planes));
  EXPECT_THAT(meters, testing::HasSubstr(">10 m</text>"));
  EXPECT_NEAR(LinesOf(meters)[2][2], 10.0, 1e-9);
}

TEST(FloorPlan, IsADrawingForCad) {
  ExportedPlanes planes = MakePlanes({MakeWall(0)});
  ScaleToMeters(2.0, &planes);
  const std::string dxf = Written(&PutPlanDxf, MakeFloorPlan(planes));
  EXPECT_THAT(dxf, testing::HasSubstr("$INSUNITS\n 70\n6\n"));
  EXPECT_THAT(dxf,
              testing::EndsWith("ENTITIES\n  0\nLINE\n  8\nWALL\n"
                                " 10\n200\n 20\n-4\n 30\n0\n"
                                " 11\n206\n 21\n-4\n 31\n0\n"
                                "  0\nENDSEC\n  0\nEOF\n"));
}

TEST(PlanWriter, IsReadFromTheName) {
  EXPECT_EQ(PlanWriterFor("a/plan.SVG"), &PutPlanSvg);
  EXPECT_EQ(PlanWriterFor("plan.dxf"), &PutPlanDxf);
  ExpectError(ErrorCode::kBadOption,
              {"plan_path", "plan.png", ".svg or .dxf"},
              [] { PlanWriterFor("plan.png"); });
}

}  // namespace
}  // namespace tsar
