// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/cli/export_command.h"
#include "colmap_tsar/cli/fuse_command.h"
#include "colmap_tsar/cli/import_command.h"
#include "colmap_tsar/cli/name_suggestion.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/refine_command.h"
#include "colmap_tsar/cli/report_command.h"
#include "colmap_tsar/cli/stereo_command.h"
#include "colmap_tsar/fusion/fuse_workspace.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/export/export_workspace.h"
#include "colmap_tsar/tools/import/import_workspace.h"
#include "colmap_tsar/tools/import/undo_import.h"
#include "colmap_tsar/tools/report/write_page.h"

#include <filesystem>
#include <functional>
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

// What --help_json of the command prints of its options.
template <typename Command>
py::str HelpJson() {
  Command command;
  OptionSet options("", "", "");
  command.AddTo(&options);
  TextStream text;
  PrintHelpJson(options.Help(), text);
  return ToText(text.str());
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

// Undoes the work of a command on a workspace. num_restored: tells of the
// result of how many images.
template <typename Undo, typename NumRestored>
py::dict Undone(const std::filesystem::path& workspace_path,
                const std::string& conflicts,
                const Undo& undo,
                const NumRestored& num_restored) {
  PrepareStreams();
  const auto result = [&] {
    const py::gil_scoped_release release;
    const WorkspaceLock lock(workspace_path);
    return undo(workspace_path, ParseRestoreConflicts(conflicts));
  }();
  py::dict dict;
  dict["num_restored"] = num_restored(result);
  dict["kept"] = ToTexts(result.kept);
  dict["superseded"] = ToTexts(result.superseded);
  dict["conflicts"] = ToTexts(result.conflicts);
  return dict;
}

template <typename Summary>
py::str TextOf(const Summary& summary) {
  TextStream text;
  PrintSummary(summary, text);
  return ToText(text.str());
}

py::dict ToDict(const RunSummary& summary) {
  py::dict kept;
  for (const RunSummary::KeptImage& image : summary.kept) {
    kept[ToText(image.name)] = ToText(image.reason);
  }
  py::dict dict;
  dict["workspace_path"] = summary.workspace_path;
  dict["input_type"] = ToString(summary.type);
  dict["device"] = summary.device;
  dict["num_workers"] = summary.num_workers;
  dict["num_images"] = summary.num_images;
  dict["num_observed"] = summary.num_observed;
  dict["num_refined"] = summary.num_refined;
  dict["num_skipped"] = summary.num_skipped;
  dict["num_masks"] = summary.num_masks;
  dict["num_priors"] = summary.num_priors;
  dict["kept"] = kept;
  dict["num_sources_without_maps"] = summary.num_sources_without_maps;
  dict["counts"] = summary.counts;
  dict["seconds"] = summary.seconds;
  dict["wall_seconds"] = summary.wall_seconds;
  dict["peak_gpu_memory"] = ToDict(summary.peak_gpu_memory);
  dict["text"] = TextOf(summary);
  return dict;
}

// Returns the summary of the command's work; see WorkWhileServingPython.
template <typename Command>
auto Run(const std::string& name,
         const Command& command,
         const py::tuple& listeners) {
  decltype(command.Run(std::declval<Progress&>(), {})) summary;
  WorkWhileServingPython(
      name,
      ToPythonListeners(listeners),
      [&](Progress& progress, const std::function<bool()>& should_stop) {
        summary = command.Run(progress, should_stop);
      });
  return summary;
}

py::dict Refine(const py::dict& options, const py::tuple& listeners) {
  auto command = ToCommand<RefineCommand>(options);
  command.UsePreset();
  SetGiven(options, &command);
  return ToDict(Run("refine", command, listeners));
}

py::dict RestoreOriginals(const std::filesystem::path& workspace_path,
                          const std::string& conflicts) {
  const auto restore = [](const std::filesystem::path& path,
                          RestoreConflicts choice) {
    RestoreResult result = Restore(path, choice);
    // Those are for the user to decide about as well.
    result.conflicts.insert(
        result.conflicts.end(), result.lost.begin(), result.lost.end());
    return result;
  };
  return Undone(
      workspace_path, conflicts, restore, [](const RestoreResult& result) {
        return result.num_restored;
      });
}

py::dict Stereo(const py::dict& options, const py::tuple& listeners) {
  const auto command = ToCommand<StereoCommand>(options);
  const StereoSummary summary = Run("stereo", command, listeners);
  py::dict dropped_priors;
  for (const StereoSummary::ImageReason& image : summary.dropped_priors) {
    dropped_priors[ToText(image.name)] = ToText(image.reason);
  }
  py::list without_sources;
  for (const StereoSummary::ImageReason& image : summary.without_sources) {
    without_sources.append(ToText(image.name));
  }
  py::dict dict;
  dict["workspace_path"] = summary.workspace_path;
  dict["input_type"] = ToString(summary.type);
  dict["device"] = summary.device;
  dict["num_images"] = summary.num_images;
  dict["num_skipped"] = summary.num_skipped;
  dict["num_masks"] = summary.num_masks;
  dict["num_priors"] = summary.num_priors;
  dict["dropped_priors"] = dropped_priors;
  dict["without_sources"] = without_sources;
  dict["wall_seconds"] = summary.wall_seconds;
  dict["peak_gpu_memory"] = ToDict(summary.peak_gpu_memory);
  dict["text"] = TextOf(summary);
  return dict;
}

py::dict Fuse(const py::dict& options, const py::tuple& listeners) {
  const auto command = ToCommand<FuseCommand>(options);
  const FuseSummary summary = Run("fuse", command, listeners);
  py::dict dict;
  dict["output_path"] = command.options.output_path;
  dict["device"] = summary.devices;
  dict["num_images"] = summary.num_images;
  dict["num_masks"] = summary.num_masks;
  dict["num_points"] = summary.num_points;
  dict["wall_seconds"] = summary.seconds;
  dict["peak_gpu_memory"] = ToDict(summary.gpu_memory);
  return dict;
}

py::dict ImportMaps(const py::dict& options, const py::tuple& listeners) {
  const auto command = ToCommand<ImportCommand>(options);
  const ImportSummary summary = Run("import_maps", command, listeners);
  py::list warnings;
  for (const std::string& warning : summary.warnings) {
    warnings.append(ToText(warning));
  }
  py::dict dict;
  dict["workspace_path"] = summary.workspace_path;
  dict["output_type"] = ToString(summary.type);
  dict["num_images"] = summary.num_images;
  dict["num_imported"] = summary.num_imported;
  dict["num_without_image"] = summary.num_without_image;
  dict["num_with_normals"] = summary.num_with_normals;
  dict["num_with_costs"] = summary.num_with_costs;
  dict["num_pixels"] = summary.num_pixels;
  dict["num_with_depth"] = summary.num_with_depth;
  dict["scale"] = summary.scale.num_images > 0
                      ? py::object(py::float_(summary.scale.median))
                      : py::object(py::none());
  dict["warnings"] = warnings;
  dict["text"] = TextOf(summary);
  return dict;
}

py::dict UndoImports(const std::filesystem::path& workspace_path,
                     const std::string& conflicts) {
  return Undone(
      workspace_path, conflicts, &UndoImport, [](const UndoResult& result) {
        return result.num_images;
      });
}

py::dict Report(const py::dict& options, const py::tuple& listeners) {
  const auto command = ToCommand<ReportCommand>(options);
  std::optional<std::filesystem::path> page_path;
  std::optional<std::filesystem::path> picture_path;
  int num_images = 0;
  WorkWhileServingPython(
      "report",
      ToPythonListeners(listeners),
      [&](Progress& progress, const std::function<bool()>& should_stop) {
        const Workspace workspace = command.Open();
        if (command.WantsPicture()) {
          command.WritePicture(workspace);
          picture_path = command.output_path;
        }
        if (command.WantsPage()) {
          const PageOptions page = command.Page(workspace);
          num_images = WritePage(workspace, page, progress, should_stop);
          page_path = page.report_path / "index.html";
        }
      });
  py::dict dict;
  dict["page_path"] = page_path;
  dict["picture_path"] = picture_path;
  dict["num_images"] = num_images;
  return dict;
}

py::dict Export(const py::dict& options, const py::tuple& listeners) {
  const auto command = ToCommand<ExportCommand>(options);
  const ExportSummary summary = Run("export", command, listeners);
  py::dict dict;
  dict["output_path"] = command.options.output_path;
  dict["num_images"] = summary.num_images;
  dict["num_with_depth"] = summary.num_with_depth;
  dict["num_masks"] = summary.num_masks;
  dict["num_pixels"] = summary.num_pixels;
  dict["num_depths"] = summary.num_depths;
  return dict;
}

}  // namespace

void BindCommands(py::module_* module) {
  module->def("help_json_of_refine", &HelpJson<RefineCommand>);
  module->def("help_json_of_stereo", &HelpJson<StereoCommand>);
  module->def("help_json_of_fuse", &HelpJson<FuseCommand>);
  module->def("help_json_of_import", &HelpJson<ImportCommand>);
  module->def("help_json_of_report", &HelpJson<ReportCommand>);
  module->def("help_json_of_export", &HelpJson<ExportCommand>);
  module->def("suggest_names", &SuggestNames);
  module->def("refine", &Refine);
  module->def("restore", &RestoreOriginals);
  module->def("stereo", &Stereo);
  module->def("fuse", &Fuse);
  module->def("import_maps", &ImportMaps);
  module->def("undo_imports", &UndoImports);
  module->def("report", &Report);
  module->def("export", &Export);
}

}  // namespace tsar
