// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// For each of Problems(), whether a file of image names lists its reference,
// see ReadImageList; the file may list an image several times. All are listed
// where the path is empty. Throws Error: what ReadImageList throws, and
// kMismatch where an image has no sources in patch-match.cfg.
std::vector<bool> FindListedImages(const Workspace& workspace,
                                   const std::filesystem::path& list);

// The part of the records of images refined with these options that says what
// they were made from: the options, the inputs and, if images share them, the
// current planes of the scene.
ImageRecord CurrentRecord(const Workspace& workspace,
                          const RefineOptions& options,
                          const InputFingerprints& inputs);

// Which images a run refines: for each image, by its index in
// Workspace::Problems(), whether it has maps and whether it is to be refined.
// Images of the sparse model, which may be sources only, are called `image` and
// given by their indices there. Reads records and the states of files, no
// pixels. Can be used from several threads.
class ImageSelection {
 public:
  // All references must outlive this object. has_maps: see WorkspaceOverview.
  // is_listed: the images that are to be refined; the others stay as they are
  // and serve only as sources. expected: see CurrentRecord; images with other
  // records are refined again. Throws what ReadRecord throws.
  ImageSelection(const Workspace& workspace,
                 const InputFingerprints& inputs,
                 std::vector<bool> has_maps,
                 std::vector<bool> is_listed,
                 const ImageRecord& expected);

  size_t NumImages() const { return workspace_.Problems().size(); }
  const StereoProblem& Problem(size_t index) const {
    return workspace_.Problems()[index];
  }
  int Reference(size_t index) const { return Problem(index).reference; }
  const std::string& Name(size_t index) const {
    return workspace_.Name(Reference(index));
  }
  bool HasMaps(int image) const { return has_maps_[image]; }
  // The sources that have maps.
  std::vector<int> Sources(size_t index) const;
  // The views that single-view stages need.
  std::vector<int> SourcesAndReference(size_t index) const;
  // Whether the image and at least one of its sources have maps.
  bool CanRefine(size_t index) const;
  bool IsListed(size_t index) const { return is_listed_[index]; }
  size_t NumListed() const;

  // Whether the image had been refined before the run and is not to be refined
  // again.
  bool HasBeenRefined(size_t index) const { return is_done_[index]; }
  // Whether the image is listed, can be refined, and has not been refined
  // before the run.
  bool IsToBeRefined(size_t index) const;
  // Whether the image, or one that uses it as a source, is to be refined.
  bool IsNeeded(size_t index) const { return is_needed_[Reference(index)]; }
  // Whether some image is to be refined.
  bool IsAnyNeeded() const { return is_any_needed_; }

  // For images that share the planes of the scene, which are recomputed if any
  // image is to be refined: throws kUnsupported, naming the list, where an
  // image that is not listed was refined before the run with other options, or
  // from inputs that have changed since.
  void RequireOthersFit(const std::filesystem::path& list) const;
  // Warns where images that were refined with these options are to be refined
  // again, and says which input has changed.
  void WarnOfChanges() const;

  // The report of the image before it is refined. The outcome is kNotDone if it
  // is to be refined; otherwise it is final, with the reason for kKept.
  ImageReport Begin(size_t index) const;

 private:
  const Workspace& workspace_;
  const InputFingerprints& inputs_;
  const std::vector<bool> has_maps_;
  // By image of the run, as before the run.
  const std::vector<bool> is_listed_;
  std::vector<bool> is_done_;
  // The records of refined images, whatever they were made from.
  std::vector<std::optional<ImageRecord>> records_;
  const std::string options_hash_;
  bool is_any_needed_ = false;
  // By image of the sparse model: whether an image that is to be refined needs
  // it as its reference or as a source.
  std::vector<bool> is_needed_;
};

}  // namespace tsar
