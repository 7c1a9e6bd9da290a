// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <cstdint>

namespace tsar {

// Counter-based random numbers: Philox 4x32 with 10 rounds (Salmon et al.,
// "Parallel Random Numbers: As Easy as 1, 2, 3", SC 2011). The stream is a pure
// function of (key, counter), so results depend neither on threads nor on the
// order of work.
class Philox {
 public:
  // The stream for one draw site, e.g. (image, region, iteration); another seed
  // gives every site another stream.
  TSAR_HD Philox(uint32_t image,
                 uint32_t region,
                 uint32_t iteration,
                 uint32_t seed = 0)
      : key0_(image),
        key1_(0x5EEDu ^ seed),
        counter1_(region),
        counter2_(iteration) {}

  // Continues with the given block of four numbers of the stream, so that many
  // threads can draw separate blocks from one stream.
  TSAR_HD void SkipToBlock(uint32_t block) {
    counter0_ = block;
    used_ = 4;
  }

  // A uniformly distributed 32-bit number.
  TSAR_HD uint32_t Next() {
    if (used_ == 4) {
      Refill();
    }
    return block_[used_++];
  }

  // A uniformly distributed number in [0, bound); bound must not be 0. The bias
  // of the multiply-shift is below bound / 2^32.
  TSAR_HD uint32_t NextBelow(uint32_t bound) {
    return static_cast<uint32_t>((static_cast<uint64_t>(Next()) * bound) >> 32);
  }

  // A uniformly distributed number in [0, 1).
  TSAR_HD float NextFloat() { return (Next() >> 8) * (1.f / 16777216.f); }

 private:
  TSAR_HD void Refill() {
    uint32_t c0 = counter0_++;
    uint32_t c1 = counter1_;
    uint32_t c2 = counter2_;
    uint32_t c3 = 0;
    uint32_t k0 = key0_;
    uint32_t k1 = key1_;
    for (int round = 0; round < 10; ++round) {
      const uint64_t product0 = static_cast<uint64_t>(0xD2511F53u) * c0;
      const uint64_t product1 = static_cast<uint64_t>(0xCD9E8D57u) * c2;
      const uint32_t high0 = static_cast<uint32_t>(product0 >> 32);
      const uint32_t high1 = static_cast<uint32_t>(product1 >> 32);
      c0 = high1 ^ c1 ^ k0;
      c2 = high0 ^ c3 ^ k1;
      c1 = static_cast<uint32_t>(product1);
      c3 = static_cast<uint32_t>(product0);
      k0 += 0x9E3779B9u;
      k1 += 0xBB67AE85u;
    }
    block_[0] = c0;
    block_[1] = c1;
    block_[2] = c2;
    block_[3] = c3;
    used_ = 0;
  }

  uint32_t key0_;
  uint32_t key1_;
  uint32_t counter0_ = 0;
  uint32_t counter1_;
  uint32_t counter2_;
  uint32_t block_[4] = {};
  int used_ = 4;
};

}  // namespace tsar
