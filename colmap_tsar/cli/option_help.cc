// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/option_help.h"

#include "colmap_tsar/base/printable.h"

#include <map>
#include <ostream>
#include <sstream>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

using Lines = std::vector<std::pair<std::string, std::string>>;

// The most used options by command, beside the required ones, each with a
// description of one line.
const Lines& MostUsed(const std::string& command) {
  static const std::map<std::string, Lines> lines = {
      {"tsar_refine",
       {{"output_path", "write a second workspace, leave this alone"},
        {"restore", "put the original maps back"},
        {"image_list_path", "refine the images of this list alone"},
        {"mask_path", "the folder with masks of the images"},
        {"prior_path", "the folder with their depth priors"},
        {"TsarRefine.device", "where to compute"},
        {"TsarRefine.min_confidence", "leave doubtful depths out"}}},
      {"tsar_stereo",
       {{"image_list_path", "make the maps of the images of this list alone"},
        {"mask_path", "the folder with masks of the images"},
        {"prior_path", "the folder with their depth priors"},
        {"overwrite", "replace maps of other programs and options"},
        {"TsarStereo.max_image_size", "longer side of the maps, in pixels"},
        {"TsarStereo.geom_consistency", "also make geometric maps"},
        {"TsarStereo.device", "where to compute"}}},
      {"tsar_fuse",
       {{"overwrite", "replace a cloud that is there"},
        {"mask_path", "the folder with masks of the images"},
        {"TsarFuse.preset", "default, paper or colmap"},
        {"TsarFuse.min_num_views", "images that have to agree on a point"},
        {"TsarFuse.point_spacing", "1: the densest cloud"},
        {"TsarFuse.device", "where to compute"}}},
      {"tsar_import",
       {{"format", "of the maps"},
        {"depth_scale", "units of the model per stored unit of depth"},
        {"scale_to_sparse", "for depth whose scale is unknown"},
        {"overwrite", "replace an earlier import"}}},
      {"tsar_report",
       {{"report_path", "the folder of the page, if not report in there"},
        {"before_path", "the cloud fused before, for the 3D view"},
        {"after_path", "the cloud fused after, for the 3D view"},
        {"ground_truth_path", "depth maps to score the maps against"},
        {"output_path", "a picture instead of the page"},
        {"overwrite", "replace an earlier page or picture"}}},
      {"tsar_planes",
       {{"format", "if not given: by the name of the file"},
        {"plan_path", "a floor plan instead, or as well"},
        {"min_area", "leave smaller planes out"},
        {"overwrite", "replace the file"}}},
      {"tsar_evaluate depth",
       {{"ground_truth_path", "true depth, if not in the workspace"},
        {"tolerances", "errors below which a depth is right"},
        {"mask_path", "the folder with masks of the images"},
        {"json", "print JSON"}}},
      {"tsar_evaluate cloud",
       {{"tolerances", "distances up to which a point is right"},
        {"json", "print JSON"}}},
  };
  static const Lines none;
  const auto found = lines.find(command);
  return found == lines.end() ? none : found->second;
}

// Breaks a text into lines of at most 79 letters with this indentation.
std::string WrapText(const std::string& text, size_t indentation) {
  const std::string indent(indentation, ' ');
  std::istringstream words(text);
  std::string wrapped;
  std::string line = indent;
  for (std::string word; words >> word;) {
    if (line.size() > indentation && line.size() + 1 + word.size() > 79) {
      wrapped += line + "\n";
      line = indent;
    }
    line += (line.size() > indentation ? " " : "") + word;
  }
  return wrapped + line + "\n";
}

std::string FirstSentence(const std::string& text) {
  const size_t end = text.find(". ");
  return end == std::string::npos ? text : text.substr(0, end + 1);
}

void PrintLine(const Option& option,
               const std::string& text,
               std::ostream& out) {
  constexpr size_t kTextColumn = 32;
  std::string line = "  --" + option.name + " " + option.ValueHint();
  if (line.size() + 2 > kTextColumn) {
    out << line << "\n";
    line.clear();
  }
  line.resize(kTextColumn, ' ');
  out << line << text << "\n";
}

// dashes: the prefix of its name.
void PrintOption(const Option& option,
                 const std::string& dashes,
                 std::ostream& out) {
  std::string remark = option.required ? "required" : "";
  if (!option.required && !option.Text().empty()) {
    remark = "default: " + option.Text();
  }
  for (const auto& [preset, value] : option.presets) {
    remark += "; " + preset + ": " + value;
  }
  out << "  " << dashes << option.name << " " << option.ValueHint()
      << (remark.empty() ? "" : " (" + remark + ")") << "\n"
      << WrapText(option.description, 6);
}

nlohmann::ordered_json ToJson(const Option& option) {
  nlohmann::ordered_json json = {{"name", option.name},
                                 {"value", option.ValueHint()},
                                 {"choices",
                                  std::holds_alternative<bool*>(option.target)
                                      ? std::vector<std::string>{"0", "1"}
                                      : option.choices},
                                 {"is_path", option.IsPath()},
                                 {"required", option.required},
                                 {"default", option.Text()},
                                 {"description", option.description}};
  for (const Option& setting : option.settings) {
    json["settings"].push_back(ToJson(setting));
    json["settings"].back()["presets"] = setting.presets;
    json["settings"].back()["max"] = setting.range.max;
  }
  return json;
}

}  // namespace

void PrintHelp(const CommandHelp& help,
               const std::string& program_name,
               std::ostream& out) {
  const std::string program = Printable(program_name);
  std::string usage = program + " " + help.command;
  for (const Option& option : help.options) {
    if (option.required) {
      usage += " --" + option.name + " " + option.ValueHint();
    }
  }
  out << WrapText(help.summary, 0) << "\nUsage:\n  " << usage
      << " [options]\n\nExample:\n  " << program << " " << help.example
      << "\n\nOptions:\n";
  for (const Option& option : help.options) {
    PrintOption(option, "--", out);
  }
  out << "  -h, --help\n      Print this text; -h what is used most of it.\n"
      << "  --help_json\n      Print the same as JSON, for programs.\n";
}

void PrintShortHelp(const CommandHelp& help,
                    const std::string& program_name,
                    std::ostream& out) {
  const std::string program = Printable(program_name) + " ";
  out << WrapText(FirstSentence(help.summary), 0) << "\nExample:\n"
      << WrapText(program + help.example, 2) << "\nOptions:\n";
  for (const Option& option : help.options) {
    if (option.required) {
      PrintLine(option, "required", out);
    }
  }
  for (const auto& [name, text] : MostUsed(help.command)) {
    for (const Option& option : help.options) {
      if (option.name == name) {
        PrintLine(option, text, out);
      }
    }
  }
  out << "\nAll " << help.options.size() << " options: " << program
      << help.command << " --help\n";
}

void PrintSettings(const Option& option, std::ostream& out) {
  out << WrapText("For experiments, --" + option.name +
                      " takes any of these as NAME=VALUE, with commas between "
                      "them.",
                  0)
      << "\n";
  for (const Option& setting : option.settings) {
    PrintOption(setting, "", out);
  }
}

void PrintHelpJson(const CommandHelp& help, std::ostream& out) {
  nlohmann::ordered_json json;
  json["command"] = help.command;
  json["summary"] = help.summary;
  json["example"] = help.example;
  json["options"] = nlohmann::ordered_json::array();
  for (const Option& option : help.options) {
    json["options"].push_back(ToJson(option));
  }
  out << json.dump(2) << "\n";
}

}  // namespace tsar
