// SPDX-License-Identifier: MIT
// Owners of Aravis' objects and of its error texts, without its header; for the aravis_* files only.
#pragma once

#include <memory>
#include <string>

typedef struct _ArvCamera ArvCamera;
typedef struct _ArvStream ArvStream;
typedef struct _ArvBuffer ArvBuffer;
typedef struct _GError GError;

namespace rptv {

struct DropObject {
  void operator()(void* object) const noexcept;
};
using CameraHandle = std::unique_ptr<ArvCamera, DropObject>;
using StreamHandle = std::unique_ptr<ArvStream, DropObject>;
using BufferHandle = std::unique_ptr<ArvBuffer, DropObject>;

/// Where an Aravis call leaves its error: pass out(), then ask.
class ArvFailure {
 public:
  ArvFailure() = default;
  ~ArvFailure() { clear(); }
  ArvFailure(const ArvFailure&) = delete;
  ArvFailure& operator=(const ArvFailure&) = delete;
  GError** out() noexcept {
    clear();
    return &error_;
  }
  explicit operator bool() const noexcept { return error_ != nullptr; }
  std::string text() const;

 private:
  void clear() noexcept;
  GError* error_ = nullptr;
};

}  // namespace rptv
