// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/page_data.h"

#include "colmap_tsar/base/label_color.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/tools/plane_export/plane_mesh.h"
#include "colmap_tsar/tools/report/colors.h"
#include "colmap_tsar/tools/report/page_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

std::optional<double> TiltOf(const Eigen::Vector3d& normal,
                             const Vertical& vertical) {
  if (vertical.source == Vertical::Source::kNone) {
    return std::nullopt;
  }
  const double cosine = normal.dot(vertical.up);
  const double from_level =
      std::atan2(normal.cross(vertical.up).norm(), std::abs(cosine)) * 180.0 /
      std::numbers::pi;
  return std::min(from_level, 90.0 - from_level);
}

// Returns the number of vertices.
int64_t AddMesh(const ExportedPlane& plane,
                const Eigen::Vector3d& origin,
                PointSample* sample) {
  const PlaneMesh mesh = MakePlaneMesh(plane);
  const Rgb color = LabelColor(plane.id);
  for (const auto& triangle : mesh.triangles) {
    for (const int corner : triangle) {
      sample->Add(mesh.points[corner] - origin, color);
    }
  }
  return 3 * static_cast<int64_t>(mesh.triangles.size());
}

using Json = nlohmann::ordered_json;

constexpr int kNumScaleColors = 16;

std::string ColorText(const Rgb& color) {
  char text[8];
  std::snprintf(text, sizeof(text), "#%02x%02x%02x", color.r, color.g, color.b);
  return text;
}

Json ColorTexts(const Image<Rgb>& colors) {
  Json texts = Json::array();
  for (const Rgb& color : colors) {
    texts.push_back(ColorText(color));
  }
  return texts;
}

// Adds the color scales of depth from near to far, and of values from 0 to 1.
void AddScales(Json* json) {
  Image<float> ramp(kNumScaleColors, 1);
  for (int i = 0; i < kNumScaleColors; ++i) {
    ramp(i, 0) = static_cast<float>(i) / (kNumScaleColors - 1);
  }
  (*json)["value_colors"] = ColorTexts(ColorizeValues(ramp, 1.f));
  for (float& value : ramp) {
    value += 1.f;
  }
  (*json)["depth_colors"] = ColorTexts(ColorizeDepth(ramp, {1.f, 2.f}));
  (*json)["provenance"] = Json::array();
  for (const ProvenanceKind& kind : ProvenanceKinds()) {
    (*json)["provenance"].push_back(
        {{"name", kind.name}, {"color", ColorText(kind.color)}});
  }
}

Json ImageJson(const ImagePage& image) {
  return {{"name", image.name},
          {"folder", image.folder},
          {"width", image.width},
          {"height", image.height},
          {"picture_width", image.picture_width},
          {"picture_height", image.picture_height},
          {"nearest", image.range.nearest},
          {"farthest", image.range.farthest},
          {"before", image.num_before},
          {"after", image.num_after},
          {"provenance", image.num_by_provenance},
          {"seconds", image.seconds},
          {"note", image.note},
          {"has_sigma", image.has_sigma},
          {"has_planes", image.has_planes},
          {"has_prior", image.has_prior}};
}

Json ScoreJson(const DepthScore& score) {
  return {{"precision", score.Precision()},
          {"recall", score.Recall()},
          {"f1", score.F1()}};
}

Json ScoreJson(const CloudScore& score) {
  return {{"accuracy", score.accuracy},
          {"completeness", score.completeness},
          {"f1", score.f1}};
}

template <typename Evaluation>
Json GainJson(const Gain<Evaluation>& gain) {
  Json rows = Json::array();
  for (size_t i = 0; i < gain.after.scores.size(); ++i) {
    Json row = {{"tolerance", gain.after.scores[i].tolerance},
                {"before", ScoreJson(gain.before.scores[i])},
                {"after", ScoreJson(gain.after.scores[i])}};
    if constexpr (requires { gain.after.scores[i].area; }) {
      row["area"] = gain.after.scores[i].area;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Json VectorJson(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Json PointsJson(const PointView& points) {
  return {{"from_clouds", points.from_clouds},
          {"before_from_maps", points.before_from_maps},
          {"fused", {points.fused[0], points.fused[1]}},
          {"fusion", points.fusion},
          {"shown", {points.num_shown[0], points.num_shown[1]}},
          {"all", {points.num_all[0], points.num_all[1]}},
          {"eye", VectorJson(points.eye)},
          {"target", points.target ? VectorJson(*points.target) : Json()},
          {"up", VectorJson(points.up)}};
}

Json NumberOrNull(const std::optional<double>& number) {
  return number ? Json(*number) : Json();
}

Json PlaneJson(const PlanePage::Plane& plane) {
  return {{"id", plane.id},
          {"class", ToString(plane.plane_class)},
          {"color", ColorText(LabelColor(plane.id))},
          {"area", plane.area},
          {"tilt", NumberOrNull(plane.tilt)},
          {"images", plane.num_images},
          {"measured", plane.share_measured},
          {"sigma", NumberOrNull(plane.sigma)},
          {"first", plane.first_vertex},
          {"count", plane.num_vertices}};
}

}  // namespace

PlanePage MakePlanePage(const ExportedPlanes& planes,
                        const Eigen::Vector3d& origin) {
  PlanePage page;
  for (const ExportedPlane& exported : planes.planes) {
    PlanePage::Plane plane;
    plane.id = exported.id;
    plane.plane_class = exported.plane_class;
    plane.area = exported.area;
    plane.tilt = TiltOf(exported.coordinates.normal, planes.vertical);
    plane.num_images = static_cast<int64_t>(exported.images.size());
    plane.share_measured = exported.share_measured;
    const double variance = exported.covariance(2, 2);
    if (std::isfinite(variance)) {
      plane.sigma = std::sqrt(variance);
    }
    plane.first_vertex = static_cast<int64_t>(page.mesh.NumPoints());
    plane.num_vertices = AddMesh(exported, origin, &page.mesh);
    page.planes.push_back(plane);
  }
  std::ranges::stable_sort(
      page.planes, std::greater(), &PlanePage::Plane::area);
  return page;
}

std::string PageDataScript(const PageData& data) {
  Json json = {{"version", data.version},
               {"workspace", data.workspace},
               {"type", data.type}};
  AddScales(&json);
  json["images"] = Json::array();
  for (const ImagePage& image : data.images) {
    json["images"].push_back(ImageJson(image));
  }
  json["kept"] = Json::array();
  for (const KeptImage& image : data.kept) {
    json["kept"].push_back({{"name", image.name}, {"reason", image.reason}});
  }
  json["points"] = PointsJson(data.points);
  if (data.planes) {
    json["planes"] = Json::array();
    for (const PlanePage::Plane& plane : data.planes->planes) {
      json["planes"].push_back(PlaneJson(plane));
    }
  }
  json["gains"] = Json::object();
  if (data.gains.depth) {
    json["gains"]["depth"] = GainJson(*data.gains.depth);
  }
  if (data.gains.clouds) {
    json["gains"]["clouds"] = GainJson(*data.gains.clouds);
  }
  return "window.tsarReport = " +
         EscapeScript(
             json.dump(1, ' ', false, Json::error_handler_t::replace)) +
         ";\n";
}

std::string ImageTable(const PageData& data) {
  TextStream table;
  table << "image,pixels,depth_before,depth_after";
  for (const ProvenanceKind& kind : ProvenanceKinds()) {
    table << "," << kind.name;
  }
  table << ",seconds\n";
  for (const ImagePage& image : data.images) {
    table << '"';
    for (const char letter : image.name) {
      table << (letter == '"' ? "\"" : "") << letter;
    }
    table << "\"," << int64_t{image.width} * image.height << ","
          << image.num_before << "," << image.num_after;
    for (const int64_t count : image.num_by_provenance) {
      table << "," << count;
    }
    double seconds = 0.0;
    for (const auto& [stage, value] : image.seconds) {
      seconds += value;
    }
    table << "," << seconds << "\n";
  }
  return table.str();
}

}  // namespace tsar
