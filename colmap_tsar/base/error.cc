// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"

#include <filesystem>
#include <new>

#include <opencv2/core.hpp>

namespace tsar {

bool IsOutOfMemory(const std::exception_ptr& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (const std::bad_alloc&) {
    return true;
  } catch (const cv::Exception& error) {
    return error.code == cv::Error::StsNoMem;
  } catch (...) {
    return false;
  }
}

std::string FailureText(const std::exception_ptr& failure) {
  if (IsOutOfMemory(failure)) {
    return kOutOfMemory;
  }
  try {
    std::rethrow_exception(failure);
  } catch (const Error& error) {
    return error.what();
  } catch (const std::filesystem::filesystem_error& error) {
    return error.path1().string() + ": " + error.code().message() +
           "; check the path and its permissions";
  } catch (const std::exception& error) {
    return std::string("unexpected failure: ") + error.what();
  } catch (...) {
    return "unexpected failure";
  }
}

}  // namespace tsar
