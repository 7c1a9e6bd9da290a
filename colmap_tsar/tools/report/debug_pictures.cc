// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/debug_pictures.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/tools/report/colors.h"
#include "colmap_tsar/tools/report/pictures.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// Number of agreeing sources at which agreement saturates (ReliabilityOptions).
constexpr float kMaxAgreement = 4.f;

float MaxValue(RefineStage stage) {
  switch (stage) {
    case RefineStage::kCost:
      return 2.f;
    case RefineStage::kDiscontinuity:
      return 11.f / 6.f;
    default:
      return 1.f;
  }
}

bool ShowsDepth(RefineStage stage) {
  return stage == RefineStage::kDepthInput ||
         stage == RefineStage::kDepthReliable ||
         stage == RefineStage::kDepthTrusted ||
         stage == RefineStage::kDepthComposed || stage == RefineStage::kDepth;
}

std::string FileName(RefineStage stage) {
  const auto index = static_cast<int>(stage);
  char number[16];
  std::snprintf(number, sizeof(number), "%02d_", index);
  return number + RefineStages()[index].name + ".png";
}

// Whether this is the name of a picture or of its AtomicFile temporary.
bool IsPictureName(std::string name) {
  const std::string_view suffix = AtomicFile::kTemporarySuffix;
  if (name.ends_with(suffix)) {
    name.resize(name.size() - suffix.size());
  }
  const std::vector<RefineStageInfo>& stages = RefineStages();
  return std::ranges::any_of(stages, [&](const RefineStageInfo& info) {
    return FileName(info.stage) == name;
  });
}

// Throws for other content, which must not be replaced or mixed in.
void RequirePicturesAlone(const std::filesystem::path& folder) {
  for (const TreeEntry& entry : ListTree({folder, {}})) {
    if (!entry.is_folder && !IsPictureName(entry.path.Filename().string())) {
      throw Error::File(ErrorCode::kUnsupported,
                        entry.path.string(),
                        "is no picture of " + OptionName("debug_path"),
                        "give another folder, where nothing else is");
    }
  }
}

Image<float> ToFloat(const Image<uint8_t>& values) {
  Image<float> floats(values.Width(), values.Height());
  std::ranges::copy(values, floats.begin());
  return floats;
}

Image<Rgb> ColorizeMask(const Image<uint8_t>& mask) {
  Image<Rgb> colors(mask.Width(), mask.Height());
  std::ranges::transform(mask, colors.begin(), [](uint8_t value) {
    return value != 0 ? Rgb{255, 255, 255} : Rgb();
  });
  return colors;
}

// Colors evidence like the corresponding provenance.
Image<Rgb> ColorizeEvidence(const Image<uint8_t>& evidence) {
  Image<uint8_t> kinds(evidence.Width(), evidence.Height());
  std::ranges::transform(evidence, kinds.begin(), [](uint8_t value) {
    switch (static_cast<LabelEvidence>(value)) {
      case LabelEvidence::kMeasured:
        return static_cast<uint8_t>(Provenance::kMeasured);
      case LabelEvidence::kCarried:
        return static_cast<uint8_t>(Provenance::kOtherViews);
      case LabelEvidence::kGuessed:
        return static_cast<uint8_t>(Provenance::kGuessed);
      default:
        return static_cast<uint8_t>(Provenance::kNone);
    }
  });
  return ColorizeProvenance(kinds);
}

class ImagePictures : public StageObserver {
 public:
  ImagePictures(ContainedPath folder, const Image<float>& depth)
      : folder_(std::move(folder)),
        range_(RobustDepthRange(depth, Image<float>())) {}

  void Show(RefineStage stage, const Image<Rgb>& colors) override {
    image_ = colors;
    Write(stage, colors);
  }
  void Show(RefineStage stage, const Image<float>& values) override {
    Write(stage,
          ShowsDepth(stage) ? ColorizeDepth(values, range_)
                            : ColorizeValues(values, MaxValue(stage)));
  }
  void Show(RefineStage stage, const Image<Vec3f>& normals) override {
    Write(stage, ColorizeNormals(normals));
  }
  void Show(RefineStage stage, const Image<uint8_t>& values) override {
    switch (stage) {
      case RefineStage::kAgreement:
        Write(stage, ColorizeValues(ToFloat(values), kMaxAgreement));
        break;
      case RefineStage::kLabelEvidence:
        Write(stage, ColorizeEvidence(values));
        break;
      case RefineStage::kProvenance:
        Write(stage, ColorizeProvenance(values));
        break;
      default:
        Write(stage, ColorizeMask(values));
    }
  }
  void Show(RefineStage stage, const Image<int>& labels) override {
    const bool draws_borders =
        stage == RefineStage::kSuperpixels && image_.HasSizeOf(labels);
    Write(stage,
          draws_borders ? DrawLabelBorders(labels, image_)
                        : ColorizeLabels(labels));
  }
  void Show(RefineStage stage, const Image<Plane>& planes) override {
    Image<Vec3f> normals(planes.Width(), planes.Height());
    std::ranges::transform(planes, normals.begin(), [](const Plane& plane) {
      return plane.Valid() ? plane.normal : Vec3f();
    });
    Show(stage, normals);
  }

 private:
  void Write(RefineStage stage, const Image<Rgb>& picture) {
    WritePng(folder_ / FileName(stage), picture);
  }

  const ContainedPath folder_;
  const DepthRange range_;
  Image<Rgb> image_;  // The image of kImage.
};

}  // namespace

DebugPictures::DebugPictures(const std::filesystem::path& folder)
    : folder_(folder) {
  RequirePicturesAlone(folder_);
  CreateFolders({folder_, {}});
}

std::unique_ptr<StageObserver> DebugPictures::Observe(
    const std::string& image_name, const Image<float>& depth) {
  const ContainedPath folder(folder_, image_name);
  CreateFolders(folder);
  return std::make_unique<ImagePictures>(folder, depth);
}

std::filesystem::path DebugPicturePath(const std::filesystem::path& folder,
                                       const std::string& image_name,
                                       RefineStage stage) {
  return folder / image_name / FileName(stage);
}

std::string DebugPicturesText() {
  std::string text;
  for (const RefineStageInfo& info : RefineStages()) {
    text += (text.empty() ? "" : "; ") + FileName(info.stage).substr(0, 3) +
            info.name + ": " + info.description;
  }
  return text;
}

}  // namespace tsar
