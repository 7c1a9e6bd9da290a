// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/image_maps.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/main_memory.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/start_thread.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/device/thread_pool.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"

#include <algorithm>
#include <utility>

namespace tsar {
namespace {

// Reads the map in a file; empty if there is no such file.
template <typename Read>
auto ReadIfThere(const Image<float>& depth,
                 const std::filesystem::path& path,
                 Read read) {
  return Exists(path) ? RequireSizeOf(depth, path, read(path))
                      : decltype(read(path))();
}

Image<uint8_t> MaskOf(const Workspace& workspace,
                      int image,
                      const Image<float>& depth) {
  return workspace.ReadMask(image, {depth.Width(), depth.Height()});
}

// Maps of other programs; those of this one follow COLMAP's conventions.
MapConventions ConventionsOf(const Workspace& workspace, int image) {
  const MapType type = workspace.Type();
  return Exists(workspace.Paths(image, type).provenance) ||
                 !workspace.HasMaps(image, type)
             ? MapConventions()
             : workspace.OpenOriginalMaps(image, type).conventions;
}

// Reads a depth map including masked pixels.
Image<float> ReadWholeDepth(const Workspace& workspace,
                            int image,
                            const MapConventions& conventions) {
  const ContainedPath path = workspace.Paths(image, workspace.Type()).depth;
  Image<float> depth = ReadDepthMap(path);
  workspace.RequireShapeOfImage(image, path, {depth.Width(), depth.Height()});
  conventions.Apply(depth);
  return depth;
}

// Reads a normal map including masked pixels.
Image<Vec3f> ReadWholeNormal(const Workspace& workspace,
                             int image,
                             const Image<float>& depth,
                             const MapConventions& conventions) {
  const ContainedPath path = workspace.Paths(image, workspace.Type()).normal;
  Image<Vec3f> normal = RequireSizeOf(depth, path, ReadNormalMap(path));
  conventions.Apply(normal);
  return normal;
}

int NumThreadsFor(const Workspace& workspace,
                  const std::vector<int>& images,
                  int num_threads) {
  // The memory of an image's maps and of the results.
  constexpr int64_t kBytesPerPixel = 60;
  int64_t num_pixels = 1;
  for (const int image : images) {
    const Camera& camera = workspace.CameraOf(image);
    num_pixels = std::max(num_pixels,
                          static_cast<int64_t>(camera.width) * camera.height);
  }
  const int64_t room = MainMemoryBytes() / 2 / (kBytesPerPixel * num_pixels);
  return static_cast<int>(
      std::clamp<int64_t>(room, 1, NumThreads(num_threads)));
}

std::vector<int> FindRefinedImages(const Workspace& workspace) {
  const MapType type = workspace.Type();
  std::vector<int> refined;
  for (int image = 0; image < workspace.NumImages(); ++image) {
    if (workspace.HasMaps(image, type) &&
        Exists(workspace.Paths(image, type).provenance)) {
      refined.push_back(image);
    }
  }
  return refined;
}

}  // namespace

std::vector<int> FindImagesWithMaps(const Workspace& workspace) {
  std::vector<int> images;
  for (int image = 0; image < workspace.NumImages(); ++image) {
    const MapPaths paths = workspace.Paths(image, workspace.Type());
    if (Exists(paths.depth) && Exists(paths.normal)) {
      images.push_back(image);
    }
  }
  return images;
}

std::vector<int> RequireRefinedImages(const Workspace& workspace) {
  const std::vector<int> refined = FindRefinedImages(workspace);
  if (refined.empty()) {
    throw Error::File(
        ErrorCode::kNotFound,
        workspace.Root().string(),
        "has no refined " + ToString(workspace.Type()) + " maps",
        "run tsar_refine on it first, or " + AdviceOfTypes(workspace.Root()));
  }
  return refined;
}

Workspace OpenWorkspaceWithMaps(const std::filesystem::path& root,
                                std::optional<MapType> type) {
  Workspace workspace(root, type.value_or(MapType::kGeometric));
  if (!type && FindRefinedImages(workspace).empty()) {
    Workspace photometric(root, MapType::kPhotometric);
    if (!FindRefinedImages(photometric).empty() ||
        (FindImagesWithMaps(workspace).empty() &&
         !FindImagesWithMaps(photometric).empty())) {
      return photometric;
    }
  }
  return workspace;
}

void WarnOfConventions(const Workspace& workspace,
                       const std::vector<int>& images) {
  ImageRemarks remarks;
  for (const int image : images) {
    remarks.Add(ConventionsOf(workspace, image).remarks, workspace.Name(image));
  }
  std::ranges::for_each(remarks.Lines(), &Warn);
}

Image<float> ReadImageDepth(const Workspace& workspace, int image) {
  Image<float> depth =
      ReadWholeDepth(workspace, image, ConventionsOf(workspace, image));
  ClearMasked(MaskOf(workspace, image, depth), &depth);
  return depth;
}

Image<Vec3f> ReadImageNormal(const Workspace& workspace,
                             int image,
                             const Image<float>& depth) {
  Image<Vec3f> normal =
      ReadWholeNormal(workspace, image, depth, ConventionsOf(workspace, image));
  ClearMasked(MaskOf(workspace, image, depth), &normal);
  return normal;
}

ImageMaps ReadImageMaps(const Workspace& workspace,
                        int image,
                        bool with_labels) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  const MapConventions conventions = ConventionsOf(workspace, image);
  ImageMaps maps;
  maps.depth = ReadWholeDepth(workspace, image, conventions);
  maps.normal = ReadWholeNormal(workspace, image, maps.depth, conventions);
  maps.confidence = ReadIfThere(maps.depth, paths.confidence, &ReadGrayPng);
  maps.sigma = ReadIfThere(maps.depth, paths.sigma, &ReadSigmaMap);
  if (with_labels) {
    maps.provenance = ReadIfThere(maps.depth, paths.provenance, &ReadGrayPng);
    maps.planes = ReadIfThere(maps.depth, paths.planes, &ReadGray16Png);
  }
  ClearMaskedPixels(MaskOf(workspace, image, maps.depth), &maps);
  return maps;
}

ImageMaps ReadOriginalImageMaps(const Workspace& workspace, int image) {
  DepthNormal original = workspace.ReadOriginalMaps(image, workspace.Type());
  ImageMaps maps;
  maps.depth = std::move(original.depth);
  maps.normal = std::move(original.normal);
  ClearMaskedPixels(MaskOf(workspace, image, maps.depth), &maps);
  return maps;
}

void ForEachImage(const Workspace& workspace,
                  const std::vector<int>& images,
                  int num_threads,
                  const std::function<void(size_t)>& function) {
  ThreadPool threads(NumThreadsFor(workspace, images, num_threads));
  threads.ForEach(images.size(), function);
}

}  // namespace tsar
