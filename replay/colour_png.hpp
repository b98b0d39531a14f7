// SPDX-License-Identifier: MIT
// Writes pictures for people.
#pragma once

#include <filesystem>

#include "core/colour_image.hpp"

namespace rptv {

/// An RGB PNG. Throws Error(io or permission) and leaves no half-written file behind.
void write_colour_png(const std::filesystem::path& file, const ColourImage& image);

}  // namespace rptv
