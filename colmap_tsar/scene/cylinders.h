// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/thread_pool.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <cmath>
#include <cstddef>
#include <mutex>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The known part of a cylinder of the scene, in a camera frame. Kernels read it
// from a buffer.
struct CameraCylinder {
  Vec3f point;  // On the axis, where the known part begins.
  Vec3f axis;   // A unit vector.
  float radius = 0.f;
  float length = 0.f;
  // The directions of the shifts in the covariance of its ModelCylinder, and
  // that covariance.
  Vec3f across;
  Vec3f third;
  Mat3f covariance;

  struct Intersection {
    float depth = 0.f;  // Along the camera's optical axis, > 0.
    Vec3f normal;       // A unit vector that points to the camera.
  };

  // Computes the first intersection of a ray with z = 1 from the camera's
  // center with the outer side. Returns false if there is none or the ray is
  // parallel to the axis.
  TSAR_HD bool Intersect(const Vec3f& ray, Intersection* intersection) const {
    const Vec3f beside = ray - axis * Dot(ray, axis);
    const Vec3f center = point - axis * Dot(point, axis);
    const float a = Dot(beside, beside);
    const float b = Dot(beside, center);
    const float c = Dot(center, center) - radius * radius;
    const float discriminant = b * b - a * c;
    if (!(discriminant > 0.f) || !(c > 0.f) || !(a > 0.f)) {
      return false;
    }
    const float depth = (b - sqrtf(discriminant)) / a;
    const float height = Dot(ray * depth - point, axis);
    intersection->depth = depth;
    intersection->normal = Normalized(beside * depth - center);
    return depth > 0.f && height >= 0.f && height < length;
  }

  // Whether the cylinder faces the camera along a ray with z = 1, rather than
  // being close to its outline. normal: of the cylinder there.
  TSAR_HD static bool FacesCamera(const Vec3f& normal, const Vec3f& ray) {
    return -Dot(normal, ray) > 0.5f * Norm(ray);
  }

  // The variance of the depth at which a ray with z = 1 intersects it.
  TSAR_HD float DepthVariance(const Vec3f& ray, const Vec3f& normal) const {
    // At the outline the depth is not linear in the parameters.
    const float cosine = fmaxf(-Dot(normal, ray), 0.1f * Norm(ray));
    const Vec3f slope = {Dot(normal, across), Dot(normal, third), 1.f};
    return fmaxf(Dot(slope, covariance * slope), 0.f) / (cosine * cosine);
  }
};

std::vector<CameraCylinder> ToCameraCylinders(
    const std::vector<ModelCylinder>& cylinders, const Camera& camera);

// A search for the columns and pipes of a scene along the axes of its Manhattan
// frames: FindOutlines() for each view, then FindCircles() for each axis, then
// Test() with each view. The calls of one step may come from several threads,
// whose number does not change the result. Memory holds the outlines of all
// views until the circles are found.
class CylinderSearch {
 public:
  // neighbors: by view, other views of the same surfaces; must outlive this
  // object.
  CylinderSearch(const std::vector<Eigen::Matrix3d>& frames,
                 const std::vector<std::vector<size_t>>& neighbors);
  ~CylinderSearch();

  size_t NumAxes() const;

  // observed: with the colors of its evidence.
  void FindOutlines(size_t view, const ObservedView& observed);
  // Finds cylinders along an axis by the outlines of all views.
  void FindCircles(size_t axis, ThreadPool& threads);
  bool HasFoundAny() const;
  // observed: with superpixels and confident depths; planes: of the scene;
  // labels: of the view.
  void Test(const ObservedView& observed,
            const std::vector<ModelPlane>& planes,
            const ViewLabels& labels);
  // The cylinders that the views do not contradict. Of those that intersect at
  // the same heights there is one.
  std::vector<ModelCylinder> Result() const;

 private:
  struct Axis;

  const std::vector<std::vector<size_t>>& neighbors_;
  std::vector<Axis> axes_;
  std::mutex mutex_;  // Of the evidence about cylinders.
};

}  // namespace tsar
