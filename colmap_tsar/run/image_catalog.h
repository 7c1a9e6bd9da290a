// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/pipeline_outcome.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/run/view_cache.h"
#include "colmap_tsar/view/refined_maps.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace tsar {

// The images of a run, by their indices in Workspace::Problems(): their inputs,
// whether they are to be refined, and the only access to their maps while
// threads read and write them. Images of the sparse model, which may also be
// sources alone, are called `image` and given by their indices there. Can be
// used from several threads.
class ImageCatalog {
 public:
  // All references must outlive this object. has_maps: see WorkspaceOverview.
  // options_hash: the hash of the options that the images are refined with.
  // planes: a fingerprint of the current planes of the scene, where images
  // share them; images that were refined with others are refined again.
  // reuses_results: whether images that were refined before the run stay so.
  // distrust_unmatched: see RefineOptions.
  ImageCatalog(const Workspace& workspace,
               std::vector<bool> has_maps,
               std::string options_hash,
               InputFingerprints& inputs,
               std::string planes,
               bool reuses_results,
               bool distrust_unmatched);

  // Selects the images of the run that are to be refined, by default all; the
  // others stay as they are and serve as sources alone.
  void RefineOnly(std::vector<bool> is_listed);

  size_t NumImages() const { return workspace_.Problems().size(); }
  int Reference(size_t index) const { return Problem(index).reference; }
  const std::string& Name(int image) const;
  bool HasMaps(int image) const;
  // See load_view.h.
  bool IsMaskedAway(int image) const;
  // The sources that have maps.
  std::vector<int> Sources(size_t index) const;
  // The views that single-view stages need.
  std::vector<int> SourcesAndReference(size_t index) const;
  int NumSourcesWithoutMaps(size_t index) const;
  // Whether the image and at least one of its sources have maps.
  bool CanRefine(size_t index) const;

  bool ReusesResults() const { return reuses_results_; }
  // Whether the image had been refined before the run and is not to be refined
  // again. The first call checks its maps and inputs.
  bool HasBeenRefined(size_t index);
  // Whether the image is listed, can be refined, and has not been refined
  // before the run.
  bool IsToBeRefined(size_t index);
  // Whether the image was refined before the run with other options, or from
  // inputs that have changed since.
  bool WasRefinedOtherwise(size_t index);
  // Whether the image, or one whose source it is, is to be refined.
  bool IsNeeded(size_t index);
  // Whether some image is to be refined.
  bool IsAnyNeeded();
  bool IsListed(size_t index) const { return is_listed_[index]; }
  size_t NumListed() const;
  // Warns where the image is to be refined again because an input has changed.
  void WarnOfChanges(size_t index);

  // Sets the fingerprint of the planes that images refined from now on have,
  // where images share the planes of the scene.
  void UsePlanes(std::string planes) { used_planes_ = std::move(planes); }

  // Reads a view while no thread renames its files.
  ViewCache::View Load(int image);
  // The view at the size at which it is judged.
  ViewCache::View LoadReduced(int image);

  // Keeps the image, and records the reason, where it cannot be refined. The
  // outcome is kNotDone where it is to be refined.
  ImageReport BeginRefining(size_t index);
  // Replaces the maps by the refined ones, without masked pixels, and records
  // the counts and times of the report and the times of earlier passes.
  void WriteRefined(size_t index, RefinedMaps maps, ImageReport* report);
  // Keeps the original maps, and records the reason.
  void Keep(size_t index, const std::string& reason, ImageReport* report);

  // Adds the seconds, by stages, that an earlier pass took for an image.
  void AddSeconds(size_t index, const std::map<std::string, double>& seconds);

 private:
  const StereoProblem& Problem(size_t index) const {
    return workspace_.Problems()[index];
  }
  // The inputs of InputFingerprints::OfResult, and the fingerprint of the
  // planes.
  InputState InputsOf(int image, const std::string& planes);
  void DropUnmatchedDepths(size_t index, ViewData* view);

  const Workspace& workspace_;
  const std::vector<bool> has_maps_;
  const std::string options_hash_;
  InputFingerprints& inputs_;
  const std::string planes_;
  std::string used_planes_;
  const bool reuses_results_;
  const bool distrust_unmatched_;
  std::vector<bool> is_listed_;  // By image of the run.
  // By image of the run: whether it had been refined before the run; valid once
  // the flag is set.
  std::vector<std::once_flag> is_done_flags_;
  std::vector<uint8_t> is_done_;
  std::once_flag is_any_needed_flag_;
  bool is_any_needed_ = false;
  // By image of the sparse model: its index among those of the run; -1: none.
  std::vector<int64_t> index_of_;
  // By image of the sparse model: the images of the run that need it as their
  // reference or as a source.
  std::vector<std::vector<size_t>> users_;
  // By image of the run: the seconds that AddSeconds added.
  std::vector<std::map<std::string, double>> seconds_;
  // By image of the sparse model. A thread that reads the originals of an image
  // while another renames its refined maps could take these for maps that
  // COLMAP wrote anew.
  std::vector<std::mutex> file_mutexes_;
};

// Adds seconds, by stages, to their sums.
void AddStageSeconds(const std::map<std::string, double>& seconds,
                     std::map<std::string, double>* sums);

}  // namespace tsar
