// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/dense_maps.h"

#include <algorithm>
#include <limits>

#include "tests/support/external_writers.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

using testing::ElementsAre;

const std::vector<float> kSix = {1, 2, 3, 4, 5, 6};

std::string Int32s(const std::vector<int32_t>& numbers) {
  std::string bytes;
  for (const int32_t number : numbers) {
    Append(number, &bytes);
  }
  return bytes;
}

DmapContent SmallDmap() {
  DmapContent content;
  content.camera.width = 3;
  content.camera.height = 2;
  content.camera.fx = 4.0;
  content.camera.fy = 5.0;
  content.camera.cx = 1.5;
  content.camera.cy = 1.0;
  content.camera.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  content.camera.translation = {1, 2, 3};
  content.depth = Image<float>(3, 2);
  content.normal = Image<Vec3f>(3, 2, Vec3f{0.f, 0.6f, -0.8f});
  std::ranges::copy(kSix, content.depth.begin());
  return content;
}

TEST(Dmb, RefusesBadHeaders) {
  const std::vector<std::pair<std::vector<int32_t>, std::string>> cases = {
      {{0, 2, 3, 1}, "type is 0"},
      {{1, 0, 3, 1}, "no size of a map"},
      {{1, 2, 3, -1}, "no size of a map"},
      {{1, 3, 3, 1}, "24 bytes follow"},
      {{1, 2, 3, 3}, "24 bytes follow"},
      // Products that wrap around to small numbers.
      {{1, 65536, 65536, 1}, "24 bytes follow"},
      {{1, 16777216, 16777216, 16}, "24 bytes follow"},
      {{1, 2147483647, 2147483647, 1}, "no size of a map"}};
  for (const auto& [header, text] : cases) {
    SCOPED_TRACE(testing::PrintToString(header));
    ExpectError(ErrorCode::kCorrupt, {"some.file", text}, [&] {
      ParseDmb(AsBytes(Int32s(header) + FloatData(kSix)), "some.file");
    });
  }
}

TEST(ApdMap, TellsTheHeadersApartWhateverTheVersion) {
  for (const int32_t version : {0, 1, 2, 5, 21, -1}) {
    SCOPED_TRACE(version);
    const std::string bytes = Int32s({version, 2, 3, 5}) + FloatData(kSix);
    const FloatMap map = ParseApdMap(AsBytes(bytes), "some.file");
    EXPECT_EQ(map.width, 3);
    EXPECT_EQ(map.height, 2);
  }
}

TEST(ApdMap, RefusesOtherMatrices) {
  for (const std::vector<int32_t>& header :
       {std::vector<int32_t>{1, 2, 3, 0},  // Bytes.
        {1, 2, 3, 6},                      // Doubles.
        {1, 3, 2, 21},
        {1, -2, -3, 5},
        {2, 4, 5},
        {0, 0, 5},
        {65536, 65536, 5}}) {
    SCOPED_TRACE(testing::PrintToString(header));
    ExpectError(ErrorCode::kCorrupt, {"some.file", "[version]"}, [&] {
      ParseApdMap(AsBytes(Int32s(header) + FloatData(kSix)), "some.file");
    });
  }
}

TEST(Dmap, ReadsNameCameraDepthAndNormals) {
  DmapContent content = SmallDmap();
  content.image_name = "C:\\photos\\b.jpg";
  content.has_confidence = true;
  content.has_views = true;
  content.depth(0, 0) = std::numeric_limits<float>::quiet_NaN();
  content.depth(1, 0) = -2.f;
  const std::string bytes = DmapBytes(content);
  const Dmap dmap = ParseDmap(AsBytes(bytes), "some.file");
  EXPECT_EQ(dmap.image_name, "C:\\photos\\b.jpg");
  EXPECT_EQ(dmap.camera.file, "some.file");
  EXPECT_EQ(dmap.camera.fx, 4.0);
  EXPECT_EQ(dmap.camera.fy, 5.0);
  EXPECT_EQ(dmap.camera.cx, 1.5);
  EXPECT_EQ(dmap.camera.cy, 1.0);
  EXPECT_TRUE(dmap.camera.rotation == content.camera.rotation);
  EXPECT_TRUE(dmap.camera.center.isApprox(content.camera.Center()));
  EXPECT_THAT(ValuesOf(dmap.depth), ElementsAre(0, 0, 3, 4, 5, 6));
  EXPECT_EQ(ValuesOf(dmap.normal), ValuesOf(content.normal));
  EXPECT_EQ(ParseDmapImageName(AsBytes(bytes.substr(0, kMaxDmapNameEnd)), "f"),
            "C:\\photos\\b.jpg");
}

TEST(Dmap, RefusesBadHeadersAndCameras) {
  const std::string good = DmapBytes(SmallDmap());
  const auto with = [&](size_t position, const std::string& part) {
    std::string bytes = good;
    bytes.replace(position, part.size(), part);
    return bytes;
  };
  const size_t ids = 30 + SmallDmap().image_name.size();
  const size_t camera = ids + 16;
  std::string huge;
  Append(uint32_t{0xffffffff}, &huge);
  std::string zero(8, '\0');
  std::string nan;
  Append(std::numeric_limits<double>::quiet_NaN(), &nan);
  std::string two;
  Append(2.0, &two);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {with(0, "XX"), "not a depth map of OpenMVS"},
      {with(2, "\x13"), "not a depth map of OpenMVS"},
      {with(12, huge), "no size of a map"},
      {with(16, huge), "no size of a map"},
      {with(28, "\xff\xff"), "shorter than its content"},
      {with(ids, huge), "shorter than its content"},
      {with(2, "\x01"), "bytes follow"},
      {with(2, "\x07"), "bytes follow"},
      {with(camera, zero), "focal length"},
      {with(camera, nan), "no number"},
      {with(camera + 72 + 8, two), "rotation"},
      {with(camera + 144, nan), "no number"}};
  for (const auto& [bytes, text] : cases) {
    SCOPED_TRACE(text);
    ExpectError(ErrorCode::kCorrupt, {"some.file", text}, [&] {
      ParseDmap(AsBytes(bytes), "some.file");
    });
  }
  ExpectError(ErrorCode::kUnsupported, {"some.file", "no depth"}, [&] {
    ParseDmap(AsBytes(with(2, "\x02")), "some.file");
  });
}

TEST(StoredCamera, ReadsWhatConvertersWrite) {
  const Camera camera = SmallDmap().camera;
  const std::string text = CamBytes(camera);
  const StoredCamera stored = ParseCamFile(AsBytes(text), "some.file");
  EXPECT_TRUE(stored.rotation.isApprox(camera.rotation));
  EXPECT_TRUE(stored.center.isApprox(camera.Center()));
  EXPECT_EQ(stored.fx, 4.0);
  EXPECT_EQ(stored.fy, 5.0);
  EXPECT_EQ(stored.cx, 1.5);
  EXPECT_EQ(stored.cy, 1.0);
}

TEST(StoredCamera, RefusesWhatIsNoCamera) {
  const std::string good = CamBytes(SmallDmap().camera);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "\"extrinsic\" with 16"},
      {with("extrinsic", "extrinsics"), "\"extrinsic\" with 16"},
      {with("intrinsic\n4", "intrinsic\nx"), "\"intrinsic\" with 9"},
      {good.substr(0, good.find("intrinsic\n4")), "\"intrinsic\" with 9"},
      {with("intrinsic\n4", "intrinsic\n-4"), "focal length"},
      {with("intrinsic\n4", "intrinsic\n0"), "focal length"},
      {with("extrinsic\n 0", "extrinsic\n 7"), "rotation"}};
  for (const auto& [text, what] : cases) {
    SCOPED_TRACE(text);
    ExpectError(ErrorCode::kCorrupt, {"some.file", what}, [&] {
      ParseCamFile(AsBytes(text), "some.file");
    });
  }
}

}  // namespace
}  // namespace tsar
