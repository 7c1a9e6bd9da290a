// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/cli/fuse_command.h"
#include "colmap_tsar/cli/import_command.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/refine_command.h"
#include "colmap_tsar/cli/report_command.h"
#include "colmap_tsar/cli/stereo_command.h"
#include "colmap_tsar/fusion/fuse_workspace.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/import/import_workspace.h"

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/bindings.h"
#include "python/serve_python.h"
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;

namespace tsar {
namespace {

using py::literals::operator""_a;

// "TsarStereo.device" is called "device" here.
std::string KeyOf(const Option& option) {
  return option.name.substr(option.name.find('.') + 1);
}

template <typename Command>
std::vector<Option> OptionsOf(Command* command) {
  OptionSet options("", "", "");
  command->AddTo(&options);
  return options.Options();
}

template <typename Command>
py::str HelpJsonOf() {
  Command command;
  OptionSet options("", "", "");
  command.AddTo(&options);
  TextStream text;
  options.PrintJson(text);
  return ToText(text.str());
}

// What --help_json of the command tells of its options.
py::str HelpJson(const std::string& command) {
  static const std::map<std::string, py::str (*)()> functions = {
      {"refine", &HelpJsonOf<RefineCommand>},
      {"stereo", &HelpJsonOf<StereoCommand>},
      {"fuse", &HelpJsonOf<FuseCommand>},
      {"import", &HelpJsonOf<ImportCommand>},
      {"report", &HelpJsonOf<ReportCommand>}};
  return functions.at(command)();
}

// Sets what is given in {name: text}, as it is written on a command line.
// Throws kBadOption for a value that is none or outside its range.
template <typename Command>
void SetGiven(const py::dict& values, Command* command) {
  for (const Option& option : OptionsOf(command)) {
    const std::string key = KeyOf(option);
    if (values.contains(key)) {
      option.Set(values[key.c_str()].cast<std::string>(), key);
    }
  }
}

template <typename Command>
Command ToCommand(const py::dict& values) {
  Command command;
  SetGiven(values, &command);
  if constexpr (requires { command.UsePreset(); }) {
    command.UsePreset();
    SetGiven(values, &command);
  }
  return command;
}

// {GPU: bytes}.
py::dict ToDict(const std::vector<RunSummary::GpuMemory>& peaks) {
  py::dict dict;
  for (const RunSummary::GpuMemory& peak : peaks) {
    dict[py::str(peak.gpu)] = peak.num_bytes;
  }
  return dict;
}

py::list ToTexts(const std::vector<std::filesystem::path>& paths) {
  py::list list;
  for (const std::filesystem::path& path : paths) {
    list.append(ToText(path.string()));
  }
  return list;
}

template <typename Summary>
py::str TextOf(const Summary& summary) {
  TextStream text;
  PrintSummary(summary, text);
  if constexpr (requires { PrintNext(summary, text); }) {
    PrintNext(summary, text);
  }
  return ToText(text.str());
}

py::dict ToDict(const RunSummary& summary) {
  py::dict kept;
  for (const RunSummary::KeptImage& image : summary.kept) {
    kept[ToText(image.name)] = ToText(image.reason);
  }
  return py::dict(
      "workspace_path"_a = summary.workspace_path,
      "input_type"_a = ToString(summary.type),
      "device"_a = summary.device,
      "num_workers"_a = summary.num_workers,
      "num_images"_a = summary.num_images,
      "num_observed"_a = summary.num_observed,
      "num_refined"_a = summary.num_refined,
      "num_skipped"_a = summary.num_skipped,
      "num_masks"_a = summary.num_masks,
      "num_priors"_a = summary.num_priors,
      "kept"_a = kept,
      "num_sources_without_maps"_a = summary.num_sources_without_maps,
      "counts"_a = summary.counts,
      "seconds"_a = summary.seconds,
      "wall_seconds"_a = summary.wall_seconds,
      "peak_gpu_memory"_a = ToDict(summary.peak_gpu_memory),
      "text"_a = TextOf(summary));
}

// Returns the summary of the command's work; see WorkWhileServingPython.
template <typename Command>
auto Run(const std::string& name,
         const Command& command,
         const py::tuple& listeners) {
  decltype(command.Run(std::declval<Progress&>())) summary;
  WorkWhileServingPython(
      name, ToPythonListeners(listeners), [&](Progress& progress) {
        summary = command.Run(progress);
      });
  return summary;
}

py::dict Refine(const py::dict& options, const py::tuple& listeners) {
  const auto command = ToCommand<RefineCommand>(options);
  return ToDict(Run("refine", command, listeners));
}

py::dict RestoreOriginals(const std::filesystem::path& workspace_path) {
  PrepareStreams();
  RestoreResult result;
  {
    const py::gil_scoped_release release;
    const WorkspaceLock lock(workspace_path);
    result = Restore(workspace_path);
  }
  return py::dict("num_restored"_a = result.num_restored,
                  "kept"_a = ToTexts(result.kept),
                  "superseded"_a = ToTexts(result.superseded),
                  "lost"_a = ToTexts(result.lost));
}

py::dict Stereo(const py::dict& options, const py::tuple& listeners) {
  const auto command = ToCommand<StereoCommand>(options);
  const StereoSummary summary = Run("stereo", command, listeners);
  py::list without_sources;
  for (const RunSummary::KeptImage& image : summary.without_sources) {
    without_sources.append(ToText(image.name));
  }
  return py::dict("workspace_path"_a = summary.workspace_path,
                  "input_type"_a = ToString(summary.type),
                  "device"_a = summary.device,
                  "num_images"_a = summary.num_images,
                  "num_skipped"_a = summary.num_skipped,
                  "num_masks"_a = summary.num_masks,
                  "without_sources"_a = without_sources,
                  "wall_seconds"_a = summary.wall_seconds,
                  "peak_gpu_memory"_a = ToDict(summary.peak_gpu_memory),
                  "text"_a = TextOf(summary));
}

py::dict Fuse(const py::dict& options, const py::tuple& listeners) {
  const auto command = ToCommand<FuseCommand>(options);
  const FuseSummary summary = Run("fuse", command, listeners);
  return py::dict("output_path"_a = command.options.output_path,
                  "device"_a = summary.devices,
                  "num_images"_a = summary.num_images,
                  "num_masks"_a = summary.num_masks,
                  "num_points"_a = summary.num_points,
                  "wall_seconds"_a = summary.seconds,
                  "peak_gpu_memory"_a = ToDict(summary.gpu_memory));
}

py::dict ImportMaps(const py::dict& options, const py::tuple& listeners) {
  const auto command = ToCommand<ImportCommand>(options);
  const ImportSummary summary = Run("import_maps", command, listeners);
  py::list warnings;
  for (const std::string& warning : summary.warnings) {
    warnings.append(ToText(warning));
  }
  return py::dict("output_path"_a = summary.output_path,
                  "output_type"_a = ToString(summary.type),
                  "num_images"_a = summary.num_images,
                  "num_imported"_a = summary.num_imported,
                  "num_without_image"_a = summary.num_without_image,
                  "num_with_normals"_a = summary.num_with_normals,
                  "num_pixels"_a = summary.num_pixels,
                  "num_with_depth"_a = summary.num_with_depth,
                  "num_kept"_a = summary.num_kept,
                  "scale"_a = summary.scale.num_images > 0
                                  ? py::object(py::float_(summary.scale.median))
                                  : py::object(py::none()),
                  "warnings"_a = warnings,
                  "text"_a = TextOf(summary));
}

py::dict Report(const py::dict& options, const py::tuple& listeners) {
  const auto command = ToCommand<ReportCommand>(options);
  const ReportSummary summary = Run("report", command, listeners);
  return py::dict("page_path"_a = summary.page_path,
                  "num_images"_a = summary.num_images);
}

}  // namespace

void BindCommands(py::module_* module) {
  module->def("help_json", &HelpJson);
  module->def("refine", &Refine);
  module->def("restore", &RestoreOriginals);
  module->def("stereo", &Stereo);
  module->def("fuse", &Fuse);
  module->def("import_maps", &ImportMaps);
  module->def("report", &Report);
}

}  // namespace tsar
