// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/refined_maps.h"

namespace tsar {

// Records that the image keeps its original maps, and the reason (record.note).
// Where they had been refined by an earlier run, the originals are put back.
void KeepImage(const Workspace& workspace, int image, ImageRecord record);

// Whether the image was refined as this record says, with the same options from
// the same inputs, and all files are still those written then. Kept images are
// not done: their missing inputs may have been added.
bool IsDone(const Workspace& workspace, int image, const ImageRecord& expected);

// Replaces the originals by the refined maps of workspace.Type(). First the
// maps are encoded and flushed to temporary files, which takes most of the
// time; then the record is written, the originals are kept, and the maps
// renamed. At every instant each map file is the complete original or the
// complete refined one, and the original is kept in stereo/tsar/original.
// record: what the maps were made from, counts, seconds and note. Thread-safe
// for different images. Throws Error: kMismatch (values that are not finite),
// kNotFound (the image has no maps), what FindOriginals throws, kIo.
void WriteRefined(const Workspace& workspace,
                  int image,
                  const RefinedMaps& maps,
                  ImageRecord record);

}  // namespace tsar
