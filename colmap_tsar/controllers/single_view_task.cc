// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/single_view_task.h"

#include "colmap_tsar/base/image_name_hash.h"

#include <utility>

namespace tsar {

ImageReport SingleViewTask::Begin(size_t index) {
  ImageReport report = RefineMapsTask::Begin(index);
  if (report.outcome == ImageReport::Outcome::kNotDone) {
    images_.WarnOfChanges(index);
  }
  return report;
}

RefineResult SingleViewTask::RefineMaps(size_t index,
                                        size_t worker,
                                        ViewCache::Lease* views) {
  const int image = images_.Reference(index);
  const ViewData& reference = views->Get(image);
  return RunSingleView(index,
                       worker,
                       views,
                       [&](std::vector<DeviceViewCache::View> sources,
                           Device& device,
                           StageObserver* observer) {
                         return RefineImage(reference,
                                            std::move(sources),
                                            HashImageName(images_.Name(image)),
                                            options_,
                                            device,
                                            observer);
                       });
}

}  // namespace tsar
