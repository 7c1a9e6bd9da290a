// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Reads the folders for trainers as their documents say that these do.

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/tools/export/image_exporter.h"

#include <filesystem>

#include "tests/tools/export/export_fixture.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;
using TrainerFormatsTest = ExportTest;

Eigen::Matrix4d ToMatrix(const nlohmann::json& json) {
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      matrix(row, column) = json[row][column].get<double>();
    }
  }
  return matrix;
}

// nerfstudio: stored depth is in thousandths and resized to the size of the
// photo, a ray goes through the center of its pixel, and cameras look along -z
// with y up.
TEST_F(TrainerFormatsTest, NerfstudioSeesEachDepthAtItsPixel) {
  Export(ExportFormat::kNerfstudio);
  const nlohmann::json transforms = ReadJson("transforms.json");
  EXPECT_EQ(transforms["camera_model"], "OPENCV");
  EXPECT_EQ(transforms["applied_transform"],
            nlohmann::json::parse("[[1,0,0,0],[0,1,0,0],[0,0,1,0]]"));
  ASSERT_EQ(transforms["frames"].size(), 3u);
  for (int image = 0; image < 2; ++image) {
    const nlohmann::json frame = transforms["frames"][image];
    const std::string& name = Names()[image];
    EXPECT_EQ(frame["file_path"], "images/" + name);
    EXPECT_EQ(ReadText(options_.output_path / "images" / name),
              ReadText(root_ / "images" / name));
    const NumpyArray array = ReadNumpyArray(
        options_.output_path / frame["depth_file_path"].get<std::string>());
    cv::Mat stored(array.shape.at(0), array.shape.at(1), CV_32F);
    array.bytes.copy(stored.ptr<char>(), array.bytes.size());
    cv::Mat depth;
    cv::resize(stored * 0.001,
               depth,
               {frame["w"].get<int>(), frame["h"].get<int>()},
               0,
               0,
               cv::INTER_NEAREST);
    const Eigen::Matrix4d pose = ToMatrix(frame["transform_matrix"]);
    for (int v = 0; v < 6; ++v) {
      for (int u = 0; u < 8; ++u) {
        const float z = depth.at<float>(v, u);
        const float expected = Depth(image, u / 2, v / 2);
        EXPECT_NEAR(z, expected, 1e-5);
        const Eigen::Vector4d world =
            pose * Eigen::Vector4d(z * (u + 0.5 - frame["cx"].get<double>()) /
                                       frame["fl_x"].get<double>(),
                                   -z * (v + 0.5 - frame["cy"].get<double>()) /
                                       frame["fl_y"].get<double>(),
                                   -z,
                                   1.0);
        // The sparse model's camera sees it in the same pixel of the photo.
        const Eigen::Vector3d point = Pose(image) * world.head<3>();
        EXPECT_NEAR(point.z(), expected, 1e-5);
        if (expected > 0.f) {
          EXPECT_NEAR(kFx * point.x() / point.z() + kCx, u + 0.5, 1e-9);
          EXPECT_NEAR(kFy * point.y() / point.z() + kCy, v + 0.5, 1e-9);
        }
      }
    }
  }
}

// It requires depth of all images or of none.
TEST_F(TrainerFormatsTest, NerfstudioGetsUnknownDepthOfImagesWithoutMaps) {
  const ExportSummary summary = Export(ExportFormat::kNerfstudio);
  EXPECT_EQ(summary.num_images, 3);
  EXPECT_EQ(summary.num_with_depth, 2);
  const NumpyArray depth =
      ReadNumpyArray(options_.output_path / "depths/c.png.npy");
  EXPECT_EQ(depth.shape, (std::vector<int>{6, 8}));
  EXPECT_EQ(depth.bytes.find_first_not_of('\0'), std::string::npos);
}

// 127.5 + 127.5 n in the camera's frame with y down and z forward, of the size
// of the photo and of each image; gray is none.
TEST_F(TrainerFormatsTest, NerfstudioGetsNormalsInTheFrameOfTheCamera) {
  UseMask(8, 6, [](int x, int) { return x == 7; });
  Export(ExportFormat::kNerfstudio);
  const nlohmann::json transforms = ReadJson("transforms.json");
  for (size_t image = 0; image < 3; ++image) {
    const std::string path = transforms["frames"][image]["normal_file_path"];
    EXPECT_EQ(path, "normals/" + Names()[image] + ".png");
    EXPECT_EQ(ImageEntry(Names()[image])["files"]["normals"], path);
    const cv::Mat normals = cv::imread((options_.output_path / path).string(),
                                       cv::IMREAD_UNCHANGED);
    ASSERT_EQ(normals.type(), CV_8UC3);
    ASSERT_EQ(normals.size(), cv::Size(8, 6));
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 8; ++x) {
        const auto& blue_first = normals.at<cv::Vec3b>(y, x);
        const bool has_normal =
            image < 2 && !(image == 0 && x / 2 == 3) &&
            Depth(static_cast<int>(image), x / 2, y / 2) > 0;
        const Vec3f expected = has_normal ? Normal(x / 2, y / 2) : Vec3f{};
        EXPECT_NEAR(blue_first[2] / 127.5 - 1.0, expected.x, 0.5 / 127);
        EXPECT_NEAR(blue_first[1] / 127.5 - 1.0, expected.y, 0.5 / 127);
        EXPECT_NEAR(blue_first[0] / 127.5 - 1.0, expected.z, 0.5 / 127);
      }
    }
  }
}

// It resolves the path against the folder of transforms.json and moves points
// as it moves the world of the cameras.
TEST_F(TrainerFormatsTest, NerfstudioGetsTheCloudInTheWorldOfTheCameras) {
  Export(ExportFormat::kNerfstudio);
  EXPECT_FALSE(ReadJson("transforms.json").contains("ply_file_path"));
  options_.overwrite = true;
  options_.cloud_path = root_ / "fused.ply";
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n";
  WriteText(options_.cloud_path, header + "1 2 3\n");
  Export(ExportFormat::kNerfstudio);
  const std::string path = ReadJson("transforms.json")["ply_file_path"];
  EXPECT_EQ(ReadText(options_.output_path / path), header + "1 2 3\n");
  EXPECT_THAT(ReadText(options_.output_path / "files.txt"),
              testing::HasSubstr(path + "\n"));
}

TEST_F(TrainerFormatsTest, RefusesCloudsThatNoTrainerCanStartFrom) {
  options_.format = ExportFormat::kNerfstudio;
  options_.cloud_path = folder_.Path() / "cloud.ply";
  ExpectFailure(ErrorCode::kNotFound, {"cloud.ply"});
  WriteText(options_.cloud_path, "solid");
  ExpectFailure(ErrorCode::kCorrupt, {"cloud.ply"});
  WriteText(options_.cloud_path,
            "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\n"
            "property float y\nproperty float z\nend_header\n");
  ExpectFailure(ErrorCode::kNotFound, {"cloud.ply", "no points", "tsar_fuse"});
  options_.format = ExportFormat::kGaussianSplatting;
  ExpectFailure(ErrorCode::kBadOption, {"cloud_path", "nerfstudio alone"});
}

// The trainer of 3D Gaussian splatting: depths/ and the keys of the parameters
// have the name without what follows its last dot, stored values are divided by
// 65536.
TEST_F(TrainerFormatsTest, GaussianSplattingGetsInverseDepth) {
  Export(ExportFormat::kGaussianSplatting);
  const nlohmann::json params = ReadJson("sparse/0/depth_params.json");
  ASSERT_EQ(params.size(), 3u);
  const char* const stems[] = {"a.1", "left/b"};
  for (int image = 0; image < 2; ++image) {
    const std::string stem = stems[image];
    const fs::path path = options_.output_path / "depths" / (stem + ".png");
    const cv::Mat stored = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(stored.type(), CV_16UC1);
    const double scale = params[stem]["scale"].get<double>();
    const double offset = params[stem]["offset"].get<double>();
    const auto inverse_depth = [&](int x, int y) {
      return stored.at<uint16_t>(y, x) / 65536.0 * scale + offset;
    };
    const nlohmann::json entry = ImageEntry(Names()[image]);
    ForEachDepth(image, inverse_depth, [&](int x, int y) {
      EXPECT_NEAR(inverse_depth(x, y) * Depth(image, x, y), 1.0, 2e-5);
      const Eigen::Vector3d point =
          PointOf(entry, x, y, 1.0 / inverse_depth(x, y));
      EXPECT_LT((point - Point(image, x, y)).norm(), 2e-4);
    });
    const cv::Mat mask = cv::imread(
        (options_.output_path / "depth_masks" / (stem + ".png")).string(),
        cv::IMREAD_UNCHANGED);
    EXPECT_EQ(mask.at<uint8_t>(2, 1), 0);
    EXPECT_EQ(mask.at<uint8_t>(2, 2), 255);
  }
  // All have one scale, so that none is off the median.
  EXPECT_EQ(params["a.1"], params["left/b"]);
}

// With --depths it needs a picture for every image; those of the scale 0 are
// left out.
TEST_F(TrainerFormatsTest, GaussianSplattingLeavesOutImagesWithoutMaps) {
  Export(ExportFormat::kGaussianSplatting);
  const nlohmann::json params = ReadJson("sparse/0/depth_params.json");
  EXPECT_EQ(params["c"]["scale"], 0.0);
  const cv::Mat stored = cv::imread(
      (options_.output_path / "depths/c.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(stored.type(), CV_16UC1);
  EXPECT_EQ(cv::countNonZero(stored), 0);
  EXPECT_TRUE(fs::exists(options_.output_path / "images/c.png"));
  for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"}) {
    EXPECT_EQ(ReadText(options_.output_path / "sparse/0" / name),
              ReadText(root_ / "sparse" / name));
  }
}

TEST(InverseDepthScaleTest, IsOfTheNearestDepthWithinReason) {
  const double unit = 65536.0 / 65535.0;
  EXPECT_DOUBLE_EQ(InverseDepthScale({10, 2.f, 9.f, 4.f}), unit / 2.0);
  // Almost in the camera.
  EXPECT_DOUBLE_EQ(InverseDepthScale({10, 0.001f, 9.f, 4.f}), unit / 0.25);
}

TEST_F(TrainerFormatsTest, RefusesNamesThatTheFormatCannotTellApart) {
  options_.format = ExportFormat::kGaussianSplatting;
  const fs::path images = root_ / "sparse/images.txt";
  const std::string text = ReadText(images);
  WriteText(images, text + "9 1 0 0 0 0 0 0 1 left/b.jpg\n\n");
  ExpectFailure(ErrorCode::kUnsupported,
                {"left/b.png", "left/b.jpg", "extensions"});
  WriteText(images, text + "9 1 0 0 0 0 0 0 1 scan\n\n");
  ExpectFailure(ErrorCode::kUnsupported, {"scan", "no extension"});
  for (const ExportFormat format :
       {ExportFormat::kGaussianSplatting, ExportFormat::kNerfstudio}) {
    options_.format = format;
    WriteText(images, text + "9 1 0 0 0 0 0 0 1 \xff.png\n\n");
    ExpectFailure(ErrorCode::kUnsupported, {"not UTF-8", "format"});
  }
  // The other formats keep extensions, and folders.
  WriteText(images, text + "9 1 0 0 0 0 0 0 1 left/b.jpg\n\n");
  const std::string maps = "stereo/depth_maps/left/b.";
  for (const char* kind : {"depth_maps", "normal_maps"}) {
    const fs::path folder = root_ / "stereo" / kind / "left";
    fs::copy(folder / "b.png.geometric.bin", folder / "b.jpg.geometric.bin");
  }
  EXPECT_EQ(Export(ExportFormat::kNpy).num_images, 3);
  EXPECT_TRUE(fs::exists(options_.output_path / "depth/left/b.jpg.npy"));
  EXPECT_TRUE(fs::exists(options_.output_path / "depth/left/b.png.npy"));
}

TEST_F(TrainerFormatsTest, NeedsTheImagesAndADepth) {
  options_.format = ExportFormat::kNerfstudio;
  fs::rename(root_ / "images/c.png", root_ / "c.png");
  ExpectFailure(ErrorCode::kNotFound, {"images/c.png"});
  const std::string photo = ReadText(root_ / "c.png");
  WriteText(root_ / "images/c.png", photo.substr(0, photo.size() / 2));
  ExpectFailure(ErrorCode::kCorrupt, {"images/c.png", "from a whole photo"});
  fs::rename(root_ / "c.png", root_ / "images/c.png");
  for (const std::string name : {"a.1.png", "left/b.png"}) {
    WriteTestMaps(root_, name, MapType::kGeometric, 0.f);
  }
  options_.format = ExportFormat::kGaussianSplatting;
  ExpectFailure(ErrorCode::kNotFound, {"no pixel", "geometric"});
}

// It requires masks of all images or of none, of the size of the photos.
TEST_F(TrainerFormatsTest, NerfstudioGetsTheMasks) {
  Export(ExportFormat::kNerfstudio);
  EXPECT_FALSE(ReadJson("transforms.json")["frames"][0].contains("mask_path"));
  EXPECT_FALSE(fs::exists(options_.output_path / "masks"));
  options_.overwrite = true;
  UseMask(8, 6, [](int x, int y) { return x > 4 || y == 2; });
  EXPECT_EQ(Export(ExportFormat::kNerfstudio).num_masks, 1);
  const nlohmann::json transforms = ReadJson("transforms.json");
  for (size_t image = 0; image < 3; ++image) {
    const nlohmann::json& frame = transforms["frames"][image];
    EXPECT_EQ(frame["mask_path"], "masks/" + Names()[image] + ".png");
    const cv::Mat mask = cv::imread(
        (options_.output_path / frame["mask_path"].get<std::string>()).string(),
        cv::IMREAD_UNCHANGED);
    ASSERT_EQ(mask.type(), CV_8UC1);
    ASSERT_EQ(mask.size(), cv::Size(8, 6));
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 8; ++x) {
        const bool is_masked = image == 0 && (x > 4 || y == 2);
        EXPECT_EQ(mask.at<uchar>(y, x), is_masked ? 0 : 255);
      }
    }
  }
  // One of the size of the maps is as coarse for the photo.
  UseMask(kWidth, kHeight, [](int x, int y) { return x == 1 && y == 2; });
  Export(ExportFormat::kNerfstudio);
  const cv::Mat mask =
      cv::imread((options_.output_path / "masks/a.1.png.png").string(),
                 cv::IMREAD_UNCHANGED);
  EXPECT_EQ(cv::countNonZero(mask == 0), 4);
  EXPECT_EQ(cv::countNonZero(mask({2, 4, 2, 2}) == 0), 4);
}

TEST_F(TrainerFormatsTest, NerfstudioGetsMasksOfImagesWithoutMaps) {
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    for (const char* type : {"geometric", "photometric"}) {
      fs::remove(root_ / "stereo" / folder /
                 ("a.1.png." + std::string(type) + ".bin"));
    }
  }
  // Of the size that its maps would have.
  UseMask(kWidth, kHeight, [](int x, int y) { return x == 1 && y == 2; });
  Export(ExportFormat::kNerfstudio);
  const cv::Mat mask =
      cv::imread((options_.output_path / "masks/a.1.png.png").string(),
                 cv::IMREAD_UNCHANGED);
  ASSERT_EQ(mask.size(), cv::Size(8, 6));
  EXPECT_EQ(cv::countNonZero(mask({2, 4, 2, 2}) == 0), 4);
}

TEST_F(TrainerFormatsTest, GaussianSplattingHasNoDepthWhereItIsMasked) {
  UseMask(8, 6, [](int x, int) { return x == 7; });
  Export(ExportFormat::kGaussianSplatting);
  for (const char* folder : {"depths", "depth_masks"}) {
    const cv::Mat map =
        cv::imread((options_.output_path / folder / "a.1.png").string(),
                   cv::IMREAD_UNCHANGED);
    EXPECT_EQ(cv::countNonZero(map.col(kWidth - 1)), 0);
    EXPECT_EQ(cv::countNonZero(map), (kWidth - 1) * kHeight - 1);
  }
}

TEST_F(TrainerFormatsTest, RefusesMasksThatDoNotFit) {
  options_.format = ExportFormat::kNerfstudio;
  UseMask(7, 6, [](int, int) { return true; });
  ExpectFailure(ErrorCode::kMismatch,
                {"a.1.png.png: the mask has 7 x 6 pixels, its undistorted "
                 "image 8 x 6, and its maps 4 x 3"});
  options_.mask_path = root_ / "images";
  ExpectFailure(ErrorCode::kBadOption, {"is the folder of the images"});
  options_.mask_path = root_ / "sparse";
  ExpectFailure(ErrorCode::kNotFound, {"holds no mask of any image"});
}

}  // namespace
}  // namespace tsar
