// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/priors/depth_prior.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_views_test.h"

namespace tsar {
namespace {

constexpr int kWidth = 128;
constexpr int kHeight = 96;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
// Depths this close to the truth are right.
constexpr float kRight = 0.01f;

// A wall, a floor and a box, seen by five cameras. The floor on the right of
// the box and a rectangle of the wall are textureless.
class RefineWithPriorsTest : public SyntheticViewsTest {
 protected:
  RefineWithPriorsTest() {
    const auto all = [](const Vec3f&) { return true; };
    const auto nothing = [](const Vec3f&) { return false; };
    SyntheticViewsOptions options;
    options.parts = {{DrawnPlane({0.2f, 0.f, -1.f}, 6.f),
                      all,
                      [](const Vec3f& point) {
                        return point.x > -2.f && point.x < -0.8f &&
                               point.y > -1.2f && point.y < -0.2f;
                      }},
                     {{{0.f, -1.f, 0.f}, 1.1f},
                      all,
                      [](const Vec3f& point) { return point.x > 0.9f; }},
                     {DrawnPlane({-0.15f, 0.f, -1.f}, 3.8f),
                      [](const Vec3f& point) {
                        return point.x > -0.3f && point.x < 0.8f &&
                               point.y > 0.f;
                      },
                      nothing}};
    options.width = kWidth;
    options.height = kHeight;
    options.noise = 2e-3f;
    options.shear_x = 0.3f;
    options.shear_y = 0.4f;
    drawn_ = MakeSyntheticViews(options);
  }

  // Gives all views a prior of values(truth, x, y).
  using Values = std::function<float(const Image<float>& truth, int x, int y)>;
  void SetPriors(PriorType type, const Values& values) {
    for (size_t i = 0; i < drawn_.views.size(); ++i) {
      auto prior = std::make_shared<DepthPrior>();
      prior->type = type;
      prior->values = Image<float>(kWidth, kHeight);
      ForEachPixel(kWidth, kHeight, [&](int x, int y) {
        prior->values(x, y) = values(drawn_.truths[i], x, y);
      });
      drawn_.views[i].prior = std::move(prior);
    }
  }

  RefinedMaps Refine() {
    RefineResult result = Compose(Observe(drawn_.views.size()));
    EXPECT_EQ(result.reason_to_keep, "");
    assessment_ = result.prior;
    ExpectSoundMaps(result.maps);
    return std::move(result.maps);
  }

  struct Quality {
    double right = 0.0;  // Shares of all pixels.
    double wrong = 0.0;
    double mean_error = 0.0;  // Over the pixels that have a depth.
  };
  Quality Measure(const RefinedMaps& maps) const {
    Quality quality;
    int count = 0;
    ForEachPixel(kWidth, kHeight, [&](int x, int y) {
      if (maps.depth(x, y) > 0.f) {
        const float error = RelativeError(maps.depth, x, y);
        (error < kRight ? quality.right : quality.wrong) +=
            1.0 / (kWidth * kHeight);
        quality.mean_error += error;
        ++count;
      }
    });
    quality.mean_error /= count;
    return quality;
  }

  PriorAssessment assessment_;  // That of the view refined last.
};

TEST_F(RefineWithPriorsTest, GoodPriorsOfEachTypeHelp) {
  const Quality without = Measure(Refine());
  const std::pair<PriorType, Values> priors[] = {
      {PriorType::kMetric,
       [](const Image<float>& truth, int x, int y) {
         return 0.5f * truth(x, y);
       }},
      {PriorType::kRelative,
       [](const Image<float>& truth, int x, int y) {
         return 0.5f * truth(x, y) + 1.f;
       }},
      {PriorType::kInverse, [](const Image<float>& truth, int x, int y) {
         return 2.f / truth(x, y) + 0.1f;
       }}};
  for (const auto& [type, values] : priors) {
    SCOPED_TRACE(static_cast<int>(type));
    SetPriors(type, values);
    const Quality with = Measure(Refine());
    EXPECT_EQ(assessment_.verdict, PriorVerdict::kUsed);
    EXPECT_GT(assessment_.skill, 0.98f);
    EXPECT_GT(with.right, without.right + 0.02);
    EXPECT_LT(with.wrong, 0.1 * without.wrong);
  }
}

TEST_F(RefineWithPriorsTest, WrongPriorsDoLittleHarm) {
  struct WrongPrior {
    std::string name;
    PriorType type;
    Values values;
  };
  const Quality without = Measure(Refine());
  Philox random(21, 0, 0);
  const WrongPrior priors[] = {
      {"random",
       PriorType::kAuto,
       [&](const Image<float>&, int, int) {
         return 1.f + 5.f * random.NextFloat();
       }},
      {"constant",
       PriorType::kAuto,
       [](const Image<float>&, int, int) { return 3.f; }},
      {"of another type",
       PriorType::kMetric,
       [](const Image<float>& truth, int x, int y) {
         return 1.f / truth(x, y);
       }},
      {"mirrored",
       PriorType::kAuto,
       [](const Image<float>& truth, int x, int y) {
         return truth(kWidth - 1 - x, y);
       }},
      {"shifted by ten pixels",
       PriorType::kAuto,
       [](const Image<float>& truth, int x, int y) {
         return truth(std::min(x + 10, kWidth - 1), y);
       }},
      {"not a number",
       PriorType::kAuto,
       [](const Image<float>&, int, int) { return kNan; }},
      {"in stripes not a number",
       PriorType::kAuto,
       [](const Image<float>& truth, int x, int y) {
         return x / 8 % 2 == 0 ? kNan : truth(x, y);
       }}};
  for (const WrongPrior& prior : priors) {
    SCOPED_TRACE(prior.name);
    SetPriors(prior.type, prior.values);
    const Quality with = Measure(Refine());
    EXPECT_GT(with.right, without.right - 0.02);
    EXPECT_LT(with.wrong, without.wrong + 0.01);
    EXPECT_LT(with.mean_error, without.mean_error + 0.005);
  }
}

// Dropped priors change no byte.
TEST_F(RefineWithPriorsTest, PriorsThatAreDroppedChangeNothing) {
  const RefinedMaps without = Refine();
  SetPriors(PriorType::kAuto,
            [](const Image<float>&, int, int) { return 3.f; });
  ExpectSameMaps(without, Refine());
}

}  // namespace
}  // namespace tsar
