// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/workspace_check.h"

#include <cstdint>
#include <string>

namespace tsar {

// One image is copied while another is computed.
constexpr int kMaxGpuWorkers = 2;

// What the images at work take of the memories, in bytes. Every number holds
// for the largest map of the workspace and the image with most sources.

// A view in main memory: colour, depth, normal and, where there are any, two
// exported costs.
int64_t ViewBytes(const WorkspaceOverview& overview);

// What reading a view takes at most in main memory beside the view itself.
int64_t LoadBytes(const WorkspaceOverview& overview);

// An image on its way from a worker to the disk: its refined maps with their
// encoded files, or what was measured in it.
int64_t ResultBytes(const WorkspaceOverview& overview);

// The source views of one image in a device's memory.
int64_t SourceBytes(const WorkspaceOverview& overview);

// What a DeviceViewCache may hold for this many workers: the sources of an
// image, which those after it share for the most part.
int64_t SharedViewBytes(const WorkspaceOverview& overview, int num_workers);

// A device at work on one image: the sources, the reference, and all that the
// stages make of it at a time.
int64_t WorkBytes(const WorkspaceOverview& overview);

// The views whose evidence is kept in main memory, and what they take: a
// neighbourhood for each image at work, and one for those to come.
size_t NumEvidenceViews(const WorkspaceOverview& overview, size_t num_images);
int64_t EvidenceBytes(const WorkspaceOverview& overview, size_t num_images);

// Finding planes in the evidence of an image and its sources, or making the
// evidence of an image: beside the evidence, in main memory.
int64_t DiscoveryBytes(const WorkspaceOverview& overview);

// How many workers a GPU gets: kMaxGpuWorkers, or as many as fit. Throws
// kDevice, with what the user can do, where not even one does. gpu: what the
// message calls it.
int NumGpuWorkers(const WorkspaceOverview& overview,
                  int64_t free_bytes,
                  const std::string& gpu);

}  // namespace tsar
