// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/workspace_check.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace tsar {

// What the images at work take of the memories, in bytes. Every number holds
// for the largest map of the workspace and the image with most sources.
struct MemoryPlan {
  int num_sources = 0;  // Of the image with most.

  // Of a device's memory, which is main memory where the device is the CPU: all
  // that a device needs for one image at a time beside the sources that were
  // uploaded, and one of these.
  int64_t work = 0;
  int64_t uploaded_view = 0;
  // Of a device's memory, for images that are refined together with their
  // neighbours; otherwise 0. The part of work that labelling a view takes.
  int64_t label_work = 0;

  // Parts of main memory. A view as it is used together with its sources, and,
  // where that is a reduced one, the whole view of an image that is composed,
  // which needs no others.
  int64_t view = 0;
  int64_t whole_view = 0;
  // What reading a view takes at most beside the view itself.
  int64_t load = 0;
  // An image on its way from a worker to the disk: its maps with their encoded
  // files, or what was measured in it.
  int64_t result = 0;

  // Of main memory, for images that are refined together with their neighbours;
  // otherwise 0. Making the evidence of an image of what was measured in it:
  int64_t make_evidence = 0;
  // Finding the planes of a block of views, with their evidence, and labelling
  // a view with planes, with the evidence of it and its sources; each in a pass
  // in which nothing else is done.
  int64_t model_block = 0;
  int64_t label_view = 0;
  // What an image needs of its own evidence, with the reduced hypotheses that
  // this rates, and what of a neighbour's.
  int64_t own_evidence = 0;
  int64_t neighbour_evidence = 0;
};

// The plan for another workspace with the same options.
using MemoryPlanner = std::function<MemoryPlan(const WorkspaceOverview&)>;

MemoryPlan PlanRefinement(const RefineOptions& options,
                          const WorkspaceOverview& overview);

// Parts of plans that do not depend on what is done to the images: see
// MemoryPlan.
int64_t ViewBytes(const WorkspaceOverview& overview);
// To read a view, beside the view itself.
int64_t LoadBytes(const WorkspaceOverview& overview);
// To read a mask for maps that are about to be written.
int64_t ReadMaskBytes(const WorkspaceOverview& overview);

// Whether some map is reduced where images are refined together with their
// neighbours (ReduceView), and what the largest view takes then.
bool HasReducedViews(const WorkspaceOverview& overview);
int64_t ReducedViewBytes(const WorkspaceOverview& overview);

// All the views of one image in main memory.
int64_t BytesForViews(const MemoryPlan& plan);

// What a DeviceViewCache may hold for this many workers: the sources of an
// image, which those after it share for the most part.
int64_t SharedViewBytes(const MemoryPlan& plan, int num_workers);

// The same plan where devices do nothing but label views, which takes no
// uploaded ones.
MemoryPlan ForLabelsAlone(MemoryPlan plan);

// What this many workers that share a device's memory take of it.
int64_t DeviceBytes(const MemoryPlan& plan, int num_workers);

// The views whose evidence is kept in main memory, and what they take: a
// neighbourhood for each image at work, and one for those to come.
size_t NumEvidenceViews(const WorkspaceOverview& overview, size_t num_images);
int64_t EvidenceBytes(const MemoryPlan& plan, size_t num_images);

}  // namespace tsar
