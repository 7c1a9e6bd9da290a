// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/meshlab_project.h"
#include "colmap_tsar/io/ply.h"

#include "tests/fuzz/fuzz_target.h"

namespace tsar {
namespace {

void ReadPly(std::span<const uint8_t> input) {
  const std::filesystem::path path = PutFile("scan.ply", input);
  Accepts([&] { ReadPlyPoints(path); });
}

std::vector<std::string> MakePlySeeds() {
  const std::string vertices =
      "element vertex 2\nproperty float x\nproperty float y\n"
      "property double z\nproperty uchar red\n";
  return {"ply\nformat ascii 1.0\ncomment made by hand\n" + vertices +
              "element face 0\nproperty list uchar int vertex_indices\n"
              "end_header\n0 1 2 255\n1e3 -.5 nan 0\n",
          "ply\nformat binary_little_endian 1.0\nelement camera 1\n"
          "property int id\n" +
              vertices + "end_header\n" + std::string(38, '\x3f')};
}

void ReadProject(std::span<const uint8_t> input) {
  const std::filesystem::path path = PutFile("scans.mlp", input);
  Accepts([&] { ReadMeshlabProject(path); });
}

std::vector<std::string> MakeProjectSeeds() {
  return {
      "<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n<MeshGroup>\n"
      "<MLMesh label=\"a\" filename=\"a.ply\">\n<MLMatrix44>\n"
      "1 0 0 2\n0 1 0 0\n0 0 1 0\n0 0 0 1\n</MLMatrix44>\n</MLMesh>\n"
      "</MeshGroup>\n</MeshLabProject>\n"};
}

}  // namespace

const FuzzTarget kPlyTarget = {"ply", &ReadPly, &MakePlySeeds};
const FuzzTarget kMeshlabTarget = {"meshlab", &ReadProject, &MakeProjectSeeds};

}  // namespace tsar
