// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/write_back.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/picture_file.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/links.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/view/refined_maps.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <opencv2/core.hpp>

namespace tsar {
namespace {

void RequireSameSizes(const RefinedMaps& maps, const std::string& image) {
  if (!maps.normal.HasSizeOf(maps.depth) ||
      !maps.confidence.HasSizeOf(maps.depth) ||
      !maps.provenance.HasSizeOf(maps.depth) ||
      (!maps.planes.Empty() && !maps.planes.HasSizeOf(maps.depth)) ||
      (!maps.sigma.Empty() && !maps.sigma.HasSizeOf(maps.depth))) {
    throw Error(ErrorCode::kMismatch,
                image +
                    ": the refined maps differ in size; this is a mistake "
                    "of the program, please report it");
  }
}

Image<uint8_t> ToLevels(const Image<float>& confidence) {
  Image<uint8_t> levels(confidence.Width(), confidence.Height());
  std::ranges::transform(confidence, levels.begin(), &ToConfidenceLevel);
  return levels;
}

// Encodes one channel with the bit depth of T.
template <typename T>
void PutPng(const Image<T>& values,
            const std::filesystem::path& path,
            AtomicFile* file) {
  // Encoding only reads. OpenCV's default settings are the fastest; the others
  // save a few per cent.
  PutPicture(cv::Mat(values.Height(),
                     values.Width(),
                     cv::DataType<T>::type,
                     const_cast<T*>(values.Data())),
             ".png",
             path,
             file);
}

// For a map that was written anew: the stored one is no longer an original.
void SupersedeOriginal(const ContainedPath& current,
                       const ContainedPath& stored) {
  const ContainedPath moved = Supersede(stored, current);
  Warn(current.string() +
       ": this map is newer than its refinement and counts "
       "as the original now; the one before is " +
       moved.string());
}

void KeepOriginal(OriginalState state,
                  const ContainedPath& current,
                  const ContainedPath& stored) {
  if (state == OriginalState::kMissing) {
    throw Error::File(ErrorCode::kNotFound,
                      current.string(),
                      "there is no map to refine",
                      "run patch_match_stereo for this image");
  }
  if (state != OriginalState::kStored) {
    LinkOrCopyFile(current, stored);
  }
}

void KeepBoth(const OriginalMaps& originals, const MapPaths& paths) {
  // Both former originals go first, so that at every instant the stored maps
  // are both former or both current.
  if (originals.depth.state == OriginalState::kReplaced) {
    SupersedeOriginal(paths.depth, paths.original_depth);
  }
  if (originals.normal.state == OriginalState::kReplaced) {
    SupersedeOriginal(paths.normal, paths.original_normal);
  }
  KeepOriginal(originals.depth.state, paths.depth, paths.original_depth);
  KeepOriginal(originals.normal.state, paths.normal, paths.original_normal);
}

// The inverse of KeepOriginal.
void PutOriginalBack(OriginalState state,
                     const ContainedPath& current,
                     const ContainedPath& stored) {
  if (state == OriginalState::kStored) {
    RenameFile(stored, current);
  } else if (state == OriginalState::kReplaced) {
    SupersedeOriginal(current, stored);
  }
}

void FillIn(const Workspace& workspace, int image, ImageRecord* record) {
  record->version = TSAR_VERSION;
  record->image = workspace.Name(image);
  record->type = ToString(workspace.Type());
}

}  // namespace

WriteBack::WriteBack(const Workspace& workspace, int image, ImageRecord record)
    : workspace_(workspace),
      image_(image),
      paths_(workspace.Paths(image, workspace.Type())),
      record_(std::move(record)) {
  FillIn(workspace, image, &record_);
}

void WriteBack::PrepareFiles(const RefinedMaps& maps) {
  RequireSameSizes(maps, record_.image);
  const auto add_file = [this](const ContainedPath& path) {
    CreateFolders(path.Parent());
    files_.emplace_back(path);
  };
  add_file(paths_.depth);
  add_file(paths_.normal);
  add_file(paths_.confidence);
  add_file(paths_.provenance);
  has_planes_ = !maps.planes.Empty();
  if (has_planes_) {
    add_file(paths_.planes);
  }
  has_sigma_ = !maps.sigma.Empty();
  if (has_sigma_) {
    add_file(paths_.sigma);
  }
  // An earlier refinement may still be in place until the files are renamed.
  const ImageRecord earlier = ReadRecord(paths_.record).value_or(ImageRecord());
  record_.depth = earlier.depth;
  record_.normal = earlier.normal;
  record_.depth.written.insert(record_.depth.written.begin(),
                               PutDepthMap(maps.depth, &files_[0]));
  record_.normal.written.insert(record_.normal.written.begin(),
                                PutNormalMap(maps.normal, &files_[1]));
  PutPng(ToLevels(maps.confidence), paths_.confidence, &files_[2]);
  PutPng(maps.provenance, paths_.provenance, &files_[3]);
  if (has_planes_) {
    PutPng(maps.planes, paths_.planes, &files_[4]);
  }
  if (has_sigma_) {
    PutSigmaMap(maps.sigma, &files_.back());
  }
  for (AtomicFile& file : files_) {
    file.Prepare();
  }
  record_.depth.written.front().time = files_[0].Time();
  record_.normal.written.front().time = files_[1].Time();
}

void WriteBack::Commit() {
  KeepOriginals();
  RecordWriting();
  RenameFiles();
  RecordDone();
}

void WriteBack::KeepOriginals() {
  const OriginalMaps originals =
      FindOriginals(workspace_.SourcePaths(image_, workspace_.Type()));
  if (!workspace_.IsOutput()) {
    KeepBoth(originals, paths_);
    // A map that was stored before is in the record already.
    const auto describe = [](OriginalState state,
                             const ContainedPath& stored,
                             std::optional<WrittenMap>* original) {
      if (state != OriginalState::kStored || !*original) {
        *original = DescribeMap(stored);
      }
    };
    describe(
        originals.depth.state, paths_.original_depth, &record_.depth.original);
    describe(originals.normal.state,
             paths_.original_normal,
             &record_.normal.original);
  }
}

void WriteBack::RecordWriting() {
  record_.status = ImageStatus::kWriting;
  WriteRecord(paths_.record, record_);
}

void WriteBack::RenameFiles() {
  // Files of an earlier refinement do not belong to these maps.
  if (!has_planes_) {
    RemoveFile(paths_.planes);
  }
  if (!has_sigma_) {
    RemoveFile(paths_.sigma);
  }
  for (AtomicFile& file : files_) {
    file.Commit();
  }
}

void WriteBack::RecordDone() {
  record_.status = ImageStatus::kDone;
  record_.depth.written.resize(1);
  record_.normal.written.resize(1);
  for (const ResultFile& file : ResultFiles(paths_)) {
    if (IsFile(*file.path)) {
      record_.results[file.name] = {
          HashFile(*file.path), TimeOf(*file.path), {}};
    }
  }
  WriteRecord(paths_.record, record_);
}

void KeepImage(const Workspace& workspace, int image, ImageRecord record) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  const OriginalMaps originals =
      FindOriginals(workspace.SourcePaths(image, workspace.Type()));
  if (workspace.IsOutput()) {
    LinkMap(originals.depth, paths.depth);
    LinkMap(originals.normal, paths.normal);
  } else {
    PutOriginalBack(originals.depth.state, paths.depth, paths.original_depth);
    PutOriginalBack(
        originals.normal.state, paths.normal, paths.original_normal);
  }
  RemoveResults(paths);
  FillIn(workspace, image, &record);
  record.status = ImageStatus::kKept;
  record.depth.written.clear();
  record.normal.written.clear();
  WriteRecord(paths.record, record);
}

void StoreOriginals(const Workspace& workspace, int image) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  const OriginalMaps originals = FindOriginals(paths);
  if (!ReadRecord(paths.record)) {
    // With a record, a map that is found in place later is known to be newer.
    ImageRecord record;
    FillIn(workspace, image, &record);
    WriteRecord(paths.record, record);
  }
  KeepBoth(originals, paths);
}

bool IsDone(const Workspace& workspace,
            int image,
            const std::string& options_hash,
            const std::map<std::string, std::string>& inputs) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  const std::optional<ImageRecord> record = ReadRecord(paths.record);
  if (!record || record->status != ImageStatus::kDone ||
      record->options_hash != options_hash || record->version != TSAR_VERSION ||
      record->inputs != inputs) {
    return false;
  }
  // The inputs cover the originals, also those in another workspace.
  const auto is_there = [](const ContainedPath& path,
                           const std::vector<WrittenMap>& written) {
    return IsFile(path) && IsAnyOf(path, written, Scrutiny::kTimeAndSamples);
  };
  return is_there(paths.depth, record->depth.written) &&
         is_there(paths.normal, record->normal.written) &&
         std::ranges::all_of(ResultFiles(paths), [&](const ResultFile& file) {
           const auto written = record->results.find(file.name);
           return written == record->results.end() ||
                  is_there(*file.path, {written->second});
         });
}

}  // namespace tsar
