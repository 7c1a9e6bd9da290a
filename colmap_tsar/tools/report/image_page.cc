// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/image_page.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/priors/fit_prior.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/tools/report/comparison_picture.h"
#include "colmap_tsar/tools/report/debug_pictures.h"
#include "colmap_tsar/tools/report/page_text.h"
#include "colmap_tsar/tools/report/pictures.h"
#include "colmap_tsar/view/refined_maps.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>

namespace tsar {
namespace {

namespace fs = std::filesystem;

// The size of each of the three parts of a preview.
constexpr int kPreviewSize = 220;

// The pictures of --TsarRefine.debug_path that overlay the image.
constexpr std::array<RefineStage, 5> kShownStages = {RefineStage::kSuperpixels,
                                                     RefineStage::kEdges,
                                                     RefineStage::kLines,
                                                     RefineStage::kRegions,
                                                     RefineStage::kSceneLabels};

int64_t CountValid(const Image<float>& depth) {
  return std::ranges::count_if(depth, [](float z) { return z > 0.f; });
}

Image<float> ReadConfidence(const Workspace& workspace,
                            int image,
                            const Image<float>& depth) {
  const fs::path path = workspace.Paths(image, workspace.Type()).confidence;
  const Image<uint8_t> levels =
      RequireSizeOf(depth, "the depth map", path, ReadGrayPng(path));
  Image<float> confidence(depth.Width(), depth.Height());
  std::ranges::transform(levels, confidence.begin(), &ConfidenceOfLevel);
  return confidence;
}

// The end of the scale of relative sigma; correct depths are below it.
constexpr float kMaxSigma = 0.01f;
Image<float> ReadRelativeSigma(const fs::path& path,
                               const Image<float>& depth) {
  Image<float> sigma =
      RequireSizeOf(depth, "the depth map", path, ReadSigmaMap(path));
  std::ranges::transform(sigma, depth, sigma.begin(), [](float s, float z) {
    return z > 0.f ? s / z : 0.f;
  });
  return sigma;
}

// Draws each scene plane in its color; black where there is none.
Image<Rgb> DrawPlanes(const fs::path& path, const Image<float>& depth) {
  const Image<uint16_t> numbers =
      RequireSizeOf(depth, "the depth map", path, ReadGray16Png(path));
  Image<int> ids(numbers.Width(), numbers.Height());
  std::ranges::transform(
      numbers, ids.begin(), [](int number) { return number - 1; });
  return ColorizeLabels(ids);
}

// The depth prior in the units of the maps: one function of its values, fitted
// to the depths before. Empty without values or depths.
Image<float> FitToDepths(const DepthPrior& prior, const Image<float>& depth) {
  const int step = 1 + std::max(depth.Width(), depth.Height()) / 256;
  const Image<float>& values = prior.values;
  std::vector<PriorSample> samples;
  for (int y = 0; y < depth.Height() && !values.Empty(); y += step) {
    for (int x = 0; x < depth.Width(); x += step) {
      const float value = values(x * values.Width() / depth.Width(),
                                 y * values.Height() / depth.Height());
      if (value > 0.f && depth(x, y) > 0.f) {
        samples.push_back({value, depth(x, y)});
      }
    }
  }
  if (samples.empty()) {
    return {};
  }
  const PriorFunction function = FitPrior(samples, prior.type).function;
  Image<float> fitted(values.Width(), values.Height());
  std::ranges::transform(values, fitted.begin(), [&](float value) {
    return value > 0.f ? static_cast<float>(function.Depth(value)) : 0.f;
  });
  return fitted;
}

void WriteMap(const ContainedPath& pictures,
              const std::string& name,
              const Image<Rgb>& picture,
              const ImagePageOptions& options) {
  WritePng(pictures / (name + ".png"),
           FitPicture(picture, options.max_picture_size, Scaling::kPick));
}

// Writes the pictures of what only some images have, and notes which exist.
void WriteOptionalPictures(const Workspace& workspace,
                           int image,
                           const ComparisonRow& row,
                           const ImagePageOptions& options,
                           const ContainedPath& pictures,
                           ImagePage* page) {
  const auto write = [&](const std::string& name, const Image<Rgb>& picture) {
    WriteMap(pictures, name, picture, options);
  };
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  if (Exists(paths.sigma)) {
    write(
        "sigma",
        ColorizeValues(
            ReadRelativeSigma(paths.sigma, row.after), kMaxSigma, &row.after));
    page->has_sigma = true;
  }
  if (options.show_planes && Exists(paths.planes)) {
    write("planes", DrawPlanes(paths.planes, row.after));
    page->has_planes = true;
  }
  if (const auto prior = workspace.ReadPrior(image)) {
    const Image<float> fitted = FitToDepths(*prior, row.before);
    if (!fitted.Empty()) {
      write("prior", ColorizeDepth(fitted, page->range));
      page->has_prior = true;
    }
  }
  if (!options.debug_path.empty()) {
    for (const RefineStage stage :
         FindStagePictures(options.debug_path, row.name)) {
      const std::string& name = RefineStages()[static_cast<size_t>(stage)].name;
      CopyFile(DebugPicturePath(options.debug_path, row.name, stage),
               pictures / (name + ".png"));
      page->stages.push_back(name);
    }
  }
}

}  // namespace

std::vector<RefineStage> FindStagePictures(const fs::path& debug_path,
                                           const std::string& image_name) {
  std::vector<RefineStage> found;
  std::ranges::copy_if(
      kShownStages, std::back_inserter(found), [&](RefineStage stage) {
        std::error_code error;
        return fs::is_regular_file(
            DebugPicturePath(debug_path, image_name, stage), error);
      });
  return found;
}

ImagePage WriteImagePage(const Workspace& workspace,
                         int image,
                         int number,
                         const fs::path& folder,
                         const ImagePageOptions& options) {
  const ComparisonRow row = ReadComparisonRow(workspace, image);
  const Image<float> confidence = ReadConfidence(workspace, image, row.after);
  ImagePage page;
  page.name = row.name;
  page.folder = SafeFileName(number, row.name);
  page.width = row.after.Width();
  page.height = row.after.Height();
  page.num_before = CountValid(row.before);
  page.num_after = CountValid(row.after);
  page.num_by_provenance.resize(ProvenanceKinds().size());
  const Image<Rgb> provenance = ColorizeProvenance(row.provenance);
  for (const uint8_t kind : row.provenance) {
    ++page.num_by_provenance[kind];
  }
  const std::optional<ImageRecord> record =
      ReadRecord(workspace.Paths(image, workspace.Type()).record);
  if (record) {
    page.seconds = record->seconds;
    page.note = record->note;
  }

  const ContainedPath pictures(folder, page.folder);
  CreateFolders(pictures);
  const auto write = [&](const std::string& name, const Image<Rgb>& picture) {
    WriteMap(pictures, name, picture, options);
  };
  page.range = RobustDepthRange(row.before, row.after);
  const Image<Rgb> before = ColorizeDepth(row.before, page.range);
  const Image<Rgb> after = ColorizeDepth(row.after, page.range);
  const Image<Rgb> photo =
      FitPicture(row.image, options.max_picture_size, Scaling::kAverage);
  page.picture_width = photo.Width();
  page.picture_height = photo.Height();
  WriteJpeg(pictures / "photo.jpg", photo);
  write("depth_before", before);
  write("depth_after", after);
  write("normals_before", ColorizeNormals(row.normals_before));
  write("normals_after", ColorizeNormals(row.normals_after));
  write("provenance", provenance);
  write("confidence", ColorizeValues(confidence, 1.f, &row.after));
  WriteOptionalPictures(workspace, image, row, options, pictures, &page);
  WriteJpeg(
      pictures / "preview.jpg",
      JoinPictures({FitPicture(row.image, kPreviewSize, Scaling::kAverage),
                    FitPicture(before, kPreviewSize, Scaling::kPick),
                    FitPicture(after, kPreviewSize, Scaling::kPick)}));
  if (options.max_num_points > 0) {
    const Camera camera =
        workspace.Model().images[image].camera.Resized(page.width, page.height);
    const int step = GridStep(page.width, page.height, options.max_num_points);
    page.points_before =
        SampleMap(row.before, row.image, camera, options.origin, step);
    page.points_after =
        SampleMap(row.after, row.image, camera, options.origin, step);
  }
  return page;
}

}  // namespace tsar
