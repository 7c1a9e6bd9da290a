// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/scene_model_file.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/scene_model_fault.h"
#include "colmap_tsar/run/store/state_file.h"

#include <array>
#include <cstddef>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace tsar {
namespace {

static_assert(sizeof(LabelEvidence) == 1);
static_assert(sizeof(LabelQuality) == 4 &&
              std::is_trivially_copyable_v<LabelQuality>);

// Matrices are stored column by column.
struct StoredPlane {
  std::array<double, 3> normal;
  double offset;
  std::array<double, 3> center;
  std::array<double, 3> axis_s;
  std::array<double, 3> axis_t;
  std::array<double, 9> covariance;
  double support;
  int32_t component;
  int32_t frame;
  int32_t axis;
  int32_t unused;
};
static_assert(sizeof(StoredPlane) == 200 &&
              std::is_trivially_copyable_v<StoredPlane>);

using StoredFrame = std::array<double, 9>;

struct StoredCylinder {
  std::array<double, 3> point;
  std::array<double, 3> along;
  std::array<double, 3> across;
  double radius;
  double min_height;
  double max_height;
  std::array<double, 9> covariance;
};
static_assert(sizeof(StoredCylinder) == 168 &&
              std::is_trivially_copyable_v<StoredCylinder>);

struct StoredView {
  int32_t image;
  uint32_t num_labels;
};
static_assert(sizeof(StoredView) == 8 &&
              std::is_trivially_copyable_v<StoredView>);

// The two parts of the file, as arrays of stored elements.
struct PlaneArrays {
  std::vector<StoredPlane> planes;
  std::vector<StoredFrame> frames;
  std::vector<StoredCylinder> cylinders;
};
struct LabelArrays {
  std::vector<StoredView> views;
  std::vector<int32_t> planes;
  std::vector<LabelEvidence> evidence;
  std::vector<LabelQuality> qualities;
};

template <typename Matrix>
auto Stored(const Matrix& matrix) {
  std::array<double, Matrix::SizeAtCompileTime> values;
  Eigen::Map<Matrix>(values.data()) = matrix;
  return values;
}

template <typename Matrix, size_t kSize>
void Load(const std::array<double, kSize>& values, Matrix* matrix) {
  static_assert(Matrix::SizeAtCompileTime == kSize);
  *matrix = Eigen::Map<const Matrix>(values.data());
}

StoredPlane ToStored(const ModelPlane& plane) {
  return {.normal = Stored(plane.plane.normal),
          .offset = plane.plane.offset,
          .center = Stored(plane.center),
          .axis_s = Stored(plane.axis_s),
          .axis_t = Stored(plane.axis_t),
          .covariance = Stored(plane.covariance),
          .support = plane.support,
          .component = plane.component,
          .frame = plane.frame,
          .axis = plane.axis,
          .unused = 0};
}

ModelPlane FromStored(const StoredPlane& stored) {
  ModelPlane plane;
  Load(stored.normal, &plane.plane.normal);
  plane.plane.offset = stored.offset;
  Load(stored.center, &plane.center);
  Load(stored.axis_s, &plane.axis_s);
  Load(stored.axis_t, &plane.axis_t);
  Load(stored.covariance, &plane.covariance);
  plane.support = stored.support;
  plane.component = stored.component;
  plane.frame = stored.frame;
  plane.axis = stored.axis;
  return plane;
}

StoredCylinder ToStored(const ModelCylinder& cylinder) {
  return {.point = Stored(cylinder.point),
          .along = Stored(cylinder.frame.along),
          .across = Stored(cylinder.frame.across),
          .radius = cylinder.radius,
          .min_height = cylinder.min_height,
          .max_height = cylinder.max_height,
          .covariance = Stored(cylinder.covariance)};
}

ModelCylinder FromStored(const StoredCylinder& stored) {
  ModelCylinder cylinder;
  Load(stored.point, &cylinder.point);
  Load(stored.along, &cylinder.frame.along);
  Load(stored.across, &cylinder.frame.across);
  cylinder.radius = stored.radius;
  cylinder.min_height = stored.min_height;
  cylinder.max_height = stored.max_height;
  Load(stored.covariance, &cylinder.covariance);
  return cylinder;
}

PlaneArrays ToPlaneArrays(const SceneModel& model) {
  PlaneArrays arrays;
  for (const ModelPlane& plane : model.planes) {
    arrays.planes.push_back(ToStored(plane));
  }
  for (const Eigen::Matrix3d& frame : model.frames) {
    arrays.frames.push_back(Stored(frame));
  }
  for (const ModelCylinder& cylinder : model.cylinders) {
    arrays.cylinders.push_back(ToStored(cylinder));
  }
  return arrays;
}

LabelArrays ToLabelArrays(const SceneModel& model) {
  LabelArrays arrays;
  for (const auto& [image, view] : model.views) {
    arrays.views.push_back({image, static_cast<uint32_t>(view.planes.size())});
    arrays.planes.insert(
        arrays.planes.end(), view.planes.begin(), view.planes.end());
    arrays.evidence.insert(
        arrays.evidence.end(), view.evidence.begin(), view.evidence.end());
    arrays.qualities.insert(
        arrays.qualities.end(), view.qualities.begin(), view.qualities.end());
  }
  return arrays;
}

// The model without its views.
SceneModel FromPlaneArrays(const PlaneArrays& arrays) {
  SceneModel model;
  for (const StoredPlane& plane : arrays.planes) {
    model.planes.push_back(FromStored(plane));
  }
  for (const StoredFrame& frame : arrays.frames) {
    Load(frame, &model.frames.emplace_back());
  }
  for (const StoredCylinder& cylinder : arrays.cylinders) {
    model.cylinders.push_back(FromStored(cylinder));
  }
  return model;
}

// The views' labels, by image; nothing where they do not match the views, which
// must be unique and in order.
std::optional<std::map<int, ViewLabels>> FromLabelArrays(
    const LabelArrays& arrays) {
  std::map<int, ViewLabels> views;
  size_t begin = 0;
  int64_t previous = -1;
  for (const StoredView& view : arrays.views) {
    if (view.image <= previous ||
        view.num_labels > arrays.planes.size() - begin) {
      return std::nullopt;
    }
    previous = view.image;
    const auto first = static_cast<ptrdiff_t>(begin);
    const auto last = static_cast<ptrdiff_t>(begin + view.num_labels);
    views[view.image] = {
        {arrays.planes.begin() + first, arrays.planes.begin() + last},
        {arrays.evidence.begin() + first, arrays.evidence.begin() + last},
        {arrays.qualities.begin() + first, arrays.qualities.begin() + last}};
    begin += view.num_labels;
  }
  if (begin != arrays.planes.size()) {
    return std::nullopt;
  }
  return views;
}

struct Header {
  StateFileStart start;
  uint64_t num_planes = 0;
  uint64_t num_frames = 0;
  uint64_t num_cylinders = 0;
  uint64_t num_views = 0;
  uint64_t num_labels = 0;  // The sum over all views.
  uint64_t planes_fingerprint = 0;
  uint64_t labels_fingerprint = 0;
  uint64_t header_fingerprint = 0;

  // The sizes in the order of PlaneArrays and LabelArrays.
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

// The arrays for writing and for reading.
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

PlaneArrays ReadPlanes(StateFileReader<Header>* reader) {
  const Header& header = reader->GetHeader();
  PlaneArrays planes;
  planes.planes.resize(header.num_planes);
  planes.frames.resize(header.num_frames);
  planes.cylinders.resize(header.num_cylinders);
  reader->Read(PlaneBytes(planes), header.planes_fingerprint);
  return planes;
}

constexpr StateFileKind kModelFile = {{'T', 'S', 'A', 'R', 'P', 'L', 'A', 'N'},
                                      /*version=*/5,
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
  const PlaneArrays planes = ReadPlanes(&reader);
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

std::optional<uint64_t> ReadScenePlanesFingerprint(
    const std::filesystem::path& path) {
  try {
    StateFileReader<Header> reader(path, kModelFile);
    ReadPlanes(&reader);
    return reader.GetHeader().planes_fingerprint;
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::optional<std::string> ReadSceneModelHash(
    const std::filesystem::path& path) {
  return ReadStateFileHash<Header>(path, kModelFile);
}

}  // namespace tsar
