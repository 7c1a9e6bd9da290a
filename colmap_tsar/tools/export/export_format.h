// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

namespace tsar {

// The formats, which docs/export.md describes.
enum class ExportFormat {
  kNpy,                // Arrays of NumPy.
  kExr,                // OpenEXR pictures of floats.
  kPng16,              // Pictures of 16 bits.
  kNerfstudio,         // A training folder of nerfstudio.
  kGaussianSplatting,  // A training folder of 3D Gaussian splatting.
};

// "npy", "exr", "png16", "nerfstudio" and "3dgs", in the order of ExportFormat.
const std::vector<std::string>& ExportFormatNames();

std::string ToString(ExportFormat format);

// Parses a name. Throws Error kBadOption, which lists the formats.
ExportFormat ParseExportFormat(const std::string& name);

}  // namespace tsar
