// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/run_summary.h"
#include "colmap_tsar/pipeline/refine_options.h"
#include "colmap_tsar/workspace/map_paths.h"

#include <filesystem>
#include <string>
#include <vector>

#include <pybind11/pybind11.h>

namespace tsar {

// The C++ part of the Python package colmap_tsar. It takes and returns plain
// Python values; the package, in colmap_tsar/*.py, makes its classes of them
// and holds the documentation for users.

// Has tsar::Error raised as the exceptions of colmap_tsar/_errors.py.
void BindErrors(pybind11::module_* module);

// The members of RefineOptions, and their checks.
void BindRefineOptions(pybind11::module_* module);

// RefineWorkspace and Restore.
void BindRefine(pybind11::module_* module);

// EvaluateDepthMaps and EvaluateCloudFile.
void BindEvaluate(pybind11::module_* module);

// MatchWorkspace, ImportWorkspace, UndoImport and WritePage, with the options
// of their commands.
void BindCommands(pybind11::module_* module);

// The images of a workspace, and the maps of each.
void BindImages(pybind11::module_* module);

// ExportPlanes, and the maps of planes.
void BindPlanes(pybind11::module_* module);

// Text with names of files, which need not be UTF-8: as Python's own functions
// write them.
pybind11::str ToText(const std::string& text);

pybind11::list ToTexts(const std::vector<std::filesystem::path>& paths);

// {GPU: bytes}.
pybind11::dict ToDict(const std::vector<RunSummary::GpuMemory>& peaks);

// result: a RestoreResult or UndoResult. num_restored: of its images.
template <typename Result>
pybind11::dict ToRestorationDict(const Result& result, int num_restored) {
  pybind11::dict dict;
  dict["num_restored"] = num_restored;
  dict["kept"] = ToTexts(result.kept);
  dict["superseded"] = ToTexts(result.superseded);
  dict["conflicts"] = ToTexts(result.conflicts);
  return dict;
}

// From {name: value}. Raises TypeError for a value of another type; throws
// kBadOption where it is outside the option's range. Unknown names are
// KeyError.
RefineOptions ToRefineOptions(const pybind11::dict& values);

// "geometric" or "photometric"; throws kBadOption for anything else.
MapType ToMapType(const std::string& input_type);

}  // namespace tsar
