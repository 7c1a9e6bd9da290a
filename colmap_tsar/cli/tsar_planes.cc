// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"
#include "colmap_tsar/tools/plane_export/floor_plan.h"
#include "colmap_tsar/tools/plane_export/write_planes.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <tuple>

namespace tsar {
namespace {

constexpr const char* kSummary =
    "Writes the planes of a refined workspace to a file: walls, floors, "
    "ceilings and other flat surfaces, each with its normal, how certain it "
    "is, its area, the images that see it, and its outlines with holes in the "
    "world frame. Walls and floors meet in the same lines. JSON holds "
    "everything; OBJ holds faces for viewers, DXF faces and outlines for CAD "
    "programs. With --plan_path it draws a "
    "floor plan of the walls instead, or as well. Coordinates and lengths are "
    "those of the sparse model, unless --up and --scale change them.";

struct PlanesCommand {
  std::filesystem::path workspace_path;
  std::filesystem::path output_path;
  std::filesystem::path plan_path;
  std::optional<MapType> input_type;
  UpAxis up = UpAxis::kModel;
  double scale = 0.0;
  bool overwrite = false;
  double min_area = 0.0;
};

void AddOptions(PlanesCommand* command, OptionSet* options) {
  options->AddRequired("workspace_path",
                       &command->workspace_path,
                       "The refined dense workspace.");
  options->Add("output_path",
               &command->output_path,
               "The file to write: .json, .obj or .dxf; not needed with "
               "--plan_path. One that is there is replaced with --overwrite 1 "
               "alone.");
  options->Add("plan_path",
               &command->plan_path,
               "A floor plan to write: the walls seen from above, as a picture "
               "with a scale bar (.svg) or for CAD programs (.dxf).");
  AddInputType(
      &command->input_type,
      "The maps that were refined. If not given: geometric, or photometric "
      "where only those were refined.",
      options);
  options->Add("min_area",
               &command->min_area,
               "Planes of a smaller area are left out; in square units of "
               "what is written.",
               {0.0, std::numeric_limits<double>::max()});
  options->AddEnum<UpAxis>(
      "up",
      &command->up,
      {UpAxis::kModel, UpAxis::kY, UpAxis::kZ},
      "The axis of the written coordinates that points up: z "
      "for CAD programs, y for most viewers. model: the axes of "
      "the sparse model, which point anywhere unless it was "
      "aligned.");
  options->Add("scale",
               &command->scale,
               "Meters per unit of the sparse model: what is written is in "
               "meters, and DXF says so; 1 for a model in meters. 0: not "
               "known; in units of the model.",
               {0.0, std::numeric_limits<double>::max()});
  options->Add(
      "overwrite", &command->overwrite, "Replace a file that is there.");
}

void PrintPlanes(const ExportedPlanes& planes,
                 PlanesWriter writer,
                 const std::filesystem::path& path) {
  const auto num_written = std::ranges::count_if(
      planes.planes,
      [&](const ExportedPlane& plane) { return IsWritten(plane, writer); });
  const auto num_outlined = std::ranges::count_if(
      planes.planes,
      [](const ExportedPlane& plane) { return !plane.polygons.empty(); });
  std::cout << "Wrote " << Counted(num_written, "plane") << " of "
            << Counted(planes.num_images, "image") << " to "
            << Printable(path.string());
  if (num_written > num_outlined) {
    std::cout << ", " << num_outlined << " with an outline";
  }
  std::cout << "\n";
  for (const auto& [plane_class, name] : kPlaneClassNames) {
    int count = 0;
    double area = 0.0;
    for (const ExportedPlane& plane : planes.planes) {
      if (plane.plane_class == plane_class && IsWritten(plane, writer)) {
        ++count;
        area += plane.area;
      }
    }
    std::cout << "  " << name << ": " << count << ", area " << area << "\n";
  }
  const auto num_left_out = std::ssize(planes.planes) - num_written;
  if (num_left_out > 0) {
    std::cout << "  left out, since too little of them is seen for an outline: "
              << num_left_out << " (JSON has them)\n";
  }
  std::cout << std::flush;
}

void PrintPlan(const FloorPlan& plan, const std::filesystem::path& path) {
  std::cout << "Drew " << Counted(std::ssize(plan.walls), "wall") << " to "
            << Printable(path.string());
  if (plan.num_leaning > 0) {
    std::cout << "\n  left out, since they lean more than " << kMaxLean
              << " degrees: " << plan.num_leaning;
  }
  std::cout << std::endl;
}

// Refuses options that nothing would read.
void CheckUse(const PlanesCommand& command) {
  if (!command.output_path.empty()) {
    return;
  }
  if (command.plan_path.empty()) {
    throw Error(ErrorCode::kBadOption,
                OptionName("output_path") +
                    " is missing; give the file to write, or a floor plan as " +
                    OptionName("plan_path"));
  }
  if (command.up == UpAxis::kY) {
    throw Error(ErrorCode::kBadOption,
                OptionName("up") + " is for " + OptionName("output_path") +
                    "; give that, too, or leave it out: a floor plan has the "
                    "axes of " +
                    OptionName("up") + " z");
  }
}

// Whether a file begins as those of this command. DXF has no name in it, but
// layers of planes at its begin.
bool IsOfPlanes(const std::string& begin) {
  const auto has = [&](const char* text) {
    return begin.find(text) != std::string::npos;
  };
  std::string dense;
  std::ranges::copy_if(begin, std::back_inserter(dense), [](char c) {
    return std::isspace(static_cast<unsigned char>(c)) == 0;
  });
  return dense.starts_with(R"({"format":"tsar_planes","version":)") ||
         begin.starts_with("# planes of the scene, by tsar_planes\n") ||
         (begin.starts_with("<?xml ") && has(", by tsar_planes</title>\n")) ||
         (begin.starts_with("  0\nSECTION\n") && has("AC1009") &&
          has("\nFLOOR\n"));
}

// Checks the paths of what is to be written.
void CheckPaths(const PlanesCommand& command) {
  for (const auto& [path, option, kind] :
       {std::tuple(command.output_path, "output_path", "file of planes"),
        std::tuple(command.plan_path, "plan_path", "floor plan")}) {
    if (!path.empty()) {
      RequireWritableOutput(command.workspace_path,
                            path,
                            kind,
                            &IsOfPlanes,
                            command.overwrite,
                            option);
    }
  }
  if (std::filesystem::weakly_canonical(command.plan_path) ==
      std::filesystem::weakly_canonical(command.output_path)) {
    throw Error(ErrorCode::kBadOption,
                OptionName("plan_path") + ": is the " +
                    OptionName("output_path") + ", too; give another file");
  }
}

}  // namespace

int RunTsarPlanes(int argc, char** argv) {
  PlanesCommand command;
  OptionSet options("tsar_planes",
                    kSummary,
                    "tsar_planes --workspace_path dense --output_path "
                    "planes.json");
  AddOptions(&command, &options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  CheckUse(command);
  const PlanesWriter writer = command.output_path.empty()
                                  ? nullptr
                                  : PlanesWriterFor(command.output_path);
  const PlanWriter plan_writer =
      command.plan_path.empty() ? nullptr : PlanWriterFor(command.plan_path);
  const Workspace workspace =
      OpenWorkspaceWithMaps(command.workspace_path, command.input_type);
  CheckPaths(command);
  if (command.scale > 0.0) {
    command.min_area /= command.scale * command.scale;
  }
  ExportedPlanes planes = RunInterruptibly([&](Progress& progress) {
    return ExportPlanes(workspace, command.min_area, progress);
  });
  if (command.scale > 0.0) {
    ScaleToMeters(command.scale, &planes);
  }
  std::optional<FloorPlan> plan;
  if (plan_writer != nullptr) {
    // Before planes are turned, so that its axes are those of --up z always.
    plan = MakeFloorPlan(planes);
  }
  TurnUp(command.up, &planes);
  if (writer != nullptr) {
    WriteFile(command.output_path, writer, planes);
    PrintPlanes(planes, writer, command.output_path);
  }
  if (plan) {
    WriteFile(command.plan_path, plan_writer, *plan);
    PrintPlan(*plan, command.plan_path);
  }
  return 0;
}

}  // namespace tsar
