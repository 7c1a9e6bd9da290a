// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/refined_maps.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tsar {

// Records that the image keeps its original maps, and the reason (record.note).
// Where they had been refined by an earlier run, the originals are put back.
void KeepImage(const Workspace& workspace, int image, ImageRecord record);

// Stores the originals of an image that has maps, and changes nothing else, so
// that other programs find them there whatever becomes of the maps. Not for
// output workspaces, whose originals nobody changes.
void StoreOriginals(const Workspace& workspace, int image);

// Whether the image was refined with the same options from the same inputs (see
// ImageRecord) and all files are still those written then. Kept images are not
// done: their missing inputs may have been added.
bool IsDone(const Workspace& workspace,
            int image,
            const std::string& options_hash,
            const std::map<std::string, std::string>& inputs);

// Replaces the originals by the refined maps of workspace.Type(), in steps to
// be called in this order. At every instant each map file is the complete
// original or the complete refined one, and the original is kept in
// stereo/tsar/original (or, for an output workspace, in the input). Thread-safe
// for different images. Throws Error: kMismatch (sizes, or values that are not
// finite), kNotFound (the image has no maps), kIo.
class WriteBack {
 public:
  WriteBack(const Workspace& workspace, int image, ImageRecord record);

  // Encodes the maps and flushes them to temporary files. This takes most of
  // the time and changes nothing that a reader of the image sees.
  void PrepareFiles(const RefinedMaps& maps);
  // Does all that follows; while it runs, nobody may look for the originals.
  void Commit();

  // The steps of Commit(), public for tests of interruptions.
  void KeepOriginals();
  void RecordWriting();
  void RenameFiles();
  void RecordDone();

 private:
  const Workspace& workspace_;
  int image_;
  MapPaths paths_;
  ImageRecord record_;
  std::vector<AtomicFile> files_;
  // Whether there are files that not every refinement has.
  bool has_planes_ = false;
  bool has_sigma_ = false;
};

}  // namespace tsar
