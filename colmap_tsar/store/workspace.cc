// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/store/workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/store/originals.h"
#include "colmap_tsar/store/output_workspace.h"
#include "colmap_tsar/workspace/map_io.h"
#include "colmap_tsar/workspace/map_shape.h"
#include "colmap_tsar/workspace/photo.h"

#include <algorithm>
#include <optional>
#include <string>
#include <system_error>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

void RequireFolder(const std::filesystem::path& folder,
                   const std::string& advice) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "no such folder, so this is not a dense workspace",
                      advice);
  }
}

// Every path of an image is made from its name, so a name must not lead out.
void RequireSafeName(const std::filesystem::path& root,
                     const std::string& name) {
  const std::filesystem::path path(name);
  if (path.is_absolute() ||
      std::find(path.begin(), path.end(), "..") != path.end()) {
    throw Error::File(ErrorCode::kUnsupported,
                      (root / "sparse").string(),
                      "the image name " + name + " leads out of the workspace",
                      "rename the image and make the workspace again");
  }
}

// Reads what is stored or, where nothing is, the current map. An image that
// turns out to keep its maps gets what is stored back, perhaps meanwhile.
template <typename Read>
auto ReadStoredOrCurrent(const std::filesystem::path& stored,
                         const std::filesystem::path& current,
                         const Read& read) {
  if (Exists(stored)) {
    try {
      return read(stored);
    } catch (const Error&) {
      if (Exists(stored)) {
        throw;
      }
    }
  }
  return read(current);
}

void RequireMap(OriginalState state,
                const std::filesystem::path& path,
                const char* kind) {
  if (state == OriginalState::kMissing) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      std::string("the image has no ") + kind + " map",
                      "run patch_match_stereo for this image");
  }
}

}  // namespace

Workspace::Workspace(const std::filesystem::path& root, MapType type)
    : root_(root), source_root_(root), type_(type) {
  RequireFolder(root, "check " + OptionName("workspace_path"));
  for (const char* folder : {"images", "sparse", "stereo"}) {
    RequireFolder(root / folder, "make the workspace with image_undistorter");
  }
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    RequireFolder(root / "stereo" / folder, "run patch_match_stereo first");
  }
  if (const std::optional<std::filesystem::path> source =
          ReadOutputMarker(root)) {
    source_root_ = *source;
    is_output_ = true;
    RequireFolder(source_root_,
                  "the input of this output workspace has been moved or "
                  "deleted; make the output workspace again");
  }
  model_ = ReadSparseModel(root / "sparse");
  for (const SparseModel::ModelImage& image : model_.images) {
    RequireSafeName(root, image.name);
  }
  problems_ = ReadPatchMatchConfig(root / "stereo" / "patch-match.cfg", model_);
}

std::filesystem::path Workspace::ImagePath(int image) const {
  return root_ / "images" / model_.images.at(static_cast<size_t>(image)).name;
}

MapPaths Workspace::Paths(int image, MapType type) const {
  return GetMapPaths(
      root_, model_.images.at(static_cast<size_t>(image)).name, type);
}

std::filesystem::path Workspace::DepthPath(int image, MapType type) const {
  return Paths(image, type).depth;
}

std::filesystem::path Workspace::CostPath(int image, MapType type) const {
  return Paths(image, type).cost;
}

std::filesystem::path Workspace::ConfidencePath(int image, MapType type) const {
  return Paths(image, type).confidence;
}

std::filesystem::path Workspace::SigmaPath(int image, MapType type) const {
  return Paths(image, type).sigma;
}

std::filesystem::path Workspace::ProvenancePath(int image, MapType type) const {
  return Paths(image, type).provenance;
}

std::filesystem::path Workspace::PlanesPath(int image, MapType type) const {
  return Paths(image, type).planes;
}

MapPaths Workspace::SourcePaths(int image, MapType type) const {
  return GetMapPaths(
      source_root_, model_.images.at(static_cast<size_t>(image)).name, type);
}

void Workspace::TrustStoredOriginals() {
  trusts_stored_.assign(model_.images.size(), false);
  for (const StereoProblem& problem : problems_) {
    trusts_stored_[static_cast<size_t>(problem.reference)] = true;
  }
}

bool Workspace::HasMaps(int image, MapType type) const {
  const MapPaths paths = SourcePaths(image, type);
  return (Exists(paths.depth) || Exists(paths.original_depth)) &&
         (Exists(paths.normal) || Exists(paths.original_normal));
}

Image<Rgb> Workspace::ReadImage(int image, int width, int height) const {
  const std::filesystem::path path = ImagePath(image);
  const Camera& camera = model_.images.at(static_cast<size_t>(image)).camera;
  Image<Rgb> photo = ReadPhoto(path);
  if (photo.Width() != camera.width || photo.Height() != camera.height) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "the image has " +
                          ToString(RasterSize{photo.Width(), photo.Height()}) +
                          " pixels, its camera " +
                          ToString(RasterSize{camera.width, camera.height}),
                      "make the workspace again with image_undistorter");
  }
  if (photo.Width() == width && photo.Height() == height) {
    return photo;
  }
  auto result = Image<Rgb>::Uninitialized(width, height);
  const cv::Mat pixels(photo.Height(), photo.Width(), CV_8UC3, photo.Data());
  cv::Mat target(height, width, CV_8UC3, result.Data());
  cv::resize(pixels, target, target.size(), 0, 0, cv::INTER_AREA);
  return result;
}

DepthNormal Workspace::ReadOriginalMaps(int image, MapType type) const {
  const MapPaths paths = SourcePaths(image, type);
  const bool trusts_stored = type == type_ && !trusts_stored_.empty() &&
                             trusts_stored_.at(static_cast<size_t>(image));
  OriginalMaps originals;
  if (!trusts_stored) {
    originals = FindOriginals(paths);
    RequireMap(originals.depth_state, originals.depth, "depth");
    RequireMap(originals.normal_state, originals.normal, "normal");
  }
  DepthNormal maps;
  int64_t num_bad_depths = 0;
  int64_t num_bad_normals = 0;
  const auto require_shape = [&](const std::filesystem::path& path,
                                 const auto& map) {
    const SparseModel::ModelImage& model_image =
        model_.images[static_cast<size_t>(image)];
    RequireShape(path,
                 {map.Width(), map.Height()},
                 {model_image.camera.width, model_image.camera.height},
                 "the image " + model_image.name,
                 "run patch_match_stereo again for this image");
  };
  const auto read_depth = [&](const std::filesystem::path& path) {
    Image<float> map = ReadDepthMap(path, &num_bad_depths);
    require_shape(path, map);
    return map;
  };
  const auto read_normal = [&](const std::filesystem::path& path) {
    Image<Vec3f> map = ReadNormalMap(path, &num_bad_normals);
    require_shape(path, map);
    return map;
  };
  if (trusts_stored) {
    maps.depth =
        ReadStoredOrCurrent(paths.original_depth, paths.depth, read_depth);
    maps.normal =
        ReadStoredOrCurrent(paths.original_normal, paths.normal, read_normal);
  } else {
    maps.depth = read_depth(originals.depth);
    maps.normal = read_normal(originals.normal);
  }
  maps.num_not_finite = num_bad_depths + num_bad_normals;
  if (!maps.depth.HasSizeOf(maps.normal)) {
    throw Error::File(
        ErrorCode::kMismatch,
        paths.normal.string(),
        "the normal map has " +
            ToString(RasterSize{maps.normal.Width(), maps.normal.Height()}) +
            " pixels, the depth map " +
            ToString(RasterSize{maps.depth.Width(), maps.depth.Height()}),
        "run patch_match_stereo again for this image");
  }
  return maps;
}

}  // namespace tsar
