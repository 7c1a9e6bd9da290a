// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/store/scene_model_file.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/store/scene_model_check.h"
#include "colmap_tsar/store/scene_model_layout.h"
#include "colmap_tsar/store/state_file.h"
#include "colmap_tsar/workspace/map_paths.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace tsar {
namespace {

struct Header {
  StateFileStart start;
  uint64_t num_planes = 0;
  uint64_t num_frames = 0;
  uint64_t num_cylinders = 0;
  uint64_t num_views = 0;
  uint64_t num_labels = 0;  // Of all views together.
  uint64_t planes_fingerprint = 0;
  uint64_t labels_fingerprint = 0;
  uint64_t header_fingerprint = 0;

  // In the order of PlaneArrays and LabelArrays.
  std::vector<StateFileArray> Arrays() const {
    return {{num_planes, sizeof(StoredPlane)},
            {num_frames, sizeof(StoredFrame)},
            {num_cylinders, sizeof(StoredCylinder)},
            {num_views, sizeof(StoredView)},
            {num_labels, sizeof(int32_t)},
            {num_labels, sizeof(LabelEvidence)},
            {num_labels, sizeof(LabelQuality)}};
  }
};
static_assert(sizeof(Header) == 80);

// For writing and for reading.
template <typename Arrays>
auto PlaneBytes(Arrays& arrays) {
  return std::vector{BytesOf(arrays.planes),
                     BytesOf(arrays.frames),
                     BytesOf(arrays.cylinders)};
}
template <typename Arrays>
auto LabelBytes(Arrays& arrays) {
  return std::vector{BytesOf(arrays.views),
                     BytesOf(arrays.planes),
                     BytesOf(arrays.evidence),
                     BytesOf(arrays.qualities)};
}

Error MissingModel(const std::filesystem::path& path) {
  return Error::File(ErrorCode::kNotFound,
                     path.string(),
                     "there are no planes of the scene",
                     "run tsar_refine on this workspace first");
}

Error CorruptModel(const std::filesystem::path& path, const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     path.string(),
                     "not a usable file of planes: " + what,
                     "delete it and run tsar_refine again");
}

constexpr StateFileKind kModelFile = {{'T', 'S', 'A', 'R', 'P', 'L', 'A', 'N'},
                                      /*version=*/4,
                                      &MissingModel,
                                      &CorruptModel};

}  // namespace

ContainedPath GetSceneModelPath(const std::filesystem::path& root) {
  return GetTsarFolder(root) / "planes.bin";
}

void WriteSceneModel(const ContainedPath& path,
                     const std::string& options_hash,
                     const SceneModel& model,
                     SceneModelParts parts) {
  RequireNoFault(path, FindSceneModelFault(model));
  const PlaneArrays planes = ToPlaneArrays(model);
  const LabelArrays labels =
      parts == SceneModelParts::kAll ? ToLabelArrays(model) : LabelArrays();
  Header header;
  header.num_planes = planes.planes.size();
  header.num_frames = planes.frames.size();
  header.num_cylinders = planes.cylinders.size();
  header.num_views = labels.views.size();
  header.num_labels = labels.planes.size();
  const ReadableArrays plane_bytes = PlaneBytes(planes);
  const ReadableArrays label_bytes = LabelBytes(labels);
  header.planes_fingerprint = FingerprintOfArrays(plane_bytes);
  header.labels_fingerprint = FingerprintOfArrays(label_bytes);
  WriteStateFile(
      path, kModelFile, header, options_hash, {plane_bytes, label_bytes});
}

SceneModel ReadSceneModel(const std::filesystem::path& path,
                          SceneModelParts parts) {
  StateFileReader<Header> reader(path, kModelFile);
  const Header& header = reader.GetHeader();
  PlaneArrays planes;
  planes.planes.resize(header.num_planes);
  planes.frames.resize(header.num_frames);
  planes.cylinders.resize(header.num_cylinders);
  reader.Read(PlaneBytes(planes), header.planes_fingerprint);
  SceneModel model = FromPlaneArrays(planes);
  if (parts == SceneModelParts::kAll) {
    LabelArrays labels;
    labels.views.resize(header.num_views);
    labels.planes.resize(header.num_labels);
    labels.evidence.resize(header.num_labels);
    labels.qualities.resize(header.num_labels);
    reader.Read(LabelBytes(labels), header.labels_fingerprint);
    auto views = FromLabelArrays(labels);
    if (!views) {
      throw CorruptModel(path, "it has labels that are not those of its views");
    }
    model.views = std::move(*views);
  }
  if (const auto fault = FindSceneModelFault(model)) {
    throw CorruptModel(path, "it has " + *fault);
  }
  return model;
}

std::optional<std::string> ReadSceneModelHash(
    const std::filesystem::path& path) {
  return ReadStateFileHash<Header>(path, kModelFile);
}

}  // namespace tsar
