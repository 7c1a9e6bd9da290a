// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/write_back.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/picture_file.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/view/refined_maps.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <opencv2/core.hpp>

namespace tsar {
namespace {

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

void FillIn(const Workspace& workspace, int image, ImageRecord* record) {
  record->image = workspace.Name(image);
  record->type = ToString(workspace.Type());
}

}  // namespace

WriteBack::WriteBack(const Workspace& workspace, int image, ImageRecord record)
    : paths_(workspace.Paths(image, workspace.Type())),
      record_(std::move(record)) {
  FillIn(workspace, image, &record_);
  record_.status = ImageStatus::kDone;
}

AtomicFile& WriteBack::Add(const char* name, const ContainedPath& path) {
  CreateFolders(path.Parent());
  return files_.emplace_back(File{name, path, AtomicFile(path)}).file;
}

void WriteBack::PrepareFiles(const RefinedMaps& maps) {
  files_.reserve(2 + kResultFolders.size());
  AtomicFile& depth = Add("depth", paths_.depth);
  files_.back().hash = PutDepthMap(maps.depth, &depth);
  AtomicFile& normal = Add("normal", paths_.normal);
  files_.back().hash = PutNormalMap(maps.normal, &normal);
  const auto add_png =
      [&](const char* name, const ContainedPath& path, const auto& values) {
        PutPng(values, path, &Add(name, path));
      };
  add_png("confidence", paths_.confidence, ToLevels(maps.confidence));
  add_png("provenance", paths_.provenance, maps.provenance);
  if (!maps.planes.Empty()) {
    add_png("planes", paths_.planes, maps.planes);
  }
  if (!maps.sigma.Empty()) {
    PutSigmaMap(maps.sigma, &Add("sigma", paths_.sigma));
  }
  for (File& file : files_) {
    record_.files[file.name] = {IdOfPrepared(file.path, &file.file, file.hash)};
  }
}

void WriteBack::Commit() {
  const OriginalMaps originals = FindOriginals(paths_);
  // A refined map of an earlier run stays until its name is given away.
  const auto list_earlier =
      [&](const OriginalMap& map, const char* name, const ContainedPath& path) {
        const std::optional<FileId> id = FindFileId(path);
        if (map.state == MapState::kRefined && id) {
          record_.files[name].push_back(*id);
        }
      };
  list_earlier(originals.depth, "depth", paths_.depth);
  list_earlier(originals.normal, "normal", paths_.normal);
  WriteRecord(paths_.record, record_);
  KeepOriginal(originals.depth, paths_.depth, paths_.original_depth);
  KeepOriginal(originals.normal, paths_.normal, paths_.original_normal);
  for (const ResultFile& result : ResultFiles(paths_)) {
    // Files of an earlier refinement do not belong to these maps.
    if (!record_.files.contains(result.name)) {
      RemoveFile(*result.path);
    }
  }
  for (File& file : files_) {
    file.file.Commit();
  }
}

void KeepImage(const Workspace& workspace, int image, ImageRecord record) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  const OriginalMaps originals = FindOriginals(paths);
  PutOriginalBack(originals.normal, paths.normal, paths.original_normal);
  PutOriginalBack(originals.depth, paths.depth, paths.original_depth);
  RemoveResults(paths);
  FillIn(workspace, image, &record);
  record.status = ImageStatus::kKept;
  WriteRecord(paths.record, record);
}

bool IsDone(const Workspace& workspace,
            int image,
            const ImageRecord& expected) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  const std::optional<ImageRecord> record = ReadRecord(paths.record);
  return record && record->status == ImageStatus::kDone &&
         record->options_hash == expected.options_hash &&
         record->inputs == expected.inputs &&
         record->planes == expected.planes &&
         record->Has("depth", paths.depth) &&
         record->Has("normal", paths.normal) &&
         std::ranges::all_of(ResultFiles(paths), [&](const ResultFile& file) {
           return !record->files.contains(file.name) ||
                  record->Has(file.name, *file.path);
         });
}

}  // namespace tsar
