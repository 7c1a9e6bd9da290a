// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"

#include <array>
#include <filesystem>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The part of COLMAP's sparse model that dense reconstruction needs.
class SparseModel {
 public:
  struct ModelImage {
    std::string name;  // Relative to images/, with '/' between folders.
    Camera camera;
    // The number of images before it in the file, by which COLMAP's visibility
    // files of fused points refer to images.
    int index_in_file = 0;
    // Indices into `points`, ascending, one per observation: a point that the
    // image sees twice is listed twice.
    std::vector<int> point_indices;
  };

  std::vector<ModelImage> images;       // By ascending COLMAP image id.
  std::vector<Eigen::Vector3d> points;  // World frame.
  // Names of images that are left out, whose poses are no numbers.
  std::set<std::string> without_pose;

  // The image of this name, or nullptr or -1 if there is none.
  const ModelImage* Find(const std::string& name) const;
  int IndexOf(const std::string& name) const;

  // Must be called after `images` was changed.
  void IndexNames();

 private:
  std::unordered_map<std::string, int> index_of_name_;
};

// The files of cameras, images and points3D in a folder, in this order: binary
// if all three .bin files exist, otherwise text. Throws Error kNotFound if the
// folder or files are missing.
std::array<std::filesystem::path, 3> FindSparseModelFiles(
    const std::filesystem::path& sparse_folder);

// Reads these files; the format is the same in all versions of COLMAP from 3.7
// on; images of rigs have their own poses, too. Quaternions are normalized.
//
// Throws Error: those of FindSparseModelFiles(), kUnsupported (a camera model
// other than PINHOLE and SIMPLE_PINHOLE), kCorrupt (anything that breaks the
// format: truncated files, counts larger than the file, ids that do not exist,
// duplicates, focal lengths that are not positive). Warns of images and points
// that it leaves out, whose poses and positions are no numbers.
SparseModel ReadSparseModel(const std::filesystem::path& sparse_folder);

// The folder that holds the sparse model of a dense workspace: `sparse`, where
// image_undistorter writes it, or `sparse/0`, where programs that train on
// undistorted images keep it. The first is used if it has any file of a model.
// Throws Error kNotFound if neither has one.
std::filesystem::path FindModelFolder(const std::filesystem::path& root);

// Reads the model in that folder. Throws Error: kUnsupported (an image's name
// leaves the workspace), and those of ReadSparseModel.
SparseModel ReadWorkspaceModel(const std::filesystem::path& model_folder);

// Properties of a sparse model that COLMAP's stereo_fusion cannot handle but
// this library can, one line for users each: coordinates far from the origin,
// which single precision rounds by a quarter of a pixel and more, and names of
// images with spaces where the model is text. sparse_folder: where it was read.
std::vector<std::string> FindFusionObstacles(
    const SparseModel& model, const std::filesystem::path& sparse_folder);

}  // namespace tsar
