// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/image_masks.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/io/photo.h"
#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/run/store/originals.h"

#include <algorithm>
#include <iterator>
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
                      AdviceForMissing(folder, advice));
  }
}

void RequireMap(const OriginalMap& map,
                const ContainedPath& current,
                const char* kind) {
  if (map.path.empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      current.string(),
                      std::string("the image has no ") + kind + " map",
                      "run patch_match_stereo for this image");
  }
}

std::vector<std::string> NamesOf(const SparseModel& model) {
  std::vector<std::string> names;
  for (const SparseModel::ModelImage& image : model.images) {
    names.push_back(image.name);
  }
  return names;
}

MapSample ReadSample(DepthMapReader depth, NormalMapReader normal) {
  const MapSize& size = depth.Size();
  MapSample sample(size.width, size.height);
  const auto width = static_cast<size_t>(size.width);
  for (size_t i = 0; i < sample.rows.size(); ++i) {
    const size_t first = static_cast<size_t>(sample.rows[i]) * width;
    depth.Read(first, {sample.depth.Data() + i * width, width});
    normal.Read(first, {sample.normal.Data() + i * width, width});
  }
  return sample;
}

// Throws kMismatch where a map is not of the size of the depth map beside it.
void RequireSizeOfDepthMap(const std::filesystem::path& map,
                           const RasterSize& size,
                           const RasterSize& depth_size) {
  if (size.width != depth_size.width || size.height != depth_size.height) {
    throw Error::File(ErrorCode::kMismatch,
                      map.string(),
                      "the map has " + ToString(size) +
                          " pixels, the depth map " + ToString(depth_size),
                      "run patch_match_stereo again for this image");
  }
}

}  // namespace

Workspace::Workspace(const std::filesystem::path& root, MapType type)
    : root_(root), type_(type) {
  RequireFolder(root, "check " + OptionName("workspace_path"));
  // Where image_undistorter puts the images for PMVS.
  const std::string option =
      Exists(root / "visualize") ? " --output_type COLMAP" : "";
  for (const char* folder : {"images", "sparse", "stereo"}) {
    RequireFolder(root / folder,
                  "make the workspace with image_undistorter" + option);
  }
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    RequireFolder(root / "stereo" / folder, "run patch_match_stereo first");
  }
  model_folder_ = FindModelFolder(root);
  model_ = ReadWorkspaceModel(model_folder_);
  problems_ = ReadPatchMatchConfig(root / "stereo" / "patch-match.cfg", model_);
}

void Workspace::MoveTo(const std::filesystem::path& root) {
  root_ = root;
  model_folder_ = FindModelFolder(root);
}

std::vector<int> Workspace::References() const {
  std::vector<int> references;
  std::ranges::transform(
      problems_, std::back_inserter(references), &StereoProblem::reference);
  return references;
}

std::vector<int> Workspace::ReferencesOf(
    const std::vector<size_t>& problems) const {
  std::vector<int> references;
  for (const size_t index : problems) {
    references.push_back(problems_[index].reference);
  }
  return references;
}

std::set<int> Workspace::ImagesInUse() const {
  std::set<int> images;
  for (const StereoProblem& problem : problems_) {
    images.insert(problem.reference);
    images.insert(problem.sources.begin(), problem.sources.end());
  }
  return images;
}

void Workspace::RequireShapeOfImage(int image,
                                    const std::filesystem::path& map,
                                    const RasterSize& size) const {
  RequireShape(map,
               size,
               SizeOfImage(image),
               "the image " + Name(image),
               "run patch_match_stereo again for this image");
}

std::filesystem::path Workspace::ImagePath(int image) const {
  return root_ / "images" / Name(image);
}

MapPaths Workspace::Paths(int image, MapType type) const {
  return GetMapPaths(root_, Name(image), type);
}

void Workspace::UseMasks(const std::filesystem::path& folder) {
  masks_.clear();
  mask_folder_ = folder;
  if (folder.empty()) {
    return;
  }
  RequireNoImageFolder(
      folder, root_ / "images", "masks", OptionName("mask_path"));
  masks_ = FindImageMasks(folder, NamesOf(model_), OptionName("mask_path"));
}

void Workspace::WarnOfStrayFiles() const {
  if (!masks_.empty()) {
    WarnOfStrayMasks(mask_folder_, masks_);
  }
  priors_.WarnOfStrayFiles();
}

std::filesystem::path Workspace::MaskPath(int image) const {
  return masks_.empty() ? std::filesystem::path()
                        : masks_.at(static_cast<size_t>(image));
}

RasterSize Workspace::SizeOfImage(int image) const {
  return {CameraOf(image).width, CameraOf(image).height};
}

MaskSizes Workspace::SizesOfMask(int image, const RasterSize& maps) const {
  return {SizeOfImage(image), maps};
}

Image<uint8_t> Workspace::ReadMask(int image, const RasterSize& maps) const {
  return HasMask(image) ? ResizeMask(ReadImageMask(MaskPath(image),
                                                   SizesOfMask(image, maps)),
                                     maps)
                        : Image<uint8_t>();
}

Image<uint8_t> Workspace::ReadMaskOfImage(int image,
                                          const RasterSize& maps) const {
  const MaskSizes sizes = SizesOfMask(image, maps);
  return HasMask(image)
             ? ResizeMask(ReadImageMask(MaskPath(image), sizes), sizes.image)
             : Image<uint8_t>();
}

void Workspace::CheckMask(int image, const RasterSize& maps) const {
  if (HasMask(image)) {
    CheckImageMask(MaskPath(image), SizesOfMask(image, maps));
  }
}

std::optional<int64_t> Workspace::CountMasks(
    const std::vector<int>& images) const {
  // A folder of masks is refused if it holds none of the images'.
  if (masks_.empty()) {
    return std::nullopt;
  }
  return std::ranges::count_if(images,
                               [&](int image) { return HasMask(image); });
}

void Workspace::UsePriors(const std::filesystem::path& folder, PriorType type) {
  priors_ = PriorFolder();
  if (folder.empty()) {
    return;
  }
  RequireNoImageFolder(
      folder, root_ / "images", "depth priors", OptionName("prior_path"));
  priors_ = PriorFolder(folder, type, NamesOf(model_));
}

std::shared_ptr<DepthPrior> Workspace::ReadPrior(int image) const {
  if (!priors_.HasPrior(image)) {
    return nullptr;
  }
  auto prior = std::make_shared<DepthPrior>(tsar::ReadPrior(
      priors_.FilesOf(image), priors_.Type(), SizeOfImage(image)));
  if (!prior->values.Empty()) {
    const bool are_depths = priors_.Type() == PriorType::kMetric ||
                            priors_.Type() == PriorType::kRelative;
    prior->no_depth = FindNoDepth(
        MapSample(prior->values, {}), are_depths ? &model_ : nullptr, image);
    ClearNoDepth(prior->no_depth, prior->values);
  }
  return prior;
}

bool Workspace::HasMaps(int image, MapType type) const {
  const MapPaths paths = Paths(image, type);
  return (Exists(paths.depth) || Exists(paths.original_depth)) &&
         (Exists(paths.normal) || Exists(paths.original_normal));
}

Image<Rgb> Workspace::ReadImage(int image, int width, int height) const {
  const std::filesystem::path path = ImagePath(image);
  const RasterSize size = SizeOfImage(image);
  Image<Rgb> photo = ReadPhoto(path);
  if (photo.Width() != size.width || photo.Height() != size.height) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "the image has " +
                          ToString(RasterSize{photo.Width(), photo.Height()}) +
                          " pixels, its camera " + ToString(size),
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
  DepthNormalReader reader = OpenOriginalMaps(image, type);
  DepthNormal maps;
  maps.depth = Image<float>::Uninitialized(reader.Width(), reader.Height());
  maps.normal = Image<Vec3f>::Uninitialized(reader.Width(), reader.Height());
  ForEachPiece(reader.NumPixels(), [&](size_t first, size_t count) {
    reader.ReadDepths(first, {maps.depth.Data() + first, count});
    reader.ReadNormals(first, {maps.normal.Data() + first, count});
  });
  maps.num_not_finite = reader.NumNotFinite();
  return maps;
}

DepthNormalReader Workspace::OpenOriginalMaps(int image, MapType type) const {
  const MapPaths paths = Paths(image, type);
  const auto open = [&]<typename Reader>(const std::filesystem::path& path) {
    Reader map(path);
    RequireShapeOfImage(image, path, {map.Size().width, map.Size().height});
    return map;
  };
  for (;;) {
    const OriginalMaps originals = FindOriginals(paths);
    RequireMap(originals.depth, paths.depth, "depth");
    RequireMap(originals.normal, paths.normal, "normal");
    const auto is_still_there = [&] {
      return originals.files == FindMapFiles(paths);
    };
    try {
      DepthNormalReader maps = {
          open.operator()<DepthMapReader>(originals.depth.path),
          open.operator()<NormalMapReader>(originals.normal.path),
          {}};
      // A refined map may have taken the name meanwhile.
      if (!is_still_there()) {
        continue;
      }
      const MapSize& normal = maps.normal.Size();
      RequireSizeOfDepthMap(
          paths.normal, {normal.width, normal.height}, maps.Size());
      // By readers of their own, which count what they read.
      maps.conventions =
          FindConventions(ReadSample(DepthMapReader(originals.depth.path),
                                     NormalMapReader(originals.normal.path)),
                          model_,
                          image);
      return maps;
    } catch (const Error&) {
      if (is_still_there()) {
        throw;
      }
    }
  }
}

std::optional<MapReader> Workspace::OpenCosts(
    int image, const RasterSize& depth_size) const {
  const std::filesystem::path path = Paths(image, type_).cost;
  if (!Exists(path)) {
    return std::nullopt;
  }
  MapReader costs(path);
  costs.RequireChannels(2, "a cost map");
  const RasterSize size = {costs.Size().width, costs.Size().height};
  RequireShapeOfImage(image, path, size);
  RequireSizeOfDepthMap(path, size, depth_size);
  return costs;
}

}  // namespace tsar
