// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Connected components by a union-find that all pixels build in parallel.
// Included by .cu files only.

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/atomic.h"
#include "colmap_tsar/device/parallel_for.h"

namespace tsar {

enum class Connectivity { kFour, kEight };

// The root of the tree that element i of a union-find belongs to; a root is its
// own parent.
TSAR_HD inline int FindRoot(const int* parents, int i) {
  int parent = AtomicLoad(parents + i);
  while (parent != i) {
    i = parent;
    parent = AtomicLoad(parents + i);
  }
  return i;
}

// Joins two trees under the smaller root. If another thread moves a root
// between reading and writing, the loop continues from the new one.
TSAR_HD inline void UniteRoots(int* parents, int a, int b) {
  while (true) {
    a = FindRoot(parents, a);
    b = FindRoot(parents, b);
    if (a == b) {
      return;
    }
    const int high = a > b ? a : b;
    const int low = a > b ? b : a;
    const int previous = AtomicMin(parents + high, low);
    if (previous == high) {
      return;
    }
    a = previous;
    b = low;
  }
}

namespace internal {

// Length of the pieces of rows that are the initial trees, so that few links
// between pixels need atomic operations.
constexpr int kRowPiece = 32;

// Sets the parent of each pixel to the first pixel of its run, the sequence of
// joined pixels in its piece of the row.
template <typename Relation>
struct JoinRowPieces {
  ImageView<int> labels;
  Relation relation;

  TSAR_HD void operator()(int x, int y) const {
    const int i = static_cast<int>(labels.Index(x, y));
    if (!relation.Contains(i)) {
      labels.data[i] = -1;
      return;
    }
    const int first_in_piece = i - x % kRowPiece;
    int first = i;
    while (first > first_in_piece && relation.Contains(first - 1) &&
           relation.Connected(first - 1, first)) {
      --first;
    }
    labels.data[i] = first;
  }
};

// Joins pixels of different rows or pieces. A link is omitted if three others
// around the same corner imply it.
template <typename Relation>
struct UniteNeighbors {
  ImageView<int> labels;
  Relation relation;
  bool eight;

  TSAR_HD bool Joined(int x0, int y0, int x1, int y1) const {
    if (!labels.Contains(x0, y0) || !labels.Contains(x1, y1)) {
      return false;
    }
    const int i = static_cast<int>(labels.Index(x0, y0));
    const int j = static_cast<int>(labels.Index(x1, y1));
    return relation.Contains(i) && relation.Contains(j) &&
           relation.Connected(i < j ? i : j, i < j ? j : i);
  }
  TSAR_HD void Unite(int x0, int y0, int x1, int y1) const {
    UniteRoots(labels.data,
               static_cast<int>(labels.Index(x0, y0)),
               static_cast<int>(labels.Index(x1, y1)));
  }

  TSAR_HD void operator()(int x, int y) const {
    if (!relation.Contains(static_cast<int>(labels.Index(x, y)))) {
      return;
    }
    const bool left = Joined(x - 1, y, x, y);
    if (left && x % kRowPiece == 0) {
      Unite(x - 1, y, x, y);
    }
    const bool below = Joined(x, y, x, y + 1);
    if (below && !(left && Joined(x - 1, y, x - 1, y + 1) &&
                   Joined(x - 1, y + 1, x, y + 1))) {
      Unite(x, y, x, y + 1);
    }
    if (eight) {
      UniteDiagonal(x, y, x + 1, below);
      UniteDiagonal(x, y, x - 1, below);
    }
  }

  TSAR_HD void UniteDiagonal(int x, int y, int other_x, bool below) const {
    if (Joined(x, y, other_x, y + 1) &&
        !(below && Joined(x, y + 1, other_x, y + 1)) &&
        !(Joined(x, y, other_x, y) && Joined(other_x, y, other_x, y + 1))) {
      Unite(x, y, other_x, y + 1);
    }
  }
};

struct FlattenKernel {
  ImageView<int> parents;
  TSAR_HD void operator()(int64_t i) const {
    if (AtomicLoad(parents.data + i) >= 0) {
      // Roots never change here, so the result does not depend on the order of
      // reads and writes.
      const int root = FindRoot(parents.data, static_cast<int>(i));
      AtomicMin(parents.data + i, root);
    }
  }
};

struct CountComponents {
  ImageView<const int> labels;
  int* sizes;
  TSAR_HD void operator()(int64_t i) const {
    if (labels.data[i] >= 0) {
      AtomicAdd(sizes + labels.data[i], 1);
    }
  }
};

}  // namespace internal

// Sets the parent of every element of a union-find to its root. Negative
// elements are skipped.
inline void FlattenTrees(Device& device, ImageView<int> parents) {
  ParallelFor(device,
              static_cast<int64_t>(parents.NumPixels()),
              internal::FlattenKernel{parents});
}

// Labels every pixel with the smallest pixel index of its component, or with -1
// where the pixel takes no part. Relation has two TSAR_HD members:
//   bool Contains(int i) const            whether pixel i takes part,
//   bool Connected(int i, int j) const    whether neighbors i < j are joined.
template <typename Relation>
void LabelComponents(Device& device,
                     const Relation& relation,
                     Connectivity connectivity,
                     ImageView<int> labels) {
  ParallelFor(device,
              labels.width,
              labels.height,
              internal::JoinRowPieces<Relation>{labels, relation});
  ParallelFor(device,
              labels.width,
              labels.height,
              internal::UniteNeighbors<Relation>{
                  labels, relation, connectivity == Connectivity::kEight});
  FlattenTrees(device, labels);
}

// sizes[label] = number of pixels with that label; sizes must hold zeros and
// have one element per pixel.
inline void CountComponentPixels(Device& device,
                                 ImageView<const int> labels,
                                 int* sizes) {
  ParallelFor(device,
              static_cast<int64_t>(labels.NumPixels()),
              internal::CountComponents{labels, sizes});
}

}  // namespace tsar
