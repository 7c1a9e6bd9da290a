// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/dense_maps.h"
#include "colmap_tsar/io/image_lists.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/ply.h"
#include "colmap_tsar/tools/evaluation/meshlab_project.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "tests/fuzz/fuzz_target.h"
#include "tests/support/external_writers.h"
#include "tests/support/test_workspace.h"
#include <unistd.h>

namespace tsar {
namespace {

namespace fs = std::filesystem;

using Bytes = std::span<const uint8_t>;

// Holds the files of one process, in memory if possible; removed when the
// program ends by itself.
struct Folder {
  Folder() {
    const fs::path memory = "/dev/shm";
    path = (access(memory.c_str(), W_OK) == 0 ? memory
                                              : fs::temp_directory_path()) /
           ("tsar_fuzz_" + std::to_string(getpid()));
    fs::create_directories(path);
  }
  ~Folder() {
    std::error_code error;
    fs::remove_all(path, error);
  }
  fs::path path;
};

fs::path PutFile(const std::string& name, Bytes input) {
  static const Folder folder;
  fs::create_directories((folder.path / name).parent_path());
  std::ofstream file(folder.path / name, std::ios::binary);
  file.write(reinterpret_cast<const char*>(input.data()),
             static_cast<std::streamsize>(input.size()));
  return folder.path / name;
}

// The three files of a model are one input, separated by lines of "----".
constexpr const char* kSeparator = "\n----\n";

template <const char* kExtension>
void ReadModel(Bytes input) {
  std::string rest(input.begin(), input.end());
  fs::path folder;
  for (const std::string name : {"/cameras", "/images", "/points3D"}) {
    const size_t end = rest.find(kSeparator);
    const std::string content = rest.substr(0, end);
    folder =
        PutFile(kExtension + name + kExtension, AsBytes(content)).parent_path();
    rest.erase(0, end == std::string::npos ? end : end + 6);
  }
  ReadSparseModel(folder);
}
constexpr char kBinary[] = ".bin";
constexpr char kText[] = ".txt";

template <typename... Values>
std::string Joined(Values... values) {
  std::string bytes;
  (Append(values, &bytes), ...);
  return bytes;
}

std::string BinaryModel() {
  std::string bytes =
      Joined(uint64_t{2}, 1u, 1, uint64_t{8}, uint64_t{6}, 9., 9., 4., 3.) +
      Joined(2u, 0, uint64_t{8}, uint64_t{6}, 9., 4., 3.) + kSeparator +
      Joined(uint64_t{2});
  for (const uint32_t id : {1u, 2u}) {
    bytes += Joined(id, 1., 0., 0., 0., -1. * id, 0., 0., id) +
             (id == 1 ? "a.png" : "left/b.png") +
             Joined('\0', uint64_t{1}, 1., 2., uint64_t{1});
  }
  return bytes + kSeparator + Joined(uint64_t{1}, uint64_t{1}, 0., 0., 5.) +
         "rgb" + Joined(.5, uint64_t{2}, 1u, 0u, 2u, 0u);
}

// Three images in a row that see the same points.
SparseModel MakeModel() {
  SparseModel model;
  for (const char* name : {"a.png", "left/b.png", "c.png"}) {
    SparseModel::ModelImage image;
    image.name = name;
    image.camera.translation.x() = -static_cast<double>(model.images.size());
    for (int i = 0; i < 20; ++i) {
      image.point_indices.push_back(i);
    }
    model.images.push_back(std::move(image));
  }
  for (int i = 0; i < 20; ++i) {
    model.points.push_back({0.1 * i, 0.2 * i, 5.0});
  }
  model.IndexNames();
  return model;
}

void ReadConfig(Bytes input) {
  static const SparseModel model = MakeModel();
  ReadPatchMatchConfig(PutFile("some.cfg", input), model);
}

void ReadList(Bytes input) {
  static const SparseModel model = MakeModel();
  ReadImageList(PutFile("list.txt", input), model, "image_list");
}

DmapContent SmallDmap() {
  DmapContent content;
  content.camera.width = 2;
  content.camera.height = 2;
  content.depth = Image<float>(2, 2, 3.f);
  content.normal = Image<Vec3f>(2, 2, Vec3f{0.f, 0.f, -1.f});
  content.has_confidence = true;
  content.has_views = true;
  return content;
}

// The conversion that follows reading.
void Convert(const FloatMap& map) {
  map.channels == 1 ? void(ToDepth(map, "map")) : void(ToNormals(map, "map"));
}

template <const char* kName>
void ReadDepth(Bytes input) {
  ParseDepthImage(input, kName);
}
template <const char* kName>
void ReadNormals(Bytes input) {
  ParseNormalImage(input, kName);
}
constexpr char kNpy[] = "depth.npy";
constexpr char kPfm[] = "depth.pfm";

}  // namespace

std::vector<FuzzTarget> MakeFuzzTargets() {
  const std::vector<float> six = {1, 2, 3, 4, 5, 6};
  const std::string floats = FloatData(six);
  const std::string vertices =
      "element vertex 2\nproperty float x\nproperty float y\n"
      "property double z\nproperty uchar red\n";
  return {
      {"map",
       {[](Bytes input) { ReadMapSize(PutFile("map.bin", input)); },
        [](Bytes input) { ReadDepthMap(PutFile("map.bin", input)); },
        [](Bytes input) { ReadNormalMap(PutFile("map.bin", input)); }},
       {"3&2&1&" + floats, "1&2&3&" + floats, "3&1&2&" + floats}},
      {"npy",
       {&ReadDepth<kNpy>,
        &ReadNormals<kNpy>,
        [](Bytes input) { ReadSigmaMap(PutFile("sigma.npy", input)); }},
       {NpyBytes("<f4", "(2, 3)", floats),
        NpyBytes("<f8", "(1, 1, 3)", floats),
        NpyBytes("<f2", "(3, 4)", floats),
        NpyBytes("<u2", "(4, 3, 1)", floats)}},
      {"pfm",
       {&ReadDepth<kPfm>, &ReadNormals<kPfm>},
       {PfmBytes(3, 2, 1, six, true), PfmBytes(2, 1, 3, six, false)}},
      {"dmb",
       {[](Bytes input) { Convert(ParseDmb(input, "a.dmb")); }},
       {DmbBytes(3, 2, 1, six), DmbBytes(2, 1, 3, six)}},
      {"apd",
       {[](Bytes input) { Convert(ParseApdMap(input, "a.bin")); }},
       {ApdBytes(3, 2, 1, six, true),
        ApdBytes(3, 2, 1, six, false),
        ApdBytes(2, 1, 3, six, true)}},
      {"dmap",
       {[](Bytes input) { ParseDmap(input, "a.dmap"); },
        [](Bytes input) { ParseDmapImageName(input, "a.dmap"); }},
       {DmapBytes(SmallDmap())}},
      {"stored_camera",
       {[](Bytes input) { ParseCamFile(input, "00000000_cam.txt"); }},
       {CamBytes(SmallDmap().camera)}},
      {"sparse_binary", {&ReadModel<kBinary>}, {BinaryModel()}},
      {"sparse_text",
       {&ReadModel<kText>},
       {std::string("# cameras\n1 PINHOLE 8 6 10 10 4 3\n"
                    "2 SIMPLE_PINHOLE 8 6 10 4 3\n") +
        kSeparator +
        "1 1 0 0 0 0 0 0 1 a.png\n\n"
        "2 1 0 0 0 -1 0 0 2 left/b.png\n1.5 2.5 1\n" +
        kSeparator + "1 0 0 5 0 0 0 0.5 1 0 2 0\n"}},
      {"config",
       {&ReadConfig},
       {"# a comment\na.png\n__all__\nleft/b.png\n__auto__, 20\n"
        "c.png\na.png, left/b.png\n"}},
      {"image_list", {&ReadList}, {"c.png\na.png\n\nleft/b.png\n"}},
      {"ply",
       {[](Bytes input) { ReadPlyPoints(PutFile("scan.ply", input)); }},
       {"ply\nformat ascii 1.0\ncomment made by hand\n" + vertices +
            "element face 0\nproperty list uchar int vertex_indices\n"
            "end_header\n0 1 2 255\n1e3 -.5 1 0\n",
        "ply\nformat binary_little_endian 1.0\nelement camera 1\n"
        "property int id\n" +
            vertices + "end_header\n" + std::string(38, '\x3f')}},
      {"meshlab",
       {[](Bytes input) { ReadMeshlabProject(PutFile("scans.mlp", input)); }},
       {"<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n<MeshGroup>\n"
        "<MLMesh label=\"a\" filename=\"a.ply\">\n<MLMatrix44>\n"
        "1 0 0 2\n0 1 0 0\n0 0 1 0\n0 0 0 1\n</MLMatrix44>\n</MLMesh>\n"
        "</MeshGroup>\n</MeshLabProject>\n"}},
  };
}

}  // namespace tsar
