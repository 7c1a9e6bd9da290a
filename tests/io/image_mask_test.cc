// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/io/image_masks.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/mask_files.h"
#include "tests/support/test_workspace.h"
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

constexpr MaskSizes kSizes = {{8, 6}, {4, 3}};

class ImageMaskTest : public testing::Test {
 protected:
  // The mask in the first row of a picture as wide as the image.
  std::vector<int> ReadRow(const cv::Mat& row) const {
    cv::Mat pixels;
    cv::repeat(row, kSizes.image.height, 1, pixels);
    EXPECT_TRUE(cv::imwrite(path_.string(), pixels));
    CheckImageMask(path_, kSizes);
    const Image<uint8_t> mask = ReadImageMask(path_, kSizes);
    return std::vector<int>(mask.begin(), mask.begin() + row.cols);
  }
  void ExpectRefused(ErrorCode code, const std::string& text) const {
    for (const auto& look :
         {+[](const fs::path& path) { ReadImageMask(path, kSizes); },
          +[](const fs::path& path) { CheckImageMask(path, kSizes); }}) {
      ExpectError(code, {path_.string() + ": " + text}, [&] { look(path_); });
    }
  }
  // The bytes of a good mask.
  std::string WriteGoodMask() const {
    WriteMask(path_, 8, 6, [](int x, int y) { return x > y; });
    return ReadText(path_);
  }

  TemporaryFolder folder_;
  const fs::path path_ = folder_.Path() / "a.jpg.png";
};

TEST_F(ImageMaskTest, IsFoundByTheNamesThatColmapGives) {
  const auto expect_not_found = [](const fs::path& folder,
                                   const std::string& text) {
    ExpectError(ErrorCode::kNotFound,
                {folder.string() + ": " + text, "check --mask_path"},
                [&] { FindImageMasks(folder, {"a.jpg"}, "--mask_path"); });
  };
  expect_not_found(folder_.Path() / "none", "there is no such folder of masks");
  expect_not_found(folder_.Path(),
                   "holds no mask of any image; that of a.jpg would be "
                   "a.jpg.png");
  for (const char* name :
       {"a.jpg.png", "left/b c.png.png", "left/b c.png", "d.PNG", "f.jpg"}) {
    WriteText(folder_.Path() / name, "");
  }
  const std::vector<fs::path> masks = FindImageMasks(
      folder_.Path(),
      {"a.jpg", "left/b c.png", "d.PNG", "f.jpg", "left/a.jpg", "b c.png"},
      "--mask_path");
  const fs::path& folder = folder_.Path();
  EXPECT_EQ(masks,
            (std::vector<fs::path>{folder / "a.jpg.png",
                                   folder / "left/b c.png.png",
                                   folder / "d.PNG",
                                   "",
                                   "",
                                   ""}));
}

TEST_F(ImageMaskTest, OnlyBlackIsMasked) {
  const cv::Mat gray =
      (cv::Mat_<uchar>(1, 8) << 0, 1, 2, 127, 128, 254, 255, 0);
  const std::vector<int> expected = {1, 0, 0, 0, 0, 0, 0, 1};
  EXPECT_EQ(ReadRow(gray), expected);
  // As image_undistorter writes it.
  cv::Mat color;
  cv::cvtColor(gray, color, cv::COLOR_GRAY2BGR);
  EXPECT_EQ(ReadRow(color), expected);
  // Colors of transparent pixels do not count.
  cv::Mat with_alpha;
  cv::cvtColor(gray, with_alpha, cv::COLOR_GRAY2BGRA);
  with_alpha.forEach<cv::Vec4b>(
      [](cv::Vec4b& pixel, const int* at) { pixel[3] = at[1] < 4 ? 0 : 255; });
  EXPECT_EQ(ReadRow(with_alpha), expected);
  color.at<cv::Vec3b>(0, 0) = {0, 0, 200};
  color.at<cv::Vec3b>(0, 1) = {0, 0, 0};
  EXPECT_EQ(ReadRow(color), (std::vector<int>{0, 1, 0, 0, 0, 0, 0, 1}));
}

TEST_F(ImageMaskTest, Reads1And16BitsPerPixel) {
  cv::Mat pixels(6, 8, CV_8UC1, cv::Scalar(255));
  pixels.at<uchar>(2, 3) = 0;
  const cv::Mat deep = cv::Mat_<ushort>(pixels) / 255;
  for (const cv::Mat& stored : {pixels, deep}) {
    ASSERT_TRUE(
        cv::imwrite(path_.string(), stored, {cv::IMWRITE_PNG_BILEVEL, 1}));
    const Image<uint8_t> mask = ReadImageMask(path_, kSizes);
    EXPECT_EQ(std::count(mask.begin(), mask.end(), 1), 1);
    EXPECT_EQ(mask(3, 2), 1);
  }
}

TEST_F(ImageMaskTest, HasTheSizeOfTheImageOrOfItsMaps) {
  const auto write = [&](int width, int height) {
    WriteMask(path_, width, height, [](int x, int) { return x == 1; });
  };
  write(4, 3);
  CheckImageMask(path_, kSizes);
  EXPECT_EQ(ReadImageMask(path_, kSizes).Width(), 4);
  for (const auto& [width, height] :
       {std::pair(6, 8), std::pair(8, 3), std::pair(16, 12)}) {
    write(width, height);
    ExpectRefused(ErrorCode::kMismatch,
                  "the mask has " + std::to_string(width) + " x " +
                      std::to_string(height) +
                      " pixels, its undistorted image 8 x 6, and its maps 4 x "
                      "3; masks of the photos do not fit: undistort them with "
                      "image_undistorter");
  }
  ExpectError(ErrorCode::kMismatch, {"its undistorted image 8 x 6; "}, [&] {
    ReadImageMask(path_, {{8, 6}, {8, 6}});
  });
}

TEST_F(ImageMaskTest, OtherFilesAreRefused) {
  const std::string png = WriteGoodMask();
  struct Case {
    std::string bytes;
    const char* text;
  };
  for (const auto& [bytes, text] :
       {Case{"mask", "the mask is no PNG file; write it as"},
        Case{"\xff\xd8\xff\xe0 ", "the mask is no PNG file; write it as"},
        Case{png.substr(0, 20), "the mask is no PNG file; write it as"},
        Case{png.substr(0, png.size() - 1), "the mask is damaged"},
        Case{"", "the file is empty; write it as"}}) {
    WriteText(path_, bytes);
    ExpectRefused(ErrorCode::kCorrupt, text);
  }
  fs::remove(path_);
  ExpectRefused(ErrorCode::kNotFound, "no such mask; write it as");
  fs::create_directory(path_);
  ExpectRefused(ErrorCode::kIo, "cannot be read (it is a ");
}

TEST_F(ImageMaskTest, AMaskInTheAlphaChannelIsRefused) {
  cv::Mat pixels(6, 8, CV_8UC4, cv::Scalar::all(255));
  cv::imwrite(path_.string(), pixels);
  EXPECT_EQ(ReadImageMask(path_, kSizes)(0, 0), 0);
  pixels.at<cv::Vec4b>(3, 3)[3] = 0;
  cv::imwrite(path_.string(), pixels);
  ExpectRefused(ErrorCode::kCorrupt,
                "the mask is all of one color, and transparent");
}

TEST_F(ImageMaskTest, WarnsOfPicturesOfNoImage) {
  const fs::path folder = folder_.Path();
  for (const char* name : {"a.png", "b.jpg", "notes.txt"}) {
    WriteText(folder / name, "");
  }
  WriteGoodMask();
  testing::internal::CaptureStderr();
  WarnOfStrayMasks(folder, FindImageMasks(folder, {"a.jpg"}, "--mask_path"));
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::HasSubstr(": 2 files belong to no image, such as " +
                                 (folder / "a.png").string()));
}

TEST_F(ImageMaskTest, DamageNeverGivesAnotherMask) {
  const std::string png = WriteGoodMask();
  const Image<uint8_t> whole = ReadImageMask(path_, kSizes);
  const auto is_refused = [&](const std::string& bytes) {
    WriteText(path_, bytes);
    try {
      const Image<uint8_t> mask = ReadImageMask(path_, kSizes);
      EXPECT_TRUE(std::equal(mask.begin(), mask.end(), whole.begin()));
      return false;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(path_.string() + ": "));
      return true;
    }
  };
  for (size_t size = 0; size < png.size(); ++size) {
    EXPECT_TRUE(is_refused(png.substr(0, size))) << size;
    EXPECT_THROW(CheckImageMask(path_, kSizes), Error) << size;
  }
  for (size_t i = 0; i < png.size(); ++i) {
    std::string changed = png;
    changed[i] = static_cast<char>(changed[i] ^ 0x41);
    is_refused(changed);
  }
  EXPECT_FALSE(is_refused(png + "more"));
  CheckImageMask(path_, kSizes);
}

TEST(ResizeMask, AnyMaskedPixelThatIsCoveredMasks) {
  Philox random(3, 0, 0);
  const auto side = [&] {
    return 1 + static_cast<int>(random.NextFloat() * 12);
  };
  for (int round = 0; round < 200; ++round) {
    Image<uint8_t> mask(side(), side());
    for (uint8_t& value : mask) {
      value = random.NextFloat() < 0.2f ? 1 : 0;
    }
    const RasterSize size{side(), side()};
    const Image<uint8_t> resized = ResizeMask(mask, size);
    ASSERT_EQ(resized.Width(), size.width);
    ASSERT_EQ(resized.Height(), size.height);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        // Pixels as intervals, in units in which all borders are integers.
        bool expected = false;
        for (int v = 0; v < mask.Height(); ++v) {
          for (int u = 0; u < mask.Width(); ++u) {
            const bool overlaps = u * size.width < (x + 1) * mask.Width() &&
                                  x * mask.Width() < (u + 1) * size.width &&
                                  v * size.height < (y + 1) * mask.Height() &&
                                  y * mask.Height() < (v + 1) * size.height;
            expected = expected || (overlaps && mask(u, v) != 0);
          }
        }
        ASSERT_EQ(resized(x, y), expected ? 1 : 0) << round;
      }
    }
  }
}

TEST(ClearMasked, LeavesTheRestAndWhatIsEmpty) {
  Image<uint8_t> mask(2, 1);
  mask(1, 0) = 1;
  Image<float> map(2, 1, 3.f);
  ClearMasked({}, &map);
  EXPECT_EQ(map(1, 0), 3.f);
  ClearMasked(mask, &map, 2.f);
  EXPECT_EQ(map(0, 0), 3.f);
  EXPECT_EQ(map(1, 0), 2.f);
  Image<float> none;
  ClearMasked(mask, &none);
  EXPECT_TRUE(none.Empty());
}

}  // namespace
}  // namespace tsar
