// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/refined_maps.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tsar {

// Records that the image keeps its original maps, and the reason (record.note).
// Where they had been refined by an earlier run, the originals are put back.
void KeepImage(const Workspace& workspace, int image, ImageRecord record);

// Whether the image was refined as this record says, with the same options from
// the same inputs, and all files are still those written then. Kept images are
// not done: their missing inputs may have been added.
bool IsDone(const Workspace& workspace, int image, const ImageRecord& expected);

// Replaces the originals by the refined maps of workspace.Type(), in steps to
// be called in this order. At every instant each map file is the complete
// original or the complete refined one, and the original is kept in
// stereo/tsar/original. Thread-safe for different images. Throws Error:
// kMismatch (values that are not finite), kNotFound (the image has no
// maps), what FindOriginals throws, kIo.
class WriteBack {
 public:
  WriteBack(const Workspace& workspace, int image, ImageRecord record);

  // Encodes the maps and flushes them to temporary files. This takes most of
  // the time and changes nothing that a reader of the image sees.
  void PrepareFiles(const RefinedMaps& maps);
  // Writes the record, keeps the originals, and renames the maps.
  void Commit();

 private:
  struct File {
    const char* name;  // As in ImageRecord::files.
    ContainedPath path;
    AtomicFile file;
    uint64_t hash = 0;  // Of the content; 0: not known.
  };
  AtomicFile& Add(const char* name, const ContainedPath& path);

  MapPaths paths_;
  ImageRecord record_;
  std::vector<File> files_;
};

}  // namespace tsar
