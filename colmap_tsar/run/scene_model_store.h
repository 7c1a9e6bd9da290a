// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <string>

namespace tsar {

// The planes of a workspace's scene, in stereo/tsar/planes.bin: with the labels
// of all views until the run ends, so that a killed run goes on from there, and
// without them from then on.
class SceneModelStore {
 public:
  // workspace and inputs must outlive this object. options_hash: the model of
  // other options does not count.
  SceneModelStore(const Workspace& workspace,
                  InputFingerprints& inputs,
                  std::string options_hash);

  // Whether there is a model with labels, made with these options from all
  // views as they are.
  bool IsCurrent() const;

  // A warning says so where the model has more planes than plane maps can name.
  void Write(const SceneModel& model) const;
  // Throws kNotFound where none is current.
  SceneModel Read() const;

  // Stands for the planes alone; empty where there are none that can be read.
  std::string PlanesFingerprint() const;

  // Removes the labels, at the end of a complete run, and what tells of which
  // files they were made: the same maps then give the same bytes.
  static void DropLabels(const Workspace& workspace);
  // Removes the model.
  static void Remove(const Workspace& workspace);

 private:
  std::string Fingerprint() const;

  const Workspace& workspace_;
  InputFingerprints& inputs_;
  const std::string options_hash_;
};

}  // namespace tsar
