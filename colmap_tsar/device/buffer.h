// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/device.h"

#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

namespace tsar {

// An array in a device's memory, freed with this object. The device must
// outlive it.
template <typename T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Buffer() = default;
  Buffer(Device& device, size_t size) : device_(&device), size_(size) {
    if (size > 0) {
      data_ = static_cast<T*>(device.Allocate(size * sizeof(T)));
    }
  }
  Buffer(Device& device, const std::vector<T>& host)
      : Buffer(device, host.size()) {
    Upload(host.data());
  }
  Buffer(Buffer&& other) noexcept { Swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    Buffer moved(std::move(other));
    Swap(moved);
    return *this;
  }
  ~Buffer() {
    if (data_ != nullptr) {
      device_->Free(data_);
    }
  }

  T* Data() { return data_; }
  const T* Data() const { return data_; }
  size_t Size() const { return size_; }

  void Upload(const T* host) {
    if (size_ > 0) {
      device_->CopyToDevice(data_, host, size_ * sizeof(T));
    }
  }
  void Download(T* host) const {
    if (size_ > 0) {
      device_->CopyToHost(host, data_, size_ * sizeof(T));
    }
  }
  std::vector<T> ToHost() const {
    std::vector<T> host(size_);
    Download(host.data());
    return host;
  }

 private:
  void Swap(Buffer& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
  }

  Device* device_ = nullptr;
  T* data_ = nullptr;
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
