// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmarks/stages/stage_inputs.h"

#include "colmap_tsar/matching/agreement.h"
#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/filter/discontinuity.h"
#include "colmap_tsar/view/filter/reliability.h"
#include "colmap_tsar/view/regions/edges.h"

#include <algorithm>
#include <utility>

namespace tsar {

std::vector<const ViewData*> ViewSet::SourcePointers() const {
  std::vector<const ViewData*> pointers;
  for (const ViewData& source : sources) {
    pointers.push_back(&source);
  }
  return pointers;
}

ViewSet LoadFirstView(const std::filesystem::path& path, int max_sources) {
  const Workspace workspace(path, MapType::kGeometric);
  const StereoProblem& problem = workspace.Problems().at(0);
  ViewSet set{LoadView(workspace, problem.reference), {}};
  const size_t num_sources =
      std::min(problem.sources.size(), static_cast<size_t>(max_sources));
  for (size_t i = 0; i < num_sources; ++i) {
    set.sources.push_back(LoadView(workspace, problem.sources[i]));
  }
  return set;
}

StageInputs::StageInputs(const ViewSet& set, Device& target)
    : device(target),
      view_set(set),
      views(set.reference, UploadViews(set.SourcePointers(), device), device),
      hough_max_gap(ScaledLength(options.hough_max_gap, views.RasterScale())),
      min_region_size(MinRegionSize(options, views.RasterScale())),
      plane_options(MakeRegionPlaneOptions(options, views.RasterScale(), 0)),
      costs(ComputeMatchingCosts(views.Reference(), views.Sources(), device)),
      agreement(
          CountAgreeingSources(views.Reference(), views.Sources(), device)),
      confidence(ComputeConfidence(costs, device)),
      discontinuity(ComputeDiscontinuity(
          views.Hypotheses().depth, views.Scale(), device)),
      score(AggregateScores(views.Hypotheses().depth,
                            confidence.View(),
                            discontinuity.View(),
                            agreement.View(),
                            {},
                            device)),
      raster_score(ReduceNearest(score.View(), views.Raster(), device)),
      superpixels(ComputeSuperpixels(views.RasterColor(),
                                     raster_score.View(),
                                     options.superpixel_size,
                                     device)),
      correlation(
          RefineByCorrelation(views,
                              score.View(),
                              SelectReliable(score.View(), MinScore(), device),
                              superpixels,
                              options,
                              0,
                              device)),
      samples(SampleMeasurements(views.Hypotheses().depth,
                                 score.View(),
                                 correlation.trusted.View(),
                                 views.MapIntrinsics(),
                                 views.Raster(),
                                 device)),
      superpixel_groups(
          GroupPixels(superpixels.labels.View(), superpixels.count, device)),
      superpixel_planes(PlanesOfLabels(
          superpixels.labels.View(), correlation.planes, device)),
      edges(DetectRobertsEdges(views.RasterColor(),
                               static_cast<float>(options.edge_threshold),
                               device)),
      borders(DrawLineSegments(edges.View(), hough_max_gap, device)),
      regions(FindRegions(borders.View(), min_region_size, device)),
      region_planes(FitRegionPlanes(
          regions, samples.View(), views.Scale(), plane_options, device)),
      pixel_planes(AssignRegionPlanes(regions,
                                      region_planes,
                                      samples.View(),
                                      views.RasterIntrinsics(),
                                      views.Scale(),
                                      plane_options,
                                      device)),
      composed(Compose(OwnMap())) {}

DepthNormalImages StageInputs::OwnMap() const {
  DepthNormalImages own;
  own.depth = DeviceImage<float>(device, view_set.reference.depth);
  own.normal = DeviceImage<Vec3f>(device, view_set.reference.normal);
  return own;
}

ComposedMap StageInputs::Compose(DepthNormalImages own) const {
  return ComposeMap(std::move(own),
                    {correlation.trusted.View(),
                     views.OnMap(superpixel_planes),
                     views.OnMap(pixel_planes)},
                    views.Scale(),
                    device);
}

float StageInputs::MinScore() const {
  return static_cast<float>(options.min_aggregated_score);
}

double StageInputs::NumPixels() const {
  return static_cast<double>(views.Hypotheses().depth.NumPixels());
}

double StageInputs::NumRasterPixels() const {
  return static_cast<double>(views.Raster().width) * views.Raster().height;
}

double StageInputs::NumSources() const {
  return static_cast<double>(views.Sources().Size());
}

WeightedMedianOptions StageInputs::MedianOptions(double radius) const {
  WeightedMedianOptions median;
  median.radius =
      ScaledRadius(static_cast<float>(radius), views.Width(), views.Height());
  median.spatial_sigma = static_cast<float>(options.spatial_sigma);
  median.color_sigma = static_cast<float>(options.color_sigma);
  return median;
}

}  // namespace tsar
