// SPDX-License-Identifier: MIT
// Reading the kernel's small files below /sys and /proc, none of which need be there.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace rptv {

/// Without the newline at its end; empty when it cannot be read.
inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::ostringstream copy;
  copy << stream.rdbuf();  // no exception: a link that is down answers a read of its speed with EINVAL
  std::string text = copy.str();
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

/// −1 when it cannot be read; some links without carrier say −1 themselves.
inline long long number_of(const std::filesystem::path& file) {
  const std::string text = text_of(file);
  char* end = nullptr;
  const long long value = std::strtoll(text.c_str(), &end, 10);
  return end == text.c_str() ? -1 : value;
}

/// Entries of a folder in order; empty when it is not there.
inline std::vector<std::filesystem::path> entries(const std::filesystem::path& folder) {
  std::error_code none;
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace rptv
