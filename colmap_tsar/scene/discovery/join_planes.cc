// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/join_planes.h"

#include "colmap_tsar/scene/discovery/merge_planes.h"
#include "colmap_tsar/scene/discovery/observation_table.h"
#include "colmap_tsar/scene/evidence/plane_indices.h"
#include "colmap_tsar/view/planes/fit_plane.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tsar {
namespace {

// The share of its support that the smaller of two planes of different blocks
// may lose when they are joined: each view shares errors with its neighbors, by
// which measurements of one surface differ.
constexpr double kMaxMergeShare = 0.1;

using Observations = std::vector<DepthObservation>;

// The score of DiscoverPlanes, with the tolerance as the expected error.
double Support(const WorldPlane& plane, const Observations& observations) {
  double sum = 0.0;
  for (const DepthObservation& observation : observations) {
    const double residual = NormalizedResidual(plane, observation);
    sum += observation.weight * std::max(1.0 - residual * residual, 0.0);
  }
  return sum;
}

// Whether at least half of the measurements of another plane are near.
bool IsNear(const WorldPlane& plane, const Observations& observations) {
  const size_t num_near = std::ranges::count_if(
      observations, [&](const DepthObservation& observation) {
        return std::abs(NormalizedResidual(plane, observation)) <
               kMaxMergeDistance;
      });
  return 2 * num_near >= observations.size();
}

std::vector<int> Union(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> result;
  std::ranges::set_union(a, b, std::back_inserter(result));
  return result;
}

// Translates a plane and its samples, so that arithmetic is done near the
// origin.
void Shift(const Eigen::Vector3d& offset, MeasuredScenePlane* plane) {
  plane->found.plane.offset -= plane->found.plane.normal.dot(offset);
  for (DepthObservation& observation : plane->observations) {
    observation.center += offset;
  }
}

class PlaneJoiner {
 public:
  // origin: near which arithmetic is done. Takes the samples of the blocks.
  PlaneJoiner(std::vector<PlaneBlock>* blocks,
              const Eigen::Vector3d& origin,
              double min_gain,
              Device& device)
      : blocks_(*blocks),
        min_gain_(min_gain),
        threads_(device.Threads()),
        nodes_of_block_(blocks_.size()) {
    for (int b = 0; b < static_cast<int>(blocks_.size()); ++b) {
      for (MeasuredScenePlane& plane : (*blocks)[b].planes) {
        nodes_of_block_[b].push_back(static_cast<int>(nodes_.size()));
        Node& node = nodes_.emplace_back();
        node.blocks = {b};
        node.neighbors = blocks_[b].neighbors;
        node.plane = {plane.found, std::move(plane.observations)};
        Shift(-origin, &node.plane);
        node.support = Support(node.plane.found.plane, node.plane.observations);
      }
    }
  }

  JoinedPlanes Run() {
    FindAllPairs();
    while (!queue_.empty()) {
      const auto [key, joint] = *queue_.begin();
      const auto [share, a, b] = key;
      queue_.erase(queue_.begin());
      if (IsLeft(a) && IsLeft(b)) {
        Join(a, b, joint);
      }
    }
    return Collect();
  }

 private:
  struct Node {
    MeasuredScenePlane plane;
    double support = 0.0;  // The score of its sample.
    std::vector<int> blocks;
    std::vector<int> neighbors;  // The neighbors of all of these blocks.
    int heir = -1;               // The node that it was joined into.
  };
  struct Joint {
    double share = 0.0;  // The ratio of loss to its limit.
    WorldPlane plane;
  };

  bool IsLeft(int node) const { return nodes_[node].heir < 0; }

  void FindAllPairs() {
    std::vector<std::pair<int, int>> pairs;
    for (int a = 0; a < static_cast<int>(nodes_.size()); ++a) {
      for (const int block : nodes_[a].neighbors) {
        for (const int b : nodes_of_block_[block]) {
          if (a < b) {
            pairs.emplace_back(a, b);
          }
        }
      }
    }
    Consider(pairs);
  }

  // Queues the pairs whose loss is below its limit.
  void Consider(const std::vector<std::pair<int, int>>& pairs) {
    std::vector<std::optional<Joint>> joints(pairs.size());
    threads_.ForEach(pairs.size(), [&](size_t i) {
      joints[i] = FindJoint(nodes_[pairs[i].first], nodes_[pairs[i].second]);
    });
    for (size_t i = 0; i < pairs.size(); ++i) {
      if (joints[i]) {
        queue_[{joints[i]->share, pairs[i].first, pairs[i].second}] =
            joints[i]->plane;
      }
    }
  }

  std::optional<Joint> FindJoint(const Node& a, const Node& b) const {
    const WorldPlane& plane_a = a.plane.found.plane;
    const WorldPlane& plane_b = b.plane.found.plane;
    if (!MayBeMerged(plane_a, plane_b) ||
        !(IsNear(plane_a, b.plane.observations) ||
          IsNear(plane_b, a.plane.observations))) {
      return std::nullopt;
    }
    FitSamples samples;
    for (const Node* node : {&a, &b}) {
      for (const DepthObservation& observation : node->plane.observations) {
        samples.Add(observation);
      }
    }
    const double max_loss =
        std::max(min_gain_, kMaxMergeShare * std::min(a.support, b.support));
    std::optional<Joint> best;
    for (const WorldPlane& initial : {plane_a, plane_b}) {
      const WorldPlane fit = FitPlane(initial, samples, kCauchyShare);
      const double loss = a.support + b.support -
                          Support(fit, a.plane.observations) -
                          Support(fit, b.plane.observations);
      if (loss / max_loss < (best ? best->share : 1.0)) {
        best = Joint{loss / max_loss, fit};
      }
    }
    return best;
  }

  void Join(int a, int b, const WorldPlane& plane) {
    Node joint;
    Node& first = nodes_[a];
    Node& second = nodes_[b];
    joint.plane.found = {
        plane, first.plane.found.support + second.plane.found.support};
    joint.plane.observations = std::move(first.plane.observations);
    std::ranges::copy(second.plane.observations,
                      std::back_inserter(joint.plane.observations));
    ThinOut(&joint.plane.observations);
    joint.support = Support(plane, joint.plane.observations);
    joint.blocks = Union(first.blocks, second.blocks);
    joint.neighbors = Union(first.neighbors, second.neighbors);
    const int joint_node = static_cast<int>(nodes_.size());
    first.heir = joint_node;
    second.heir = joint_node;
    second.plane = {};
    std::set<std::pair<int, int>> pairs;
    for (const int block : Union(joint.blocks, joint.neighbors)) {
      for (const int other : nodes_of_block_[block]) {
        if (IsLeft(other)) {
          pairs.emplace(other, joint_node);
        }
      }
    }
    for (const int block : joint.blocks) {
      std::vector<int>& nodes = nodes_of_block_[block];
      std::erase_if(nodes, [&](int node) { return node == a || node == b; });
      nodes.push_back(joint_node);
    }
    nodes_.push_back(std::move(joint));
    Consider({pairs.begin(), pairs.end()});
  }

  JoinedPlanes Collect() {
    std::vector<int> order;
    for (int node = 0; node < static_cast<int>(nodes_.size()); ++node) {
      if (IsLeft(node)) {
        order.push_back(node);
      }
    }
    std::ranges::stable_sort(order, std::greater{}, [&](int node) {
      return nodes_[node].plane.found.support;
    });
    JoinedPlanes result;
    for (const int node : order) {
      result.planes.push_back(std::move(nodes_[node].plane));
    }
    const std::vector<int> new_indices = IndicesAmong(order, nodes_.size());
    int original = 0;
    for (const PlaneBlock& block : blocks_) {
      std::vector<int>& indices = result.indices.emplace_back();
      for (size_t i = 0; i < block.planes.size(); ++i) {
        int node = original++;
        while (!IsLeft(node)) {
          node = nodes_[node].heir;
        }
        indices.push_back(new_indices[node]);
      }
    }
    return result;
  }

  const std::vector<PlaneBlock>& blocks_;
  const double min_gain_;
  ThreadPool& threads_;
  // The planes of the blocks, then those that they are joined into.
  std::vector<Node> nodes_;
  // Nodes that have not been joined into others.
  std::vector<std::vector<int>> nodes_of_block_;
  // Joint planes by their share of the limit and the two nodes.
  std::map<std::tuple<double, int, int>, WorldPlane> queue_;
};

// A point near the measurements.
Eigen::Vector3d FindOrigin(const std::vector<PlaneBlock>& blocks) {
  for (const PlaneBlock& block : blocks) {
    for (const MeasuredScenePlane& plane : block.planes) {
      if (!plane.observations.empty()) {
        return plane.observations[0].center;
      }
    }
  }
  return Eigen::Vector3d::Zero();
}

// The superpixels that are assigned to each plane, indexed across all views.
std::vector<std::vector<int>> MembersOf(const DiscoveredPlanes& discovered) {
  std::vector<std::vector<int>> members(discovered.planes.size());
  int superpixel = 0;
  for (const std::vector<int>& of_view : discovered.assignment) {
    for (const int plane : of_view) {
      if (plane >= 0) {
        members[plane].push_back(superpixel);
      }
      ++superpixel;
    }
  }
  return members;
}

}  // namespace

void ThinOut(std::vector<DepthObservation>* samples) {
  const size_t count = samples->size();
  if (count <= kMaxPlaneSamples) {
    return;
  }
  const double scale = static_cast<double>(count) / kMaxPlaneSamples;
  for (size_t i = 0; i < kMaxPlaneSamples; ++i) {
    (*samples)[i] = (*samples)[i * count / kMaxPlaneSamples];
    (*samples)[i].weight *= scale;
  }
  samples->resize(kMaxPlaneSamples);
}

std::vector<MeasuredScenePlane> MeasureScenePlanes(
    const std::vector<ObservedView>& views,
    const DiscoveredPlanes& discovered,
    double tolerance) {
  if (discovered.planes.empty()) {
    return {};
  }
  const ObservationTable observations(views);
  const ObservationTable of_priors(views, ObservationsOf::kPriors);
  const std::vector<std::vector<int>> members = MembersOf(discovered);
  const Eigen::Matrix3d to_world = views[0].camera.rotation.transpose();
  const Eigen::Vector3d origin = views[0].camera.Center();
  std::vector<MeasuredScenePlane> result;
  for (size_t p = 0; p < members.size(); ++p) {
    MeasuredScenePlane plane;
    plane.found = discovered.planes[p];
    const auto count_of = [&](const ObservationTable& of_members) {
      size_t count = 0;
      for (const int k : members[p]) {
        count += of_members.NumObservations(k);
      }
      return count;
    };
    const ObservationTable& sampled =
        count_of(observations) > 0 ? observations : of_priors;
    const size_t count = count_of(sampled);
    sampled.Sample(members[p], kMaxPlaneSamples, [&](DepthObservation sample) {
      sample.center = to_world * sample.center + origin;
      sample.ray = to_world * sample.ray;
      sample.sigma *= tolerance;
      plane.observations.push_back(sample);
    });
    for (DepthObservation& sample : plane.observations) {
      sample.weight *= static_cast<double>(count) / plane.observations.size();
    }
    result.push_back(std::move(plane));
  }
  return result;
}

ModelPlane ToModelPlane(const MeasuredScenePlane& measured) {
  ModelPlane plane;
  plane.plane = measured.found.plane;
  plane.support = measured.found.support;
  for (const DepthObservation& observation : measured.observations) {
    plane.center +=
        FootPoint(plane.plane, observation) / measured.observations.size();
  }
  plane.axis_s = plane.plane.normal.unitOrthogonal();
  plane.axis_t = plane.plane.normal.cross(plane.axis_s);
  return plane;
}

JoinedPlanes JoinPlanes(std::vector<PlaneBlock>* blocks,
                        double min_gain,
                        Device& device) {
  const Eigen::Vector3d origin = FindOrigin(*blocks);
  JoinedPlanes joined = PlaneJoiner(blocks, origin, min_gain, device).Run();
  for (MeasuredScenePlane& plane : joined.planes) {
    Shift(origin, &plane);
  }
  return joined;
}

}  // namespace tsar
