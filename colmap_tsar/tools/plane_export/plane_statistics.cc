// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/plane_statistics.h"

#include "colmap_tsar/view/refined_maps.h"

#include <cmath>

namespace tsar {
namespace {

constexpr double kBinsPerOctave = 8.0;

}  // namespace

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
