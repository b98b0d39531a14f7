// SPDX-License-Identifier: MIT
// How Aravis' objects and error texts are let go.
#include "acquisition/aravis_handle.hpp"

#include <arv.h>

namespace rptv {

void DropObject::operator()(void* object) const noexcept { g_object_unref(object); }

void ArvFailure::clear() noexcept { g_clear_error(&error_); }

std::string ArvFailure::text() const { return error_ == nullptr ? std::string() : error_->message; }

}  // namespace rptv
