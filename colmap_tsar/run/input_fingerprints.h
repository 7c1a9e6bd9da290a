// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/run/store/workspace.h"

#include <map>
#include <string>

namespace tsar {

// Fingerprints have 16 hexadecimal digits.
std::string FingerprintOf(const std::string& text);
std::string FingerprintOf(const Camera& camera);

// All inputs of a run besides its options: of every image that is a reference
// or a source, the list of sources and, where there are maps to refine, the
// original maps and their costs, camera, photo, mask and depth
// prior. Files are identified by their sizes and times, which links and
// renaming keep. After any change all images of a run are refined again, since
// they share the planes of the scene.
class InputFingerprints {
 public:
  // To be constructed before the first file is read and the first map is
  // changed. workspace must outlive this object. Throws what FindOriginals
  // throws.
  explicit InputFingerprints(const Workspace& workspace);

  // The states of the inputs by their names, such as "the photo of a.png".
  const std::map<std::string, std::string>& States() const { return states_; }
  // One fingerprint of them, of the program's version and of the type of maps.
  const std::string& OfRun() const { return fingerprint_; }

  // What has changed since the inputs were in these states, such as "the photo
  // of a.png has changed"; empty where nothing has.
  std::string ChangesSince(
      const std::map<std::string, std::string>& states) const;

 private:
  void AddView(const Workspace& workspace, int image);

  std::map<std::string, std::string> states_;
  std::string fingerprint_;
};

}  // namespace tsar
