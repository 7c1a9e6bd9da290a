// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/refine_options.h"

#include "colmap_tsar/cli/name_suggestion.h"
#include "colmap_tsar/pipeline/refine_option_list.h"

#include <algorithm>
#include <limits>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "python/bindings.h"
#include <pybind11/stl.h>

namespace py = pybind11;

namespace tsar {
namespace {

[[noreturn]] void ThrowWrongType(const RefineField& field,
                                 const char* expected,
                                 py::handle value) {
  throw py::type_error(field.name + ": give " + expected + ", not " +
                       std::string(py::repr(value)));
}

void Assign(const RefineField& field, py::handle value, bool* target) {
  // As it is: without truth values of numbers and containers.
  py::detail::make_caster<bool> caster;
  if (!caster.load(value, /*convert=*/false)) {
    ThrowWrongType(field, "True or False", value);
  }
  *target = static_cast<bool>(caster);
}

void Assign(const RefineField& field, py::handle value, int* target) {
  if (PyBool_Check(value.ptr()) || !PyIndex_Check(value.ptr())) {
    ThrowWrongType(field, "an integer", value);
  }
  const auto number =
      py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!number) {
    throw py::error_already_set();
  }
  // Where it does not fit, it is outside of every option's range, and shall
  // still be afterwards.
  int overflow = 0;
  const long long wide = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
  constexpr long long kMin = std::numeric_limits<int>::min();
  constexpr long long kMax = std::numeric_limits<int>::max();
  *target = static_cast<int>(overflow < 0   ? kMin
                             : overflow > 0 ? kMax
                                            : std::clamp(wide, kMin, kMax));
}

void Assign(const RefineField& field, py::handle value, double* target) {
  const double number =
      PyBool_Check(value.ptr()) ? -1.0 : PyFloat_AsDouble(value.ptr());
  if (PyBool_Check(value.ptr()) || PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    ThrowWrongType(field, "a number", value);
  }
  *target = number;
}

void SetField(const RefineField& field, py::handle value) {
  std::visit([&](auto* target) { Assign(field, value, target); }, field.value);
}

py::object GetField(const RefineField& field) {
  return std::visit([](const auto* value) { return py::cast(*value); },
                    field.value);
}

const RefineField& FindField(const std::vector<RefineField>& fields,
                             const std::string& name) {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const RefineField& field) {
        return field.name == name;
      });
  if (found == fields.end()) {
    throw py::key_error(name);
  }
  return *found;
}

// What a user may know about each option, in the order of the help.
py::list DescribeFields() {
  RefineOptions defaults;
  RefineOptions paper = RefineOptions::Paper();
  const std::vector<RefineField> paper_fields = ListRefineFields(&paper);
  RefineOptions strict = RefineOptions::PaperStrict();
  const std::vector<RefineField> strict_fields = ListRefineFields(&strict);
  py::list all;
  for (const RefineField& field : ListRefineFields(&defaults)) {
    py::dict description;
    description["name"] = field.name;
    description["default"] = GetField(field);
    description["paper"] = GetField(FindField(paper_fields, field.name));
    description["paper_strict"] =
        GetField(FindField(strict_fields, field.name));
    description["description"] = field.description;
    const bool has_range = !std::holds_alternative<bool*>(field.value);
    description["range"] =
        has_range ? py::object(py::make_tuple(field.min, field.max))
                  : py::object(py::none());
    all.append(description);
  }
  return all;
}

// The former names of options and their present ones.
py::dict DescribeRenamed() {
  py::dict names;
  for (const RenamedOption& renamed : RenamedRefineOptions()) {
    names[py::str(renamed.former_name)] = renamed.name;
  }
  return names;
}

// The value as the option's type, after its checks.
py::object CheckField(const std::string& name, py::handle value) {
  // No value of one option alone makes the defaults contradict each other.
  RefineOptions options;
  const std::vector<RefineField> fields = ListRefineFields(&options);
  const RefineField& field = FindField(fields, name);
  SetField(field, value);
  options.Check();
  return GetField(field);
}

}  // namespace

RefineOptions ToRefineOptions(const py::dict& values) {
  RefineOptions options;
  const std::vector<RefineField> fields = ListRefineFields(&options);
  for (const auto& [name, value] : values) {
    SetField(FindField(fields, py::cast<std::string>(name)), value);
  }
  return options;
}

void BindRefineOptions(py::module_* module) {
  module->def("describe_fields", &DescribeFields);
  module->def("describe_renamed", &DescribeRenamed);
  module->def("check_field", &CheckField);
  module->def("check_options",
              [](const py::dict& values) { ToRefineOptions(values).Check(); });
  module->def("suggest_names", &SuggestNames);
}

}  // namespace tsar
