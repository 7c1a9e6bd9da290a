// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/comparison_picture.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/tools/report/colors.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace tsar {
namespace {

bool Same(const Rgb& a, const Rgb& b) {
  return a.r == b.r && a.g == b.g && a.b == b.b;
}

int Count(const Image<Rgb>& picture, const Rgb& color) {
  return static_cast<int>(
      std::count_if(picture.begin(), picture.end(), [&color](const Rgb& pixel) {
        return Same(pixel, color);
      }));
}

// A view of 60 x 45 pixels of one image color, half of which had a depth
// before; all comes from region planes.
ComparisonRow DrawnRow() {
  ComparisonRow row;
  row.name = "drawn.jpg";
  row.image = Image<Rgb>(60, 45, Rgb{12, 200, 34});
  row.before = Image<float>(60, 45, 0.f);
  row.after = Image<float>(60, 45, 4.f);
  row.normals_before = Image<Vec3f>(60, 45, Vec3f{});
  row.normals_after = Image<Vec3f>(60, 45, Vec3f{0.f, 0.f, -1.f});
  row.provenance = Image<uint8_t>(60, 45, 4);
  for (int y = 0; y < 45; ++y) {
    for (int x = 0; x < 30; ++x) {
      row.before(x, y) = 2.f;
      row.after(x, y) = 2.f;
    }
  }
  return row;
}

constexpr int kCellArea =
    kComparisonColumnWidth * kComparisonColumnWidth * 3 / 4;

TEST(DrawComparison, ShowsAllColumnsAtTheSameSize) {
  const ComparisonRow row = DrawnRow();
  const Image<Rgb> picture = DrawComparison({row});

  EXPECT_EQ(Count(picture, row.image(0, 0)), kCellArea);
  const Rgb region_plane = ProvenanceKinds()[4].color;
  EXPECT_GE(Count(picture, region_plane), kCellArea);

  // Half of the cell before and half of the cell after are near; half of the
  // one after is far; half of the one before has no depth, and no normal is
  // there before.
  const Image<Rgb> depths = ColorizeDepth(row.after, {2.f, 4.f});
  EXPECT_EQ(Count(picture, depths(0, 0)), kCellArea);
  EXPECT_EQ(Count(picture, depths(59, 0)), kCellArea / 2);
  EXPECT_GE(Count(picture, Rgb()), kCellArea * 3 / 2);
  EXPECT_LT(Count(picture, Rgb()), kCellArea * 7 / 4);
  EXPECT_EQ(Count(picture, ColorizeNormals(row.normals_after)(0, 0)),
            kCellArea);
}

TEST(DrawComparison, ColumnsStandInTheNamedOrder) {
  const ComparisonRow row = DrawnRow();
  const Image<Rgb> picture = DrawComparison({row});
  const auto first_column = [&picture](const Rgb& color) {
    for (int x = 0; x < picture.Width(); ++x) {
      for (int y = 0; y < picture.Height() * 3 / 4; ++y) {
        if (Same(picture(x, y), color)) {
          return x;
        }
      }
    }
    return -1;
  };
  const Image<Rgb> depths = ColorizeDepth(row.after, {2.f, 4.f});
  const int image = first_column(row.image(0, 0));
  const int before = first_column(depths(0, 0));
  const int after = first_column(depths(59, 0));
  const int normals = first_column(ColorizeNormals(row.normals_after)(0, 0));
  const int provenance = first_column(ProvenanceKinds()[4].color);
  ASSERT_GE(image, 0);
  EXPECT_GE(before, image + kComparisonColumnWidth);
  EXPECT_GE(after, before + kComparisonColumnWidth);
  EXPECT_GE(normals, after + kComparisonColumnWidth * 3 / 2);
  EXPECT_GE(provenance, normals + kComparisonColumnWidth);
}

TEST(DrawComparison, EveryViewAddsTheSameHeight) {
  const ComparisonRow row = DrawnRow();
  const int one = DrawComparison({row}).Height();
  const int two = DrawComparison({row, row}).Height();
  const int three = DrawComparison({row, row, row}).Height();
  EXPECT_GT(two - one, kComparisonColumnWidth * 3 / 4);
  EXPECT_EQ(three - two, two - one);
}

TEST(DrawComparison, NameAndLegendAreWritten) {
  ComparisonRow row = DrawnRow();
  const Image<Rgb> named = DrawComparison({row});
  row.name = "";
  const Image<Rgb> unnamed = DrawComparison({row});
  ASSERT_TRUE(named.HasSizeOf(unnamed));
  EXPECT_FALSE(std::equal(named.begin(), named.end(), unnamed.begin(), Same));
  for (const ProvenanceKind& kind : ProvenanceKinds()) {
    EXPECT_GT(Count(named, kind.color), 0) << kind.name;
  }
}

TEST(DrawComparison, TakesExtremeProportionsAndNames) {
  ComparisonRow row;
  row.name = std::string(1000, 'x') + "\xc3\xa4\n";
  row.image = Image<Rgb>(1000, 1);
  row.before = row.after = Image<float>(1000, 1, 1.f);
  row.normals_before = row.normals_after = Image<Vec3f>(1000, 1);
  row.provenance = Image<uint8_t>(1000, 1, 1);
  EXPECT_GT(DrawComparison({row}).Height(), 0);
}

TEST(DrawComparison, RejectsWhatCannotBeCompared) {
  EXPECT_THROW(DrawComparison({}), Error);

  ComparisonRow smaller = DrawnRow();
  smaller.after = Image<float>(30, 45, 1.f);
  EXPECT_THROW(DrawComparison({smaller}), Error);

  ComparisonRow other_normals = DrawnRow();
  other_normals.normals_after = Image<Vec3f>(30, 45);
  EXPECT_THROW(DrawComparison({other_normals}), Error);

  ComparisonRow no_image = DrawnRow();
  no_image.image = Image<Rgb>();
  EXPECT_THROW(DrawComparison({no_image}), Error);

  ComparisonRow unknown = DrawnRow();
  unknown.provenance(5, 5) = 8;
  EXPECT_THROW(DrawComparison({unknown}), Error);
}

}  // namespace
}  // namespace tsar
