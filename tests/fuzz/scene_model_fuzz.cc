// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/store/scene_model_file.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "tests/fuzz/fuzz_target.h"

namespace tsar {
namespace {

// Of the header, see scene_model_file.cc.
constexpr size_t kHeaderSize = 72;
constexpr size_t kPlanesFingerprint = 48;
constexpr size_t kLabelsFingerprint = 56;
constexpr size_t kHeaderFingerprint = 64;
constexpr size_t kPlaneSize = 200;
constexpr size_t kFrameSize = 72;

template <typename T>
T ValueAt(const std::vector<uint8_t>& bytes, size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

void PutFingerprint(const ContentHash& hash,
                    size_t offset,
                    std::vector<uint8_t>* bytes) {
  const uint64_t value = hash.Value();
  std::memcpy(bytes->data() + offset, &value, sizeof(value));
}

// Makes the fingerprints right, behind which no mutation would get otherwise.
std::vector<uint8_t> Signed(std::span<const uint8_t> input) {
  std::vector<uint8_t> bytes(input.begin(), input.end());
  if (bytes.size() < kHeaderSize ||
      ValueAt<uint32_t>(bytes, 12) > bytes.size() - kHeaderSize) {
    return bytes;
  }
  const size_t begin = kHeaderSize + ValueAt<uint32_t>(bytes, 12);
  // Where the numbers are absurd, any length will do.
  const size_t length = kPlaneSize * ValueAt<uint16_t>(bytes, 16) +
                        kFrameSize * ValueAt<uint16_t>(bytes, 24);
  const size_t end = std::min(begin + length, bytes.size());
  ContentHash planes;
  planes.Update(bytes.data() + begin, end - begin);
  PutFingerprint(planes, kPlanesFingerprint, &bytes);
  ContentHash labels;
  labels.Update(bytes.data() + end, bytes.size() - end);
  PutFingerprint(labels, kLabelsFingerprint, &bytes);
  ContentHash header;
  header.Update(bytes.data(), kHeaderFingerprint);
  header.Update(bytes.data() + kHeaderSize, begin - kHeaderSize);
  PutFingerprint(header, kHeaderFingerprint, &bytes);
  return bytes;
}

bool ReadBoth(std::span<const uint8_t> input) {
  const std::filesystem::path path = PutFile("planes.bin", input);
  ReadSceneModelHash(path);
  Accepts([&] { ReadSceneModel(path, SceneModelParts::kWithoutLabels); });
  return Accepts([&] { ReadSceneModel(path); });
}

void Read(std::span<const uint8_t> input) {
  ReadBoth(input);
  ReadBoth(Signed(input));
}

std::vector<std::string> MakeSeeds() {
  SceneModel model;
  model.frames.push_back(Eigen::Matrix3d::Identity());
  model.planes.resize(2);
  model.planes[1].frame = 0;
  model.planes[1].axis = 2;
  model.views[0] = {{0, -1}, {LabelEvidence::kMeasured, LabelEvidence::kNone}};
  model.views[4] = {{1}, {LabelEvidence::kGuessed}};
  WriteSceneModel(UserPath(FuzzFolder() / "planes.bin"), "options", model);
  const std::string seed = TakeFile("planes.bin");
  // The layout above is that of the file, or this target would test nothing.
  std::string changed = seed;
  changed[kHeaderSize - 1] ^= 1;
  if (!ReadBoth(Signed(BytesOf(changed)))) {
    throw std::logic_error("scene_model_fuzz.cc knows another layout");
  }
  return {seed};
}

}  // namespace

const FuzzTarget kSceneModelTarget = {"scene_model", &Read, &MakeSeeds};

}  // namespace tsar
