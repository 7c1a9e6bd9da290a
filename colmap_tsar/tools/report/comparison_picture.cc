// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/comparison_picture.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/tools/report/colors.h"
#include "colmap_tsar/tools/report/pictures.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <utility>

#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

static_assert(sizeof(Rgb) == 3, "an Image<Rgb> is read as 8-bit triples");

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.5;
// Half the height of a capital letter at that scale.
constexpr int kHalfLetter = 5;

// A picture that grows downwards while it is drawn. Positions are in pixels
// from the upper left corner; content beyond the width is clipped.
class Canvas {
 public:
  explicit Canvas(int width) : width_(width) {}

  // Adds a white strip below all others and returns its upper edge.
  int AddStrip(int height) {
    const int top = pixels_.rows;
    const cv::Mat strip(height, width_, CV_8UC3, cv::Scalar::all(255));
    if (pixels_.empty()) {
      pixels_ = strip;
    } else {
      cv::vconcat(pixels_, strip, pixels_);
    }
    return top;
  }

  // All drawings must lie on strips.
  void Draw(const Image<Rgb>& image,
            int x,
            int y,
            int width,
            int height,
            Scaling scaling) {
    // OpenCV has no const matrices; this one is only read.
    const cv::Mat source(
        image.Height(), image.Width(), CV_8UC3, const_cast<Rgb*>(image.Data()));
    cv::resize(
        source,
        pixels_(cv::Rect(x, y, width, height)),
        cv::Size(width, height),
        0,
        0,
        scaling == Scaling::kAverage ? cv::INTER_AREA : cv::INTER_NEAREST);
  }

  void FillBox(int x, int y, int width, int height, const Rgb& color) {
    pixels_(cv::Rect(x, y, width, height)) =
        cv::Scalar(color.r, color.g, color.b);
  }

  // y: the center of the line. Characters other than ASCII become '?'.
  void Write(const std::string& text, int x, int y) {
    std::string shown = text;
    std::ranges::replace_if(
        shown, [](char c) { return c < ' ' || c > '~'; }, '?');
    cv::putText(pixels_,
                shown,
                {x, y + kHalfLetter},
                kFont,
                kFontScale,
                cv::Scalar::all(0),
                1,
                cv::LINE_AA);
  }

  Image<Rgb> Picture() const {
    Image<Rgb> picture(pixels_.cols, pixels_.rows);
    cv::Mat target(pixels_.rows, pixels_.cols, CV_8UC3, picture.Data());
    pixels_.copyTo(target);
    return picture;
  }

 private:
  int width_;
  cv::Mat pixels_;  // CV_8UC3, red first.
};

constexpr int kNumColumns = 6;
constexpr int kGap = 8;
constexpr int kLineHeight = 24;
constexpr int kBoxSize = 12;
constexpr int kPictureWidth =
    kNumColumns * kComparisonColumnWidth + (kNumColumns + 1) * kGap;

int ColumnX(int column) {
  return kGap + column * (kComparisonColumnWidth + kGap);
}

void CheckRow(const ComparisonRow& row) {
  if (row.image.Empty() || row.before.Empty()) {
    throw Error(ErrorCode::kMismatch,
                row.name +
                    ": the image or its depth map is empty; both are "
                    "needed for the picture");
  }
  if (!row.after.HasSizeOf(row.before) ||
      !row.normals_before.HasSizeOf(row.before) ||
      !row.normals_after.HasSizeOf(row.before) ||
      !row.provenance.HasSizeOf(row.before)) {
    throw Error(ErrorCode::kMismatch,
                row.name +
                    ": the maps before and after differ in size; refine "
                    "the workspace again");
  }
}

std::string Coverage(const Image<float>& depth) {
  const auto valid =
      std::ranges::count_if(depth, [](float value) { return value > 0.f; });
  TextStream text;
  text << std::fixed << std::setprecision(1)
       << 100.0 * valid / depth.NumPixels() << " % of the pixels";
  return text.str();
}

void WriteLine(Canvas& canvas, const std::vector<std::string>& texts) {
  const int middle = canvas.AddStrip(kLineHeight) + kLineHeight / 2;
  for (size_t i = 0; i < texts.size(); ++i) {
    canvas.Write(texts[i], ColumnX(static_cast<int>(i)), middle);
  }
}

void DrawRow(Canvas& canvas, const ComparisonRow& row) {
  const DepthRange range = RobustDepthRange(row.before, row.after);
  TextStream scale;
  scale << std::setprecision(3) << ", red " << range.nearest << " to blue "
        << range.farthest;
  WriteLine(
      canvas,
      {row.name, Coverage(row.before) + scale.str(), Coverage(row.after)});

  const int height =
      std::max(1,
               static_cast<int>(
                   std::lround(static_cast<double>(row.before.Height()) *
                               kComparisonColumnWidth / row.before.Width())));
  const int top = canvas.AddStrip(height + kGap);
  const auto draw = [&](const Image<Rgb>& cell, int column, Scaling scaling) {
    canvas.Draw(
        cell, ColumnX(column), top, kComparisonColumnWidth, height, scaling);
  };
  draw(row.image, 0, Scaling::kAverage);
  draw(ColorizeDepth(row.before, range), 1, Scaling::kPick);
  draw(ColorizeDepth(row.after, range), 2, Scaling::kPick);
  draw(ColorizeNormals(row.normals_before), 3, Scaling::kPick);
  draw(ColorizeNormals(row.normals_after), 4, Scaling::kPick);
  draw(ColorizeProvenance(row.provenance), 5, Scaling::kPick);
}

void DrawLegend(Canvas& canvas) {
  const int middle = canvas.AddStrip(kLineHeight) + kLineHeight / 2;
  const std::vector<ProvenanceKind>& kinds = ProvenanceKinds();
  const int step = kPictureWidth / static_cast<int>(kinds.size());
  for (size_t i = 0; i < kinds.size(); ++i) {
    const int x = kGap + static_cast<int>(i) * step;
    canvas.FillBox(
        x, middle - kBoxSize / 2, kBoxSize, kBoxSize, kinds[i].color);
    canvas.Write(kinds[i].name, x + kBoxSize + kGap, middle);
  }
}

}  // namespace

Image<Rgb> DrawComparison(const std::vector<ComparisonRow>& rows) {
  if (rows.empty()) {
    throw Error(ErrorCode::kMismatch,
                "comparison picture: there is no view to draw; name at least "
                "one");
  }
  std::ranges::for_each(rows, CheckRow);

  Canvas canvas(kPictureWidth);
  WriteLine(canvas,
            {"Image",
             "Depth before",
             "Depth after",
             "Normals before",
             "Normals after",
             "Origin of the depth"});
  for (const ComparisonRow& row : rows) {
    DrawRow(canvas, row);
  }
  DrawLegend(canvas);
  return canvas.Picture();
}

std::vector<int> PickEvenly(const std::vector<int>& values, int count) {
  const size_t num_picked =
      std::min(values.size(), static_cast<size_t>(std::max(0, count)));
  std::vector<int> picked;
  for (size_t i = 0; i < num_picked; ++i) {
    picked.push_back(values[i * values.size() / num_picked]);
  }
  return picked;
}

ComparisonRow ReadComparisonRow(const Workspace& workspace, int image) {
  const MapType type = workspace.Type();
  ComparisonRow row;
  row.name = workspace.Model().images[image].name;
  DepthNormal original = workspace.ReadOriginalMaps(image, type);
  row.before = std::move(original.depth);
  row.normals_before = std::move(original.normal);
  const MapPaths paths = workspace.Paths(image, type);
  row.after = RequireSizeOf(
      row.before, "the map was before", paths.depth, ReadDepthMap(paths.depth));
  row.normals_after = RequireSizeOf(row.before,
                                    "the map was before",
                                    paths.normal,
                                    ReadNormalMap(paths.normal));
  row.provenance = RequireSizeOf(row.before,
                                 "the map was before",
                                 paths.provenance,
                                 ReadGrayPng(paths.provenance));
  row.image =
      workspace.ReadImage(image, row.before.Width(), row.before.Height());
  return row;
}

}  // namespace tsar
