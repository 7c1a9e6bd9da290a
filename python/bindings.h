// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/io/map_paths.h"

#include <string>

#include <pybind11/pybind11.h>

namespace tsar {

// The C++ part of the Python package colmap_tsar. It takes and returns plain
// Python values; the package, in colmap_tsar/*.py, makes its classes of them
// and holds the documentation for users.

// Has tsar::Error raised as the exceptions of colmap_tsar/_errors.py.
void BindErrors(pybind11::module_* module);

// EvaluateDepthMaps and EvaluateCloudFile.
void BindEvaluate(pybind11::module_* module);

// The commands that change and show a workspace, with their options, and what
// undoes them.
void BindCommands(pybind11::module_* module);

// The images of a workspace, and the maps of each, also by their paths.
void BindImages(pybind11::module_* module);

// What an export reads of a workspace.
void BindExport(pybind11::module_* module);

// ExportPlanes.
void BindPlanes(pybind11::module_* module);

// Text with names of files, which need not be UTF-8: as Python's own functions
// write them.
pybind11::str ToText(const std::string& text);

// Throws kBadOption for what is none.
MapType ToMapType(const std::string& input_type);

// Width, height, and the pixels row by row, as they lie in memory.
template <typename Pixel>
pybind11::tuple ToTuple(const Image<Pixel>& map) {
  PyObject* const pixels = PyByteArray_FromStringAndSize(
      reinterpret_cast<const char*>(map.Data()),
      static_cast<Py_ssize_t>(sizeof(Pixel) * map.NumPixels()));
  if (pixels == nullptr) {
    throw pybind11::error_already_set();
  }
  return pybind11::make_tuple(
      map.Width(),
      map.Height(),
      pybind11::reinterpret_steal<pybind11::object>(pixels));
}

}  // namespace tsar
