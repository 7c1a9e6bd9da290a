// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/json_file.h"
#include "colmap_tsar/tools/export/image_exporter.h"
#include "colmap_tsar/tools/export/map_levels.h"
#include "colmap_tsar/tools/export/scene_files.h"
#include "colmap_tsar/tools/export/value_files.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace tsar {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNumLevels = 65536.0;  // The trainer's divisor.

class GaussianSplattingExporter : public ImageExporter {
 public:
  GaussianSplattingExporter(const Workspace& workspace,
                            const ContainedPath& folder,
                            const DepthStatistics& depth)
      : workspace_(workspace),
        folder_(folder),
        images_with_maps_(FindImagesWithMaps(workspace)),
        stems_(UniqueStems(workspace)),
        scale_(InverseDepthScale(depth)) {
    RequireUtf8Names(workspace);
  }

  Json DescribeMaps() const override {
    Json maps;
    maps["inverse_depth"] = {{"meaning",
                              "1 / z in the camera's frame, z in units of the "
                              "sparse model; 0: no depth"},
                             {"stored", "uint16"},
                             {"scale", scale_ / kNumLevels},
                             {"offset", 0.0}};
    maps["depth_mask"] = {{"meaning", "255: depth, 0: no depth"},
                          {"stored", "uint8"}};
    return maps;
  }

  ExportedImage Export(int image) const override {
    const auto index = static_cast<size_t>(image);
    const Camera& camera = workspace_.Model().images.at(index).camera;
    const bool has_maps = std::ranges::binary_search(images_with_maps_, image);
    const Image<float> depth = has_maps
                                   ? ReadImageDepth(workspace_, image)
                                   : Image<float>(camera.width, camera.height);
    ExportedImage exported = Describe(depth);
    exported.files["photo"] = CopyPhoto(workspace_, image, folder_);
    const std::string path = "depths/" + stems_[index] + ".png";
    WritePngFile(folder_ / path, Levels(depth, &exported.num_out_of_range));
    exported.files["inverse_depth"] = path;
    Image<uint8_t> mask(depth.Width(), depth.Height());
    std::ranges::transform(depth, mask.begin(), [](float z) -> uint8_t {
      return z > 0.f ? 255 : 0;
    });
    const std::string mask_path = "depth_masks/" + stems_[index] + ".png";
    WritePngFile(folder_ / mask_path, mask);
    exported.files["depth_mask"] = mask_path;
    return exported;
  }

  void Finish(const std::vector<int>& images,
              const std::vector<ExportedImage>& exported) const override {
    CopySparseModel(workspace_, folder_ / "sparse" / "0");
    Json params = Json::object();
    int64_t num_depths = 0;
    int64_t num_too_near = 0;
    for (size_t i = 0; i < images.size(); ++i) {
      num_depths += exported[i].depth.num_depths;
      num_too_near += exported[i].num_out_of_range;
      params[stems_[images[i]]] = {
          {"scale", exported[i].depth.num_depths > 0 ? scale_ : 0.0},
          {"offset", 0.0}};
    }
    WriteOrderedJson(folder_ / "sparse" / "0" / "depth_params.json", params);
    // A few near pixels are no cause for a warning.
    if (num_too_near > num_depths / 1000) {
      TextStream text;
      text << ShareOfDepths(num_too_near, num_depths) << " are nearer than "
           << 1.0 / scale_ << " and were stored as that";
      Warn(text.str());
    }
  }

 private:
  // Converts depths to levels and counts depths too near for the largest level.
  Image<uint16_t> Levels(const Image<float>& depth,
                         int64_t* num_too_near) const {
    Image<uint16_t> levels(depth.Width(), depth.Height());
    std::ranges::transform(depth, levels.begin(), [&](float z) -> uint16_t {
      if (!(z > 0.f)) {
        return 0;
      }
      const double level = kNumLevels / (scale_ * z);
      *num_too_near += level >= kMaxLevel + 0.5 ? 1 : 0;
      return static_cast<uint16_t>(
          std::lround(std::clamp(level, 1.0, 1.0 * kMaxLevel)));
    });
    return levels;
  }

  const Workspace& workspace_;
  ContainedPath folder_;
  std::vector<int> images_with_maps_;
  std::vector<std::string> stems_;
  double scale_;
};

}  // namespace

double InverseDepthScale(const DepthStatistics& depth) {
  constexpr double kMaxRatio = 16.0;
  const double nearest =
      std::max<double>(depth.nearest, depth.median / kMaxRatio);
  // This scale gives the nearest depth the largest level.
  return kNumLevels / kMaxLevel / nearest;
}

std::unique_ptr<ImageExporter> MakeGaussianSplattingExporter(
    const Workspace& workspace,
    const ContainedPath& folder,
    const DepthStatistics& depth) {
  return std::make_unique<GaussianSplattingExporter>(workspace, folder, depth);
}

}  // namespace tsar
