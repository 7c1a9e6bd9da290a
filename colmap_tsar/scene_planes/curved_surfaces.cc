// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/curved_surfaces.h"

#include "colmap_tsar/base/disparity.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <set>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace tsar {
namespace {

constexpr int kNumParameters = 6;
constexpr int kNumParametersOfPlane = 3;
using Vector6 = Eigen::Matrix<double, kNumParameters, 1>;
using Matrix6 = Eigen::Matrix<double, kNumParameters, kNumParameters>;

constexpr int kFitIterations = 4;
// A surface grows by one ring of superpixels at a time.
constexpr int kMaxRounds = 24;
// In so many it must explain what it covers better than the planes around, and
// later better than what each superpixel has: most seeds lie at the rims of
// walls, all over which it would grow else.
constexpr int kFirstRounds = 2;
// One of so many pixels of a superpixel is tested against the other views, but
// a few at least, and more views than these that say the same about it change
// nothing.
constexpr size_t kPixelsPerTest = 64;
constexpr size_t kMinTests = 6;
constexpr int kMaxVotes = 2;
// Directions of eight in which a surface must have been measured around a
// superpixel to be known there.
constexpr int kSectorsKnown = 7;
// Depths are believed so far beyond those measured on the surface, as a share.
constexpr float kDepthMargin = 0.2f;

size_t NumTests(size_t num_pixels) {
  return std::max(num_pixels / kPixelsPerTest,
                  std::clamp<size_t>(num_pixels, 1, kMinTests));
}

struct Superpixel {
  std::vector<int> pixels;                // Of the raster.
  std::vector<Observation> observations;  // Those that were measured.
  std::vector<int> neighbors;             // Ascending.
  float quality = 0.f;                    // Of the observations together.
  float mass = 0.f;                       // Of what was measured.
  Vec3f middle;                           // A ray.
  // With its plane or without any: what that costs, and Residual().
  float cost = 0.f;
  float residual = 0.f;

  bool IsMeasured() const { return quality > 0.f; }
};

// A view that looks at the same scene, on its raster.
struct Witness {
  Intrinsics intrinsics;
  RelativePose from_reference;
  DisparityScale scale;
  const Image<float>* strong_depth;
};

struct Votes {
  int confirmed = 0;
  int contradicted = 0;
};

Vector6 Powers(double u, double v) {
  Vector6 powers;
  powers << 1.0, u, v, u * u, u * v, v * v;
  return powers;
}

// A surface that was fitted to superpixels, and what it gains.
struct Group {
  std::vector<int> members;  // Ascending.
  CurvedSurface surface;
  // Of the coefficients.
  Matrix6 covariance = Matrix6::Zero();
  float min_depth = 0.f;
  float max_depth = 0.f;
  double gain = 0.0;
  int seed = 0;
};

class Finder {
 public:
  Finder(const std::vector<ObservedView>& views,
         const LabeledView& labeled,
         const CurvedSurfaceOptions& options)
      : evidence_(*views[0].evidence),
        intrinsics_(views[0].camera.GetIntrinsics()),
        scale_{0.f, evidence_.error_per_depth},
        labeled_(labeled),
        options_(options),
        taken_(labeled.labels.size(), 0) {
    for (size_t j = 1; j < views.size(); ++j) {
      witnesses_.push_back(
          {views[j].camera.GetIntrinsics(),
           ComputeRelativePose(views[0].camera, views[j].camera),
           DisparityScale{0.f, views[j].evidence->error_per_depth},
           &views[j].evidence->strong_depth});
    }
    MakeSuperpixels();
  }

  CurvedView Find() {
    CurvedView result;
    result.labels.assign(superpixels_.size(), -1);
    result.evidence = labeled_.evidence;
    for (Group& group : Candidates()) {
      if (IsTouched(group)) {
        group = Grow(group.seed);
      }
      if (!(group.gain > 0.0)) {
        continue;
      }
      FillBetween(&group);
      for (const int s : group.members) {
        const auto i = static_cast<size_t>(s);
        taken_[i] = 1;
        result.labels[i] = static_cast<int>(result.surfaces.size());
        result.evidence[i] = EvidenceOf(superpixels_[i], group.surface);
      }
      result.surfaces.push_back(group.surface);
    }
    return result;
  }

 private:
  const Superpixel& At(int s) const {
    return superpixels_[static_cast<size_t>(s)];
  }
  int LabelOf(int s) const { return labeled_.labels[static_cast<size_t>(s)]; }
  bool IsTaken(int s) const { return taken_[static_cast<size_t>(s)] != 0; }
  Vec3f RayOf(int pixel) const {
    return intrinsics_.Ray(static_cast<float>(pixel % evidence_.width),
                           static_cast<float>(pixel / evidence_.width));
  }

  void MakeSuperpixels() {
    superpixels_.resize(static_cast<size_t>(evidence_.NumSuperpixels()));
    for (size_t i = 0; i < evidence_.superpixels.NumPixels(); ++i) {
      superpixels_[evidence_.superpixels.Data()[i]].pixels.push_back(
          static_cast<int>(i));
    }
    for (const SuperpixelBorder& border : evidence_.borders) {
      superpixels_[static_cast<size_t>(border.first)].neighbors.push_back(
          border.second);
      superpixels_[static_cast<size_t>(border.second)].neighbors.push_back(
          border.first);
    }
    for (int s = 0; s < evidence_.NumSuperpixels(); ++s) {
      Superpixel& superpixel = superpixels_[static_cast<size_t>(s)];
      std::sort(superpixel.neighbors.begin(), superpixel.neighbors.end());
      AddObservations(s, &superpixel);
      Vec3f sum;
      for (const int pixel : superpixel.pixels) {
        sum = sum + RayOf(pixel);
      }
      if (!superpixel.pixels.empty()) {
        superpixel.middle = sum * (1.f / sum.z);
      }
      SetPresentCost(LabelOf(s), &superpixel);
    }
  }

  void AddObservations(int s, Superpixel* superpixel) {
    const auto i = static_cast<size_t>(s);
    float all = 0.f;
    for (int k = evidence_.first_observation[i];
         k < evidence_.first_observation[i + 1];
         ++k) {
      const Observation& observation =
          evidence_.observations[static_cast<size_t>(k)];
      all += observation.quality;
      if (observation.quality >= options_.min_quality) {
        superpixel->observations.push_back(observation);
        superpixel->quality += observation.quality;
      }
    }
    superpixel->mass =
        all > 0.f ? evidence_.mass[i] * superpixel->quality / all : 0.f;
    const auto num_pixels = static_cast<float>(superpixel->pixels.size());
    if (superpixel->mass < options_.min_measured * num_pixels) {
      superpixel->observations.clear();
      superpixel->quality = 0.f;
      superpixel->mass = 0.f;
    }
  }

  void SetPresentCost(int label, Superpixel* superpixel) const {
    const LabelOptions& labels = options_.labels;
    if (label < 0) {
      superpixel->residual = labels.cost_of_unexplained;
      superpixel->cost =
          superpixel->mass * superpixel->residual +
          labels.cost_of_none *
              std::max(static_cast<float>(superpixel->pixels.size()) -
                           superpixel->mass,
                       0.f);
      return;
    }
    const CurvedSurface surface =
        FromPlane(labeled_.planes[static_cast<size_t>(label)]);
    superpixel->residual = Residual(*superpixel, surface);
    superpixel->cost = Cost(*superpixel, surface);
  }

  static CurvedSurface FromPlane(const Plane& plane) {
    CurvedSurface surface;
    surface.coefficients[0] = -plane.normal.z / plane.offset;
    surface.coefficients[1] = -plane.normal.x / plane.offset;
    surface.coefficients[2] = -plane.normal.y / plane.offset;
    return surface;
  }

  // In pixels of disparity, of a depth that was measured.
  float Difference(const RayDepth& sample, const CurvedSurface& surface) const {
    const float depth = DepthAt(surface, {sample.x, sample.y, 1.f});
    return depth > 0.f ? std::abs(depth - sample.z) /
                             (sample.z * scale_.RelativeDepthError(sample.z))
                       : INFINITY;
  }

  static float DepthAt(const CurvedSurface& surface, const Vec3f& ray) {
    const Plane plane = surface.TangentAt(ray);
    return plane.Valid() ? plane.Depth(ray) : 0.f;
  }

  // Mean of min(difference / tolerance, 1)^2; 1 without observations.
  float Residual(const Superpixel& superpixel,
                 const CurvedSurface& surface) const {
    float sum = 0.f;
    for (const Observation& observation : superpixel.observations) {
      const float share = std::min(
          Difference(observation.sample, surface) / options_.labels.tolerance,
          1.f);
      sum += observation.quality * share * share;
    }
    return superpixel.quality > 0.f ? sum / superpixel.quality : 1.f;
  }

  float Cost(const Superpixel& superpixel, const CurvedSurface& surface) const {
    const LabelOptions& labels = options_.labels;
    int num_tests = 0;
    const Votes votes = AskWitnesses(superpixel, surface, &num_tests);
    const float pixels_per_vote = static_cast<float>(superpixel.pixels.size()) /
                                  static_cast<float>(num_tests * kMaxVotes);
    const float seen =
        labels.cost_of_contradiction * static_cast<float>(votes.contradicted) -
        labels.gain_of_confirmation * static_cast<float>(votes.confirmed);
    return (superpixel.IsMeasured()
                ? superpixel.mass * Residual(superpixel, surface)
                : 0.f) +
           seen * pixels_per_vote;
  }

  Votes AskWitnesses(const Superpixel& superpixel,
                     const CurvedSurface& surface,
                     int* num_tests) const {
    const size_t num_pixels = superpixel.pixels.size();
    const size_t count = NumTests(num_pixels);
    *num_tests = static_cast<int>(count);
    Votes sum;
    for (size_t i = 0; i < count && num_pixels > 0; ++i) {
      const Vec3f ray =
          RayOf(superpixel.pixels[(2 * i + 1) * num_pixels / (2 * count)]);
      const float depth = DepthAt(surface, ray);
      if (!(depth > 0.f)) {
        continue;
      }
      Votes votes;
      for (const Witness& witness : witnesses_) {
        Ask(witness, ray * depth, &votes);
      }
      sum.confirmed += std::min(votes.confirmed, kMaxVotes);
      sum.contradicted += std::min(votes.contradicted, kMaxVotes);
    }
    return sum;
  }

  void Ask(const Witness& witness, const Vec3f& point, Votes* votes) const {
    const Vec3f seen = witness.from_reference * point;
    if (!(seen.z > 0.f)) {
      return;
    }
    float x = 0.f;
    float y = 0.f;
    witness.intrinsics.Project(seen, &x, &y);
    const Image<float>& depths = *witness.strong_depth;
    // As floats, since far outside they do not fit into integers.
    if (!(x >= 0.f && y >= 0.f &&
          x < static_cast<float>(depths.Width()) - 0.5f &&
          y < static_cast<float>(depths.Height()) - 0.5f)) {
      return;
    }
    const float measured =
        depths(static_cast<int>(x + 0.5f), static_cast<int>(y + 0.5f));
    if (!(measured > 0.f)) {
      return;
    }
    const LabelOptions& labels = options_.labels;
    const float gap = (seen.z - measured) /
                      (measured * witness.scale.RelativeDepthError(measured));
    if (std::abs(gap) < labels.confirmation_share * labels.tolerance) {
      ++votes->confirmed;
    } else if (gap < -labels.min_contradiction) {
      ++votes->contradicted;
    }
  }

  // Superpixels that lie next to another plane or have none: planes that
  // explain all around them are left alone. Those that are explained worst come
  // first.
  std::vector<int> Seeds() const {
    std::vector<int> seeds;
    for (int s = 0; s < static_cast<int>(superpixels_.size()); ++s) {
      const Superpixel& superpixel = At(s);
      const bool is_alone = std::all_of(
          superpixel.neighbors.begin(), superpixel.neighbors.end(), [&](int t) {
            return LabelOf(t) == LabelOf(s);
          });
      if (superpixel.IsMeasured() && (LabelOf(s) < 0 || !is_alone)) {
        seeds.push_back(s);
      }
    }
    std::stable_sort(seeds.begin(), seeds.end(), [&](int s, int t) {
      return At(s).residual > At(t).residual;
    });
    return seeds;
  }

  // Those that gain most first.
  std::vector<Group> Candidates() const {
    std::vector<Group> groups;
    std::vector<char> is_covered(superpixels_.size(), 0);
    for (const int seed : Seeds()) {
      if (is_covered[static_cast<size_t>(seed)]) {
        continue;
      }
      Group group = Grow(seed);
      if (group.gain > 0.0) {
        for (const int s : group.members) {
          is_covered[static_cast<size_t>(s)] = 1;
        }
        groups.push_back(std::move(group));
      }
    }
    std::stable_sort(
        groups.begin(), groups.end(), [](const Group& a, const Group& b) {
          return a.gain > b.gain;
        });
    return groups;
  }

  bool IsTouched(const Group& group) const {
    return std::any_of(group.members.begin(), group.members.end(), [&](int s) {
      return IsTaken(s);
    });
  }

  // Grows a surface about a superpixel; its gain is 0 where there is none, and
  // its members are those that were tried.
  Group Grow(int seed) const {
    Group group;
    group.seed = seed;
    if (IsTaken(seed)) {
      return group;
    }
    group.members = {seed};
    for (const int s : At(seed).neighbors) {
      if (At(s).IsMeasured() && !IsTaken(s)) {
        group.members.push_back(s);
      }
    }
    std::sort(group.members.begin(), group.members.end());
    for (int round = 0; round < kMaxRounds; ++round) {
      if (!Fit(group.members, &group) ||
          (round < kFirstRounds ? !BeatsPlanesAround(group)
                                : !Improves(group))) {
        return group;
      }
      std::vector<int> next =
          Connected(seed, group, group.members, options_.growth_slack);
      if (next == group.members) {
        break;
      }
      if (next.empty()) {
        return group;
      }
      group.members = std::move(next);
    }
    if (!Fit(group.members, &group)) {
      return group;
    }
    std::vector<int> kept = Keep(group, group.members);
    if (static_cast<int>(kept.size()) < options_.min_superpixels) {
      return group;
    }
    group.members = std::move(kept);
    if (Fit(group.members, &group) && IsSound(group)) {
      group.gain = Gain(group);
    }
    return group;
  }

  // Whether the surface explains its members better than what they have.
  bool Improves(const Group& group) const {
    double fall = 0.0;
    double mass = 0.0;
    for (const int s : group.members) {
      const Superpixel& superpixel = At(s);
      fall += superpixel.mass *
              (superpixel.residual - Residual(superpixel, group.surface));
      mass += superpixel.mass;
    }
    return fall > options_.min_improvement * mass;
  }

  // Least squares of the inverse depth with Cauchy weights.
  bool Fit(const std::vector<int>& members, Group* group) const {
    double weights = 0.0;
    double x = 0.0;
    double y = 0.0;
    double inverse = 0.0;
    double mass = 0.0;
    group->min_depth = INFINITY;
    group->max_depth = 0.f;
    for (const int s : members) {
      for (const Observation& observation : At(s).observations) {
        const double weight = observation.quality;
        weights += weight;
        x += weight * observation.sample.x;
        y += weight * observation.sample.y;
        inverse += weight / observation.sample.z;
      }
      mass += At(s).mass;
    }
    if (!(weights > 0.0)) {
      return false;
    }
    CurvedSurface& surface = group->surface;
    surface.middle_x = static_cast<float>(x / weights);
    surface.middle_y = static_cast<float>(y / weights);
    inverse /= weights;
    double extent = 0.0;
    for (const int s : members) {
      for (const Observation& observation : At(s).observations) {
        extent = std::max({extent,
                           std::abs(static_cast<double>(observation.sample.x) -
                                    surface.middle_x),
                           std::abs(static_cast<double>(observation.sample.y) -
                                    surface.middle_y)});
      }
    }
    if (!(extent > 0.0)) {
      return false;
    }
    surface.extent = static_cast<float>(extent);
    const double sigma = options_.noise_share * options_.labels.tolerance;
    const double share = mass / (weights * options_.pixels_per_observation);
    Vector6 coefficients = Vector6::Zero();
    Matrix6 normal = Matrix6::Zero();
    for (int iteration = 0; iteration < kFitIterations; ++iteration) {
      normal = Matrix6::Identity() * 1e-9;
      Vector6 right = Vector6::Zero();
      for (const int s : members) {
        for (const Observation& observation : At(s).observations) {
          const RayDepth& sample = observation.sample;
          const Vector6 powers = Powers((sample.x - surface.middle_x) / extent,
                                        (sample.y - surface.middle_y) / extent);
          const double measured = 1.0 / (sample.z * inverse);
          const double error =
              measured * scale_.RelativeDepthError(sample.z) * sigma;
          double weight = observation.quality * share / (error * error);
          if (iteration > 0) {
            const double residual =
                (measured - powers.dot(coefficients)) / error;
            weight /= 1.0 + residual * residual;
          }
          normal.selfadjointView<Eigen::Lower>().rankUpdate(powers, weight);
          right += weight * measured * powers;
        }
      }
      const Matrix6 full = normal.selfadjointView<Eigen::Lower>();
      const Eigen::LDLT<Matrix6> solver(full);
      coefficients = solver.solve(right);
      if (iteration + 1 == kFitIterations) {
        group->covariance =
            solver.solve(Matrix6::Identity()) * (inverse * inverse);
      }
    }
    if (!coefficients.allFinite()) {
      return false;
    }
    for (int i = 0; i < kNumParameters; ++i) {
      surface.coefficients[i] = static_cast<float>(coefficients(i) * inverse);
    }
    for (const int s : members) {
      for (const Observation& observation : At(s).observations) {
        if (Difference(observation.sample, surface) <
            options_.labels.tolerance) {
          group->min_depth = std::min(group->min_depth, observation.sample.z);
          group->max_depth = std::max(group->max_depth, observation.sample.z);
        }
      }
    }
    return group->max_depth > 0.f;
  }

  // Whether the surface's depth is known at a superpixel's pixels, and
  // possible.
  bool IsKnown(const Group& group, const Superpixel& superpixel) const {
    const size_t num_pixels = superpixel.pixels.size();
    const size_t count = NumTests(num_pixels);
    const CurvedSurface& surface = group.surface;
    for (size_t i = 0; i < count && num_pixels > 0; ++i) {
      const Vec3f ray =
          RayOf(superpixel.pixels[(2 * i + 1) * num_pixels / (2 * count)]);
      const Plane plane = surface.TangentAt(ray);
      if (!plane.Valid() ||
          !(-Dot(plane.normal, ray) > options_.min_slope * Norm(ray))) {
        return false;
      }
      const float depth = plane.Depth(ray);
      if (!(depth > group.min_depth * (1.f - kDepthMargin) &&
            depth < group.max_depth * (1.f + kDepthMargin))) {
        return false;
      }
      const Vector6 powers =
          Powers((ray.x - surface.middle_x) / surface.extent,
                 (ray.y - surface.middle_y) / surface.extent);
      const double sigma = std::sqrt(powers.dot(group.covariance * powers)) *
                           depth / scale_.RelativeDepthError(depth);
      if (!(sigma < options_.labels.max_sigma)) {
        return false;
      }
    }
    return true;
  }

  // The measured superpixels that the surface explains about as well as what
  // they have, as far as they hang together with the seed, one ring around the
  // present ones at most.
  std::vector<int> Connected(int seed,
                             const Group& group,
                             const std::vector<int>& members,
                             float slack) const {
    const auto holds = [&](int s) {
      const Superpixel& superpixel = At(s);
      return superpixel.IsMeasured() && !IsTaken(s) &&
             Residual(superpixel, group.surface) <=
                 options_.max_residual_of_superpixel &&
             IsKnown(group, superpixel) &&
             Cost(superpixel, group.surface) <=
                 superpixel.cost + slack * superpixel.mass;
    };
    std::vector<char> is_member(superpixels_.size(), 0);
    for (const int s : members) {
      is_member[static_cast<size_t>(s)] = 1;
    }
    std::vector<char> is_seen(superpixels_.size(), 0);
    std::vector<int> result;
    if (!holds(seed)) {
      return result;
    }
    result.push_back(seed);
    is_seen[static_cast<size_t>(seed)] = 1;
    for (size_t i = 0; i < result.size(); ++i) {
      const int s = result[i];
      // The ring does not grow further.
      if (!is_member[static_cast<size_t>(s)]) {
        continue;
      }
      for (const int t : At(s).neighbors) {
        char& seen = is_seen[static_cast<size_t>(t)];
        if (!seen) {
          seen = 1;
          if (holds(t)) {
            result.push_back(t);
          }
        }
      }
    }
    std::sort(result.begin(), result.end());
    return result;
  }

  // How much worse the surface explains the superpixels than what they have.
  double Loss(const Group& group, const std::vector<int>& superpixels) const {
    double loss = 0.0;
    for (const int s : superpixels) {
      loss += static_cast<double>(Cost(At(s), group.surface)) - At(s).cost;
    }
    return loss;
  }

  // A difference of the criterion, in the units of costs.
  double ToCost(double criterion) const {
    return criterion * options_.noise_share * options_.noise_share *
           options_.pixels_per_observation;
  }

  double CostOfParameter(const std::vector<int>& members) const {
    double mass = 0.0;
    for (const int s : members) {
      mass += At(s).mass;
    }
    return ToCost(
        std::log(std::max(mass / options_.pixels_per_observation, 2.0)));
  }

  // Of the members with each plane those that the surface explains better, or
  // all where none of the plane is left then, and it pays.
  std::vector<int> Keep(const Group& group,
                        const std::vector<int>& members) const {
    const double saving = kNumParametersOfPlane * CostOfParameter(members);
    std::vector<int> kept;
    for (int k = -1; k < static_cast<int>(labeled_.planes.size()); ++k) {
      std::vector<int> all;
      std::vector<int> better;
      for (const int s : members) {
        if (LabelOf(s) == k) {
          all.push_back(s);
          if (Cost(At(s), group.surface) < At(s).cost) {
            better.push_back(s);
          }
        }
      }
      const bool pays = k >= 0 && IsWhole(k, all) &&
                        Loss(group, all) - saving < Loss(group, better);
      const std::vector<int>& chosen = pays ? all : better;
      kept.insert(kept.end(), chosen.begin(), chosen.end());
    }
    std::sort(kept.begin(), kept.end());
    return Largest(kept);
  }

  // Whether these are all the measured superpixels of a plane.
  bool IsWhole(int plane, const std::vector<int>& superpixels) const {
    size_t count = 0;
    for (int s = 0; s < static_cast<int>(superpixels_.size()); ++s) {
      count += LabelOf(s) == plane && At(s).IsMeasured() ? 1u : 0u;
    }
    return count > 0 && superpixels.size() == count;
  }

  // The largest connected part.
  std::vector<int> Largest(const std::vector<int>& superpixels) const {
    std::vector<char> is_left(superpixels_.size(), 0);
    for (const int s : superpixels) {
      is_left[static_cast<size_t>(s)] = 1;
    }
    std::vector<int> largest;
    for (const int seed : superpixels) {
      if (!is_left[static_cast<size_t>(seed)]) {
        continue;
      }
      std::vector<int> part = {seed};
      is_left[static_cast<size_t>(seed)] = 0;
      for (size_t i = 0; i < part.size(); ++i) {
        for (const int t : At(part[i]).neighbors) {
          if (is_left[static_cast<size_t>(t)]) {
            is_left[static_cast<size_t>(t)] = 0;
            part.push_back(t);
          }
        }
      }
      if (part.size() > largest.size()) {
        largest = std::move(part);
      }
    }
    std::sort(largest.begin(), largest.end());
    return largest;
  }

  // Those of superpixels and of their neighbours.
  std::vector<CurvedSurface> PlanesAround(
      const std::vector<int>& superpixels) const {
    std::set<int> labels;
    for (const int s : superpixels) {
      labels.insert(LabelOf(s));
      for (const int t : At(s).neighbors) {
        labels.insert(LabelOf(t));
      }
    }
    labels.erase(-1);
    std::vector<CurvedSurface> planes;
    for (const int label : labels) {
      planes.push_back(FromPlane(labeled_.planes[static_cast<size_t>(label)]));
    }
    return planes;
  }

  // As Residual(), each observation on the plane that is nearest to it: where
  // planes meet inside a superpixel, none of them explains it alone.
  float ResidualOfNearest(const Superpixel& superpixel,
                          const std::vector<CurvedSurface>& planes) const {
    float sum = 0.f;
    for (const Observation& observation : superpixel.observations) {
      float share = 1.f;
      for (const CurvedSurface& plane : planes) {
        share = std::min(
            share,
            Difference(observation.sample, plane) / options_.labels.tolerance);
      }
      sum += observation.quality * share * share;
    }
    return sum / superpixel.quality;
  }

  // Whether the surface explains its members better than planes do, each
  // observation on the nearest of those in and around them.
  bool BeatsPlanesAround(const Group& group) const {
    const std::vector<CurvedSurface> planes = PlanesAround(group.members);
    double fall = 0.0;
    double mass = 0.0;
    for (const int s : group.members) {
      fall += At(s).mass * (ResidualOfNearest(At(s), planes) -
                            Residual(At(s), group.surface));
      mass += At(s).mass;
    }
    return fall >= options_.min_improvement * mass;
  }

  // Whether it fits, is known where it lies and does not bend too much.
  bool IsSound(const Group& group) const {
    double residual = 0.0;
    double mass = 0.0;
    for (const int s : group.members) {
      residual += At(s).mass * Residual(At(s), group.surface);
      mass += At(s).mass;
    }
    const float* c = group.surface.coefficients;
    const float sagitta =
        (std::abs(c[3]) + std::abs(c[4]) + std::abs(c[5])) / c[0];
    return residual <= options_.max_residual * mass &&
           BeatsPlanesAround(group) && c[0] > 0.f &&
           sagitta <= options_.max_sagitta &&
           std::all_of(group.members.begin(), group.members.end(), [&](int s) {
             return IsKnown(group, At(s));
           });
  }

  // By how much the criterion falls beyond the least, in the units of costs.
  double Gain(const Group& group) const {
    const double cost_of_parameter = CostOfParameter(group.members);
    double gain = -Loss(group, group.members) -
                  kNumParameters * cost_of_parameter -
                  ToCost(options_.min_gain);
    for (int k = 0; k < static_cast<int>(labeled_.planes.size()); ++k) {
      std::vector<int> of_plane;
      std::copy_if(group.members.begin(),
                   group.members.end(),
                   std::back_inserter(of_plane),
                   [&](int s) { return LabelOf(s) == k; });
      if (IsWhole(k, of_plane)) {
        gain += kNumParametersOfPlane * cost_of_parameter;
      }
    }
    return gain;
  }

  // Adds superpixels without measurements, but with measured members all
  // around, unless their plane was carried there by other views.
  void FillBetween(Group* group) const {
    const std::vector<int> measured = group->members;
    std::vector<char> is_seen(superpixels_.size(), 0);
    for (const int s : measured) {
      is_seen[static_cast<size_t>(s)] = 1;
    }
    std::set<int> replaced;
    for (const int s : measured) {
      replaced.insert(LabelOf(s));
    }
    std::vector<int>& members = group->members;
    for (size_t i = 0; i < members.size(); ++i) {
      // Not a reference: the list grows.
      const int s = members[i];
      for (const int t : At(s).neighbors) {
        char& seen = is_seen[static_cast<size_t>(t)];
        if (seen) {
          continue;
        }
        seen = 1;
        if (!At(t).IsMeasured() && !IsTaken(t) &&
            (LabelOf(t) < 0 ? !OpposesRegion(t, group->surface)
                            : replaced.count(LabelOf(t)) > 0) &&
            IsSurrounded(At(t), measured) && IsKnown(*group, At(t)) &&
            Cost(At(t), group->surface) <= At(t).cost) {
          members.push_back(t);
        }
      }
    }
    std::sort(members.begin(), members.end());
  }

  // Whether the superpixel lies in a region whose plane is another surface.
  bool OpposesRegion(int s, const CurvedSurface& surface) const {
    const auto i = static_cast<size_t>(s);
    const auto begin = evidence_.observations.begin();
    return std::any_of(begin + evidence_.first_observation[i],
                       begin + evidence_.first_observation[i + 1],
                       [&](const Observation& observation) {
                         return Difference(observation.sample, surface) >
                                options_.labels.tolerance;
                       });
  }

  bool IsSurrounded(const Superpixel& superpixel,
                    const std::vector<int>& measured) const {
    unsigned sectors = 0;
    for (const int s : measured) {
      const float x = At(s).middle.x - superpixel.middle.x;
      const float y = At(s).middle.y - superpixel.middle.y;
      const unsigned sector = (x > 0.f ? 1u : 0u) | (y > 0.f ? 2u : 0u) |
                              (std::abs(x) > std::abs(y) ? 4u : 0u);
      sectors |= 1u << sector;
    }
    int count = 0;
    for (int i = 0; i < 8; ++i) {
      count += static_cast<int>(sectors >> i & 1u);
    }
    return count >= kSectorsKnown;
  }

  LabelEvidence EvidenceOf(const Superpixel& superpixel,
                           const CurvedSurface& surface) const {
    if (superpixel.IsMeasured() && Residual(superpixel, surface) < 1.f) {
      return LabelEvidence::kMeasured;
    }
    int num_tests = 0;
    return AskWitnesses(superpixel, surface, &num_tests).confirmed > 0
               ? LabelEvidence::kCarried
               : LabelEvidence::kGuessed;
  }

  const ViewEvidence& evidence_;
  Intrinsics intrinsics_;
  DisparityScale scale_;
  const LabeledView& labeled_;
  const CurvedSurfaceOptions& options_;
  std::vector<Witness> witnesses_;
  std::vector<Superpixel> superpixels_;
  // By a surface.
  std::vector<char> taken_;
};

}  // namespace

CurvedView FindCurvedSurfaces(const std::vector<ObservedView>& views,
                              const LabeledView& labeled,
                              const CurvedSurfaceOptions& options) {
  return Finder(views, labeled, options).Find();
}

}  // namespace tsar
