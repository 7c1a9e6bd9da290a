// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/sparse_model.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/median.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/io/sparse_model_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <unordered_set>

#include <Eigen/Geometry>

namespace tsar {
namespace {

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
  image.index_in_file = in.index_in_file;
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
  std::ranges::sort(*items, {}, &T::id);
  const auto twice = std::ranges::adjacent_find(*items, {}, &T::id);
  if (twice != items->end()) {
    throw CorruptModel(path,
                       std::string(kind) + " " + std::to_string(twice->id) +
                           " is there more than once");
  }
}

void AddImages(SparseModelFiles* files, SparseModel* model) {
  for (size_t i = 0; i < files->images.size(); ++i) {
    files->images[i].index_in_file = static_cast<int>(i);
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
      model->images[image->second].point_indices.push_back(index);
    }
  }
}

std::vector<std::string> MissingFiles(const std::filesystem::path& folder,
                                      const std::string& extension) {
  std::vector<std::string> missing;
  for (const char* name : {"cameras", "images", "points3D"}) {
    if (!Exists(folder / (name + extension))) {
      missing.push_back(name + extension);
    }
  }
  return missing;
}

std::string Joined(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) {
    joined += (joined.empty() ? "" : ", ") + name;
  }
  return joined;
}

// Throws if only some files of a model exist: another folder's model may be a
// different one.
bool HoldsModel(const std::filesystem::path& folder) {
  const std::vector<std::string> binary = MissingFiles(folder, ".bin");
  const std::vector<std::string> text = MissingFiles(folder, ".txt");
  if (binary.empty() || text.empty()) {
    return true;
  }
  const std::vector<std::string>& fewer =
      text.size() < binary.size() ? text : binary;
  if (fewer.size() == 3) {
    return false;
  }
  throw Error::File(ErrorCode::kNotFound,
                    folder.string(),
                    "the sparse model is not complete: " + Joined(fewer) +
                        (fewer.size() == 1 ? " is" : " are") + " missing",
                    "copy it again, or make the workspace with "
                    "image_undistorter");
}

// Every path of an image is derived from its name, so a name must not leave the
// workspace.
void RequireSafeName(const std::filesystem::path& folder,
                     const std::string& name) {
  const std::filesystem::path path(name);
  if (path.is_absolute() ||
      std::find(path.begin(), path.end(), "..") != path.end()) {
    throw Error::File(ErrorCode::kUnsupported,
                      folder.string(),
                      "the image name " + name + " leads out of the workspace",
                      "rename the image and make the workspace again");
  }
}

// The coordinates of a point at the median depth of those that the image sees,
// rounded to single precision, in pixels.
double RoundingPixels(const SparseModel& model,
                      const SparseModel::ModelImage& image) {
  const Camera& camera = image.camera;
  const Eigen::Vector3d axis = camera.rotation.row(2).transpose();
  std::vector<double> depths;
  for (const int point : image.point_indices) {
    depths.push_back(axis.dot(model.points[point]) + camera.translation.z());
  }
  if (depths.empty()) {
    return 0.0;
  }
  const double depth = UpperMedian(&depths);
  const double rounding = 0.5 * std::numeric_limits<float>::epsilon() *
                          camera.Center().lpNorm<Eigen::Infinity>();
  return depth > 0.0 ? rounding * camera.fx / depth : 0.0;
}

}  // namespace

const SparseModel::ModelImage* SparseModel::Find(
    const std::string& name) const {
  const int index = IndexOf(name);
  return index < 0 ? nullptr : &images[index];
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
    if (std::ranges::all_of(paths, &Exists)) {
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
  SparseModelFiles files =
      ReadSparseModelFiles(FindSparseModelFiles(sparse_folder));
  SparseModel model;
  AddImages(&files, &model);
  AddPoints(&files, &model);
  return model;
}

std::filesystem::path FindModelFolder(const std::filesystem::path& root) {
  const std::filesystem::path sparse = root / "sparse";
  for (const std::filesystem::path& folder : {sparse, sparse / "0"}) {
    if (HoldsModel(folder)) {
      return folder;
    }
  }
  throw Error::File(ErrorCode::kNotFound,
                    sparse.string(),
                    "no sparse model: cameras, images and points3D, .bin or "
                    ".txt, are neither there nor in its folder 0",
                    "make the workspace with image_undistorter");
}

SparseModel ReadWorkspaceModel(const std::filesystem::path& model_folder) {
  SparseModel model = ReadSparseModel(model_folder);
  for (const SparseModel::ModelImage& image : model.images) {
    RequireSafeName(model_folder, image.name);
  }
  return model;
}

std::vector<std::string> FindFusionObstacles(
    const SparseModel& model, const std::filesystem::path& sparse_folder) {
  constexpr double kMaxRoundingPixels = 0.25;
  std::vector<std::string> obstacles;
  const SparseModel::ModelImage* farthest = nullptr;
  double most = 0.0;
  for (const SparseModel::ModelImage& image : model.images) {
    const double pixels = RoundingPixels(model, image);
    if (pixels > most) {
      most = pixels;
      farthest = &image;
    }
  }
  if (most > kMaxRoundingPixels) {
    char numbers[128];
    std::snprintf(numbers,
                  sizeof(numbers),
                  "lies %.3g units from the origin, where the single precision "
                  "of stereo_fusion and of clouds is off by up to %.2g pixels",
                  farthest->camera.Center().norm(),
                  most);
    obstacles.push_back(sparse_folder.string() + ": the model " + numbers +
                        "; before fusion shift it by colmap model_transformer "
                        "(docs/troubleshooting.md tells how; the maps stay as "
                        "they are)");
  }
  const bool is_text =
      FindSparseModelFiles(sparse_folder)[1].extension() == ".txt";
  const auto spaced = std::ranges::find_if(model.images, [](const auto& image) {
    return image.name.find(' ') != std::string::npos;
  });
  if (is_text && spaced != model.images.end()) {
    obstacles.push_back(
        sparse_folder.string() + ": the image \"" + spaced->name +
        "\" has a space in its name, which COLMAP does not read in text models "
        "(stereo_fusion would not find its maps); use tsar_fuse, rename the "
        "images, or write the model as cameras.bin, images.bin and "
        "points3D.bin");
  }
  return obstacles;
}

}  // namespace tsar
