// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/label_color.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"
#include "colmap_tsar/tools/plane_export/plane_mesh.h"
#include "colmap_tsar/tools/plane_export/write_planes.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little);

// Constants of glTF 2.0.
constexpr uint32_t kMagic = 0x46546C67;  // "glTF"
constexpr uint32_t kVersion = 2;
constexpr uint32_t kJsonChunk = 0x4E4F534A;    // "JSON"
constexpr uint32_t kBinaryChunk = 0x004E4942;  // "BIN"
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;
constexpr int kVertices = 34962;  // Targets of buffer views.
constexpr int kIndices = 34963;

template <typename T>
void Append(const T& value, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(T));
}

void AppendChunk(uint32_t type,
                 char padding,
                 std::string content,
                 std::string* bytes) {
  content.append((4 - content.size() % 4) % 4, padding);
  Append(static_cast<uint32_t>(content.size()), bytes);
  Append(type, bytes);
  *bytes += content;
}

// glTF wants linear light; 16 bits tell all levels of sRGB apart.
std::array<uint16_t, 4> LinearColor(const Rgb& color) {
  const auto linear = [](uint8_t level) {
    const double value = level / 255.0;
    const double light = value <= 0.04045
                             ? value / 12.92
                             : std::pow((value + 0.055) / 1.055, 2.4);
    return static_cast<uint16_t>(std::lround(65535.0 * light));
  };
  return {linear(color.r), linear(color.g), linear(color.b), 65535};
}

// Collects meshes and their data.
class GlbWriter {
 public:
  void AddPlane(const ExportedPlane& plane) {
    const PlaneMesh mesh = MakePlaneMesh(plane);
    if (mesh.triangles.empty()) {
      return;
    }
    const std::string name =
        "plane_" + std::to_string(plane.id) + "_" + ToString(plane.plane_class);
    // Numbers of 32 bits are exact near the plane alone.
    const Eigen::Vector3d& origin = plane.coordinates.origin;
    Json primitive;
    primitive["attributes"]["POSITION"] = AddPositions(mesh, origin);
    primitive["attributes"]["COLOR_0"] = AddColors(mesh, LabelColor(plane.id));
    primitive["indices"] = AddIndices(mesh);
    primitive["material"] = 0;
    json_["nodes"].push_back(
        {{"name", name},
         {"mesh", json_["meshes"].size()},
         {"translation", {origin.x(), origin.y(), origin.z()}}});
    json_["meshes"].push_back(
        {{"name", name}, {"primitives", Json::array({primitive})}});
  }

  void Put(std::ostream* out) {
    Json json;
    json["asset"] = {{"version", "2.0"}, {"generator", "tsar_planes"}};
    std::string chunks;
    if (!data_.empty()) {
      Json nodes = Json::array();
      for (size_t i = 0; i < json_["nodes"].size(); ++i) {
        nodes.push_back(i);
      }
      json["scene"] = 0;
      json["scenes"] = Json::array({{{"nodes", nodes}}});
      json["materials"] = Json::array(
          {{{"pbrMetallicRoughness",
             {{"metallicFactor", 0.0}, {"roughnessFactor", 1.0}}}}});
      json["buffers"] = Json::array({{{"byteLength", data_.size()}}});
      json.update(json_);
    }
    AppendChunk(kJsonChunk, ' ', json.dump(), &chunks);
    if (!data_.empty()) {
      AppendChunk(kBinaryChunk, '\0', data_, &chunks);
    }
    std::string header;
    Append(kMagic, &header);
    Append(kVersion, &header);
    Append(static_cast<uint32_t>(12 + chunks.size()), &header);
    *out << header << chunks;
  }

 private:
  // Each of these appends data and returns the index of its accessor.
  size_t AddPositions(const PlaneMesh& mesh, const Eigen::Vector3d& origin) {
    Eigen::Array3f low = Eigen::Array3f::Constant(INFINITY);
    Eigen::Array3f high = -low;
    const size_t begin = data_.size();
    for (const Eigen::Vector3d& point : mesh.points) {
      const Eigen::Array3f position = (point - origin).cast<float>().array();
      low = low.min(position);
      high = high.max(position);
      for (const float value : position) {
        Append(value, &data_);
      }
    }
    const size_t accessor =
        AddAccessor(begin, kVertices, kFloat, "VEC3", mesh.points.size());
    json_["accessors"][accessor]["min"] = {low[0], low[1], low[2]};
    json_["accessors"][accessor]["max"] = {high[0], high[1], high[2]};
    return accessor;
  }

  size_t AddColors(const PlaneMesh& mesh, const Rgb& color) {
    const size_t begin = data_.size();
    for (size_t i = 0; i < mesh.points.size(); ++i) {
      Append(LinearColor(color), &data_);
    }
    const size_t accessor = AddAccessor(
        begin, kVertices, kUnsignedShort, "VEC4", mesh.points.size());
    json_["accessors"][accessor]["normalized"] = true;
    return accessor;
  }

  size_t AddIndices(const PlaneMesh& mesh) {
    const size_t begin = data_.size();
    for (const auto& triangle : mesh.triangles) {
      for (const int corner : triangle) {
        Append(static_cast<uint32_t>(corner), &data_);
      }
    }
    return AddAccessor(
        begin, kIndices, kUnsignedInt, "SCALAR", 3 * mesh.triangles.size());
  }

  // Of the data from `begin` to the end.
  size_t AddAccessor(size_t begin,
                     int target,
                     int component_type,
                     const char* type,
                     size_t count) {
    json_["bufferViews"].push_back({{"buffer", 0},
                                    {"byteOffset", begin},
                                    {"byteLength", data_.size() - begin},
                                    {"target", target}});
    json_["accessors"].push_back({{"bufferView", json_["accessors"].size()},
                                  {"componentType", component_type},
                                  {"count", count},
                                  {"type", type}});
    return json_["accessors"].size() - 1;
  }

  // Lists of glTF; each accessor has a buffer view.
  Json json_ = {{"nodes", Json::array()},
                {"meshes", Json::array()},
                {"accessors", Json::array()},
                {"bufferViews", Json::array()}};
  std::string data_;
};

}  // namespace

void PutPlanesGlb(const ExportedPlanes& planes, std::ostream* out) {
  ExportedPlanes turned = planes;
  if (planes.vertical.source != Vertical::Source::kNone) {
    TurnUp(UpAxis::kY, &turned);
  }
  GlbWriter writer;
  for (const ExportedPlane& plane : turned.planes) {
    writer.AddPlane(plane);
  }
  writer.Put(out);
}

}  // namespace tsar
