// SPDX-License-Identifier: MIT
// The doctor on the disk: how fast the folder of the outputs takes data in for good.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <random>
#include <system_error>

#include "core/clock.hpp"
#include "core/descriptor.hpp"
#include "daemon/doctor.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;
using Verdict = Finding::Verdict;

constexpr std::size_t kStepBytes = 8 << 20;  // written, then forced to the disk: what a bound may be late by
constexpr std::size_t kMostBytes = 256 << 20;
constexpr std::int64_t kMostNs = 2'000'000'000;

std::string reason(int error) { return std::generic_category().message(error); }

/// A file that nobody else sees, and that is gone when it is closed, however the process ends.
int open_nameless(const fs::path& folder) {
  std::string name = (folder / ".rapidptv-disk-").string() + std::string(6, 'X');  // mkostemp fills them in
  const int file = mkostemp(name.data(), O_CLOEXEC);
  if (file >= 0) unlink(name.c_str());
  return file;
}

std::vector<char> incompressible() {
  std::vector<char> bytes(kStepBytes);
  std::minstd_rand random(1);
  std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<char>(random() >> 8); });
  return bytes;
}

/// 0, or the error.
int write_step(int file, const std::vector<char>& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = ::write(file, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno != EINTR) return errno;
    done += static_cast<std::size_t>(std::max<ssize_t>(written, 0));
  }
  return fdatasync(file) == 0 ? 0 : errno;
}

}  // namespace

Finding examine_disk(const fs::path& folder, double needed_bytes_per_second) {
  Finding finding{"disk " + folder.string(), Verdict::ok, {}, {}, {}};
  finding.needed = needed_bytes_per_second > 0
                       ? fmt::format("{:.1f} MB/s when every frame is full", needed_bytes_per_second * 1e-6)
                       : "unknown, as the frame rate is";
  const Descriptor file(open_nameless(folder));
  int error = file.open() ? 0 : errno;
  std::error_code unknown;
  const std::uintmax_t room = fs::space(folder, unknown).available;
  const std::uintmax_t most = unknown ? kStepBytes : std::min<std::uintmax_t>(kMostBytes, room / 4);
  const std::vector<char> bytes = incompressible();
  const std::int64_t start_ns = host_now_ns();
  std::uintmax_t written = 0;
  std::int64_t spent_ns = 0;
  while (error == 0 && written + kStepBytes <= most && spent_ns < kMostNs) {
    error = write_step(file.get(), bytes);
    written += kStepBytes;
    spent_ns = host_now_ns() - start_ns;
  }
  if (error == 0 && written == 0) error = ENOSPC;
  if (error != 0) {
    finding.verdict = Verdict::problem;
    finding.measured = reason(error);
    finding.mend = "free some space, mend the folder's permissions, or choose another one in [output]";
    return finding;
  }
  const double rate = static_cast<double>(written) * 1e9 / static_cast<double>(std::max<std::int64_t>(spent_ns, 1));
  finding.measured = fmt::format("{:.0f} MB/s", rate * 1e-6);
  if (rate < needed_bytes_per_second) {
    finding.verdict = Verdict::warning;
    finding.mend = "write to a faster disk, or leave out output.points: rows are lost as writer_backlog";
  }
  return finding;
}

}  // namespace rptv
