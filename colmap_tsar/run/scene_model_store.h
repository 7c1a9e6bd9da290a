// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <string>

namespace tsar {

// The planes of a workspace's scene, in stereo/tsar/planes.bin. The file holds
// the labels of all views, so that a killed run resumes from there, until the
// run ends.
class SceneModelStore {
 public:
  // workspace and inputs must outlive this object. options_hash: a model made
  // with other options is not current.
  SceneModelStore(const Workspace& workspace,
                  const InputFingerprints& inputs,
                  std::string options_hash);

  // Whether there is a model with labels, made with these options from all
  // views in their current state.
  bool IsCurrent() const;

  // Warns where the model has more planes than plane maps can represent.
  void Write(const SceneModel& model) const;
  // Throws kNotFound where none is current.
  SceneModel Read() const;

  // A fingerprint of the planes alone; empty where none can be read.
  std::string PlanesFingerprint() const;

  // At the end of a complete run, removes the labels and the fingerprint of the
  // input files, so that the same maps give the same bytes.
  static void DropLabels(const Workspace& workspace);
  // Removes the model.
  static void Remove(const Workspace& workspace);

 private:
  std::string Fingerprint() const;

  const Workspace& workspace_;
  const InputFingerprints& inputs_;
  const std::string options_hash_;
};

}  // namespace tsar
