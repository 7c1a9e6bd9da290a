// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/image_page.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/tools/report/page_text.h"
#include "colmap_tsar/tools/report/pictures.h"

#include <algorithm>
#include <optional>

namespace tsar {
namespace {

double ShareValid(const Image<float>& depth) {
  const auto num_valid =
      std::ranges::count_if(depth, [](float z) { return z > 0.f; });
  return static_cast<double>(num_valid) /
         static_cast<double>(depth.NumPixels());
}

void AddShares(const std::filesystem::path& path,
               const Image<uint8_t>& provenance,
               ImagePage* page) {
  auto& shares = page->shares_by_provenance;
  for (const uint8_t value : provenance) {
    if (value >= shares.size()) {
      throw Error::File(ErrorCode::kCorrupt,
                        path.string(),
                        "has the unknown value " + std::to_string(value),
                        "refine the workspace again");
    }
    shares[value] += 1.0;
  }
  for (double& share : shares) {
    share /= static_cast<double>(provenance.NumPixels());
  }
}

}  // namespace

ImagePage WriteImagePage(const Workspace& workspace,
                         int image,
                         int number,
                         const std::filesystem::path& folder,
                         int max_picture_size) {
  const ImageMaps before = ReadOriginalImageMaps(workspace, image);
  const ImageMaps after = ReadImageMaps(workspace, image);
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  ImagePage page;
  page.name = workspace.Name(image);
  page.folder = SafeFileName(number, page.name);
  page.width = after.depth.Width();
  page.height = after.depth.Height();
  page.range = RobustDepthRange(before.depth, after.depth);
  page.share_before = ShareValid(before.depth);
  page.share_after = ShareValid(after.depth);
  page.has_confidence = !after.confidence.Empty();
  page.has_planes = !after.planes.Empty();
  if (const std::optional<ImageRecord> record = ReadRecord(paths.record)) {
    page.note = record->note;
    for (const auto& [stage, seconds] : record->seconds) {
      page.seconds += seconds;
    }
  }

  const ContainedPath pictures(folder, page.folder);
  CreateFolders(pictures);
  const auto write = [&](const char* name, const Image<Rgb>& picture) {
    WritePng(pictures / name,
             FitPicture(picture, max_picture_size, Scaling::kPick));
  };
  const Image<Rgb> photo =
      FitPicture(workspace.ReadImage(image, page.width, page.height),
                 max_picture_size,
                 Scaling::kAverage);
  page.picture_width = photo.Width();
  page.picture_height = photo.Height();
  WriteJpeg(pictures / "photo.jpg", photo);
  write("depth_before.png", ColorizeDepth(before.depth, page.range));
  write("depth_after.png", ColorizeDepth(after.depth, page.range));
  write("normals_before.png", ColorizeNormals(before.normal));
  write("normals_after.png", ColorizeNormals(after.normal));
  AddShares(paths.provenance, after.provenance, &page);
  write("provenance.png", ColorizeProvenance(after.provenance));
  if (page.has_confidence) {
    write("confidence.png", ColorizeConfidence(after.confidence));
  }
  if (page.has_planes) {
    write("planes.png", ColorizePlanes(after.planes));
  }
  return page;
}

}  // namespace tsar
