// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/workspace_check.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace tsar {

// The memory that images at work take, in bytes. Every value holds for the
// largest map of the workspace and the image with most sources.
struct MemoryPlan {
  int num_sources = 0;  // The largest number.

  // Device memory, which is main memory where the device is the CPU: the memory
  // of one image at work without its uploaded sources, and one uploaded source.
  int64_t work = 0;
  int64_t uploaded_view = 0;
  // Device memory for labeling a view, a part of work; 0 unless images are
  // refined together with their neighbors.
  int64_t label_work = 0;

  // Main memory of a view as it is used together with its sources. whole_view:
  // 0 unless that view is a reduced one; the full view of an image that is
  // composed, which needs no others.
  int64_t view = 0;
  int64_t whole_view = 0;
  // The most that reading a view takes beside the view itself.
  int64_t load = 0;
  // The result of an image on its way from a worker to the disk: its maps with
  // their encoded files, or its measurements.
  int64_t result = 0;

  // Main memory for images that are refined together with their neighbors;
  // otherwise 0. Making the evidence of an image from its measurements:
  int64_t make_evidence = 0;
  // Finding the planes of a block of views, with their evidence, and labeling a
  // view with planes, with the evidence of it and its sources; each in a pass
  // in which nothing else is done.
  int64_t model_block = 0;
  int64_t label_view = 0;
  // An image's own evidence, with the reduced hypotheses that it scores, and
  // the evidence of one neighbor.
  int64_t own_evidence = 0;
  int64_t neighbor_evidence = 0;
};

// The plan for another workspace with the same options.
using MemoryPlanner = std::function<MemoryPlan(const WorkspaceOverview&)>;

MemoryPlan PlanRefinement(const RefineOptions& options,
                          const WorkspaceOverview& overview);

// The values of MemoryPlan that do not depend on the options.
int64_t ViewBytes(const WorkspaceOverview& overview);
// The memory of reading a view, beside the view itself.
int64_t LoadBytes(const WorkspaceOverview& overview);
// The memory of reading a mask for maps that are about to be written.
int64_t ReadMaskBytes(const WorkspaceOverview& overview);

// Whether some map is reduced where images are refined together with their
// neighbors (ReduceView), and the size of the largest view then.
bool HasReducedViews(const WorkspaceOverview& overview);
int64_t ReducedViewBytes(const WorkspaceOverview& overview);

// The main memory of all the views of one image.
int64_t BytesForViews(const MemoryPlan& plan);

// The size of a DeviceViewCache for this many workers: the sources of an image,
// most of which the following images share.
int64_t SharedViewBytes(const MemoryPlan& plan, int num_workers);

// The plan where devices only label views, which needs no uploaded ones.
MemoryPlan ForLabelsAlone(MemoryPlan plan);

// The memory of this many workers that share a device.
int64_t DeviceBytes(const MemoryPlan& plan, int num_workers);

// The number of views whose evidence is kept in main memory, a neighborhood for
// each image at work and one for those to come, and its size.
size_t NumEvidenceViews(const WorkspaceOverview& overview, size_t num_images);
int64_t EvidenceBytes(const MemoryPlan& plan, size_t num_images);

}  // namespace tsar
