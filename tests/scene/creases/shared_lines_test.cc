// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/creases/shared_lines.h"

#include <cmath>
#include <cstddef>
#include <functional>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/support/synthetic_observations.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr float kPixel = 0.04f;
constexpr float kLength = 4.f;      // Of a profile.
constexpr float kPieceSize = 32.f;  // In pixels.

// The step of each piece of the line at a position.
using StepAt = std::function<float(float position, int piece)>;

PlaneProfile Profile(const StepAt& step_at,
                     int num_pieces = 10,
                     float pixel = kPixel,
                     float first = -2.f) {
  PlaneProfile profile;
  profile.plane = 0;
  profile.axis = 1;
  profile.pixel = pixel;
  profile.first = first;
  profile.piece_length = kPieceSize * pixel;
  profile.bins.resize(static_cast<size_t>(std::lround(kLength / pixel)));
  for (size_t i = 0; i < profile.bins.size(); ++i) {
    PlaneProfile::Bin& bin = profile.bins[i];
    const float position = first + (static_cast<float>(i) + 0.5f) * pixel;
    bin.num_pixels = kPieceSize * static_cast<float>(num_pieces);
    for (int piece = 0; piece < num_pieces; ++piece) {
      const float rise = kPieceSize * step_at(position, piece);
      bin.pieces.push_back(
          {profile.piece_length * (static_cast<float>(piece) + 0.5f),
           rise,
           kPieceSize});
      bin.step += rise / bin.num_pixels;
    }
  }
  return profile;
}

// A step that blurs over three pixels.
StepAt StepOf(float step, float place, float pixel = kPixel) {
  return [=](float position, int) {
    return std::abs(position - place) < 1.5f * pixel ? step : 0.f;
  };
}

std::vector<PlaneLine> Find(const std::vector<PlaneProfile>& profiles) {
  std::vector<std::vector<PlaneProfile>> of_views;
  for (const PlaneProfile& profile : profiles) {
    of_views.push_back({profile});
  }
  return FindSharedLines(of_views);
}

TEST(FindSharedLines, ThreeViewsMakeALineAndTwoDoNot) {
  const PlaneProfile shows = Profile(StepOf(3.f, 0.52f));
  const PlaneProfile bare = Profile(StepOf(0.f, 0.f));
  EXPECT_TRUE(Find({shows, shows}).empty());
  EXPECT_TRUE(Find({shows, shows, bare}).empty());
  const std::vector<PlaneLine> lines = Find({shows, shows, shows, bare});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].plane, 0);
  EXPECT_EQ(lines[0].axis, 1);
  EXPECT_EQ(lines[0].num_views, 3);
  EXPECT_NEAR(lines[0].position, 0.52f, 0.5f * kPixel);
  EXPECT_EQ(lines[0].pixel, kPixel);
  // That of the views that show it.
  EXPECT_NEAR(lines[0].step, 3.f, 1e-5f);
}

// Six views whose pieces have a standard deviation each.
std::vector<PlaneLine> FindInNoise(float step,
                                   float deviation,
                                   int num_pieces,
                                   Philox* random) {
  std::vector<PlaneProfile> profiles;
  for (int view = 0; view < 6; ++view) {
    profiles.push_back(Profile(
        [&](float position, int piece) {
          return StepOf(step, 0.3f)(position, piece) +
                 deviation * static_cast<float>(NextNormal(random));
        },
        num_pieces));
  }
  return Find(profiles);
}

TEST(FindSharedLines, NoiseAveragesOut) {
  Philox random(5, 0, 0);
  for (int run = 0; run < 20; ++run) {
    const std::vector<PlaneLine> lines = FindInNoise(1.8f, 2.f, 10, &random);
    ASSERT_EQ(lines.size(), 1u) << run;
    EXPECT_NEAR(lines[0].position, 0.3f, 1.5f * kPixel) << run;
  }
}

// Its mean over a line often exceeds the least step.
TEST(FindSharedLines, StrongNoiseIsNone) {
  Philox random(6, 0, 0);
  for (int run = 0; run < 10; ++run) {
    EXPECT_TRUE(FindInNoise(0.f, 3.f, 10, &random).empty()) << run;
  }
}

// The share of a poster's edge in the line decides, however many views show it.
TEST(FindSharedLines, APartOfTheLineIsNone) {
  const auto up_to = [](int num_pieces, int num_views) {
    const PlaneProfile profile = Profile(
        [=](float position, int piece) {
          return piece < num_pieces ? StepOf(12.f, 0.f)(position, piece) : 0.f;
        },
        20);
    return Find(std::vector<PlaneProfile>(num_views, profile));
  };
  EXPECT_TRUE(up_to(9, 3).empty());
  EXPECT_TRUE(up_to(9, 30).empty());
  EXPECT_EQ(up_to(11, 3).size(), 1u);
}

// The end of a poster is no better known where one view hides it in noise.
TEST(FindSharedLines, ViewsAreAveragedBeforeAPosterEnds) {
  Philox random(7, 0, 0);
  std::vector<PlaneProfile> profiles;
  for (int view = 0; view < 12; ++view) {
    profiles.push_back(Profile(
        [&](float position, int piece) {
          return (piece < 7 ? StepOf(8.f, 0.f)(position, piece) : 0.f) +
                 2.f * static_cast<float>(NextNormal(&random));
        },
        20));
  }
  EXPECT_TRUE(Find(profiles).empty());
}

TEST(FindSharedLines, FaintStepsAndThoseOfOtherSignsAreNone) {
  const PlaneProfile faint = Profile(StepOf(0.9f, 0.f));
  EXPECT_TRUE(Find({faint, faint, faint, faint}).empty());
  const PlaneProfile rises = Profile(StepOf(4.f, 0.f));
  const PlaneProfile falls = Profile(StepOf(-4.f, 0.f));
  EXPECT_TRUE(Find({rises, rises, falls, falls}).empty());
  const std::vector<PlaneLine> lines = Find({falls, falls, falls});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(lines[0].step, -4.f, 1e-5f);
}

TEST(FindSharedLines, ViewsFromOtherPlacesShowTheSameLine) {
  const PlaneProfile near = Profile(StepOf(3.f, 0.5f, 0.02f), 10, 0.02f, -1.f);
  const PlaneProfile far = Profile(StepOf(3.f, 0.5f, 0.06f), 10, 0.06f, -2.5f);
  const std::vector<PlaneLine> lines =
      Find({near, Profile(StepOf(3.f, 0.5f)), far});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].num_views, 3);
  EXPECT_EQ(lines[0].pixel, kPixel);
  EXPECT_NEAR(lines[0].position, 0.5f, 0.75f * kPixel);
  // One from so far away that the line could be anywhere does not count.
  const PlaneProfile farther =
      Profile(StepOf(3.f, 0.5f, 0.2f), 10, 0.2f, -2.5f);
  EXPECT_TRUE(Find({near, farther, Profile(StepOf(3.f, 0.5f))}).empty());
}

TEST(FindSharedLines, OfTwoCloseLinesTheStrongerCounts) {
  const auto with_gap = [](float gap) {
    const PlaneProfile profile = Profile([=](float position, int) {
      return std::abs(position) < 0.5f * kPixel         ? 4.f
             : std::abs(position - gap) < 0.5f * kPixel ? 3.f
                                                        : 0.f;
    });
    return Find({profile, profile, profile});
  };
  EXPECT_EQ(with_gap(6.f * kPixel).size(), 2u);
  const std::vector<PlaneLine> lines = with_gap(3.f * kPixel);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(lines[0].step, 4.f, 1e-5f);
}

TEST(FindSharedLines, AreSortedByPlaneAxisAndPosition) {
  std::vector<PlaneProfile> of_view;
  for (const auto& [plane, axis] : {std::pair(2, 0), {0, 1}, {0, 0}}) {
    of_view.push_back(Profile([](float position, int piece) {
      return StepOf(3.f, 0.8f)(position, piece) +
             StepOf(-2.f, -0.8f)(position, piece);
    }));
    of_view.back().plane = plane;
    of_view.back().axis = axis;
  }
  const std::vector<PlaneLine> lines =
      FindSharedLines({of_view, of_view, of_view});
  ASSERT_EQ(lines.size(), 6u);
  for (size_t i = 1; i < lines.size(); ++i) {
    const PlaneLine& a = lines[i - 1];
    const PlaneLine& b = lines[i];
    EXPECT_LT(std::tie(a.plane, a.axis, a.position),
              std::tie(b.plane, b.axis, b.position));
  }
}

}  // namespace
}  // namespace tsar
