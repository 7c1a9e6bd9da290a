// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/scene_model_file.h"

#include "colmap_tsar/base/content_hash.h"

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "tests/support/scene_model_testing.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

constexpr const char* kOptionsHash = "0123456789abcdef";
constexpr size_t kHeaderSize = 80;
constexpr size_t kPlaneSize = 200;
constexpr size_t kFrameSize = 72;
constexpr size_t kCylinderSize = 168;

void ExpectSamePlanes(const SceneModel& a, const SceneModel& b) {
  ASSERT_EQ(a.planes.size(), b.planes.size());
  for (size_t i = 0; i < a.planes.size(); ++i) {
    EXPECT_EQ(a.planes[i].plane.normal, b.planes[i].plane.normal);
    EXPECT_EQ(a.planes[i].plane.offset, b.planes[i].plane.offset);
    EXPECT_EQ(a.planes[i].center, b.planes[i].center);
    EXPECT_EQ(a.planes[i].axis_s, b.planes[i].axis_s);
    EXPECT_EQ(a.planes[i].axis_t, b.planes[i].axis_t);
    EXPECT_EQ(a.planes[i].covariance, b.planes[i].covariance);
    EXPECT_EQ(a.planes[i].support, b.planes[i].support);
    EXPECT_EQ(a.planes[i].component, b.planes[i].component);
    EXPECT_EQ(a.planes[i].frame, b.planes[i].frame);
    EXPECT_EQ(a.planes[i].axis, b.planes[i].axis);
  }
  EXPECT_EQ(a.frames, b.frames);
  ASSERT_EQ(a.cylinders.size(), b.cylinders.size());
  for (size_t i = 0; i < a.cylinders.size(); ++i) {
    EXPECT_EQ(a.cylinders[i].point, b.cylinders[i].point);
    EXPECT_EQ(a.cylinders[i].frame.along, b.cylinders[i].frame.along);
    EXPECT_EQ(a.cylinders[i].frame.across, b.cylinders[i].frame.across);
    EXPECT_EQ(a.cylinders[i].radius, b.cylinders[i].radius);
    EXPECT_EQ(a.cylinders[i].min_height, b.cylinders[i].min_height);
    EXPECT_EQ(a.cylinders[i].max_height, b.cylinders[i].max_height);
    EXPECT_EQ(a.cylinders[i].covariance, b.cylinders[i].covariance);
  }
}

void ExpectSame(const SceneModel& a, const SceneModel& b) {
  ExpectSamePlanes(a, b);
  ASSERT_EQ(a.views.size(), b.views.size());
  for (const auto& [image, view] : a.views) {
    ASSERT_TRUE(b.views.contains(image));
    EXPECT_EQ(view.planes, b.views.at(image).planes);
    EXPECT_EQ(view.evidence, b.views.at(image).evidence);
    EXPECT_TRUE(view.qualities == b.views.at(image).qualities);
  }
}

class SceneModelFileTest : public testing::Test {
 protected:
  std::string GoodBytes() const {
    WriteSceneModel(UserPath(path_), kOptionsHash, model_);
    return ReadText(path_);
  }
  // Sets a count in the header, whose fingerprint is right again.
  static std::string WithCount(std::string bytes,
                               size_t position,
                               uint64_t count) {
    bytes.replace(position, sizeof(count), [&] {
      std::string text;
      Append(count, &text);
      return text;
    }());
    ContentHash hash;
    hash.Update(bytes.data(), kHeaderSize - sizeof(uint64_t));
    hash.Update(kOptionsHash, 16);
    std::string text;
    Append(hash.Value(), &text);
    return bytes.replace(kHeaderSize - sizeof(uint64_t), text.size(), text);
  }
  void ExpectCorrupt(const std::string& what) const {
    ExpectError(ErrorCode::kCorrupt,
                {path_.string() + ": not a usable file of planes: ",
                 what,
                 "; delete it and run tsar_refine again"},
                [&] { ReadSceneModel(path_); });
  }

  TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.Path() / "tsar" / "planes.bin";
  const SceneModel model_ = MakeSceneModel();
};

TEST_F(SceneModelFileTest, LiesInTheFolderOfThisProgram) {
  EXPECT_EQ(GetSceneModelPath("dense").Path(), "dense/stereo/tsar/planes.bin");
}

TEST_F(SceneModelFileTest, ReadsWhatWasWritten) {
  WriteSceneModel(UserPath(path_), kOptionsHash, model_);
  ExpectSame(ReadSceneModel(path_), model_);
  EXPECT_EQ(ReadSceneModelHash(path_), kOptionsHash);
  const SceneModel planes =
      ReadSceneModel(path_, SceneModelParts::kWithoutLabels);
  ExpectSamePlanes(planes, model_);
  EXPECT_TRUE(planes.views.empty());
}

TEST_F(SceneModelFileTest, LeavesLabelsOut) {
  WriteSceneModel(UserPath(path_), "", model_, SceneModelParts::kWithoutLabels);
  const SceneModel read = ReadSceneModel(path_);
  ExpectSamePlanes(read, model_);
  EXPECT_TRUE(read.views.empty());
  EXPECT_EQ(ReadSceneModelHash(path_), "");
  EXPECT_EQ(std::filesystem::file_size(path_),
            kHeaderSize + 3 * kPlaneSize + kFrameSize + kCylinderSize);
}

TEST_F(SceneModelFileTest, KeepsNothingAndExtremes) {
  WriteSceneModel(UserPath(path_), kOptionsHash, {});
  ExpectSame(ReadSceneModel(path_), {});
  SceneModel model = model_;
  model.planes[0].covariance.setZero();
  model.planes[0].covariance.diagonal().setConstant(
      std::numeric_limits<double>::infinity());
  model.planes[1].plane.offset = -std::numeric_limits<double>::max();
  model.planes[2].plane.normal *= -1.0;
  WriteSceneModel(UserPath(path_), kOptionsHash, model);
  ExpectSame(ReadSceneModel(path_), model);
}

TEST_F(SceneModelFileTest, RefusesToWriteWhatItWouldNotRead) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<const char*, std::function<void(SceneModel*)>>>
      faults = {
          {"unit vectors", [](auto* m) { m->planes[0].plane.normal *= 1.1; }},
          {"unit vectors", [](auto* m) { m->planes[0].axis_s.x() = kNan; }},
          {"unit vectors",
           [](auto* m) { m->planes[0].axis_t = m->planes[0].axis_s; }},
          {"no number", [](auto* m) { m->planes[2].plane.offset = kNan; }},
          {"no number", [](auto* m) { m->planes[2].center.z() = kNan; }},
          {"covariance", [](auto* m) { m->planes[1].covariance(0, 2) = kNan; }},
          {"covariance", [](auto* m) { m->planes[1].covariance(1, 1) = -1; }},
          {"support", [](auto* m) { m->planes[1].support = kNan; }},
          {"support", [](auto* m) { m->planes[1].support = -1; }},
          {"component", [](auto* m) { m->planes[1].component = -1; }},
          {"no frame has", [](auto* m) { m->planes[1].frame = 1; }},
          {"no frame has", [](auto* m) { m->planes[1].axis = 3; }},
          {"no frame has", [](auto* m) { m->planes[0].frame = 0; }},
          {"no rotation", [](auto* m) { m->frames[0].col(0) *= -1.0; }},
          {"no rotation", [](auto* m) { m->frames[0](0, 0) = kNan; }},
          {"directions",
           [](auto* m) {
             m->cylinders[0].frame.across = m->cylinders[0].frame.along;
           }},
          {"directions",
           [](auto* m) { m->cylinders[0].frame.along.x() = kNan; }},
          {"place or size", [](auto* m) { m->cylinders[0].point.y() = kNan; }},
          {"place or size", [](auto* m) { m->cylinders[0].radius = 0; }},
          {"place or size", [](auto* m) { m->cylinders[0].radius = kNan; }},
          {"place or size", [](auto* m) { m->cylinders[0].max_height = -1.5; }},
          {"place or size", [](auto* m) { m->cylinders[0].min_height = kNan; }},
          {"cylinder's invalid covariance",
           [](auto* m) { m->cylinders[0].covariance(2, 2) = -1; }},
          {"cylinder's invalid covariance",
           [](auto* m) { m->cylinders[0].covariance(0, 0) = INFINITY; }},
          {"no plane has", [](auto* m) { m->views[0].planes[0] = 3; }},
          {"no plane has", [](auto* m) { m->views[0].planes[0] = -2; }},
          {"do not fit", [](auto* m) { m->views[0].planes.pop_back(); }},
          {"do not fit", [](auto* m) { m->views[0].qualities.pop_back(); }},
          {"do not fit", [](auto* m) { m->views[-1] = {}; }},
          {"unknown evidence", [](auto* m) {
             m->views[0].evidence[0] = static_cast<LabelEvidence>(5);
           }}};
  for (const auto& [what, spoil] : faults) {
    SceneModel model = model_;
    spoil(&model);
    try {
      WriteSceneModel(UserPath(path_), "", model);
      ADD_FAILURE() << what;
    } catch (const Error& error) {
      EXPECT_EQ(static_cast<int>(error.Code()),
                static_cast<int>(ErrorCode::kMismatch));
      EXPECT_THAT(error.what(), testing::HasSubstr(what));
    }
    EXPECT_FALSE(std::filesystem::exists(path_));
  }
}

TEST_F(SceneModelFileTest, NamesMissingFiles) {
  ExpectError(ErrorCode::kNotFound, {path_.string(), "run tsar_refine"}, [&] {
    ReadSceneModel(path_);
  });
  EXPECT_EQ(ReadSceneModelHash(path_), std::nullopt);
}

TEST_F(SceneModelFileTest, RefusesOtherFilesAndVersions) {
  WriteText(path_, "");
  ExpectCorrupt("not complete");
  WriteText(path_, std::string(300, 'x'));
  ExpectCorrupt("another kind of file");
  std::string bytes = GoodBytes();
  bytes[8] = 1;
  WriteText(path_, bytes);
  ExpectCorrupt("version 1, this program reads version 5");
}

TEST_F(SceneModelFileTest, SeesEveryChangedByte) {
  const std::string good = GoodBytes();
  for (size_t i = 0; i < good.size(); ++i) {
    SCOPED_TRACE(i);
    std::string bytes = good;
    bytes[i] = static_cast<char>(bytes[i] ^ 0x10);
    WriteText(path_, bytes);
    ExpectCorrupt("not a usable file of planes");
  }
}

// A file of the right length and fingerprints whose views have other labels.
TEST_F(SceneModelFileTest, RefusesLabelsOfNoView) {
  SceneModel model;
  model.views[1] = {std::vector<int>(8, -1),
                    std::vector<LabelEvidence>(8, LabelEvidence::kNone),
                    std::vector<LabelQuality>(8)};
  WriteSceneModel(UserPath(path_), kOptionsHash, model);
  const std::string good = ReadText(path_);
  const size_t view_begin = kHeaderSize + 16;
  for (const auto& [image, num_labels] :
       {std::pair(1, 7), std::pair(1, 9), std::pair(1, -1), std::pair(-1, 8)}) {
    std::string view;
    Append(image, &view);
    Append(num_labels, &view);
    std::string bytes = good;
    bytes.replace(view_begin, view.size(), view);
    ContentHash hash;
    hash.Update(bytes.data() + view_begin, bytes.size() - view_begin);
    WriteText(path_, WithCount(bytes, 64, hash.Value()));
    ExpectCorrupt("labels that are not those of its views");
  }
}

}  // namespace
}  // namespace tsar
