// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "python/bindings.h"

PYBIND11_MODULE(_core, module) {
  module.doc() = "The C++ part of colmap_tsar; use that.";
  module.attr("__version__") = TSAR_VERSION;
  module.attr("has_cuda") = static_cast<bool>(TSAR_CUDA_ENABLED);
  tsar::BindErrors(&module);
  tsar::BindEvaluate(&module);
  tsar::BindCommands(&module);
  tsar::BindExport(&module);
  tsar::BindImages(&module);
  tsar::BindPlanes(&module);
}
