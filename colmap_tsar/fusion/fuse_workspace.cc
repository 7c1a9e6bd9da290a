// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fuse_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/parse_number.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/fusion/fuse_images.h"
#include "colmap_tsar/fusion/fused_cloud_writer.h"
#include "colmap_tsar/fusion/fusion_neighbors.h"
#include "colmap_tsar/run/gpu_workers.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/run/store/workspace_lock.h"

#include <array>
#include <cstddef>
#include <sstream>
#include <string>
#include <thread>

namespace tsar {

Eigen::AlignedBox3d ReadBoundingBox(const std::filesystem::path& path) {
  InputFile file(path);
  file.RequireOpened("file of a box",
                     "check " + OptionName("bounding_box_path"));
  std::stringstream words;
  std::string line;
  for (bool is_first = true; ReadLine(file, is_first, &line);
       is_first = false) {
    words << line.substr(0, line.find('#')) << "\n";
  }
  std::array<double, 6> numbers = {};
  bool is_complete = true;
  for (double& number : numbers) {
    const std::optional<double> parsed = ReadNumber<double>(words);
    is_complete &= parsed.has_value();
    number = parsed.value_or(0.0);
  }
  std::string rest;
  is_complete &= !(words >> rest);
  const Eigen::AlignedBox3d box(Eigen::Vector3d::Map(&numbers[0]),
                                Eigen::Vector3d::Map(&numbers[3]));
  if (!is_complete || !(box.min().array() <= box.max().array()).all()) {
    throw Error::File(ErrorCode::kCorrupt,
                      path.string(),
                      "does not hold the six numbers of a box",
                      "write the smallest x, y and z, then the largest");
  }
  return box;
}

FuseSummary FuseWorkspace(Workspace workspace,
                          const FuseWorkspaceOptions& options,
                          Progress& progress) {
  const Stopwatch stopwatch;
  options.fusion.Check();
  const std::jthread preparing_gpus = BeginPreparingGpus(options.devices);
  workspace.UseMasks(options.mask_path);
  workspace.WarnOfStrayFiles();
  // The lock keeps the maps of an image consistent.
  const WorkspaceLock lock(workspace.Root(), WorkspaceLock::Mode::kShared);
  WarnOfChangedResults(workspace);
  const FusionPlan plan = PlanFusion(
      workspace, options.image_list_path, options.fusion.check_num_images);
  WarnOfConventions(workspace, plan.order);
  FusedCloudWriter writer(UserPath(options.output_path));
  const auto place_in_file = [&](int image) {
    return workspace.Model().images[image].index_in_file;
  };
  const FusionDevices devices = FuseImages(
      workspace,
      plan,
      options.fusion,
      options.devices,
      [&](size_t place, const FusedImage& fused) {
        const int image = plan.order[place];
        std::vector<int> sources;
        for (const int source : plan.sources[image]) {
          sources.push_back(place_in_file(source));
        }
        writer.Add(place,
                   EncodePoints(fused.points,
                                fused.view->camera,
                                options.bounding_box,
                                place_in_file(image),
                                sources));
      },
      progress);
  writer.Commit();
  return {static_cast<int>(plan.order.size()),
          workspace.CountMasks(plan.order),
          writer.NumPoints(),
          stopwatch.Seconds(),
          devices.description,
          devices.peak_gpu_memory};
}

}  // namespace tsar
