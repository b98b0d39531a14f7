// SPDX-License-Identifier: MIT
// Owners of Aravis' objects and of its error texts; for the aravis_*.cpp files only.
#pragma once

#include <arv.h>

#include <memory>
#include <string>
#include <utility>

namespace rptv {

struct DropObject {
  void operator()(void* object) const noexcept { g_object_unref(object); }
};
using CameraHandle = std::unique_ptr<ArvCamera, DropObject>;
using StreamHandle = std::unique_ptr<ArvStream, DropObject>;
using BufferHandle = std::unique_ptr<ArvBuffer, DropObject>;

/// Where an Aravis call leaves its error: pass out(), then ask.
class ArvFailure {
 public:
  ArvFailure() = default;
  ~ArvFailure() { g_clear_error(&error_); }
  ArvFailure(const ArvFailure&) = delete;
  ArvFailure& operator=(const ArvFailure&) = delete;
  GError** out() noexcept {
    g_clear_error(&error_);
    return &error_;
  }
  explicit operator bool() const noexcept { return error_ != nullptr; }
  std::string text() const { return error_ == nullptr ? std::string() : error_->message; }

 private:
  GError* error_ = nullptr;
};

}  // namespace rptv
