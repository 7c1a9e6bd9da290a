// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/meshlab_project.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/io/float_map.h"

#include <algorithm>
#include <cstdint>
#include <sstream>
#include <string>

#include <Eigen/LU>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>

namespace tsar {
namespace {

namespace pt = boost::property_tree;

// The XML parser is recursive; this many levels of nesting fit on the stack.
constexpr std::ptrdiff_t kMaxNumTags = 4096;

[[noreturn]] void Corrupt(const std::filesystem::path& path,
                          const std::string& what) {
  throw Error::File(ErrorCode::kCorrupt,
                    path.string(),
                    "not a valid MeshLab project: " + what,
                    "save it anew with MeshLab");
}

pt::ptree ReadXml(const std::filesystem::path& path) {
  const std::vector<uint8_t> bytes = ReadFileBytes(path);
  const std::string text(bytes.begin(), bytes.end());
  if (std::ranges::count(text, '<') > kMaxNumTags) {
    Corrupt(path, "it has too many tags");
  }
  pt::ptree tree;
  std::istringstream content(text);
  try {
    pt::read_xml(content, tree);
  } catch (const pt::xml_parser_error& error) {
    Corrupt(path, error.message());
  }
  return tree;
}

Eigen::Matrix4d ReadMatrix(const std::filesystem::path& path,
                           const std::string& text) {
  std::istringstream numbers(text);
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) {
    if (!(numbers >> matrix(i / 4, i % 4))) {
      Corrupt(path, "a matrix has not 16 numbers");
    }
  }
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const bool is_rigid = matrix.allFinite() &&
                        matrix.row(3) == Eigen::RowVector4d(0, 0, 0, 1) &&
                        (rotation.transpose() * rotation).isIdentity(1e-3) &&
                        rotation.determinant() > 0;
  if (!is_rigid) {
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      "the matrix of a scan is not a rigid motion",
                      "apply scale or shear to the scan's points first");
  }
  return matrix;
}

}  // namespace

std::vector<MeshlabScan> ReadMeshlabProject(const std::filesystem::path& path) {
  const pt::ptree tree = ReadXml(path);
  const auto group = tree.get_child_optional("MeshLabProject.MeshGroup");
  if (!group) {
    Corrupt(path, "it has no MeshLabProject with a MeshGroup");
  }
  std::vector<MeshlabScan> scans;
  for (const auto& [tag, mesh] : *group) {
    if (tag != "MLMesh") {
      continue;
    }
    const auto name = mesh.get_optional<std::string>("<xmlattr>.filename");
    const auto matrix = mesh.get_optional<std::string>("MLMatrix44");
    if (!name || name->empty() || !matrix) {
      Corrupt(path, "a mesh has no file name or no matrix");
    }
    scans.push_back({path.parent_path() / *name, ReadMatrix(path, *matrix)});
  }
  if (scans.empty()) {
    Corrupt(path, "it lists no meshes");
  }
  return scans;
}

}  // namespace tsar
