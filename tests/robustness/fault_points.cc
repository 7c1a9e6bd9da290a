// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// A library for LD_PRELOAD that counts the calls by which a program changes
// files, and ends or stops the program at one of them:
//
//   TSAR_FAULT_LOG=FILE      appends a line for every call, in their order
//   TSAR_FAULT_KILL_AT=K     SIGKILL before call number K (from 1 on); where
//                            that is a write, after half of it
//   TSAR_FAULT_STOP_AT=K     SIGSTOP before call number K
//   TSAR_FAULT_NO_EXCHANGE=1 the file system cannot exchange two names
//
// Calls on descriptors count where these stand for files and folders, not for
// terminals and pipes.
//
// Or it gives less than a program asks for, which is counted apart:
//
//   TSAR_FAULT_NO_THREADS_FROM=K   no thread from the K-th on
//   TSAR_FAULT_NO_MEMORY_AT=K      no memory at the K-th call of operator new
//   TSAR_FAULT_NO_MEMORY_FROM=K    nor at any after it
//   TSAR_FAULT_NO_ADDRESSES_FROM=K   no more from the system from that call on:
//                                  the program may reuse what it holds

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

std::atomic<long> num_calls = 0;

long NumberOf(const char* variable) {
  const char* text = std::getenv(variable);
  return text == nullptr ? 0 : std::atol(text);
}

bool IsOnDisk(int descriptor) {
  struct stat state;
  return fstat(descriptor, &state) == 0 &&
         (S_ISREG(state.st_mode) || S_ISDIR(state.st_mode));
}

std::string PathOf(int descriptor) {
  char path[4096];
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t length = readlink(link.c_str(), path, sizeof(path));
  return std::string(path, static_cast<size_t>(std::max<ssize_t>(length, 0)));
}

// The path of a name in an open folder.
std::string PathAt(int folder, const char* name) {
  return folder == AT_FDCWD || name[0] == '/' ? name
                                              : PathOf(folder) + "/" + name;
}

void Log(const std::string& line) {
  static const char* const path = std::getenv("TSAR_FAULT_LOG");
  if (path == nullptr) {
    return;
  }
  static const auto log = static_cast<int>(
      syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND, 0666));
  const std::string text = line + "\n";
  syscall(SYS_write, log, text.data(), text.size());
}

// Counts a call; whether the program is to end at it.
bool IsLast(const std::string& name,
            const std::string& first,
            const std::string& second = "") {
  static const long kill_at = NumberOf("TSAR_FAULT_KILL_AT");
  static const long stop_at = NumberOf("TSAR_FAULT_STOP_AT");
  const long number = ++num_calls;
  Log(name + "\t" + first + "\t" + second);
  if (number == stop_at) {
    raise(SIGSTOP);
  }
  return number == kill_at;
}

void Note(const std::string& name,
          const std::string& first,
          const std::string& second = "") {
  if (IsLast(name, first, second)) {
    raise(SIGKILL);
  }
}

// What would be called without this library.
template <typename Function, typename... Arguments>
auto CallNext(const char* name, Function*, Arguments... arguments) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name))(arguments...);
}

mode_t ModeOf(int flags, va_list arguments) {
  return (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = ModeOf(flags, arguments);
  va_end(arguments);
  if ((flags & O_CREAT) != 0) {
    Note("create", path);
  }
  return CallNext("open", open, path, flags, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = ModeOf(flags, arguments);
  va_end(arguments);
  if ((flags & O_CREAT) != 0) {
    Note("create", PathAt(folder, path));
  }
  return CallNext("openat", openat, folder, path, flags, mode);
}

ssize_t write(int descriptor, const void* data, size_t size) {
  if (IsOnDisk(descriptor) && IsLast("write", PathOf(descriptor))) {
    CallNext("write", write, descriptor, data, size / 2);
    raise(SIGKILL);
  }
  return CallNext("write", write, descriptor, data, size);
}

ssize_t writev(int descriptor, const iovec* parts, int num_parts) {
  if (IsOnDisk(descriptor) && IsLast("write", PathOf(descriptor))) {
    CallNext("writev", writev, descriptor, parts, num_parts / 2);
    raise(SIGKILL);
  }
  return CallNext("writev", writev, descriptor, parts, num_parts);
}

int fsync(int descriptor) {
  if (IsOnDisk(descriptor)) {
    Note("fsync", PathOf(descriptor));
  }
  return CallNext("fsync", fsync, descriptor);
}

int rename(const char* from, const char* to) noexcept {
  Note("rename", from, to);
  return CallNext("rename", rename, from, to);
}

int renameat2(int from_folder,
              const char* from,
              int to_folder,
              const char* to,
              unsigned flags) noexcept {
  if ((flags & RENAME_EXCHANGE) != 0 && NumberOf("TSAR_FAULT_NO_EXCHANGE")) {
    errno = EINVAL;
    return -1;
  }
  Note("rename", PathAt(from_folder, from), PathAt(to_folder, to));
  return CallNext(
      "renameat2", renameat2, from_folder, from, to_folder, to, flags);
}

int linkat(int from_folder,
           const char* from,
           int to_folder,
           const char* to,
           int flags) noexcept {
  Note("link", PathAt(from_folder, from), PathAt(to_folder, to));
  return CallNext("linkat", linkat, from_folder, from, to_folder, to, flags);
}

int symlink(const char* target, const char* link) noexcept {
  Note("symlink", target, link);
  return CallNext("symlink", symlink, target, link);
}

int symlinkat(const char* target, int folder, const char* link) noexcept {
  Note("symlink", target, PathAt(folder, link));
  return CallNext("symlinkat", symlinkat, target, folder, link);
}

int unlink(const char* path) noexcept {
  Note("unlink", path);
  return CallNext("unlink", unlink, path);
}

int unlinkat(int folder, const char* path, int flags) noexcept {
  Note((flags & AT_REMOVEDIR) != 0 ? "rmdir" : "unlink", PathAt(folder, path));
  return CallNext("unlinkat", unlinkat, folder, path, flags);
}

int remove(const char* path) noexcept {
  Note("unlink", path);
  return CallNext("remove", remove, path);
}

int rmdir(const char* path) noexcept {
  Note("rmdir", path);
  return CallNext("rmdir", rmdir, path);
}

int mkdir(const char* path, mode_t mode) noexcept {
  Note("mkdir", path);
  return CallNext("mkdir", mkdir, path, mode);
}

int pthread_create(pthread_t* thread,
                   const pthread_attr_t* attributes,
                   void* (*function)(void*),
                   void* argument) noexcept {
  static const long from = NumberOf("TSAR_FAULT_NO_THREADS_FROM");
  static std::atomic<long> num_threads = 0;
  if (++num_threads >= from && from > 0) {
    return EAGAIN;
  }
  return CallNext(
      "pthread_create", pthread_create, thread, attributes, function, argument);
}

}  // extern "C"

void* operator new(size_t size) {
  static const long at = NumberOf("TSAR_FAULT_NO_MEMORY_AT");
  static const long from = NumberOf("TSAR_FAULT_NO_MEMORY_FROM");
  static const long limit_from = NumberOf("TSAR_FAULT_NO_ADDRESSES_FROM");
  static std::atomic<long> num_allocations = 0;
  const long number = ++num_allocations;
  if (number == from || number == limit_from) {
    const rlimit nothing = {0, 0};
    setrlimit(RLIMIT_AS, &nothing);
  }
  void* const memory = number == at || (number >= from && from > 0)
                           ? nullptr
                           : std::malloc(std::max<size_t>(size, 1));
  if (memory == nullptr) {
    throw std::bad_alloc();
  }
  return memory;
}

void operator delete(void* memory) noexcept { std::free(memory); }

void operator delete(void* memory, size_t /*size*/) noexcept {
  std::free(memory);
}
