// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/tools/export/image_exporter.h"
#include "colmap_tsar/tools/export/map_levels.h"
#include "colmap_tsar/tools/export/value_files.h"
#include "colmap_tsar/view/refined_maps.h"

#include <string>
#include <type_traits>

namespace tsar {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSigmaStep = 0.01;  // In steps of depth.

// The description of a kind of map: value = scale * stored value + offset.
Json MapJson(const std::string& meaning,
             const std::string& stored,
             double scale = 1.0,
             double offset = 0.0) {
  return {{"meaning", meaning},
          {"stored", stored},
          {"scale", scale},
          {"offset", offset}};
}

class MapExporter : public ImageExporter {
 public:
  MapExporter(const Workspace& workspace,
              const ContainedPath& folder,
              ExportFormat format,
              double depth_scale)
      : workspace_(workspace),
        folder_(folder),
        format_(format),
        step_(depth_scale) {
    if (format_ == ExportFormat::kExr) {
      RequireExr();
    }
  }

  Json DescribeMaps() const override {
    const std::string floats = "float32";
    Json maps;
    maps["depth"] = MapJson(
        "z in the camera's frame, in units of the sparse model; 0: no depth",
        IsPng() ? "uint16" : floats,
        IsPng() ? step_ : 1.0);
    maps["normals"] = MapJson(
        "unit vector in the camera's frame, towards the camera; (0, 0, 0): "
        "none",
        IsPng() ? "uint16, red green blue" : floats,
        IsPng() ? kNormalScale : 1.0,
        IsPng() ? kNormalOffset : 0.0);
    maps["confidence"] =
        MapJson("probability that the depth is right, to 1 %; 0: no depth",
                IsPng() ? "uint8" : floats,
                IsPng() ? static_cast<double>(ConfidenceOfLevel(1)) : 1.0);
    maps["sigma"] = MapJson(
        "standard deviation of the depth, in units of the sparse model; 0: no "
        "depth",
        IsPng() ? "uint16" : floats,
        IsPng() ? kSigmaStep * step_ : 1.0);
    maps["provenance"] = MapJson("where the depth comes from", "uint8");
    maps["provenance"]["values"] = kProvenanceNames;

    maps["planes"] = MapJson(
        "1 + the id of the plane that tsar_planes writes; 0: none", "uint16");
    return maps;
  }

  ExportedImage Export(int image) const override {
    const std::string& name = workspace_.Model().images.at(image).name;
    const ImageMaps maps = ReadImageMaps(workspace_, image);
    ExportedImage exported = Describe(maps.depth);
    const auto write = [&](const auto& values, const std::string& kind) {
      exported.files[kind] = Write(values, kind + "/" + name);
    };
    if (IsPng()) {
      write(DepthLevels(maps.depth, step_, &exported.num_out_of_range),
            "depth");
      write(NormalLevels(maps.normal), "normals");
    } else {
      write(maps.depth, "depth");
      write(maps.normal, "normals");
    }
    if (!maps.confidence.Empty() && IsPng()) {
      write(maps.confidence, "confidence");
    } else if (!maps.confidence.Empty()) {
      write(ConfidencesOf(maps.confidence), "confidence");
    }
    if (!maps.sigma.Empty() && IsPng()) {
      write(SigmaLevels(maps.sigma, kSigmaStep * step_), "sigma");
    } else if (!maps.sigma.Empty()) {
      write(maps.sigma, "sigma");
    }
    if (!maps.provenance.Empty()) {
      write(maps.provenance, "provenance");
    }
    if (!maps.planes.Empty()) {
      write(maps.planes, "planes");
    }
    return exported;
  }

  void Finish(const std::vector<int>& /*images*/,
              const std::vector<ExportedImage>& exported) const override {
    if (!IsPng()) {
      return;
    }
    int64_t num_out_of_range = 0;
    std::vector<DepthStatistics> statistics;
    for (const ExportedImage& image : exported) {
      num_out_of_range += image.num_out_of_range;
      statistics.push_back(image.depth);
    }
    const DepthStatistics depth = JoinStatistics(statistics);
    // The largest step without a warning, as a share of the median depth;
    // rounding errors are at most half a step.
    constexpr double kCoarseStep = 0.005;
    const std::string option = OptionName("depth_scale");
    TextStream text;
    if (num_out_of_range > 0) {
      text << ShareOfDepths(num_out_of_range, depth.num_depths)
           << " are not between " << step_ << " and " << step_ * kMaxLevel
           << ", which 16 bits hold at " << option << " " << step_
           << ", and were left out; the farthest, " << depth.farthest
           << ", needs " << option << " " << StepFor(depth.farthest);
      Warn(text.str());
    } else if (depth.num_depths > 0 && step_ > kCoarseStep * depth.median) {
      text << "depths were rounded to steps of " << step_ << ", which is "
           << 100.0 * step_ / depth.median << " % of their median; " << option
           << " " << StepFor(depth.farthest) << " keeps more";
      Warn(text.str());
    }
  }

 private:
  bool IsPng() const { return format_ == ExportFormat::kPng16; }

  // Writes arrays for kNpy, otherwise EXR of floats and PNG of integers, to
  // this path in the folder plus an extension; returns the path.
  template <typename T>
  std::string Write(const Image<T>& values, std::string path) const {
    if constexpr (!std::is_same_v<T, Rgb16>) {
      if (format_ == ExportFormat::kNpy) {
        path += ".npy";
        WriteArray(folder_ / path, values);
        return path;
      }
    }
    if constexpr (std::is_same_v<T, float> || std::is_same_v<T, Vec3f>) {
      path += ".exr";
      WriteExrFile(folder_ / path, values);
    } else {
      path += ".png";
      WritePngFile(folder_ / path, values);
    }
    return path;
  }

  const Workspace& workspace_;
  ContainedPath folder_;
  ExportFormat format_;
  double step_;
};

}  // namespace

std::unique_ptr<ImageExporter> MakeMapExporter(const Workspace& workspace,
                                               const ContainedPath& folder,
                                               ExportFormat format,
                                               double depth_scale) {
  return std::make_unique<MapExporter>(workspace, folder, format, depth_scale);
}

}  // namespace tsar
