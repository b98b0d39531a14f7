// SPDX-License-Identifier: MIT
// Decodes on as many threads as there are processors; the calling thread is one of them and reports.
#include "replay/preload.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <new>
#include <thread>

#include "core/error.hpp"

namespace rptv {
namespace {

struct Work {
  const std::vector<ImageSequence>& cameras;
  std::vector<DecodedImages>& decoded;
  std::size_t total = 0;
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> done{0};
  std::mutex failure_mutex{};
  std::exception_ptr failure{};
};

/// Takes images one by one, in order over all cameras, until none is left or one fails.
void decode_share(Work& work, const PreloadProgress* progress) {
  std::vector<ImageSequence::Reader> readers(work.cameras.begin(), work.cameras.end());
  try {
    for (std::size_t task = work.next++; task < work.total; task = work.next++) {
      std::size_t camera = 0, image = task;
      while (image >= work.cameras[camera].size()) image -= work.cameras[camera++].size();
      DecodedImages& into = work.decoded[camera];
      readers[camera].decode(image, {into.pixels.get() + image * into.bytes_per_image, into.bytes_per_image});
      const std::size_t done = ++work.done;
      if (progress != nullptr && *progress) (*progress)(done, work.total);
    }
  } catch (...) {
    const std::lock_guard lock(work.failure_mutex);
    if (!work.failure) work.failure = std::current_exception();
    work.next = work.total;
  }
}

void take_memory(const std::vector<ImageSequence>& cameras, std::int64_t limit_mb,
                 std::vector<DecodedImages>& decoded) {
  double bytes = 0;
  std::size_t images = 0;
  for (const ImageSequence& camera : cameras) {
    bytes += static_cast<double>(camera.size()) * static_cast<double>(camera.shape().bytes());
    images += camera.size();
  }
  const std::string need = "replay.preload: " + std::to_string(images) + " decoded images take " +
                           std::to_string(static_cast<std::int64_t>(bytes / 1e6) + 1) + " MB";
  if (bytes > static_cast<double>(limit_mb) * 1e6)
    throw Error(ExitCode::configuration, need + ", above replay.preload_limit_mb = " + std::to_string(limit_mb) +
                                             "; raise it if there is that much memory, or set replay.preload = false");
  try {
    for (const ImageSequence& camera : cameras)
      decoded.push_back({std::unique_ptr<std::byte[]>(new std::byte[camera.size() * camera.shape().bytes()]),
                         camera.shape().bytes()});
  } catch (const std::bad_alloc&) {
    throw Error(ExitCode::unavailable, need + ", more than this machine gives; set replay.preload = false");
  }
}

}  // namespace

std::vector<DecodedImages> preload(const std::vector<ImageSequence>& cameras, std::int64_t limit_mb,
                                   const PreloadProgress& progress) {
  std::vector<DecodedImages> decoded;
  take_memory(cameras, limit_mb, decoded);
  Work work{cameras, decoded};
  for (const ImageSequence& camera : cameras) work.total += camera.size();
  const std::size_t processors = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::thread> helpers;
  for (std::size_t i = 1; i < std::min(processors, work.total); ++i)
    helpers.emplace_back([&work] { decode_share(work, nullptr); });
  decode_share(work, &progress);
  for (std::thread& helper : helpers) helper.join();
  if (work.failure) std::rethrow_exception(work.failure);
  return decoded;
}

}  // namespace rptv
