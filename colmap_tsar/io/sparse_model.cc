// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/sparse_model.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/io/sparse_model_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>

#include <Eigen/Geometry>

namespace tsar {
namespace {

Error CorruptModel(const std::filesystem::path& path, const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     path.string(),
                     what,
                     "copy or make the sparse model again");
}

Camera MakeCamera(const SparseModelFiles& files, uint32_t id) {
  const SparseModelFiles::FileCamera& in = files.cameras.at(id);
  const bool has_two_focals = in.params.size() == 4;
  Camera camera;
  camera.fx = in.params[0];
  camera.fy = in.params[has_two_focals ? 1 : 0];
  camera.cx = in.params[in.params.size() - 2];
  camera.cy = in.params[in.params.size() - 1];
  const std::string name = "camera " + std::to_string(id);
  constexpr uint64_t kMaxSize = uint64_t{1} << 24;
  if (in.width < 1 || in.height < 1 || in.width > kMaxSize ||
      in.height > kMaxSize) {
    throw CorruptModel(files.cameras_path,
                       name + " has an impossible image size");
  }
  if (!(camera.fx > 0.0 && camera.fy > 0.0 && std::isfinite(camera.fx) &&
        std::isfinite(camera.fy))) {
    throw CorruptModel(files.cameras_path,
                       name + " has a focal length that is not positive");
  }
  // The least focal length relative to the size, that of a field of view of 179
  // degrees.
  constexpr double kMinFocalLength = 0.01;
  const double least =
      kMinFocalLength * static_cast<double>(std::max(in.width, in.height));
  if (camera.fx < least || camera.fy < least) {
    throw CorruptModel(
        files.cameras_path,
        name +
            " has a focal length below a hundredth of the image's longer side");
  }
  if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy)) {
    throw CorruptModel(files.cameras_path,
                       name + " has a principal point that is not a number");
  }
  camera.width = static_cast<int>(in.width);
  camera.height = static_cast<int>(in.height);
  return camera;
}

SparseModel::ModelImage MakeImage(const SparseModelFiles& files,
                                  const SparseModelFiles::FileImage& in) {
  const std::string name = "image " + std::to_string(in.id);
  if (in.name.empty() || HasControlCharacter(in.name)) {
    throw CorruptModel(files.images_path, name + " has no usable name");
  }
  if (!files.cameras.contains(in.camera_id)) {
    throw CorruptModel(files.images_path,
                       name + " has camera " + std::to_string(in.camera_id) +
                           ", which does not exist");
  }
  SparseModel::ModelImage image;
  image.name = in.name;
  image.place_in_file = in.place;
  image.camera = MakeCamera(files, in.camera_id);
  const Eigen::Quaterniond rotation(
      in.quaternion[0], in.quaternion[1], in.quaternion[2], in.quaternion[3]);
  const double norm = rotation.norm();
  image.camera.translation = Eigen::Vector3d(in.translation);
  if (!(norm > 0.0) || !std::isfinite(norm) ||
      !image.camera.translation.allFinite()) {
    throw CorruptModel(files.images_path,
                       name + " (" + in.name + ") has no valid pose");
  }
  image.camera.rotation = rotation.normalized().toRotationMatrix();
  return image;
}

template <typename T>
void SortById(const std::filesystem::path& path,
              const char* kind,
              std::vector<T>* items) {
  std::sort(items->begin(), items->end(), [](const T& a, const T& b) {
    return a.id < b.id;
  });
  for (size_t i = 1; i < items->size(); ++i) {
    if ((*items)[i - 1].id == (*items)[i].id) {
      throw CorruptModel(path,
                         std::string(kind) + " " +
                             std::to_string((*items)[i].id) +
                             " is there more than once");
    }
  }
}

void AddImages(SparseModelFiles* files, SparseModel* model) {
  for (size_t i = 0; i < files->images.size(); ++i) {
    files->images[i].place = static_cast<int>(i);
  }
  SortById(files->images_path, "image", &files->images);
  model->images.reserve(files->images.size());
  for (const SparseModelFiles::FileImage& image : files->images) {
    model->images.push_back(MakeImage(*files, image));
  }
  model->IndexNames();
  for (size_t i = 0; i < model->images.size(); ++i) {
    if (model->IndexOf(model->images[i].name) != static_cast<int>(i)) {
      throw CorruptModel(
          files->images_path,
          "the name " + model->images[i].name + " is there more than once");
    }
  }
  // "./a.png" and "a.png" are different names of the same maps.
  std::unordered_set<std::string> paths;
  for (const SparseModel::ModelImage& image : model->images) {
    const std::filesystem::path path(image.name);
    if (!paths.insert(path.lexically_normal().string()).second) {
      throw CorruptModel(files->images_path,
                         "the name " + image.name +
                             " stands for the same file as another one");
    }
  }
}

void AddPoints(SparseModelFiles* files, SparseModel* model) {
  SortById(files->points_path, "point", &files->points);
  std::unordered_map<uint32_t, int> index_of_id;
  for (size_t i = 0; i < files->images.size(); ++i) {
    index_of_id.emplace(files->images[i].id, static_cast<int>(i));
  }
  model->points.reserve(files->points.size());
  for (const SparseModelFiles::FilePoint& point : files->points) {
    if (!point.position.allFinite()) {
      throw CorruptModel(files->points_path,
                         "point " + std::to_string(point.id) +
                             " has a position that is not a number");
    }
    const int index = static_cast<int>(model->points.size());
    model->points.push_back(point.position);
    for (size_t i = point.track_begin; i < point.track_end; ++i) {
      const auto image = index_of_id.find(files->track_image_ids[i]);
      if (image == index_of_id.end()) {
        throw CorruptModel(files->points_path,
                           "point " + std::to_string(point.id) +
                               " is seen by image " +
                               std::to_string(files->track_image_ids[i]) +
                               ", which does not exist");
      }
      model->images[static_cast<size_t>(image->second)].point_indices.push_back(
          index);
    }
  }
}

}  // namespace

int NumCameraParams(const std::filesystem::path& path,
                    const std::string& model) {
  if (model == "PINHOLE") {
    return 4;
  }
  if (model == "SIMPLE_PINHOLE") {
    return 3;
  }
  // image_undistorter does not undistort these.
  if (model == "EQUIRECTANGULAR") {
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      "a camera sees all directions (model " + model + ")",
                      "render perspective images from the panoramas and "
                      "reconstruct with those");
  }
  throw Error::File(ErrorCode::kUnsupported,
                    path.string(),
                    "a camera has lens distortion (model " + model + ")",
                    "undistort first with image_undistorter");
}

void RequireOpened(const std::filesystem::path& path, const InputFile& file) {
  if (!file) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "cannot be read (" + file.Reason() + ")",
                      "check that it is a file and that you may read it");
  }
}

void AddCamera(uint32_t id,
               SparseModelFiles::FileCamera camera,
               SparseModelFiles* files) {
  if (!files->cameras.emplace(id, std::move(camera)).second) {
    throw CorruptModel(
        files->cameras_path,
        "camera " + std::to_string(id) + " is there more than once");
  }
}

const SparseModel::ModelImage* SparseModel::Find(
    const std::string& name) const {
  const int index = IndexOf(name);
  return index < 0 ? nullptr : &images[static_cast<size_t>(index)];
}

int SparseModel::IndexOf(const std::string& name) const {
  const auto entry = index_of_name_.find(name);
  return entry == index_of_name_.end() ? -1 : entry->second;
}

void SparseModel::IndexNames() {
  index_of_name_.clear();
  for (size_t i = 0; i < images.size(); ++i) {
    index_of_name_.emplace(images[i].name, static_cast<int>(i));
  }
}

std::array<std::filesystem::path, 3> FindSparseModelFiles(
    const std::filesystem::path& sparse_folder) {
  for (const std::string extension : {".bin", ".txt"}) {
    const std::array<std::filesystem::path, 3> paths = {
        sparse_folder / ("cameras" + extension),
        sparse_folder / ("images" + extension),
        sparse_folder / ("points3D" + extension)};
    if (std::all_of(paths.begin(), paths.end(), &Exists)) {
      return paths;
    }
  }
  throw Error::File(
      ErrorCode::kNotFound,
      sparse_folder.string(),
      "no sparse model: neither cameras, images and points3D .bin "
      "nor .txt are all there",
      "make the workspace with image_undistorter");
}

SparseModel ReadSparseModel(const std::filesystem::path& sparse_folder) {
  SparseModelFiles files;
  const auto paths = FindSparseModelFiles(sparse_folder);
  files.cameras_path = paths[0];
  files.images_path = paths[1];
  files.points_path = paths[2];
  if (paths[0].extension() == ".bin") {
    ReadSparseModelBinary(&files);
  } else {
    ReadSparseModelText(&files);
  }
  SparseModel model;
  AddImages(&files, &model);
  AddPoints(&files, &model);
  return model;
}

}  // namespace tsar
