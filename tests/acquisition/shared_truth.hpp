// SPDX-License-Identifier: MIT
// A GvspTruth in a file that two processes map.
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <new>
#include <stdexcept>
#include <string>

#include "tests/acquisition/gvsp_truth.hpp"

namespace rptv {

class SharedTruth {
 public:
  /// The maker starts it with zeros; who opens it finds it as it is. Throws std::runtime_error.
  static SharedTruth make(const std::string& file) { return SharedTruth(file, true); }
  static SharedTruth open(const std::string& file) { return SharedTruth(file, false); }
  ~SharedTruth() { munmap(truth_, sizeof(GvspTruth)); }
  SharedTruth(const SharedTruth&) = delete;
  SharedTruth& operator=(const SharedTruth&) = delete;
  GvspTruth& operator*() const { return *truth_; }

 private:
  SharedTruth(const std::string& file, bool make) {
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (descriptor < 0 || ftruncate(descriptor, sizeof(GvspTruth)) != 0)
      throw std::runtime_error("cannot write " + file);
    void* memory = mmap(nullptr, sizeof(GvspTruth), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    close(descriptor);
    if (memory == MAP_FAILED) throw std::runtime_error("cannot map " + file);
    truth_ = make ? new (memory) GvspTruth : static_cast<GvspTruth*>(memory);
  }
  GvspTruth* truth_;
};

}  // namespace rptv
