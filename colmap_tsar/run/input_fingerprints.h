// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/run/store/workspace.h"

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace tsar {

// The inputs of a result, as fingerprints by input name, from which a later run
// sees which inputs have changed.
using InputState = std::map<std::string, std::string>;

// Fingerprints have 16 hexadecimal digits.
std::string FingerprintOf(const std::string& text);
std::string FingerprintOf(const Camera& camera);

// Size and time of last change, or "-" where there is no such file. Follows
// links.
std::string FileState(const std::filesystem::path& path);

// An input that changed: "its photo", "its maps".
struct ChangedInput {
  std::string name;
  bool is_plural = false;
};

// "its camera, its photo and its maps have changed"; at least one change.
std::string DescribeChanges(const std::vector<ChangedInput>& changes);

// The fingerprint of the files of an image's depth prior, and of their meaning.
std::string FingerprintOfPrior(const Workspace& workspace, int image);

// Fingerprints of all inputs of the images' results, beside the options and the
// program. Photos, masks, depth priors and maps are identified by their sizes
// and times, which links and renaming keep. Can be used from several threads.
class InputFingerprints {
 public:
  // workspace must outlive this object.
  explicit InputFingerprints(const Workspace& workspace);

  // Null where the image is no reference.
  const StereoProblem* Problem(int image) const { return problems_[image]; }

  // The state of the inputs of an image's view: "camera", "photo", "mask" and
  // "prior" where it has one, "maps" (the originals, of both types) and
  // "costs"; "maps" alone where there is nothing to refine. The state is that
  // of the first call, which must come before the files are read and before the
  // image's maps are changed. Throws what FindOriginals throws.
  const InputState& OfView(int image);

  // One fingerprint of OfView().
  const std::string& StateOfView(int image);

  // One fingerprint of the inputs of the planes of the scene: all views that
  // are references or sources, and the source lists of the references.
  const std::string& StateOfScene();

  // The state of the inputs of a reference's result: OfView(), "sources" (their
  // list), "scene" (StateOfScene()) and the fingerprint of the planes that it
  // is made with, if any. It holds no names, since these need not be UTF-8.
  InputState OfResult(int reference, const std::string& planes = "");

  // The differences between the recorded state of a result and the current one,
  // such as "its photo and its maps have changed" or "other images of the scene
  // have changed"; empty where there are none.
  std::string ChangesOfResult(int reference, const InputState& recorded);

  // For a run beside others that are changing the maps of references: sets the
  // states of these views, by image. OfView() then looks at no maps but those
  // of `own`, the images of this run, and throws kMismatch where a view is in
  // another state.
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
