// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/write_back.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/picture_file.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/view/refined_maps.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

namespace tsar {
namespace {

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

// A complete file that has yet to get its name.
struct PreparedFile {
  const char* name;  // As in ImageRecord::files.
  AtomicFile file;
  FileId id;
};

std::vector<PreparedFile> PrepareFiles(const RefinedMaps& maps,
                                       const MapPaths& paths) {
  std::vector<PreparedFile> files;
  // put: writes the content and returns its hash, or 0.
  const auto add =
      [&](const char* name, const ContainedPath& path, const auto& put) {
        CreateFolders(path.Parent());
        AtomicFile file(path);
        const uint64_t hash = put(&file);
        const FileId id = IdOfPrepared(path, &file, hash);
        files.push_back({name, std::move(file), id});
      };
  const auto add_png =
      [&](const char* name, const ContainedPath& path, const auto& values) {
        add(name, path, [&](AtomicFile* file) {
          PutPng(values, path, file);
          return uint64_t{0};
        });
      };
  add("depth", paths.depth, [&](AtomicFile* file) {
    return PutDepthMap(maps.depth, file);
  });
  add("normal", paths.normal, [&](AtomicFile* file) {
    return PutNormalMap(maps.normal, file);
  });
  add_png("confidence", paths.confidence, maps.confidence);
  add_png("provenance", paths.provenance, maps.provenance);
  if (!maps.planes.Empty()) {
    add_png("planes", paths.planes, maps.planes);
  }
  if (!maps.sigma.Empty()) {
    add("sigma", paths.sigma, [&](AtomicFile* file) {
      PutSigmaMap(maps.sigma, file);
      return uint64_t{0};
    });
  }
  return files;
}

}  // namespace

void WriteRefined(const Workspace& workspace,
                  int image,
                  const RefinedMaps& maps,
                  ImageRecord record) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  FillIn(workspace, image, &record);
  record.status = ImageStatus::kDone;
  std::vector<PreparedFile> files = PrepareFiles(maps, paths);
  for (const PreparedFile& file : files) {
    record.files[file.name] = {file.id};
  }
  const OriginalMaps originals = FindOriginals(paths);
  // A refined map of an earlier run stays until it is replaced.
  const auto list_earlier =
      [&](const OriginalMap& map, const char* name, const ContainedPath& path) {
        const std::optional<FileId> id = FindFileId(path);
        if (map.state == MapState::kRefined && id) {
          record.files[name].push_back(*id);
        }
      };
  list_earlier(originals.depth, "depth", paths.depth);
  list_earlier(originals.normal, "normal", paths.normal);
  WriteRecord(paths.record, record);
  KeepOriginal(originals.depth, paths.depth, paths.original_depth);
  KeepOriginal(originals.normal, paths.normal, paths.original_normal);
  for (const ResultFile& result : ResultFiles(paths)) {
    // Files of an earlier refinement do not belong to these maps.
    if (!record.files.contains(result.name)) {
      RemoveFile(*result.path);
    }
  }
  for (PreparedFile& file : files) {
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
