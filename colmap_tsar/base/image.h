// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace tsar {

// Color of one pixel, 0-255 per channel.
struct Rgb {
  uint8_t r = 0;
  uint8_t g = 0;
  uint8_t b = 0;
};

// The luminance of a color, 0 to 255, with the weights of Rec. 601.
TSAR_HD inline float GrayLevel(const Rgb& color) {
  return 0.299f * color.r + 0.587f * color.g + 0.114f * color.b;
}

// A view of a row-major raster owned elsewhere, in host or device memory. Pixel
// (x, y) is column x, row y. Views are copied by value into kernels.
template <typename T>
struct ImageView {
  T* data = nullptr;
  int width = 0;
  int height = 0;

  TSAR_HD size_t NumPixels() const {
    return static_cast<size_t>(width) * static_cast<size_t>(height);
  }
  TSAR_HD bool Empty() const { return data == nullptr || NumPixels() == 0; }
  TSAR_HD bool Contains(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height;
  }
  TSAR_HD size_t Index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + x;
  }
  TSAR_HD T& operator()(int x, int y) const { return data[Index(x, y)]; }

  template <typename U>
  requires std::is_same_v<U, T> TSAR_HD operator ImageView<const U>() const {
    return {data, width, height};
  }
};

// Memory of an image, to be freed by std::free. Large images are in huge pages
// where the system has them, since most of their time would be spent on page
// faults. Throws std::bad_alloc.
void* AllocatePixels(size_t num_bytes);

// A vector's allocator that leaves elements without a value uninitialized.
template <typename T>
struct PixelAllocator : std::allocator<T> {
  template <typename U>
  struct rebind {
    using other = PixelAllocator<U>;
  };

  T* allocate(size_t count) {
    return static_cast<T*>(AllocatePixels(count * sizeof(T)));
  }
  void deallocate(T* pixels, size_t) { std::free(pixels); }

  template <typename U>
  void construct(U*) {}
  template <typename U, typename... Arguments>
  void construct(U* element, Arguments&&... arguments) {
    ::new (static_cast<void*>(element))
        U(std::forward<Arguments>(arguments)...);
  }
};

// A row-major raster in host memory.
template <typename T>
class Image {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Image() = default;
  Image(int width, int height, const T& value = T())
      : width_(width),
        height_(height),
        data_(static_cast<size_t>(width) * static_cast<size_t>(height), value) {
  }

  // An image of undefined pixels, for callers that set every pixel.
  static Image Uninitialized(int width, int height) {
    Image image;
    image.width_ = width;
    image.height_ = height;
    image.data_.resize(static_cast<size_t>(width) *
                       static_cast<size_t>(height));
    return image;
  }

  int Width() const { return width_; }
  int Height() const { return height_; }
  size_t NumPixels() const { return data_.size(); }
  bool Empty() const { return data_.empty(); }
  bool Contains(int x, int y) const { return View().Contains(x, y); }
  template <typename U>
  bool HasSizeOf(const Image<U>& other) const {
    return width_ == other.Width() && height_ == other.Height();
  }

  T& operator()(int x, int y) { return View()(x, y); }
  const T& operator()(int x, int y) const { return View()(x, y); }

  T* Data() { return data_.data(); }
  const T* Data() const { return data_.data(); }
  auto begin() { return data_.begin(); }
  auto end() { return data_.end(); }
  auto begin() const { return data_.begin(); }
  auto end() const { return data_.end(); }

  ImageView<T> View() { return {data_.data(), width_, height_}; }
  ImageView<const T> View() const { return {data_.data(), width_, height_}; }

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<T, PixelAllocator<T>> data_;
};

}  // namespace tsar
