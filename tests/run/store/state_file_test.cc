// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/state_file.h"

#include "colmap_tsar/run/store/evidence_file.h"
#include "colmap_tsar/run/store/scene_model_file.h"

#include <limits>
#include <tuple>

#include "tests/support/scene_model_testing.h"
#include "tests/support/test_workspace.h"
#include <sys/stat.h>

namespace tsar {
namespace {

// A file of the two formats, with all that its functions do.
struct Format {
  const char* name;
  std::string path;
  void (*write)(const ContainedPath& path);
  // Read a part of the file, and all of it.
  void (*read_part)(const std::filesystem::path& path);
  void (*read)(const std::filesystem::path& path);
  StateFileKind kind;
};

// Every array has elements, and no two are of the same length.
ViewEvidence DrawEvidence() {
  ViewEvidence evidence;
  evidence.width = 9;
  evidence.height = 7;
  evidence.intrinsics = {8.f, 9.f, 4.f, 3.f};
  evidence.resolution.error_per_depth = 0.25f;
  evidence.noise = 0.5f;
  evidence.superpixels = Image<uint16_t>(9, 7, 1);
  evidence.confident_depth = Image<float>(9, 7, 3.f);
  evidence.color = Image<Rgb>(9, 7, {1, 2, 3});
  evidence.weights = {1.f, 2.f};
  evidence.first_observation = {0, 3, 4};
  evidence.observations.resize(4, {{0.5f, -0.5f, 2.f}, 0.75f});
  evidence.sources.resize(4, ObservationSource::kPrior);
  evidence.errors = {1.f, 2.f, 3.f, 4.f};
  evidence.candidates.resize(5, {{0.f, 0.6f, -0.8f}, 5.f});
  evidence.prior.depth = Image<float>(9, 7, 4.f);
  evidence.prior.sigma = Image<float>(9, 7, 0.1f);
  evidence.prior.outlier_share = 0.125f;
  evidence.prior.normals.resize(2, {0.f, 0.f, -1.f});
  evidence.prior.normal_outlier_share = 0.375f;
  evidence.prior.assessment = {PriorVerdict::kUsed,
                               PriorType::kInverse,
                               0.875f,
                               PriorVerdict::kUnlike,
                               0.0625f};
  evidence.first_confirmed = {0, 1, 1};
  evidence.confirmed = {{0.f, 1.f, 2.f}};
  evidence.confirmed_pixels = {6, 0};
  evidence.borders.resize(3, {0, 1, 7.f, {1, 10, 19, 28}});
  evidence.gray = Image<uint8_t>(9, 7, 4);
  evidence.flags = Image<uint8_t>(13, 11, 5);
  return evidence;
}

const Format kFormats[] = {
    {"evidence",
     "left/b.png.bin",
     [](const ContainedPath& path) {
       WriteEvidence(path, "key", DrawEvidence());
     },
     [](const std::filesystem::path& path) {
       ReadEvidence(path, EvidenceParts::kForNeighbors);
     },
     [](const std::filesystem::path& path) { ReadEvidence(path); },
     kEvidenceFile},
    {"planes",
     "tsar/planes.bin",
     [](const ContainedPath& path) {
       WriteSceneModel(path, "key", MakeSceneModel());
     },
     [](const std::filesystem::path& path) {
       ReadSceneModel(path, SceneModelParts::kWithoutLabels);
     },
     [](const std::filesystem::path& path) { ReadSceneModel(path); },
     kSceneModelFile}};

class StateFileTest : public testing::TestWithParam<Format> {
 protected:
  std::string GoodBytes() const {
    GetParam().write(UserPath(path_));
    return ReadText(path_);
  }
  void ExpectCorrupt(const std::string& what) const {
    ExpectError(
        ErrorCode::kCorrupt,
        {path_.string() + ": ", what, "delete it and run tsar_refine again"},
        [&] { GetParam().read(path_); });
  }
  std::optional<std::string> Key() const {
    return ReadStateFileKey(path_, GetParam().kind);
  }
  bool IsPartGood() const {
    try {
      GetParam().read_part(path_);
      return true;
    } catch (const Error&) {
      return false;
    }
  }

  TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.Path() / GetParam().path;
};

TEST_P(StateFileTest, SeesEveryChangedByteAndEveryMissingOne) {
  const std::string good = GoodBytes();
  EXPECT_EQ(Key(), "key");
  size_t num_good_parts = 0;
  for (size_t i = 0; i < good.size(); ++i) {
    SCOPED_TRACE(i);
    std::string bytes = good;
    bytes[i] = static_cast<char>(bytes[i] ^ 0x81);
    WriteText(path_, bytes);
    ExpectCorrupt("not a usable");
    num_good_parts += IsPartGood() ? 1 : 0;
    WriteText(path_, good.substr(0, i));
    ExpectCorrupt("not complete");
    EXPECT_EQ(Key(), std::nullopt);
  }
  // What only the other part holds is not even read.
  EXPECT_GT(num_good_parts, 20u);
  EXPECT_LT(num_good_parts, good.size() - 100);
}

TEST_P(StateFileTest, RefusesOtherFilesByName) {
  const std::string good = GoodBytes();
  std::string other_version = good;
  other_version[8] = 99;
  for (const auto& [bytes, what] :
       {std::pair(std::string(300, 'x'), "another kind of file"),
        std::pair(other_version, "version 99, this program reads version"),
        std::pair(good + "x", "not complete"),
        std::pair(std::string(), "not complete")}) {
    WriteText(path_, bytes);
    ExpectCorrupt(what);
    EXPECT_EQ(Key(), std::nullopt);
  }
  std::filesystem::remove(path_);
  EXPECT_EQ(Key(), std::nullopt);
  ExpectError(
      ErrorCode::kNotFound, {path_.string()}, [&] { GetParam().read(path_); });
  // Opening a pipe would wait forever.
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  ExpectCorrupt("not a regular file");
}

TEST_P(StateFileTest, AllocatesNoMoreThanTheFileHolds) {
  std::string bytes = GoodBytes();
  // The length of the first array, after the header and the key.
  for (const uint64_t length :
       {uint64_t{1} << 40, UINT64_MAX, UINT64_MAX / 4}) {
    std::string text;
    Append(length, &text);
    WriteText(path_, bytes.replace(32 + 3, text.size(), text));
    ExpectCorrupt("its content was changed");
  }
}

INSTANTIATE_TEST_SUITE_P(Formats,
                         StateFileTest,
                         testing::ValuesIn(kFormats),
                         [](const auto& info) { return info.param.name; });

TEST(EvidenceFile, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.Path() / "b.bin";
  const ViewEvidence written = DrawEvidence();
  WriteEvidence(UserPath(path), "key", written);
  const ViewEvidence read = ReadEvidence(path);
  EXPECT_EQ(read.width, 9);
  EXPECT_EQ(read.height, 7);
  EXPECT_EQ(read.intrinsics.cx, 4.f);
  EXPECT_EQ(read.resolution.error_per_depth, 0.25f);
  EXPECT_EQ(read.noise, 0.5f);
  EXPECT_EQ(read.superpixels(8, 6), 1);
  EXPECT_EQ(read.confident_depth(8, 6), 3.f);
  EXPECT_EQ(read.color(8, 6).b, 3);
  EXPECT_EQ(read.weights, written.weights);
  EXPECT_EQ(read.first_observation, written.first_observation);
  EXPECT_EQ(read.observations.at(3).sample.z, 2.f);
  EXPECT_EQ(read.observations.at(3).confidence, 0.75f);
  EXPECT_EQ(read.sources, written.sources);
  EXPECT_EQ(read.errors, written.errors);
  EXPECT_EQ(read.candidates.at(4).offset, 5.f);
  EXPECT_EQ(read.prior.depth(8, 6), 4.f);
  EXPECT_EQ(read.prior.sigma(8, 6), 0.1f);
  EXPECT_EQ(read.prior.outlier_share, 0.125f);
  EXPECT_EQ(read.prior.normals.at(1).z, -1.f);
  EXPECT_EQ(read.prior.normal_outlier_share, 0.375f);
  const PriorAssessment& prior = read.prior.assessment;
  EXPECT_EQ(prior.verdict, PriorVerdict::kUsed);
  EXPECT_EQ(prior.type, PriorType::kInverse);
  EXPECT_EQ(prior.skill, 0.875f);
  EXPECT_EQ(prior.of_normals, PriorVerdict::kUnlike);
  EXPECT_EQ(prior.normal_sigma, 0.0625f);
  EXPECT_EQ(read.first_confirmed, written.first_confirmed);
  EXPECT_EQ(read.confirmed.at(0).y, 1.f);
  EXPECT_EQ(read.confirmed_pixels, written.confirmed_pixels);
  EXPECT_EQ(read.borders.at(2).pixels[3], 28);
  EXPECT_EQ(read.gray(8, 6), 4);
  EXPECT_EQ(read.flags(12, 10), 5);

  const ViewEvidence some = ReadEvidence(path, EvidenceParts::kForNeighbors);
  EXPECT_EQ(some.errors, written.errors);
  EXPECT_EQ(some.candidates.size(), 5u);
  EXPECT_TRUE(some.prior.Empty());
  EXPECT_TRUE(some.borders.empty());
  EXPECT_TRUE(some.gray.Empty());
  EXPECT_TRUE(some.flags.Empty());
}

TEST(EvidenceFile, KeepsThatThereIsNothing) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.Path() / "b.bin";
  WriteEvidence(UserPath(path), "", {});
  EXPECT_EQ(ReadStateFileKey(path, kEvidenceFile), "");
  const ViewEvidence read = ReadEvidence(path);
  EXPECT_EQ(read.NumSuperpixels(), 0);
  EXPECT_TRUE(read.superpixels.Empty());
  EXPECT_TRUE(read.prior.Empty());
}

TEST(SceneModelFile, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.Path() / "planes.bin";
  SceneModel written = MakeSceneModel();
  written.planes[1].covariance.setZero();
  written.planes[1].covariance.diagonal().setConstant(
      std::numeric_limits<double>::infinity());
  WriteSceneModel(UserPath(path), "key", written);
  const SceneModel read = ReadSceneModel(path);
  const auto fields = [](const ModelPlane& p) {
    return std::tuple(p.plane.normal,
                      p.plane.offset,
                      p.center,
                      p.axis_s,
                      p.axis_t,
                      p.covariance,
                      p.support,
                      p.component,
                      p.frame,
                      p.axis);
  };
  ASSERT_EQ(read.planes.size(), written.planes.size());
  for (size_t i = 0; i < read.planes.size(); ++i) {
    EXPECT_TRUE(fields(read.planes[i]) == fields(written.planes[i])) << i;
  }
  EXPECT_EQ(read.frames, written.frames);
  ASSERT_EQ(read.cylinders.size(), 1u);
  const ModelCylinder& cylinder = written.cylinders[0];
  EXPECT_EQ(read.cylinders[0].point, cylinder.point);
  EXPECT_TRUE(read.cylinders[0].frame == cylinder.frame);
  EXPECT_EQ(read.cylinders[0].radius, cylinder.radius);
  EXPECT_EQ(read.cylinders[0].min_height, cylinder.min_height);
  EXPECT_EQ(read.cylinders[0].max_height, cylinder.max_height);
  EXPECT_EQ(read.cylinders[0].covariance, cylinder.covariance);
  ASSERT_EQ(read.views.size(), written.views.size());
  for (const auto& [image, view] : written.views) {
    EXPECT_EQ(read.views.at(image).planes, view.planes);
    EXPECT_EQ(read.views.at(image).origins, view.origins);
    EXPECT_TRUE(read.views.at(image).qualities == view.qualities);
  }

  // The planes alone have the same fingerprint.
  const std::optional<uint64_t> planes = ReadScenePlanesFingerprint(path);
  EXPECT_NE(planes, std::nullopt);
  written.views.clear();
  WriteSceneModel(UserPath(path), "", written);
  EXPECT_EQ(ReadScenePlanesFingerprint(path), planes);
  EXPECT_TRUE(ReadSceneModel(path).views.empty());
  written.planes[2].plane.offset += 1e-9;
  WriteSceneModel(UserPath(path), "key", written);
  EXPECT_NE(ReadScenePlanesFingerprint(path), planes);
}

}  // namespace
}  // namespace tsar
