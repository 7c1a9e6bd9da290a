// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/io/image_lists.h"
#include "colmap_tsar/io/image_masks.h"
#include "colmap_tsar/io/map_conventions.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/priors/depth_prior.h"
#include "colmap_tsar/priors/prior_folder.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace tsar {

// A depth and a normal map of the same size (see map_io.h).
struct DepthNormal {
  Image<float> depth;
  Image<Vec3f> normal;
  int64_t num_not_finite = 0;  // Values that were read as invalid.
};

// An open depth and normal map, to be read piece by piece as COLMAP's are,
// whatever the conventions of the program that wrote them.
struct DepthNormalReader {
  DepthMapReader depth;
  NormalMapReader normal;
  MapConventions conventions;

  void ReadDepths(size_t first_pixel, std::span<float> depths) {
    depth.Read(first_pixel, depths);
    conventions.Apply(depths);
  }
  void ReadNormals(size_t first_pixel, std::span<Vec3f> normals) {
    normal.Read(first_pixel, normals);
    conventions.Apply(normals);
  }

  int Width() const { return depth.Size().width; }
  int Height() const { return depth.Size().height; }
  RasterSize Size() const { return {Width(), Height()}; }
  size_t NumPixels() const { return depth.Size().NumPixels(); }
  // The number of such values of both maps among those that were read.
  int64_t NumNotFinite() const {
    return depth.NumNotFinite() + normal.NumNotFinite();
  }
};

// COLMAP's dense workspace: images/, sparse/ and stereo/. Images are given by
// their index in Model().images. All const methods may be called from several
// threads.
class Workspace {
 public:
  // type: the maps to refine. Reads the sparse model and patch-match.cfg.
  // Throws Error: kNotFound (a folder or file of the workspace is missing),
  // kUnsupported (an image's name leaves the folder: absolute or with ".."),
  // and what ReadSparseModel and ReadPatchMatchConfig throw.
  Workspace(const std::filesystem::path& root, MapType type);

  const std::filesystem::path& Root() const { return root_; }
  MapType Type() const { return type_; }
  const SparseModel& Model() const { return model_; }
  // The folder of the model: sparse, or sparse/0.
  const std::filesystem::path& ModelFolder() const { return model_folder_; }
  const std::vector<StereoProblem>& Problems() const { return problems_; }
  // The references of all problems, or of those with these indices.
  std::vector<int> References() const;
  std::vector<int> ReferencesOf(const std::vector<size_t>& problems) const;
  // The references and sources of all problems.
  std::set<int> ImagesInUse() const;

  int NumImages() const { return static_cast<int>(model_.images.size()); }
  const std::string& Name(int image) const {
    return model_.images.at(static_cast<size_t>(image)).name;
  }
  // Its size is that of the image.
  const Camera& CameraOf(int image) const {
    return model_.images.at(static_cast<size_t>(image)).camera;
  }
  // From now on, all files but masks and priors are those in another folder,
  // whose sparse model and patch-match.cfg are the same.
  void MoveTo(const std::filesystem::path& root);

  // Throws kMismatch where a map of this size is not of the image's shape.
  void RequireShapeOfImage(int image,
                           const std::filesystem::path& map,
                           const RasterSize& size) const;

  std::filesystem::path ImagePath(int image) const;
  MapPaths Paths(int image, MapType type) const;

  // From now on, images have the masks in this folder, see image_masks.h; none
  // where it is empty. Throws Error: what FindImageMasks throws,
  // kBadOption (it is the folder of the images).
  void UseMasks(const std::filesystem::path& folder);
  // Warns of masks and depth priors that belong to no image.
  void WarnOfStrayFiles() const;
  bool HasMask(int image) const { return !MaskPath(image).empty(); }
  // Empty where the image has no mask.
  std::filesystem::path MaskPath(int image) const;
  // 1 where the image is masked, at the size of its maps or of the image; empty
  // where it has no mask. Throw what ReadImageMask throws.
  Image<uint8_t> ReadMask(int image, const RasterSize& maps) const;
  Image<uint8_t> ReadMaskOfImage(int image, const RasterSize& maps) const;
  // Checks the mask of an image without reading it, see CheckImageMask.
  void CheckMask(int image, const RasterSize& maps) const;
  // The number of these images that have a mask; nothing without masks.
  std::optional<int64_t> CountMasks(const std::vector<int>& images) const;

  // From now on, images have the depth priors in this folder, see
  // priors/prior_folder.h; none where it is empty. Throws Error: what
  // PriorFolder throws, kBadOption (it is the folder of the images).
  void UsePriors(const std::filesystem::path& folder, PriorType type);
  const PriorFolder& Priors() const { return priors_; }
  // Null where the image has none. Throws what ReadPrior throws.
  std::shared_ptr<DepthPrior> ReadPrior(int image) const;
  // Whether the image has both a depth and a normal map of this type.
  bool HasMaps(int image, MapType type) const;

  // The undistorted image, reduced to width x height by averaging. Throws
  // Error: what ReadPhoto throws, kMismatch (its size is not the camera's).
  Image<Rgb> ReadImage(int image, int width, int height) const;

  // The maps as COLMAP wrote them, even if they have been refined since. Maps
  // that were written after that are the originals. Other programs may be
  // refining the image meanwhile. Throws Error: kNotFound (one of the two is
  // missing), kMismatch (sizes differ; a map is not of the image's shape; or
  // the original is lost), and what the readers of map_io.h throw.
  DepthNormal ReadOriginalMaps(int image, MapType type) const;
  DepthNormalReader OpenOriginalMaps(int image, MapType type) const;
  // The exported costs of one type of map, as they are beside depth maps of
  // this size; nothing without. Throws Error: what MapReader throws, kCorrupt
  // (there are not two channels), kMismatch (it is of another size).
  std::optional<MapReader> OpenCosts(int image,
                                     const RasterSize& depth_size) const;

 private:
  RasterSize SizeOfImage(int image) const;
  MaskSizes SizesOfMask(int image, const RasterSize& maps) const;

  std::filesystem::path root_;
  std::filesystem::path mask_folder_;
  std::vector<std::filesystem::path> masks_;  // By image; empty: none.
  PriorFolder priors_;
  MapType type_;
  std::filesystem::path model_folder_;
  SparseModel model_;
  std::vector<StereoProblem> problems_;
};

}  // namespace tsar
