// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/printable.h"

#include <exception>
#include <string>
#include <utility>

#include "python/bindings.h"

namespace py = pybind11;

namespace tsar {
namespace {

const char* CodeName(ErrorCode code) {
  switch (code) {
    case ErrorCode::kNotFound:
      return "not_found";
    case ErrorCode::kCorrupt:
      return "corrupt";
    case ErrorCode::kMismatch:
      return "mismatch";
    case ErrorCode::kUnsupported:
      return "unsupported";
    case ErrorCode::kIo:
      return "io";
    case ErrorCode::kBadOption:
      return "bad_option";
    case ErrorCode::kDevice:
      return "device";
    case ErrorCode::kOutOfMemory:
      return "out_of_memory";
    case ErrorCode::kInterrupted:
      return "interrupted";
  }
  return "";
}

void RaiseInPython(std::exception_ptr exception) {
  try {
    std::rethrow_exception(std::move(exception));
  } catch (const Error& error) {
    try {
      const py::object made = py::module_::import("colmap_tsar._errors")
                                  .attr("make_error")(CodeName(error.Code()),
                                                      Printable(error.what()));
      PyErr_SetObject(py::type::handle_of(made).ptr(), made.ptr());
    } catch (py::error_already_set& failure) {
      failure.restore();
    }
  }
}

}  // namespace

py::str ToText(const std::string& text) {
  PyObject* const made = PyUnicode_DecodeFSDefaultAndSize(
      text.data(), static_cast<Py_ssize_t>(text.size()));
  if (made == nullptr) {
    throw py::error_already_set();
  }
  return py::reinterpret_steal<py::str>(made);
}

void BindErrors(py::module_* /*module*/) {
  py::register_local_exception_translator(&RaiseInPython);
}

}  // namespace tsar
