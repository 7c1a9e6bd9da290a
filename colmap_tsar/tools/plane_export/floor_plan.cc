// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/floor_plan.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/parse_number.h"
#include "colmap_tsar/tools/plane_export/write_planes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

namespace tsar {
namespace {

// A vertical is z here.
FloorPlan::Wall MakeWall(const ExportedPlane& plane) {
  const Eigen::Vector3d& normal = plane.coordinates.normal;
  const Eigen::Vector2d along =
      Eigen::Vector2d(-normal.y(), normal.x()).normalized();
  const Eigen::Vector2d origin = plane.coordinates.origin.head<2>();
  std::vector<std::pair<double, double>> ranges;
  for (const PlanePolygon& polygon : plane.polygons) {
    auto& [low, high] = ranges.emplace_back(INFINITY, -INFINITY);
    for (const Eigen::Vector2d& point : polygon.outline) {
      const double place =
          along.dot(plane.coordinates.ToWorld(point).head<2>() - origin);
      low = std::min(low, place);
      high = std::max(high, place);
    }
  }
  std::ranges::sort(ranges);
  FloorPlan::Wall wall;
  wall.id = plane.id;
  double end = -INFINITY;
  for (const auto& [low, high] : ranges) {
    if (low > end) {
      wall.segments.push_back({origin + low * along, origin + high * along});
      end = high;
    } else if (high > end) {
      wall.segments.back()[1] = origin + high * along;
      end = high;
    }
  }
  return wall;
}

Eigen::AlignedBox2d BoundsOf(const FloorPlan& plan) {
  Eigen::AlignedBox2d bounds;
  for (const FloorPlan::Wall& wall : plan.walls) {
    for (const auto& segment : wall.segments) {
      bounds.extend(segment[0]);
      bounds.extend(segment[1]);
    }
  }
  return bounds;
}

// The largest of 1, 2 and 5 times a power of ten that is at most this.
double RoundLength(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  const double digits = length / power;
  return (digits >= 5.0 ? 5.0 : digits >= 2.0 ? 2.0 : 1.0) * power;
}

void PutLine(const Eigen::Vector2d& from,
             const Eigen::Vector2d& to,
             std::ostream* out) {
  *out << "<line x1=\"" << NumberText(from.x()) << "\" y1=\""
       << NumberText(from.y()) << "\" x2=\"" << NumberText(to.x()) << "\" y2=\""
       << NumberText(to.y()) << "\"/>\n";
}

}  // namespace

FloorPlan MakeFloorPlan(const ExportedPlanes& planes) {
  if (planes.vertical.source == Vertical::Source::kNone) {
    throw Error(ErrorCode::kUnsupported,
                OptionName("plan_path") +
                    ": the cameras look all ways, so that nothing tells what "
                    "is up and which planes are walls; leave the option out");
  }
  ExportedPlanes turned = planes;
  TurnUp(UpAxis::kZ, &turned);
  FloorPlan plan;
  plan.in_meters = planes.in_meters;
  for (const ExportedPlane& plane : turned.planes) {
    if (plane.plane_class != PlaneClass::kWall || plane.polygons.empty()) {
      continue;
    }
    if (std::abs(plane.coordinates.normal.z()) >
        std::sin(kMaxLean * std::numbers::pi / 180.0)) {
      ++plan.num_leaning;
    } else {
      plan.walls.push_back(MakeWall(plane));
    }
  }
  if (plan.walls.empty()) {
    throw Error(ErrorCode::kNotFound,
                OptionName("plan_path") + ": no plane is a wall (within " +
                    NumberText(kMaxLean) +
                    " degrees of the vertical, and seen enough for an "
                    "outline); leave the option out, or give a smaller " +
                    OptionName("min_area"));
  }
  return plan;
}

void PutPlanSvg(const FloorPlan& plan, std::ostream* out) {
  const Eigen::AlignedBox2d bounds = BoundsOf(plan);
  // The picture has y down, and begins at 0: viewers have single precision.
  const Eigen::Vector2d corner(bounds.min().x(), bounds.max().y());
  const auto in_picture = [&](const Eigen::Vector2d& point) {
    return Eigen::Vector2d(point.x() - corner.x(), corner.y() - point.y());
  };
  const Eigen::Vector2d size = bounds.sizes();
  const double side = size.maxCoeff();
  const double margin = 0.08 * side;
  const std::string unit = plan.in_meters ? "m" : "units";
  const double bar = RoundLength(0.3 * side);
  // The bar lies below the walls.
  const Eigen::Vector2d bar_begin(0.0, size.y() + margin);
  *out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
       << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\""
       << NumberText(-margin) << " " << NumberText(-margin) << " "
       << NumberText(std::max(size.x(), 0.6 * side) + 2 * margin) << " "
       << NumberText(size.y() + 3 * margin) << "\">\n"
       << "<title>Walls from above, by tsar_planes</title>\n"
       << "<desc>(0, 0) is x = " << NumberText(corner.x())
       << ", y = " << NumberText(corner.y()) << " with z up</desc>\n"
       << "<g id=\"walls\" stroke=\"black\" stroke-linecap=\"round\" "
          "stroke-width=\""
       << NumberText(0.006 * side) << "\">\n";
  for (const FloorPlan::Wall& wall : plan.walls) {
    *out << "<g id=\"plane_" << wall.id << "\">\n";
    for (const auto& [from, to] : wall.segments) {
      PutLine(in_picture(from), in_picture(to), out);
    }
    *out << "</g>\n";
  }
  *out << "</g>\n<g id=\"scale\" stroke=\"black\" stroke-width=\""
       << NumberText(0.003 * side) << "\">\n";
  PutLine(bar_begin, bar_begin + Eigen::Vector2d(bar, 0.0), out);
  *out << "</g>\n<text x=\"" << NumberText(bar + 0.02 * side) << "\" y=\""
       << NumberText(bar_begin.y() + 0.01 * side)
       << "\" font-family=\"sans-serif\" font-size=\""
       << NumberText(0.04 * side) << "\">" << NumberText(bar) << " " << unit
       << "</text>\n</svg>\n";
}

void PutPlanDxf(const FloorPlan& plan, std::ostream* out) {
  DxfWriter dxf(plan.in_meters, out);
  for (const FloorPlan::Wall& wall : plan.walls) {
    for (const auto& [from, to] : wall.segments) {
      dxf.Put(0, "LINE");
      dxf.Put(8, DxfWriter::LayerName(PlaneClass::kWall));
      dxf.PutPoint(10, {from.x(), from.y(), 0.0});
      dxf.PutPoint(11, {to.x(), to.y(), 0.0});
    }
  }
  dxf.Finish();
}

PlanWriter PlanWriterFor(const std::filesystem::path& path) {
  return WriterFor<PlanWriter>(
      path, "plan_path", {{".svg", &PutPlanSvg}, {".dxf", &PutPlanDxf}});
}

}  // namespace tsar
