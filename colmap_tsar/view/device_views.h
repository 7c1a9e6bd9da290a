// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"
#include "colmap_tsar/view/superpixels/samples.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace tsar {

// Largest side of the raster of superpixels and regions, which is no larger
// than the map either: a quarter of the paper's images, as in its authors'
// program.
constexpr int kMaxRasterSide = 777;

// A reference image and its maps in the device's memory.
struct DeviceReference {
  DeviceReference(const ViewData& view, Device& device);

  int Width() const { return color.Width(); }
  int Height() const { return color.Height(); }
  Intrinsics MapIntrinsics() const { return camera.GetIntrinsics(); }
  // The planes of a raster on the map's pixels.
  PlaneRaster OnMap(const DeviceImage<Plane>& planes) const {
    return {planes.View(), MapIntrinsics(), Width(), Height()};
  }

  Camera camera;
  DeviceImage<Rgb> color;
  DepthNormalImages hypotheses;
};

// A reference image and its sources in the device's memory, ready for the
// stages.
class DeviceViews : public DeviceReference {
 public:
  // The sources may have been uploaded by another device of the same GPU.
  // denoise: whether the raster's image is denoised.
  DeviceViews(const ViewData& reference,
              std::vector<std::shared_ptr<const UploadedView>> sources,
              Device& device,
              bool denoise = true);

  // Waits for work that may read the sources, which are shared with other
  // devices of the GPU.
  ~DeviceViews();

  Intrinsics RasterIntrinsics() const;
  const DisparityScale& Scale() const { return scale_; }

  ReferenceView Reference() const {
    return {MapIntrinsics(),
            gray_.View(),
            std::as_const(hypotheses.depth).View(),
            std::as_const(hypotheses.normal).View()};
  }
  const SourceViews& Sources() const { return sources_; }
  DepthNormalViews Hypotheses() const { return hypotheses.Views(); }
  // The number of sources with any depth, which bounds the agreement of a
  // pixel.
  int NumSourcesWithDepth() const { return num_sources_with_depth_; }
  // Frees the data that only matching needs, the sources and the gray image,
  // once the device has finished. They are empty afterwards.
  void ReleaseSources();
  ImageView<const Rgb> Color() const { return color.View(); }

  // The raster of superpixels and regions, and the image reduced to it.
  const ReducedRaster& Raster() const { return raster_; }
  ImageView<const Rgb> RasterColor() const { return raster_color_.View(); }
  Image<Rgb> DownloadRasterColor() const { return raster_color_.ToHost(); }
  // The raster's size relative to kMaxRasterSide: lengths shrink by it, areas
  // by its square.
  double RasterScale() const;

 private:
  Device& device_;
  DisparityScale scale_;
  ReducedRaster raster_;
  DeviceImage<Rgb> raster_color_;
  GrayTexture gray_;
  std::vector<std::shared_ptr<const UploadedView>> uploaded_sources_;
  SourceViews sources_;
  int num_sources_with_depth_ = 0;
};

// The raster of a map of this size.
ReducedRaster MakeRaster(int width, int height);

// The largest number of raster pixels of a map of num_pixels.
int64_t MaxRasterPixels(int64_t num_pixels);

// The image in which superpixels, regions, textures and borders are found, or
// lines without `denoise`: reduced to the raster and, with it, denoised.
DeviceImage<Rgb> MakeRasterColor(ImageView<const Rgb> color,
                                 const ReducedRaster& raster,
                                 bool denoise,
                                 Device& device);

}  // namespace tsar
