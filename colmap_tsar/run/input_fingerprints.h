// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/input_state.h"
#include "colmap_tsar/run/store/workspace.h"

#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace tsar {

// What the result of every image of a workspace depends on, beside the options
// and the program. Photos, masks, depth priors, label images and maps are told
// apart by their sizes and times, which links and renaming keep. Can be used
// from several threads.
class InputFingerprints {
 public:
  // workspace must outlive this object.
  explicit InputFingerprints(const Workspace& workspace);

  // Null where the image is no reference.
  const StereoProblem* Problem(int image) const {
    return problems_[static_cast<size_t>(image)];
  }

  // What an image's view is loaded from: "camera", "photo", "mask" and "prior"
  // where it has one, "regions" where it has a label image, "maps" (the
  // originals, of both types) and "costs"; "maps" alone where there is nothing
  // to refine. It is that of the first call, which must come before the files
  // are read and before the image's maps are changed. Throws what FindOriginals
  // throws.
  const InputState& OfView(int image);

  // One fingerprint of OfView().
  const std::string& StateOfView(int image);

  // One fingerprint of all views that are references or sources, and of which
  // sources the references have: of what the planes of the scene are found in.
  const std::string& StateOfScene();

  // What a reference's result is made from: OfView(), "sources" (which they
  // are) and "scene": StateOfScene(). There are no names in it, since these
  // need not be UTF-8.
  InputState OfResult(int reference);

  // What differs between the recorded state of a result and that of today, such
  // as "its photo and its maps have changed" or "other images of the scene have
  // changed"; empty where nothing does.
  std::string ChangesOfResult(int reference, const InputState& recorded);

  // For a run beside others that are changing the maps of references: from now
  // on these views, by image, are taken to be in this state. OfView() then
  // reads of the files what is safe to read, which are all of those that this
  // run works on, `own`; and throws kMismatch where they are in another state.
  void Expect(std::map<int, InputState> views, const std::vector<int>& own);

 private:
  struct View {
    std::once_flag flag;
    InputState state;
    std::string fingerprint;
  };

  const View& Find(int image);
  InputState Read(int image) const;
  std::string MapsOf(int image) const;
  std::string PriorOf(int image) const;
  const std::string& Name(int image) const;

  const Workspace& workspace_;
  // By image.
  std::vector<const StereoProblem*> problems_;
  std::vector<std::string> source_lists_;
  std::vector<View> views_;
  std::once_flag scene_flag_;
  std::string scene_;
  std::map<int, InputState> expected_;
  std::vector<bool> is_own_;
};

}  // namespace tsar
