// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/gray_pair.h"
#include "colmap_tsar/view/denoise/denoise.h"
#include "colmap_tsar/view/denoise/estimate_noise.h"

#include "tests/cuda/cuda_test.h"

namespace tsar {
namespace {

TEST_F(CudaTest, EstimateNoise) {
  ExpectAlike(
      "EstimateNoise",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        const DeviceImage<float> gray(
            device,
            RandomImage(inputs.views.Width(), inputs.views.Height(), 255.f, 4));
        for (const ImageView<const float>& image :
             {gray.View(), inputs.views.Reference().gray}) {
          const NoiseCurve noise = EstimateNoise(image, device);
          result->Add("noise",
                      std::vector<float>{noise.constant, noise.per_level});
        }
      });
}

TEST_F(CudaTest, Denoise) {
  ExpectAlike(
      "Denoise",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        const ImageView<const Rgb> color = inputs.views.Color();
        const DeviceImage<float> gray = ComputeGray(color, device);
        // Enough to mix what is not alike.
        result->Add(
            "gray",
            ComputeGray(
                Denoise(color, gray.View(), {100.f, 1.f}, device).View(),
                device));
      });
}

}  // namespace
}  // namespace tsar
