// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/store/evidence_file.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/random.h"

#include <functional>
#include <limits>
#include <utility>

#include "tests/support/test_workspace.h"
#include <sys/stat.h>

namespace tsar {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr const char* kOptionsHash = "0123456789abcdef";

// A raster of 9 x 7 pixels in vertical stripes, with all fields drawn.
ViewEvidence DrawEvidence() {
  constexpr int kNumSuperpixels = 5;
  Philox random(1, 2, 3);
  const auto draw = [&random] { return 1.f - random.NextFloat(); };
  ViewEvidence evidence;
  evidence.width = 9;
  evidence.height = 7;
  evidence.resolution.error_per_depth = draw();
  evidence.noise = draw();
  evidence.superpixels = Image<uint16_t>(9, 7);
  evidence.confident_depth = Image<float>(9, 7);
  evidence.region_planes = Image<uint16_t>(9, 7);
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 9; ++x) {
      evidence.superpixels(x, y) = static_cast<uint16_t>(x / 2);
      evidence.confident_depth(x, y) = y % 2 == 0 ? 10.f * draw() : 0.f;
      evidence.region_planes(x, y) = static_cast<uint16_t>((x + y) % 4);
    }
  }
  // The third superpixel has no observations.
  evidence.first_observation = {0, 3, 4, 4, 9, 11};
  for (int i = 0; i < 11; ++i) {
    evidence.observations.push_back(
        {{draw() - 0.5f, draw() - 0.5f, 10.f * draw()}, draw()});
  }
  for (int k = 0; k < kNumSuperpixels; ++k) {
    evidence.weights.push_back(20.f * draw());
  }
  for (int k = 0; k + 1 < kNumSuperpixels; ++k) {
    const int x = 2 * k + 1;
    evidence.borders.push_back(
        {k, k + 1, 7.f * draw(), {x, x + 9, x + 27, x + 27}});
  }
  for (int i = 0; i < 3; ++i) {
    evidence.candidates.push_back({{draw(), draw(), -draw()}, 5.f * draw()});
  }
  evidence.trust = Image<uint8_t>(13, 11);
  for (uint8_t& trust : evidence.trust) {
    trust = static_cast<uint8_t>(255.f * draw());
  }
  return evidence;
}

template <typename T>
void AppendAll(const T& values, std::string* bytes) {
  for (const auto& value : values) {
    Append(value, bytes);
  }
}

std::string NeighbourBytes(const ViewEvidence& evidence) {
  std::string bytes;
  AppendAll(evidence.superpixels, &bytes);
  AppendAll(evidence.confident_depth, &bytes);
  AppendAll(evidence.weights, &bytes);
  AppendAll(evidence.first_observation, &bytes);
  for (const Observation& observation : evidence.observations) {
    Append(observation.sample.x, &bytes);
    Append(observation.sample.y, &bytes);
    Append(observation.sample.z, &bytes);
    Append(observation.confidence, &bytes);
  }
  for (const Plane& plane : evidence.candidates) {
    Append(plane.normal.x, &bytes);
    Append(plane.normal.y, &bytes);
    Append(plane.normal.z, &bytes);
    Append(plane.offset, &bytes);
  }
  return bytes;
}

std::string OwnBytes(const ViewEvidence& evidence) {
  std::string bytes;
  for (const SuperpixelBorder& border : evidence.borders) {
    Append(border.first, &bytes);
    Append(border.second, &bytes);
    Append(border.weight, &bytes);
    AppendAll(border.pixels, &bytes);
  }
  AppendAll(evidence.region_planes, &bytes);
  AppendAll(evidence.trust, &bytes);
  return bytes;
}

uint64_t HashOf(const std::string& bytes) {
  ContentHash hash;
  hash.Update(bytes.data(), bytes.size());
  return hash.Value();
}

// What the header says, to be set to something else than the truth.
struct HeaderFields {
  explicit HeaderFields(const ViewEvidence& evidence)
      : width(evidence.width),
        height(evidence.height),
        trust_width(evidence.trust.Width()),
        trust_height(evidence.trust.Height()),
        num_superpixels(evidence.weights.size()),
        num_observations(evidence.observations.size()),
        num_candidates(evidence.candidates.size()),
        num_borders(evidence.borders.size()) {}

  std::string magic = "TSARVIEW";
  uint32_t version = 2;
  uint32_t options_hash_length = 16;
  int32_t width;
  int32_t height;
  int32_t trust_width;
  int32_t trust_height;
  uint64_t num_superpixels;
  uint64_t num_observations;
  uint64_t num_candidates;
  uint64_t num_borders;
};

// The bytes of a file whose fingerprints are right, whatever it says.
std::string FileBytes(const HeaderFields& fields,
                      const ViewEvidence& evidence) {
  const std::string neighbour_bytes = NeighbourBytes(evidence);
  const std::string own_bytes = OwnBytes(evidence);
  std::string bytes = fields.magic;
  Append(fields.version, &bytes);
  Append(fields.options_hash_length, &bytes);
  Append(fields.width, &bytes);
  Append(fields.height, &bytes);
  Append(fields.trust_width, &bytes);
  Append(fields.trust_height, &bytes);
  Append(evidence.resolution.error_per_depth, &bytes);
  Append(evidence.noise, &bytes);
  Append(fields.num_superpixels, &bytes);
  Append(fields.num_observations, &bytes);
  Append(fields.num_candidates, &bytes);
  Append(fields.num_borders, &bytes);
  Append(HashOf(neighbour_bytes), &bytes);
  Append(HashOf(own_bytes), &bytes);
  Append(HashOf(bytes + kOptionsHash), &bytes);
  return bytes + kOptionsHash + neighbour_bytes + own_bytes;
}

void ExpectSameForNeighbours(const ViewEvidence& a, const ViewEvidence& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.resolution.error_per_depth, b.resolution.error_per_depth);
  EXPECT_EQ(a.noise, b.noise);
  EXPECT_TRUE(a.superpixels.HasSizeOf(b.superpixels));
  EXPECT_TRUE(a.confident_depth.HasSizeOf(b.confident_depth));
  EXPECT_EQ(a.observations.size(), b.observations.size());
  EXPECT_EQ(NeighbourBytes(a), NeighbourBytes(b));
}

void ExpectSame(const ViewEvidence& a, const ViewEvidence& b) {
  ExpectSameForNeighbours(a, b);
  EXPECT_EQ(a.borders.size(), b.borders.size());
  EXPECT_TRUE(a.region_planes.HasSizeOf(b.region_planes));
  EXPECT_TRUE(a.trust.HasSizeOf(b.trust));
  EXPECT_EQ(OwnBytes(a), OwnBytes(b));
}

class EvidenceFileTest : public testing::Test {
 protected:
  void ExpectCorrupt(const std::string& what,
                     EvidenceParts parts = EvidenceParts::kAll) {
    ExpectError(ErrorCode::kCorrupt,
                {path_.string() + ": ",
                 what,
                 "; delete the folder " + path_.parent_path().string() +
                     " and run again"},
                [&] { ReadEvidence(path_, parts); });
  }
  void ExpectCorruptAndNoHash(const std::string& what) {
    ExpectCorrupt(what);
    ExpectCorrupt(what, EvidenceParts::kForNeighbours);
    EXPECT_EQ(ReadEvidenceHash(path_), std::nullopt);
  }

  TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.Path() / "left" / "b.png.bin";
  const ViewEvidence evidence_ = DrawEvidence();
};

TEST_F(EvidenceFileTest, ReadsWhatWasWritten) {
  WriteEvidence(UserPath(path_), kOptionsHash, evidence_);
  ExpectSame(ReadEvidence(path_), evidence_);
  EXPECT_EQ(ReadEvidenceHash(path_), kOptionsHash);
}

TEST_F(EvidenceFileTest, WritesTheDocumentedBytes) {
  WriteEvidence(UserPath(path_), kOptionsHash, evidence_);
  EXPECT_EQ(ReadText(path_), FileBytes(HeaderFields(evidence_), evidence_));
}

TEST_F(EvidenceFileTest, ReadsForNeighboursWithoutTheRest) {
  WriteEvidence(UserPath(path_), kOptionsHash, evidence_);
  const ViewEvidence read = ReadEvidence(path_, EvidenceParts::kForNeighbours);
  ExpectSameForNeighbours(read, evidence_);
  EXPECT_TRUE(read.borders.empty());
  EXPECT_TRUE(read.region_planes.Empty());
  EXPECT_TRUE(read.trust.Empty());
}

// A view without texture: nothing but one superpixel.
TEST_F(EvidenceFileTest, KeepsEvidenceOfNothing) {
  ViewEvidence nothing;
  nothing.width = 1;
  nothing.height = 2;
  nothing.superpixels = Image<uint16_t>(1, 2);
  nothing.weights = {0.f};
  nothing.first_observation = {0, 0};
  nothing.region_planes = Image<uint16_t>(1, 2);
  nothing.confident_depth = Image<float>(1, 2);
  nothing.trust = Image<uint8_t>(1, 2);
  WriteEvidence(UserPath(path_), "", nothing);
  ExpectSame(ReadEvidence(path_), nothing);
  EXPECT_EQ(ReadEvidenceHash(path_), "");
}

TEST_F(EvidenceFileTest, KeepsTheLimitsOfWhatIsAllowed) {
  ViewEvidence evidence = evidence_;
  evidence.observations[0].confidence = 1.f;
  evidence.observations[1].confidence =
      std::numeric_limits<float>::denorm_min();
  evidence.observations[2].sample.z = std::numeric_limits<float>::max();
  evidence.borders.back().second = 4;
  evidence.borders.back().pixels[3] = 9 * 7 - 1;
  evidence.borders.front().pixels[0] = 0;
  evidence.region_planes(0, 0) = 3;
  evidence.resolution.error_per_depth = 0.f;
  evidence.noise = 0.f;
  WriteEvidence(UserPath(path_), kOptionsHash, evidence);
  ExpectSame(ReadEvidence(path_), evidence);
}

TEST_F(EvidenceFileTest, ReplacesAnOlderFile) {
  WriteEvidence(UserPath(path_), "old", evidence_);
  ViewEvidence evidence = evidence_;
  evidence.trust = Image<uint8_t>(2, 1, 9);
  WriteEvidence(UserPath(path_), kOptionsHash, evidence);
  ExpectSame(ReadEvidence(path_), evidence);
  EXPECT_EQ(ReadEvidenceHash(path_), kOptionsHash);
  const std::filesystem::directory_iterator entries(path_.parent_path());
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);
}

TEST_F(EvidenceFileTest, NamesMissingFiles) {
  ExpectError(
      ErrorCode::kNotFound, {path_.string()}, [&] { ReadEvidence(path_); });
  EXPECT_EQ(ReadEvidenceHash(path_), std::nullopt);
}

TEST_F(EvidenceFileTest, RefusesWhatIsNoFile) {
  std::filesystem::create_directories(path_);
  ExpectCorruptAndNoHash("not a regular file");
  std::filesystem::remove(path_);
  // Opening a pipe would wait for ever.
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  ExpectCorruptAndNoHash("not a regular file");
}

TEST_F(EvidenceFileTest, RefusesEmptyAndOtherFiles) {
  WriteText(path_, "");
  ExpectCorruptAndNoHash("not complete");
  WriteText(path_, "3&2&1&" + std::string(200, '\0'));
  ExpectCorruptAndNoHash("another kind of file");
}

TEST_F(EvidenceFileTest, NamesTheVersionOfAnotherFormat) {
  HeaderFields fields(evidence_);
  for (const uint32_t version : {0u, 1u, 3u}) {
    fields.version = version;
    const std::string bytes = FileBytes(fields, evidence_);
    // Other versions may have a shorter header.
    for (const size_t length : {bytes.size(), size_t{40}}) {
      WriteText(path_, bytes.substr(0, length));
      ExpectCorruptAndNoHash("version " + std::to_string(version) +
                             ", this program reads version 2");
    }
  }
}

TEST_F(EvidenceFileTest, RefusesFilesOfAnotherLength) {
  WriteEvidence(UserPath(path_), kOptionsHash, evidence_);
  const std::string good = ReadText(path_);
  ASSERT_GT(good.size(), 1000u);
  for (size_t length = 0; length < good.size(); length += 97) {
    SCOPED_TRACE(length);
    WriteText(path_, good.substr(0, length));
    // The header's 96 bytes, the 16 of the options hash, the arrays.
    ExpectCorruptAndNoHash(length < 96    ? "not complete"
                           : length < 112 ? "cut off"
                                          : "not what the header says");
  }
  for (const std::string& more : {std::string("x"), good}) {
    WriteText(path_, good + more);
    ExpectCorruptAndNoHash("not what the header says");
  }
}

TEST_F(EvidenceFileTest, SeesEveryChangedByte) {
  WriteEvidence(UserPath(path_), kOptionsHash, evidence_);
  const std::string good = ReadText(path_);
  const size_t own_begin = good.size() - OwnBytes(evidence_).size();
  const size_t header_end = own_begin - NeighbourBytes(evidence_).size();
  for (size_t i = 0; i < good.size(); ++i) {
    SCOPED_TRACE(i);
    for (const int flip : {0x01, 0x80}) {
      std::string bytes = good;
      bytes[i] = static_cast<char>(bytes[i] ^ flip);
      WriteText(path_, bytes);
      ExpectCorrupt("not a usable evidence file");
      EXPECT_EQ(ReadEvidenceHash(path_).has_value(), i >= header_end);
      if (i < own_begin) {
        ExpectCorrupt("not a usable evidence file",
                      EvidenceParts::kForNeighbours);
      } else {
        ExpectSameForNeighbours(
            ReadEvidence(path_, EvidenceParts::kForNeighbours), evidence_);
      }
    }
  }
}

// Products of these numbers wrap around to small sizes in 32 and 64 bits, or
// would need more memory than there is.
TEST_F(EvidenceFileTest, RefusesAbsurdSizesBeforeAllocating) {
  constexpr int32_t kMaxInt = std::numeric_limits<int32_t>::max();
  constexpr uint64_t kMax = std::numeric_limits<uint64_t>::max();
  const std::vector<std::function<void(HeaderFields*)>> lies = {
      [](auto* f) { f->width = kMaxInt; },
      [](auto* f) { f->width = f->height = kMaxInt; },
      [](auto* f) { f->width = f->height = 65536; },
      [](auto* f) { f->width = 0; },
      [](auto* f) { f->height = 0; },
      [](auto* f) { f->width = -9; },
      [](auto* f) { f->width = -9, f->height = -7; },
      [](auto* f) { f->height = std::numeric_limits<int32_t>::min(); },
      [](auto* f) { f->width = 10; },
      [](auto* f) { f->trust_width = 0; },
      [](auto* f) { f->trust_height = -1; },
      [](auto* f) { f->trust_width = f->trust_height = kMaxInt; },
      [](auto* f) { f->trust_width = -13, f->trust_height = -11; },
      [](auto* f) { f->num_superpixels = kMax; },
      [](auto* f) { f->num_superpixels = kMax / 4 + 1; },
      [](auto* f) { f->num_superpixels = 0; },
      [](auto* f) { f->num_observations = kMax; },
      [](auto* f) { f->num_observations = (kMax >> 4) + 1; },
      [](auto* f) { f->num_observations += kMax / 16 + 1; },
      [](auto* f) { f->num_candidates = kMax / 16 + 1; },
      [](auto* f) { f->num_candidates = uint64_t{1} << 32; },
      [](auto* f) { f->num_borders = kMax; },
      [](auto* f) { f->num_borders = 0; },
  };
  for (size_t i = 0; i < lies.size(); ++i) {
    SCOPED_TRACE(i);
    HeaderFields fields(evidence_);
    lies[i](&fields);
    WriteText(path_, FileBytes(fields, evidence_));
    ExpectCorruptAndNoHash("not what the header says");
  }
  for (const auto& [width, height] : {std::pair(0, 5), std::pair(5, 0)}) {
    ViewEvidence evidence = evidence_;
    evidence.trust = Image<uint8_t>(width, height);
    WriteText(path_, FileBytes(HeaderFields(evidence), evidence));
    ExpectCorruptAndNoHash("not what the header says");
  }
  HeaderFields fields(evidence_);
  fields.options_hash_length = std::numeric_limits<uint32_t>::max();
  WriteText(path_, FileBytes(fields, evidence_));
  ExpectCorruptAndNoHash("its header was changed, or it was cut off");
}

// Sizes that fill the file, but not with what belongs there.
TEST_F(EvidenceFileTest, RefusesCountsThatOnlyFitTheLength) {
  HeaderFields fields(evidence_);
  fields.num_observations -= 1;
  fields.num_candidates += 1;
  WriteText(path_, FileBytes(fields, evidence_));
  ExpectCorrupt("observations that are not those of the superpixels");
  fields = HeaderFields(evidence_);
  std::swap(fields.num_observations, fields.num_candidates);
  WriteText(path_, FileBytes(fields, evidence_));
  ExpectCorrupt("observations that are not those of the superpixels");
}

struct Fault {
  std::string what;
  std::function<void(ViewEvidence*)> make;
};

std::vector<Fault> NeighbourFaults() {
  const std::string label = "a label that no superpixel has";
  const std::string noise = "a noise that is no number";
  const std::string weight = "a superpixel's invalid weight";
  const std::string owners = "observations that are not those of";
  const std::string observation = "an invalid observation";
  const std::string plane = "an invalid plane";
  const std::string depth = "an invalid depth";
  return {
      {label, [](auto* e) { e->superpixels(8, 6) = 5; }},
      {label, [](auto* e) { e->superpixels(0, 0) = 65535; }},
      {noise, [](auto* e) { e->resolution.error_per_depth = kNan; }},
      {noise, [](auto* e) { e->resolution.error_per_depth = -1.f; }},
      {noise, [](auto* e) { e->noise = kInf; }},
      {noise, [](auto* e) { e->noise = -kInf; }},
      {weight, [](auto* e) { e->weights[4] = kNan; }},
      {weight, [](auto* e) { e->weights[0] = -1.f; }},
      {weight, [](auto* e) { e->weights[0] = kInf; }},
      {owners, [](auto* e) { e->first_observation[0] = 1; }},
      {owners, [](auto* e) { e->first_observation[0] = -1; }},
      {owners, [](auto* e) { e->first_observation[2] = 5; }},
      {owners, [](auto* e) { e->first_observation[3] = -4; }},
      {owners, [](auto* e) { e->first_observation[4] = 12; }},
      {owners, [](auto* e) { e->first_observation[5] = 10; }},
      {owners, [](auto* e) { e->first_observation[5] = 12; }},
      {owners, [](auto* e) { e->first_observation[5] = -1; }},
      {observation, [](auto* e) { e->observations[10].sample.x = kNan; }},
      {observation, [](auto* e) { e->observations[0].sample.y = -kInf; }},
      {observation, [](auto* e) { e->observations[3].sample.z = 0.f; }},
      {observation, [](auto* e) { e->observations[3].sample.z = -1.f; }},
      {observation, [](auto* e) { e->observations[3].sample.z = kInf; }},
      {observation, [](auto* e) { e->observations[3].sample.z = kNan; }},
      {observation, [](auto* e) { e->observations[3].confidence = 0.f; }},
      {observation, [](auto* e) { e->observations[3].confidence = -0.5f; }},
      {observation, [](auto* e) { e->observations[3].confidence = 1.001f; }},
      {observation, [](auto* e) { e->observations[3].confidence = kNan; }},
      {plane, [](auto* e) { e->candidates[2].normal.x = kNan; }},
      {plane, [](auto* e) { e->candidates[0].normal.y = kInf; }},
      {plane, [](auto* e) { e->candidates[0].normal.z = -kInf; }},
      {plane, [](auto* e) { e->candidates[1].offset = kNan; }},
      {plane, [](auto* e) { e->candidates[1] = Plane(); }},
      {depth, [](auto* e) { e->confident_depth(8, 6) = kNan; }},
      {depth, [](auto* e) { e->confident_depth(0, 0) = kInf; }},
      {depth, [](auto* e) { e->confident_depth(0, 0) = -1.f; }},
  };
}

std::vector<Fault> OwnFaults() {
  const std::string border = "borders that are not those of";
  const std::string weight = "a border's invalid weight";
  const std::string region = "a region's plane";
  return {
      {border, [](auto* e) { e->borders[0].first = -1; }},
      {border, [](auto* e) { e->borders[3].second = 5; }},
      {border, [](auto* e) { e->borders[1].second = 1; }},
      {border, [](auto* e) { e->borders[3].second = 2; }},
      {border, [](auto* e) { std::swap(e->borders[0], e->borders[1]); }},
      {border, [](auto* e) { e->borders[2].pixels[0] = -1; }},
      {border, [](auto* e) { e->borders[2].pixels[3] = 9 * 7; }},
      {weight, [](auto* e) { e->borders[0].weight = kNan; }},
      {weight, [](auto* e) { e->borders[0].weight = kInf; }},
      {weight, [](auto* e) { e->borders[0].weight = -1.f; }},
      {region, [](auto* e) { e->region_planes(8, 6) = 4; }},
      {region, [](auto* e) { e->region_planes(0, 0) = 65535; }},
  };
}

TEST_F(EvidenceFileTest, RefusesToReadWhatBreaksAPromise) {
  for (const Fault& fault : NeighbourFaults()) {
    SCOPED_TRACE(fault.what);
    ViewEvidence evidence = evidence_;
    fault.make(&evidence);
    WriteText(path_, FileBytes(HeaderFields(evidence), evidence));
    ExpectCorrupt(fault.what);
    ExpectCorrupt(fault.what, EvidenceParts::kForNeighbours);
  }
  for (const Fault& fault : OwnFaults()) {
    SCOPED_TRACE(fault.what);
    ViewEvidence evidence = evidence_;
    fault.make(&evidence);
    WriteText(path_, FileBytes(HeaderFields(evidence), evidence));
    ExpectCorrupt(fault.what);
    ExpectSameForNeighbours(ReadEvidence(path_, EvidenceParts::kForNeighbours),
                            evidence);
  }
}

TEST_F(EvidenceFileTest, RefusesToWriteWhatCannotBeRead) {
  WriteText(path_, "old");
  std::vector<Fault> faults = NeighbourFaults();
  for (const Fault& fault : OwnFaults()) {
    faults.push_back(fault);
  }
  const std::string sizes = "sizes that do not fit each other";
  faults.push_back({sizes, [](auto* e) { e->width = 0; }});
  faults.push_back({sizes, [](auto* e) { e->weights.pop_back(); }});
  faults.push_back({sizes, [](auto* e) { e->first_observation.clear(); }});
  faults.push_back({sizes, [](auto* e) { std::swap(e->width, e->height); }});
  faults.push_back({sizes, [](auto* e) { e->superpixels = {}; }});
  faults.push_back({sizes, [](auto* e) { e->confident_depth = {}; }});
  faults.push_back({sizes, [](auto* e) { e->region_planes = {}; }});
  faults.push_back({sizes, [](auto* e) { e->trust = {}; }});
  for (const Fault& fault : faults) {
    SCOPED_TRACE(fault.what);
    ViewEvidence evidence = evidence_;
    fault.make(&evidence);
    ExpectError(ErrorCode::kMismatch, {path_.string(), fault.what}, [&] {
      WriteEvidence(UserPath(path_), kOptionsHash, evidence);
    });
  }
  EXPECT_EQ(ReadText(path_), "old");
}

}  // namespace
}  // namespace tsar
