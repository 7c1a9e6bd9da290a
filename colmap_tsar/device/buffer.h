// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/device.h"

#include <cstddef>
#include <memory>
#include <type_traits>
#include <vector>

namespace tsar {

// An array in a device's memory, freed with this object. The device must
// outlive it.
template <typename T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Buffer() = default;
  Buffer(Device& device, size_t size)
      : data_(size > 0 ? static_cast<T*>(device.Allocate(size * sizeof(T)))
                       : nullptr,
              {&device}),
        size_(size) {}
  Buffer(Device& device, const std::vector<T>& host)
      : Buffer(device, host.size()) {
    Upload(host.data());
  }

  T* Data() { return data_.get(); }
  const T* Data() const { return data_.get(); }
  // 0 after the content was moved to another object.
  size_t Size() const { return data_ ? size_ : 0; }

  void Upload(const T* host) {
    if (Size() > 0) {
      Owner().CopyToDevice(Data(), host, size_ * sizeof(T));
    }
  }
  void Download(T* host) const {
    if (Size() > 0) {
      Owner().CopyToHost(host, Data(), size_ * sizeof(T));
    }
  }
  std::vector<T> ToHost() const {
    std::vector<T> host(Size());
    Download(host.data());
    return host;
  }

 private:
  struct Free {
    Device* device = nullptr;
    void operator()(T* data) const {
      // Only an object without data has no device.
      if (device != nullptr) {
        device->Free(data);
      }
    }
  };

  Device& Owner() const { return *data_.get_deleter().device; }

  std::unique_ptr<T, Free> data_;
  size_t size_ = 0;
};

// A raster in a device's memory; see Image for the layout.
template <typename T>
class DeviceImage {
 public:
  DeviceImage() = default;
  DeviceImage(Device& device, int width, int height)
      : width_(width),
        height_(height),
        buffer_(device,
                static_cast<size_t>(width) * static_cast<size_t>(height)) {}
  DeviceImage(Device& device, const Image<T>& host)
      : DeviceImage(device, host.Width(), host.Height()) {
    buffer_.Upload(host.Data());
  }

  int Width() const { return width_; }
  int Height() const { return height_; }
  bool Empty() const { return buffer_.Size() == 0; }
  ImageView<T> View() { return {buffer_.Data(), width_, height_}; }
  ImageView<const T> View() const { return {buffer_.Data(), width_, height_}; }

  Image<T> ToHost() const {
    Image<T> host = Image<T>::Uninitialized(width_, height_);
    buffer_.Download(host.Data());
    return host;
  }

 private:
  int width_ = 0;
  int height_ = 0;
  Buffer<T> buffer_;
};

}  // namespace tsar
