// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/import/import_summary.h"
#include "colmap_tsar/store/workspace_lock.h"
#include "colmap_tsar/workspace/map_io.h"
#include "colmap_tsar/workspace/map_paths.h"

#include <chrono>
#include <cmath>
#include <functional>
#include <sstream>

#include "tests/cli/captured_run.h"
#include "tests/import/external_writers.h"
#include "tests/import/import_scene.h"
#include "tests/support/drawn_workspace.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

using testing::HasSubstr;

class TsarImportTest : public testing::Test {
 protected:
  Outcome RunImport(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"--workspace_path", root_.string()});
    return RunCaptured("colmap_tsar", arguments, [](int argc, char** argv) {
      return RunCommand(&RunTsarImport, argc, argv);
    });
  }

  // From the folder of the other program.
  Outcome Import(const std::string& format,
                 std::vector<std::string> arguments = {}) const {
    arguments.insert(arguments.begin(),
                     {"--format", format, "--input_path", other_.string()});
    return RunImport(arguments);
  }

  void ExpectSuccess(const Outcome& outcome,
                     const std::vector<std::string>& texts = {}) const {
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const std::string& text : texts) {
      EXPECT_THAT(outcome.out, HasSubstr(text));
    }
  }

  // Expects exit code 1, one line with these texts (after lines of progress),
  // and no file changed.
  void ExpectFailure(const std::vector<std::string>& arguments,
                     const std::vector<std::string>& texts) const {
    const auto before = ReadTree(folder_.Path());
    const Outcome outcome = RunImport(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    const size_t line = outcome.err.find("ERROR: ");
    ASSERT_NE(line, std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find('\n', line), outcome.err.size() - 1)
        << outcome.err;
    for (const std::string& text : texts) {
      EXPECT_THAT(outcome.err, HasSubstr(text));
    }
    EXPECT_TRUE(ReadTree(folder_.Path()) == before);
  }
  void ExpectImportFailure(const std::string& format,
                           const std::vector<std::string>& texts,
                           std::vector<std::string> arguments = {}) const {
    arguments.insert(arguments.begin(),
                     {"--format", format, "--input_path", other_.string()});
    ExpectFailure(arguments, texts);
  }

  MapPaths Paths(const SceneImage& image,
                 MapType type = MapType::kGeometric) const {
    return GetMapPaths(root_, image.name, type);
  }

  // Expects the scene's maps in the workspace, up to these errors.
  void ExpectScene(float max_depth_error, float max_normal_error) const {
    for (const SceneImage& image : scene_) {
      SCOPED_TRACE(image.name);
      const Image<float> depth = ReadDepthMap(Paths(image).depth);
      const Image<Vec3f> normal = ReadNormalMap(Paths(image).normal);
      ASSERT_TRUE(depth.HasSizeOf(image.depth));
      ASSERT_TRUE(normal.HasSizeOf(image.depth));
      float depth_error = 0.f;
      float normal_error = 0.f;
      for (size_t i = 0; i < depth.NumPixels(); ++i) {
        depth_error = std::max(
            depth_error, std::abs(depth.Data()[i] - image.depth.Data()[i]));
        normal_error = std::max(
            normal_error, Norm(normal.Data()[i] - image.normal.Data()[i]));
      }
      EXPECT_LE(depth_error, max_depth_error);
      EXPECT_LE(normal_error, max_normal_error);
    }
  }

  void ExpectRefinable() const {
    const Outcome outcome = RunCaptured(
        "colmap_tsar",
        {"--workspace_path", root_.string(), "--TsarRefine.device", "cpu"},
        [](int argc, char** argv) {
          return RunCommand(&RunTsarRefine, argc, argv);
        });
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("4 images: 4 refined\n"));
  }

  // As depth images called NAME with another extension.
  void ExportDepth(
      const std::string& extension,
      float scale,
      const std::function<std::string(int, int, const std::vector<float>&)>&
          encode) const {
    for (const SceneImage& image : scene_) {
      std::vector<float> values = ValuesOf(image.depth);
      for (float& value : values) {
        value *= scale;
      }
      WriteText((other_ / image.name).replace_extension(extension),
                encode(image.depth.Width(), image.depth.Height(), values));
    }
  }
  void ExportPfm(float scale = 1.f) const {
    ExportDepth(".pfm", scale, [](int width, int height, const auto& values) {
      return PfmBytes(width, height, 1, values, true);
    });
  }
  void ExportNormals() const {
    for (const SceneImage& image : scene_) {
      WriteText(folder_.Path() / "normals" / (image.name + ".pfm"),
                PfmBytes(image.depth.Width(),
                         image.depth.Height(),
                         3,
                         ValuesOf(image.normal),
                         false));
    }
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
  const std::filesystem::path other_ = folder_.Path() / "other";
  const std::vector<SceneImage> scene_ = DrawImportScene(root_);
};

TEST_F(TsarImportTest, TakesOpenMvsMapsBitByBit) {
  ExportOpenMvs(scene_, other_);
  RemoveStereo(root_);
  const Outcome outcome = Import("openmvs");
  ExpectSuccess(outcome,
                {"4 images: 4 imported, 0 without a map\n",
                 "Normals came with 4",
                 "Depth over that of the sparse points: median 1.00",
                 "Depths from 4.995 to 5.005",
                 ", sparse points from 5 to 5\n",
                 "Next: colmap_tsar tsar_refine --workspace_path " +
                     root_.string() + " --input_type geometric\n"});
  EXPECT_THAT(outcome.err, HasSubstr("Checking: [4/4]"));
  EXPECT_THAT(outcome.err, HasSubstr("Importing: [4/4]"));
  ExpectScene(0.f, 0.f);
  EXPECT_EQ(ReadText(root_ / "stereo/patch-match.cfg"),
            "v0.png\n__auto__, 20\nv1.png\n__auto__, 20\nleft/v2.png\n"
            "__auto__, 20\nv3.png\n__auto__, 20\n");
  EXPECT_EQ(ReadText(root_ / "stereo/fusion.cfg"),
            "v0.png\nv1.png\nleft/v2.png\nv3.png\n");
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesAcmMaps) {
  ExportAcm(scene_, other_);
  RemoveStereo(root_);
  ExpectSuccess(Import("acm"), {"4 imported", "Normals came with 4"});
  ExpectScene(0.f, 1e-6f);
  EXPECT_FALSE(std::filesystem::exists(root_ / "stereo/cost_maps"));
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesTheProgramsFolderToo) {
  ExportAcm(scene_, other_);
  RemoveStereo(root_);
  ExpectSuccess(RunImport({"--format",
                           "acm",
                           "--input_path",
                           (other_ / "ACMM/").string(),
                           "--import_costs",
                           "1"}),
                {"4 imported", "Costs came with 4"});
  ExpectScene(0.f, 1e-6f);
  const PlanarMap costs = ReadPlanarMap(Paths(scene_[0]).cost);
  EXPECT_EQ(costs.channels, 2);
  EXPECT_EQ(costs.values.front(), 0.25f);
  EXPECT_EQ(costs.values.back(), 2.f);
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesPhotometricAcmMaps) {
  ExportAcm(scene_, other_);
  RemoveStereo(root_);
  ExpectSuccess(
      Import("acm", {"--output_type", "photometric", "--import_costs", "1"}),
      {"Normals came with 0", "--input_type photometric"});
  const Image<float> depth =
      ReadDepthMap(Paths(scene_[1], MapType::kPhotometric).depth);
  EXPECT_EQ(depth(5, 5), 4.9f);
  EXPECT_FALSE(std::filesystem::exists(root_ / "stereo/cost_maps"));
  EXPECT_FALSE(std::filesystem::exists(Paths(scene_[1]).depth));
}

TEST_F(TsarImportTest, TakesApdMapsWithBothHeaders) {
  for (const bool has_version : {false, true}) {
    std::filesystem::remove_all(other_);
    ExportApd(scene_, other_, has_version);
    RemoveStereo(root_);
    ExpectSuccess(Import("apd"), {"4 imported", "Normals came with 4"});
    ExpectScene(0.f, 1e-6f);
  }
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesFloatDepthAndNormals) {
  ExportPfm();
  ExportNormals();
  RemoveStereo(root_);
  ExpectSuccess(
      Import("depth", {"--normal_path", (folder_.Path() / "normals").string()}),
      {"4 imported", "Normals came with 4"});
  ExpectScene(0.f, 0.f);
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesNumPyArraysAndComputesNormals) {
  ExportDepth(".npy", 1.f, [](int width, int height, const auto& values) {
    std::ostringstream shape;
    shape << "(" << height << ", " << width << ", 1)";
    return NpyBytes("<f4", shape.str(), FloatData(values));
  });
  RemoveStereo(root_);
  ExpectSuccess(Import("depth"), {"Normals came with 0"});
  ExpectScene(0.f, 2.f);
  const Image<Vec3f> normals = ReadNormalMap(Paths(scene_[0]).normal);
  EXPECT_NEAR(Norm(normals(10, 10)), 1.f, 1e-5f);
  EXPECT_LT(normals(10, 10).z, -0.9f);
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesPngInMillimetresOrOtherUnits) {
  const auto encode = [](int width, int height, const auto& values) {
    std::vector<uint16_t> integers;
    for (const float value : values) {
      integers.push_back(static_cast<uint16_t>(std::lround(value)));
    }
    return PngBytes(width, height, integers);
  };
  ExportDepth(".png", 1000.f, encode);
  RemoveStereo(root_);
  ExpectSuccess(Import("depth"), {"4 imported"});
  ExpectScene(0.00051f, 2.f);
  ExportDepth(".png", 5000.f, encode);
  ExpectImportFailure("depth",
                      {"depths are 5",
                       "times those of the sparse points",
                       "--depth_scale 0.0002",
                       "--check_scale 0"});
  ExpectSuccess(Import("depth", {"--depth_scale", "0.0002"}), {"4 imported"});
  ExpectScene(0.00011f, 2.f);
  ExpectRefinable();
}

TEST_F(TsarImportTest, KeepsTheSizeOfTheMaps) {
  const SceneImage& image = scene_[0];
  WriteText(other_ / "v0.png.pfm",
            PfmBytes(48, 36, 1, std::vector<float>(48 * 36, 5.f), true));
  RemoveStereo(root_);
  ExpectSuccess(Import("depth"), {"1 imported, 3 without a map"});
  EXPECT_EQ(ReadDepthMap(Paths(image).depth).Width(), 48);
  // Rounded in one direction or the other.
  for (const int height : {35, 37}) {
    WriteText(
        other_ / "v0.png.pfm",
        PfmBytes(48,
                 height,
                 1,
                 std::vector<float>(static_cast<size_t>(48 * height), 5.f),
                 true));
    ExpectSuccess(Import("depth"));
  }
  WriteText(other_ / "v0.png.pfm",
            PfmBytes(36, 48, 1, std::vector<float>(48 * 36, 5.f), true));
  ExpectImportFailure("depth", {"v0.png.pfm", "36 x 48", "v0.png of 96 x 72"});
}

TEST_F(TsarImportTest, OtherOrdersOfImages) {
  // By name: left/v2.png, v0.png, v1.png, v3.png.
  const std::vector<SceneImage> by_name = {
      scene_[2], scene_[0], scene_[1], scene_[3]};
  ExportAcm(by_name, other_);
  RemoveStereo(root_);
  ExpectImportFailure("acm",
                      {"cams/00000000_cam.txt",
                       "camera of left/v2.png, not of v0.png",
                       "--index_order",
                       "--image_list"});
  ExpectSuccess(Import("acm", {"--index_order", "name"}));
  ExpectScene(0.f, 1e-6f);

  RemoveStereo(root_);
  const std::string list = (folder_.Path() / "list.txt").string();
  WriteText(list, "left/v2.png\n\n v0.png\r\nv1.png\nv3.png");
  ExpectSuccess(Import("acm", {"--image_list", list}));
  ExpectScene(0.f, 1e-6f);

  WriteText(list, "left/v2.png\nv0.png\nv1.png\n");
  ExpectImportFailure(
      "acm", {"2333_00000003", "images 0 to 2"}, {"--image_list", list});
  WriteText(list, "v0.png\nv2.png\n");
  ExpectImportFailure("acm",
                      {"list.txt", "line 2", "v2.png", "not in the sparse"},
                      {"--image_list", list});
  WriteText(list, "v0.png\nv0.png\n");
  ExpectImportFailure(
      "acm", {"line 2", "a second time"}, {"--image_list", list});
  WriteText(list, "\n");
  ExpectImportFailure("acm", {"names no image"}, {"--image_list", list});
}

TEST_F(TsarImportTest, OtherUnitsOfTheWholeModel) {
  std::vector<SceneImage> large = scene_;
  for (SceneImage& image : large) {
    image.camera.translation *= 1000.0;
    for (float& depth : image.depth) {
      depth *= 1000.f;
    }
  }
  ExportAcm(large, other_);
  RemoveStereo(root_);
  ExpectImportFailure("acm", {"cam.txt", "other units", "--depth_scale 0.001"});
  ExpectSuccess(Import("acm", {"--depth_scale", "0.001"}));
  ExpectScene(1e-6f, 1e-6f);
}

TEST_F(TsarImportTest, CamerasOfAnotherModel) {
  std::vector<SceneImage> other = scene_;
  other[2].camera.rotation = other[2].camera.rotation.transpose().eval();
  ExportAcm(other, other_);
  ExpectImportFailure(
      "acm",
      {"00000002_cam.txt", "left/v2.png", "degrees", "this sparse model"},
      {"--overwrite", "1"});
  other = scene_;
  other[1].camera.cx += 10.0;
  ExportAcm(other, other_);
  ExpectImportFailure("acm",
                      {"00000001_cam.txt", "v1.png", "principal point"},
                      {"--overwrite", "1"});
}

TEST_F(TsarImportTest, NormalsInAnotherFrame) {
  ExportPfm();
  ExportNormals();
  RemoveStereo(root_);
  const std::vector<std::string> normals = {
      "--normal_path", (folder_.Path() / "normals").string()};
  // The scene's normals look along an axis; only slanted ones tell.
  for (const SceneImage& image : scene_) {
    std::vector<float> values;
    for (int y = 0; y < image.depth.Height(); ++y) {
      for (int x = 0; x < image.depth.Width(); ++x) {
        const Vec3f ray = image.camera.GetIntrinsics().Ray(
            static_cast<float>(x), static_cast<float>(y));
        // Nearly at right angles to the ray, in all directions around it.
        const float angle = static_cast<float>(x + 13 * y);
        const Vec3f side = Normalized(
            Cross(ray, Vec3f{std::cos(angle), std::sin(angle), 0.3f}));
        const Vec3f n = Normalized(side - Normalized(ray) * 0.2f);
        const Eigen::Vector3d world =
            image.camera.rotation.transpose() * Eigen::Vector3d(n.x, n.y, n.z);
        for (int i = 0; i < 3; ++i) {
          values.push_back(static_cast<float>(world[i]));
        }
      }
    }
    WriteText(
        folder_.Path() / "normals" / (image.name + ".pfm"),
        PfmBytes(image.depth.Width(), image.depth.Height(), 3, values, true));
  }
  ExpectImportFailure("depth", {"--normal_frame world"}, normals);
  std::vector<std::string> in_world = normals;
  in_world.insert(in_world.end(), {"--normal_frame", "world"});
  ExpectSuccess(Import("depth", in_world));
}

TEST_F(TsarImportTest, ScalesEachImageToItsSparsePoints) {
  for (size_t i = 0; i < scene_.size(); ++i) {
    std::vector<float> values = ValuesOf(scene_[i].depth);
    for (float& value : values) {
      value *= static_cast<float>(i + 1);
    }
    WriteText(other_ / (scene_[i].name + ".pfm"),
              PfmBytes(96, 72, 1, values, true));
  }
  RemoveStereo(root_);
  ExpectSuccess(Import("depth"),
                {"WARNING: v1.png: depths are 2 times those of its",
                 "WARNING: v3.png: depths are 4 times those of its",
                 "--scale_to_sparse 1"});
  ExpectSuccess(Import("depth", {"--scale_to_sparse", "1"}),
                {"Before scaling, depth over that of the sparse points",
                 "Depths from 4.995 to 5.005"});
  ExpectScene(0.01f, 2.f);
  for (const auto& entry :
       std::filesystem::directory_iterator(root_ / "sparse")) {
    if (entry.path().filename() == "points3D.txt") {
      WriteText(entry.path(), "");
    }
  }
  ExpectImportFailure("depth",
                      {"v0.png.pfm", "only 0 sparse points"},
                      {"--scale_to_sparse", "1"});
  ExpectSuccess(Import("depth"), {"WARNING: no image has 5 sparse points"});
}

TEST_F(TsarImportTest, TakesOffScaleDepthsWhereTold) {
  ExportPfm(10.f);
  RemoveStereo(root_);
  ExpectImportFailure("depth", {"--depth_scale 0.1"});
  ExpectSuccess(Import("depth", {"--check_scale", "0"}),
                {"median 10.0", "WARNING: v0.png"});
}

TEST_F(TsarImportTest, KeepsFormerMapsAndPutsThemBack) {
  ExportAcm(scene_, other_);
  ExpectImportFailure("acm",
                      {"v0.png.geometric.bin", "--overwrite 1", "--restore 1"});
  const MapPaths paths = Paths(scene_[0]);
  WriteText(paths.cost, "exported costs");
  const auto with_costs = ReadTree(root_);
  ExpectSuccess(Import("acm", {"--overwrite", "1"}));
  // They belonged to the former depths.
  EXPECT_FALSE(std::filesystem::exists(paths.cost));
  EXPECT_FALSE(ReadTree(root_) == with_costs);
  // Its own maps may be replaced, and the former ones stay.
  ExpectSuccess(Import("acm", {"--import_costs", "1"}));
  EXPECT_TRUE(std::filesystem::exists(paths.cost));
  ExpectSuccess(Import("acm"));

  const Outcome undone = RunImport({"--restore", "1"});
  EXPECT_EQ(undone.out, "Undid the import of 4 images.\n");
  EXPECT_TRUE(ReadTree(root_) == with_costs);
  ExpectFailure({"--restore", "1"}, {"nothing was imported"});
}

TEST_F(TsarImportTest, UndoesAnImportIntoAnEmptyWorkspace) {
  RemoveStereo(root_);
  ExportPfm();
  ExpectSuccess(Import("depth"));
  ExpectSuccess(RunImport({"--restore", "1"}));
  for (const auto& [path, content] : ReadTree(root_ / "stereo")) {
    EXPECT_TRUE(content == "folder" || path == "patch-match.cfg" ||
                path == "fusion.cfg")
        << path;
  }
}

TEST_F(TsarImportTest, LeavesMapsThatAreNewer) {
  const auto before = ReadTree(root_);
  ExportPfm();
  ExpectSuccess(Import("depth", {"--overwrite", "1"}));
  const MapPaths paths = Paths(scene_[1]);
  const auto write_later = [](const ContainedPath& path, const auto& write) {
    const auto time = std::filesystem::last_write_time(path);
    write();
    std::filesystem::last_write_time(path, time + std::chrono::hours(1));
  };
  write_later(paths.depth,
              [&] { WriteDepthMap(paths.depth, Image<float>(96, 72, 3.f)); });
  ExpectImportFailure("depth", {"v1.png.geometric.bin", "--overwrite 1"});
  // The depth map alone: whose are the two?
  const Outcome conflict = RunImport({"--restore", "1"});
  EXPECT_EQ(conflict.exit_code, 1);
  EXPECT_THAT(conflict.err, HasSubstr("v1.png.geometric.bin"));
  EXPECT_THAT(conflict.err, HasSubstr("--restore_conflicts"));
  EXPECT_EQ(ReadDepthMap(paths.depth)(0, 0), 3.f);
  write_later(paths.normal, [&] {
    WriteNormalMap(paths.normal, Image<Vec3f>(96, 72, Vec3f{0.6f, 0.f, -0.8f}));
  });
  ExpectSuccess(RunImport({"--restore", "1"}), {"Left these"});
  EXPECT_EQ(ReadDepthMap(paths.depth)(0, 0), 3.f);
  ExpectSuccess(
      RunImport({"--restore", "1", "--restore_conflicts", "original"}),
      {"stereo/tsar/superseded/depth_maps/v1.png.geometric.bin"});
  auto after = ReadTree(root_);
  for (const char* kind : {"depth_maps", "normal_maps"}) {
    EXPECT_TRUE(after.contains(std::string("stereo/tsar/superseded/") + kind +
                               "/v1.png.geometric.bin"));
  }
  std::erase_if(after, [](const auto& entry) {
    return entry.first.starts_with("stereo/tsar");
  });
  EXPECT_TRUE(after == before);
}

TEST_F(TsarImportTest, PrintsTheFirstOfManyWarnings) {
  ImportSummary summary;
  summary.warnings.assign(30, "something");
  std::ostringstream text;
  PrintSummary(summary, text);
  EXPECT_THAT(text.str(),
              HasSubstr("WARNING: something\nWARNING: and 10 more"));
}

TEST_F(TsarImportTest, WarnsOfEmptyMaps) {
  WriteText(other_ / "v0.pfm",
            PfmBytes(96, 72, 1, std::vector<float>(96 * 72, NAN), true));
  RemoveStereo(root_);
  ExpectSuccess(Import("depth"),
                {"Pixels with depth: 0.0 %", "v0.pfm: no pixel has a depth"});
  EXPECT_EQ(ReadDepthMap(Paths(scene_[0]).depth)(9, 9), 0.f);
}

TEST_F(TsarImportTest, RefusesARefinedWorkspace) {
  ExportPfm();
  ExpectRefinable();
  ExpectImportFailure(
      "depth", {"tsar_refine --restore 1"}, {"--overwrite", "1"});
  ExpectFailure({"--restore", "1"}, {"tsar_refine --restore 1"});
}

TEST_F(TsarImportTest, RefusesALockedWorkspace) {
  ExportPfm();
  const WorkspaceLock lock(root_);
  ExpectImportFailure("depth", {"another program"}, {"--overwrite", "1"});
}

TEST_F(TsarImportTest, WarnsOfMapsOfTheOtherTypeOfAnotherSize) {
  WriteText(other_ / "v0.pfm",
            PfmBytes(48, 36, 1, std::vector<float>(48 * 36, 5.f), true));
  ExpectSuccess(Import("depth", {"--overwrite", "1"}),
                {"WARNING: ", "v0.png.photometric.bin", "96 x 72", "48 x 36"});
}

TEST_F(TsarImportTest, BrokenFilesAreOneLineAndNothingIsWritten) {
  ExportAcm(scene_, other_);
  RemoveStereo(root_);
  const std::filesystem::path folder = other_ / "ACMM/2333_00000003";
  const std::string good = ReadText(folder / "normals.dmb");
  WriteText(folder / "normals.dmb", good.substr(0, 1000));
  ExpectImportFailure("acm", {"2333_00000003/normals.dmb", "72"});
  WriteText(folder / "normals.dmb", "");
  ExpectImportFailure("acm", {"2333_00000003/normals.dmb", "shorter"});
  WriteText(folder / "normals.dmb", DmbBytes(2, 1, 3, {1, 2, 3, 4, 5, 6}));
  ExpectImportFailure("acm", {"normals.dmb", "2 x 1", "96 x 72"});
  WriteText(folder / "normals.dmb", DmbBytes(2, 1, 1, {1, 2}));
  ExpectImportFailure("acm", {"normals.dmb", "3 channel"});
  WriteText(folder / "normals.dmb", good);
  ExpectImportFailure("apd", {"depths_geom.dmb", "[version]", "--format"});
  ExpectImportFailure("openmvs", {"depth0000.dmap"});
  ExpectImportFailure("depth", {"PFM", "v0.png"});
  WriteText(other_ / "cams/00000001_cam.txt", "extrinsic 1 2 3");
  ExpectImportFailure("acm", {"00000001_cam.txt", "extrinsic"});
}

TEST_F(TsarImportTest, WrongOptionsAreOneLine) {
  ExportPfm();
  const std::string other = other_.string();
  ExpectFailure({}, {"--format is missing"});
  ExpectFailure({"--format", "depth"}, {"--input_path is missing"});
  ExpectFailure({"--format", "mvs", "--input_path", other}, {"openmvs"});
  ExpectFailure({"--format", "depth", "--input_path", "/no/where"},
                {"/no/where", "no such folder"});
  ExpectImportFailure("acm", {"--normal_path"}, {"--normal_path", other});
  ExpectImportFailure(
      "depth", {"/no/where", "no such folder"}, {"--normal_path", "/no/where"});
  ExpectImportFailure("depth", {"depth_scale"}, {"--depth_scale", "-1"});
  ExpectImportFailure("depth", {"--restore"}, {"--restore", "1"});
  std::filesystem::remove_all(root_ / "sparse");
  ExpectImportFailure("depth", {"sparse", "no such folder"});
}

}  // namespace
}  // namespace tsar
