// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/view_data.h"

#include <memory>
#include <mutex>
#include <vector>

namespace tsar {

// Reads the views of a run, by their indices in the sparse model: photo, maps,
// mask and depth prior. Can be used from several threads.
class ViewLoader {
 public:
  // workspace must outlive this object.
  explicit ViewLoader(const Workspace& workspace)
      : workspace_(workspace), mutexes_(workspace.Model().images.size()) {}

  std::shared_ptr<const ViewData> Load(int image);
  // The view reduced to the size at which depths are judged, see reduce_view.h.
  std::shared_ptr<const ViewData> LoadReduced(int image);

  // While the lock is held, nobody reads the files of the image. A thread that
  // reads its originals while another renames its refined maps could take these
  // for maps that COLMAP wrote anew.
  std::unique_lock<std::mutex> Lock(int image) {
    return std::unique_lock(mutexes_[image]);
  }

 private:
  const Workspace& workspace_;
  std::vector<std::mutex> mutexes_;  // By image of the sparse model.
};

}  // namespace tsar
