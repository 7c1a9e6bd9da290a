// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/input_folders.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/run/store/workspace_lock.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "python/bindings.h"
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;

namespace tsar {
namespace {

using Path = std::filesystem::path;

Workspace OpenWithMasks(const Path& root,
                        const std::optional<std::string>& input_type,
                        const std::optional<Path>& mask_path) {
  Workspace workspace = OpenWorkspaceWithMaps(
      root, input_type ? std::optional(ToMapType(*input_type)) : std::nullopt);
  workspace.UseMasks(mask_path.value_or(Path()));
  return workspace;
}

// The maps of a workspace that no other program changes meanwhile; nothing
// where images are masked.
class ExportSource {
 public:
  // Refuses an output that lies among the inputs. Warns of results that are
  // not as they were written.
  ExportSource(const Path& root,
               const std::optional<std::string>& input_type,
               const std::optional<Path>& mask_path,
               const Path& output_path)
      : workspace_(OpenWithMasks(root, input_type, mask_path)),
        lock_(root, WorkspaceLock::Mode::kShared) {
    RequireOutsideInputs(root, output_path, "output_path");
    WarnOfChangedResults(workspace_);
    WarnOfConventions(workspace_, FindImagesWithMaps(workspace_));
  }

  const Workspace& GetWorkspace() const { return workspace_; }

  // {kind: (width, height, pixels)}. kinds: depth alone, depth and normals, or
  // all that the image has.
  py::dict Read(int image, const std::vector<std::string>& kinds) const {
    ImageMaps maps;
    {
      const py::gil_scoped_release release;
      if (kinds.size() > 2) {
        maps = ReadImageMaps(workspace_, image);
      } else {
        maps.depth = ReadImageDepth(workspace_, image);
      }
      if (kinds.size() == 2) {
        maps.normal = ReadImageNormal(workspace_, image, maps.depth);
      }
    }
    py::dict read;
    const auto add = [&](const char* kind, const auto& map) {
      if (!map.Empty()) {
        read[kind] = ToTuple(map);
      }
    };
    add("depth", maps.depth);
    add("normals", maps.normal);
    add("confidence", maps.confidence);
    add("sigma", maps.sigma);
    add("provenance", maps.provenance);
    add("planes", maps.planes);
    return read;
  }

  // 1 where the photo is masked, or None. width, height: of the image's maps.
  py::object MaskOfPhoto(int image, int width, int height) const {
    if (!workspace_.HasMask(image)) {
      return py::none();
    }
    return ToTuple(workspace_.ReadMaskOfImage(image, {width, height}));
  }

 private:
  const Workspace workspace_;
  const WorkspaceLock lock_;
};

// Of the images of an export, as indices into the sparse model.
std::vector<int> ImagesWithMaps(const ExportSource& source) {
  const Workspace& workspace = source.GetWorkspace();
  std::vector<int> images = FindImagesWithMaps(workspace);
  if (images.empty()) {
    throw Error::File(
        ErrorCode::kNotFound,
        workspace.Root().string(),
        "no image has " + ToString(workspace.Type()) + " depth and normal maps",
        "run patch_match_stereo or tsar_stereo on it first, or " +
            AdviceOfTypes(workspace.Root()));
  }
  return images;
}

}  // namespace

void BindExport(py::module_* module) {
  py::class_<ExportSource>(*module, "ExportSource")
      .def(py::init<const Path&,
                    const std::optional<std::string>&,
                    const std::optional<Path>&,
                    const Path&>())
      .def_property_readonly("input_type",
                             [](const ExportSource& source) {
                               return ToString(source.GetWorkspace().Type());
                             })
      .def("images_with_maps", &ImagesWithMaps)
      .def("is_refined",
           [](const ExportSource& source, int image) {
             const Workspace& workspace = source.GetWorkspace();
             return Exists(workspace.Paths(image, workspace.Type()).provenance);
           })
      .def("read", &ExportSource::Read)
      .def("mask_of_photo", &ExportSource::MaskOfPhoto)
      .def("count_masks",
           [](const ExportSource& source, const std::vector<int>& images) {
             return source.GetWorkspace().CountMasks(images);
           })
      .def("sparse_model_files", [](const ExportSource& source) {
        return FindSparseModelFiles(
            FindModelFolder(source.GetWorkspace().Root()));
      });
}

}  // namespace tsar
