// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/join_planes.h"

#include "tests/scene/discovery/discover_planes_fixture.h"

namespace tsar {
namespace {

class JoinPlanesTest : public DiscoverPlanesTest {
 protected:
  // Each view of the room by itself; all are neighbors.
  std::vector<PlaneBlock> MakeBlocks(const SyntheticRoom& room) {
    std::vector<PlaneBlock> blocks;
    const int count = static_cast<int>(room.cameras.size());
    for (int i = 0; i < count; ++i) {
      const std::vector<ObservedView> views = {room.Views()[i]};
      const DiscoveredPlanes found =
          DiscoverPlanes(views, room.Candidates(), options_, *device_);
      PlaneBlock block;
      block.planes = MeasureScenePlanes(views, found, options_.tolerance);
      for (int other = 0; other < count; ++other) {
        if (other != i) {
          block.neighbors.push_back(other);
        }
      }
      blocks.push_back(std::move(block));
    }
    return blocks;
  }
  JoinedPlanes Join(std::vector<PlaneBlock> blocks) const {
    return JoinPlanes(&blocks, options_.min_gain, *device_);
  }
  static std::vector<ScenePlane> Found(const JoinedPlanes& joined) {
    std::vector<ScenePlane> planes;
    for (const MeasuredScenePlane& plane : joined.planes) {
      planes.push_back(plane.found);
    }
    return planes;
  }
};

TEST_F(JoinPlanesTest, SurfacesOfSeveralBlocksBecomeOnePlane) {
  const SyntheticRoom room({Poster()});
  const std::vector<PlaneBlock> blocks = MakeBlocks(room);
  const JoinedPlanes joined = Join(blocks);
  const std::vector<ScenePlane> found = Found(joined);
  EXPECT_EQ(found.size(), room.surfaces.size());
  for (const DrawnSurface& surface : room.surfaces) {
    const int place = Find(surface, found);
    ASSERT_GE(place, 0);
    double support = 0.0;
    for (size_t b = 0; b < blocks.size(); ++b) {
      for (size_t p = 0; p < blocks[b].planes.size(); ++p) {
        const ScenePlane& own = blocks[b].planes[p].found;
        if (joined.indices[b][p] == place) {
          support += own.support;
          EXPECT_LT(AngleBetween(own.plane, surface.plane), 1.0);
        }
      }
    }
    EXPECT_NEAR(found[place].support, support, 1e-6);
  }
  for (size_t i = 1; i < found.size(); ++i) {
    EXPECT_GE(found[i - 1].support, found[i].support);
  }
}

TEST_F(JoinPlanesTest, AWallAlongManyBlocksBecomesOnePlane) {
  const SyntheticRoom room;
  std::vector<PlaneBlock> blocks = MakeBlocks(room);
  // The first and the last are connected through the one between them.
  blocks[0].neighbors = {1};
  blocks[1].neighbors = {0, 2};
  blocks[2].neighbors = {1};
  const JoinedPlanes joined = Join(blocks);
  std::vector<int> walls;
  for (size_t b = 0; b < blocks.size(); ++b) {
    for (size_t p = 0; p < blocks[b].planes.size(); ++p) {
      if (AngleBetween(blocks[b].planes[p].found.plane,
                       room.surfaces[kWall].plane) < 1.0) {
        walls.push_back(joined.indices[b][p]);
      }
    }
  }
  EXPECT_EQ(walls, std::vector<int>(3, walls[0]));
}

TEST_F(JoinPlanesTest, BlocksThatAreNoNeighborsKeepTheirPlanes) {
  const SyntheticRoom room;
  std::vector<PlaneBlock> blocks = MakeBlocks(room);
  size_t count = 0;
  for (PlaneBlock& block : blocks) {
    block.neighbors.clear();
    count += block.planes.size();
  }
  const JoinedPlanes joined = Join(blocks);
  EXPECT_EQ(joined.planes.size(), count);
  for (size_t b = 0; b < blocks.size(); ++b) {
    for (size_t p = 0; p < blocks[b].planes.size(); ++p) {
      const MeasuredScenePlane& plane = joined.planes[joined.indices[b][p]];
      const WorldPlane& own = blocks[b].planes[p].found.plane;
      EXPECT_EQ(plane.found.plane.normal, own.normal);
      EXPECT_NEAR(plane.found.plane.offset, own.offset, 1e-12);
    }
  }
}

TEST_F(JoinPlanesTest, WhatWouldCostTooMuchStaysApart) {
  // The second block sees the wall 0.05, two pixels of disparity, further away.
  const SyntheticRoom room;
  std::vector<PlaneBlock> blocks = MakeBlocks(room);
  blocks.resize(2);
  blocks[0].neighbors = {1};
  blocks[1].neighbors = {0};
  for (MeasuredScenePlane& plane : blocks[1].planes) {
    const Eigen::Vector3d shift = 0.05 * plane.found.plane.normal;
    plane.found.plane.offset -= 0.05;
    for (DepthObservation& observation : plane.observations) {
      observation.center += shift;
    }
  }
  const JoinedPlanes joined = Join(blocks);
  EXPECT_EQ(joined.planes.size(),
            blocks[0].planes.size() + blocks[1].planes.size());
}

TEST_F(JoinPlanesTest, TheOriginMayBeFarAway) {
  SyntheticRoom room;
  const std::vector<ScenePlane> near = Found(Join(MakeBlocks(room)));
  const Eigen::Vector3d shift(500000.0, -4000000.0, 200.0);
  room.Transform(1.0, shift);
  const std::vector<ScenePlane> far = Found(Join(MakeBlocks(room)));
  ASSERT_EQ(far.size(), near.size());
  for (const DrawnSurface& surface : room.surfaces) {
    EXPECT_GE(Find(surface, far), 0);
  }
}

TEST_F(JoinPlanesTest, NoBlocksAndBlocksWithoutPlanes) {
  EXPECT_TRUE(Join({}).planes.empty());
  const JoinedPlanes joined = Join(std::vector<PlaneBlock>(2));
  EXPECT_TRUE(joined.planes.empty());
  EXPECT_EQ(joined.indices.size(), 2u);
}

TEST_F(JoinPlanesTest, ThinnedSamplesWeighAsMuch) {
  std::vector<DepthObservation> samples(1000);
  for (size_t i = 0; i < samples.size(); ++i) {
    samples[i].weight = 2.0;
  }
  ThinOut(&samples);
  ASSERT_EQ(samples.size(), kMaxPlaneSamples);
  double sum = 0.0;
  for (const DepthObservation& sample : samples) {
    sum += sample.weight;
  }
  EXPECT_NEAR(sum, 2000.0, 1e-6);
}

}  // namespace
}  // namespace tsar
