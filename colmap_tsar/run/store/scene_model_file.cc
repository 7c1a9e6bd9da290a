// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/scene_model_file.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/scene/find_scene.h"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

namespace tsar {
namespace {

static_assert(sizeof(LabelOrigin) == 1 && sizeof(LabelQuality) == 4);

// Calls `use` for each number, vector and matrix of a plane or a cylinder, in
// the order of the file.
template <typename Plane>
requires std::same_as<std::remove_const_t<Plane>, ModelPlane>
void ForEachNumber(Plane& plane, const auto& use) {
  use(plane.plane.normal);
  use(plane.plane.offset);
  use(plane.center);
  use(plane.axis_s);
  use(plane.axis_t);
  use(plane.covariance);
  use(plane.support);
  use(plane.component);
  use(plane.frame);
  use(plane.axis);
}
template <typename Cylinder>
requires std::same_as<std::remove_const_t<Cylinder>, ModelCylinder>
void ForEachNumber(Cylinder& cylinder, const auto& use) {
  use(cylinder.point);
  use(cylinder.frame.along);
  use(cylinder.frame.across);
  use(cylinder.radius);
  use(cylinder.min_height);
  use(cylinder.max_height);
  use(cylinder.covariance);
}
template <typename Matrix>
requires std::same_as<std::remove_const_t<Matrix>, Eigen::Matrix3d>
void ForEachNumber(Matrix& matrix, const auto& use) { use(matrix); }

// All numbers of the elements one after the other; matrices by columns.
template <typename Element>
std::vector<double> NumbersOf(const std::vector<Element>& elements) {
  std::vector<double> numbers;
  for (const Element& element : elements) {
    ForEachNumber(element, [&](const auto& value) {
      if constexpr (requires { value.data(); }) {
        numbers.insert(
            numbers.end(), value.data(), value.data() + value.size());
      } else {
        numbers.push_back(value);
      }
    });
  }
  return numbers;
}

template <typename Element>
std::vector<Element> FromNumbers(const std::vector<double>& numbers) {
  const size_t size = NumbersOf(std::vector<Element>(1)).size();
  std::vector<Element> elements(numbers.size() / size);
  const double* next = numbers.data();
  for (Element& element : elements) {
    ForEachNumber(element, [&](auto& value) {
      if constexpr (requires { value.data(); }) {
        std::copy_n(next, value.size(), value.data());
        next += value.size();
      } else {
        value = static_cast<std::remove_reference_t<decltype(value)>>(*next++);
      }
    });
  }
  return elements;
}

// The numbers of planes, frames and cylinders.
using Numbers = std::array<std::vector<double>, 3>;

// Returns their checksum.
uint64_t ReadNumbers(StateFileReader* reader, Numbers* numbers) {
  for (std::vector<double>& array : *numbers) {
    reader->Read(&array);
  }
  return reader->EndPart();
}

void WarnOfPlanesWithoutName(size_t num_planes) {
  if (num_planes > size_t{kMaxPlanesOfMap}) {
    Warn("the scene has " + std::to_string(num_planes) +
         " planes, of which plane maps can name " +
         std::to_string(kMaxPlanesOfMap) + ": the " +
         std::to_string(num_planes - size_t{kMaxPlanesOfMap}) +
         " that least was measured of are missing in stereo/plane_maps, and "
         "tsar_planes gives them no outlines; depths and normals, and the "
         "list of planes in stereo/tsar/planes.bin, are complete");
  }
}

void Write(const ContainedPath& path,
           const std::string& key,
           const SceneModel& model) {
  const Numbers numbers = {NumbersOf(model.planes),
                           NumbersOf(model.frames),
                           NumbersOf(model.cylinders)};
  StateFileWriter writer;
  for (const std::vector<double>& array : numbers) {
    writer.Add(array);
  }
  writer.EndPart();
  std::vector<int> images;
  for (const auto& [image, view] : model.views) {
    images.push_back(image);
  }
  writer.Add(images);
  for (const auto& [image, view] : model.views) {
    writer.Add(view.planes);
    writer.Add(view.origins);
    writer.Add(view.qualities);
  }
  writer.EndPart();
  writer.Write(path, kSceneModelFile, key);
}

}  // namespace

ContainedPath GetSceneModelPath(const std::filesystem::path& root) {
  return GetTsarFolder(root) / "planes.bin";
}

void WriteSceneModel(const ContainedPath& path,
                     const std::string& key,
                     const SceneModel& model) {
  WarnOfPlanesWithoutName(model.planes.size());
  Write(path, key, model);
}

SceneModel ReadSceneModel(const std::filesystem::path& path,
                          SceneModelParts parts) {
  StateFileReader reader(path, kSceneModelFile);
  Numbers numbers;
  ReadNumbers(&reader, &numbers);
  SceneModel model = {FromNumbers<ModelPlane>(numbers[0]),
                      FromNumbers<Eigen::Matrix3d>(numbers[1]),
                      FromNumbers<ModelCylinder>(numbers[2]),
                      {}};
  if (parts == SceneModelParts::kAll) {
    std::vector<int> images;
    reader.Read(&images);
    for (const int image : images) {
      ViewLabels& view = model.views[image];
      reader.Read(&view.planes);
      reader.Read(&view.origins);
      reader.Read(&view.qualities);
    }
    reader.EndPart();
  }
  return model;
}

std::optional<uint64_t> ReadScenePlanesFingerprint(
    const std::filesystem::path& path) {
  try {
    StateFileReader reader(path, kSceneModelFile);
    Numbers numbers;
    return ReadNumbers(&reader, &numbers);
  } catch (const Error&) {
    return std::nullopt;
  }
}

void DropSceneLabels(const ContainedPath& path) {
  const std::string key = ReadStateFileKey(path, kSceneModelFile).value_or("");
  const size_t end = key.find(' ');
  if (end != std::string::npos) {
    Write(path,
          key.substr(0, end),
          ReadSceneModel(path, SceneModelParts::kWithoutLabels));
  }
}

}  // namespace tsar
