// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/view_loader.h"

#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/view/reduce_view.h"
#include "colmap_tsar/view/unmatched_depths.h"

#include <algorithm>
#include <cstddef>
#include <memory>

namespace tsar {

ViewLoader::ViewLoader(const Workspace& workspace,
                       const RefinePlan& plan,
                       bool distrust_unmatched)
    : workspace_(workspace),
      plan_(plan),
      distrust_unmatched_(distrust_unmatched),
      mutexes_(workspace.Model().images.size()) {}

std::shared_ptr<const ViewData> ViewLoader::Load(int image) {
  const auto view = std::make_shared<ViewData>();
  {
    const std::unique_lock<std::mutex> lock = Lock(image);
    *view = LoadView(workspace_, image);
  }
  if (distrust_unmatched_ && view->is_unfiltered) {
    DropUnmatchedDepths(image, view.get());
  }
  return view;
}

std::shared_ptr<const ViewData> ViewLoader::LoadReduced(int image) {
  if (distrust_unmatched_) {
    // Depths are compared with the images at the size of the maps.
    const std::shared_ptr<const ViewData> view = Load(image);
    const int factor =
        ReductionFactor(view->depth.Width(), view->depth.Height());
    return factor == 1
               ? view
               : std::make_shared<const ViewData>(ReduceView(*view, factor));
  }
  const std::unique_lock<std::mutex> lock = Lock(image);
  return std::make_shared<const ViewData>(LoadReducedView(workspace_, image));
}

void ViewLoader::DropUnmatchedDepths(int image, ViewData* view) {
  const std::vector<StereoProblem>& problems = workspace_.Problems();
  const auto problem =
      std::ranges::find(problems, image, &StereoProblem::reference);
  if (problem == problems.end()) {
    return;
  }
  const std::vector<int> sources =
      plan_.Sources(static_cast<size_t>(problem - problems.begin()));
  UnmatchedDepths unmatched(*view, static_cast<int>(sources.size()));
  for (const int source : sources) {
    const ViewData other = [&] {
      // Locks one image at a time, so that two threads that load each other's
      // source do not deadlock.
      const std::unique_lock<std::mutex> lock = Lock(source);
      return LoadDepthAndColor(workspace_, source);
    }();
    unmatched.CompareWith(other);
  }
  unmatched.Drop(view);
}

}  // namespace tsar
