// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/scan_and_sort.h"
#include "colmap_tsar/view/regions/assign_region_planes.h"
#include "colmap_tsar/view/regions/hough.h"
#include "colmap_tsar/view/regions/roberts.h"

#include "benchmarks/stages/cases.h"
#include "benchmarks/stages/label_components.h"

namespace tsar {

std::vector<StageCase> SegmentationCases(const StageInputs& in) {
  const double pixels = in.NumPixels();
  const double raster = in.NumRasterPixels();
  return {
      // Bytes: color, the edges.
      {"Roberts",
       raster,
       4.0 * raster,
       [&in] {
         DetectRobertsEdges(in.views.RasterColor(),
                            static_cast<float>(in.options.edge_threshold),
                            in.device);
       }},
      // Bytes: the edges, read and drawn.
      {"Hough",
       raster,
       2.0 * raster,
       [&in] { DrawLineSegments(in.edges.View(), in.hough, in.device); }},
      // Bytes: edges, the labels written and read once each.
      {"FindRegions",
       raster,
       (1.0 + 8.0) * raster,
       [&in] {
         FindRegions(in.borders.View(), in.min_region_size, in.device);
       }},
      // Items: R. Bytes: labels and samples read twice, a plane written.
      {"RegionPlanes",
       raster,
       (2.0 * 16.0 + 16.0) * raster,
       [&in] {
         const RegionPlanes planes = FitRegionPlanes(in.regions,
                                                     in.samples.View(),
                                                     in.views.Scale(),
                                                     in.plane_options,
                                                     in.device);
         AssignRegionPlanes(in.regions,
                            planes,
                            in.samples.View(),
                            in.views.RasterIntrinsics(),
                            in.views.Scale(),
                            in.plane_options,
                            in.device);
       }},
      // Bytes: labels, pixel indices.
      {"GroupPixels",
       raster,
       8.0 * raster,
       [&in] {
         GroupPixels(
             in.superpixels.labels.View(), in.superpixels.count, in.device);
       }},
      // Of the whole map. Bytes: depth, labels written, read and written.
      {"LabelComponents",
       pixels,
       (4.0 + 12.0) * pixels,
       [&in] { LabelContinuousDepth(in.views.Hypotheses().depth, in.device); }},
  };
}

}  // namespace tsar
