// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/plane_view.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/view/refined_maps.h"

#include <algorithm>
#include <string>

namespace tsar {
namespace {

constexpr double kBinsPerOctave = 8.0;

}  // namespace

std::vector<int> FindPlaneViews(const Workspace& workspace) {
  std::vector<int> images;
  for (int image = 0; image < workspace.NumImages(); ++image) {
    if (Exists(workspace.Paths(image, workspace.Type()).planes)) {
      images.push_back(image);
    }
  }
  return images;
}

PlaneView ReadPlaneView(const Workspace& workspace, int image, int num_planes) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  PlaneView view;
  view.image = image;
  view.depth = ReadImageDepth(workspace, image);
  view.camera = workspace.CameraOf(image).Resized(view.depth.Width(),
                                                  view.depth.Height());
  view.provenance = RequireSizeOf(
      view.depth, paths.provenance, ReadGrayPng(paths.provenance));
  view.planes =
      RequireSizeOf(view.depth, paths.planes, ReadGray16Png(paths.planes));
  const int largest = *std::ranges::max_element(view.planes);
  if (largest > num_planes) {
    throw Error::File(ErrorCode::kMismatch,
                      paths.planes.string(),
                      "names plane " + std::to_string(largest - 1) + " of " +
                          std::to_string(num_planes) +
                          ", so it is not of the same run as "
                          "stereo/tsar/planes.bin",
                      "refine the workspace again");
  }
  return view;
}

double PlaneStatistics::MedianFootprint() const {
  int64_t num_smaller = 0;
  for (const auto& [bin, count] : footprints) {
    num_smaller += count;
    if (2 * num_smaller >= num_pixels) {
      return std::exp2(bin / kBinsPerOctave);
    }
  }
  return 0.0;
}

bool PlaneStatistics::IsSeenFromNormalSide() const {
  int64_t balance = 0;
  for (const PlaneSighting& sighting : sightings) {
    balance +=
        sighting.is_on_normal_side ? sighting.num_pixels : -sighting.num_pixels;
  }
  return balance >= 0;
}

void AddStatistics(const PlaneView& view,
                   const std::vector<PlaneCoordinates>& planes,
                   std::vector<PlaneStatistics>* statistics) {
  ForEachPlanePixel(
      view,
      planes,
      [&](int p, int x, int y, const auto&, const PlaneProjection::Hit& hit) {
        PlaneStatistics& of_plane = (*statistics)[p];
        if (of_plane.sightings.empty() ||
            of_plane.sightings.back().image != view.image) {
          const PlaneCoordinates& plane = planes[p];
          of_plane.sightings.push_back(
              {view.image,
               0,
               plane.normal.dot(view.camera.Center() - plane.origin) > 0.0});
        }
        ++of_plane.sightings.back().num_pixels;
        ++of_plane.num_pixels;
        of_plane.num_measured += view.provenance(x, y) ==
                                 static_cast<uint8_t>(Provenance::kMeasured);
        of_plane.box.extend(hit.point);
        ++of_plane.footprints[static_cast<int>(
            std::lround(kBinsPerOctave * 0.5 * std::log2(hit.area)))];
      });
}

}  // namespace tsar
