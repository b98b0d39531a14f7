// SPDX-License-Identifier: MIT
// The threshold pass, per instruction set, beside a plain loop and a plain copy.
#include "reconstruct/lit_pixels.hpp"

#include <cstring>
#include <iomanip>
#include <ostream>
#include <random>
#include <stdexcept>

#include "tests/bench/contest.hpp"
#include "tests/bench/light_field_bench.hpp"

namespace rptv::bench {

namespace {

constexpr ImageShape kShape8{2048, 1536, 1}, kShape16{2048, 1536, 2};
constexpr std::size_t kLit = 50'000, kRun = 4;  // sub-images light pixels in runs

template <class Pixel>
void bench_one(std::ostream& out, const ImageShape& shape, int rounds) {
  std::mt19937 random(3);
  std::vector<Pixel> image(shape.pixels(), 20), copy(shape.pixels()), background(shape.pixels(), 18);
  for (std::size_t i = 0; i < kLit / kRun; ++i)
    std::fill_n(image.begin() + random() % (image.size() - kRun), kRun, 200);
  const ImageView view{reinterpret_cast<const std::byte*>(image.data()), shape};
  const DarkLimit limit({reinterpret_cast<const std::byte*>(background.data()), shape}, 20);
  std::vector<std::uint32_t> plain(image.size()), lit(image.size());
  std::size_t plain_count = 0, count = 0;
  Contest contest;
  contest.add("memcpy of the image", [&] { std::memcpy(copy.data(), image.data(), shape.bytes()); });
  contest.add("plain loop", [&] {
    plain_count = 0;
    for (std::size_t i = 0; i < image.size(); ++i)
      if (image[i] > limit.limits()[i]) plain[plain_count++] = static_cast<std::uint32_t>(i);
  });
  for (const auto set : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512})
    if (set <= best_instruction_set())
      contest.add(name_of(set), [&, set] { count = find_lit_pixels(view, limit, lit, set); });
  contest.run(4 * rounds);
  if (count != plain_count || !std::equal(lit.begin(), lit.begin() + static_cast<std::ptrdiff_t>(count), plain.begin()))
    throw std::runtime_error("lit pixels differ from the plain loop's");
  const double read_mb = static_cast<double>(shape.bytes() + 2 * shape.pixels()) * 1e-6;
  out << "  " << 8 * shape.bytes_per_pixel << " bit, " << count << " lit" << std::setw(45) << "median ms"
      << std::setw(12) << "GB/s read\n";
  for (std::size_t i = 0; i < contest.size(); ++i)
    out << "    " << std::left << std::setw(48) << contest.name(i) << std::right << std::fixed << std::setprecision(3)
        << std::setw(10) << contest.median_ms(i) << std::setprecision(1) << std::setw(11)
        << (i == 0 ? static_cast<double>(shape.bytes()) * 1e-6 : read_mb) / contest.median_ms(i) << '\n';
}

}  // namespace

void bench_lit_pixels(std::ostream& out, const LightFieldBenchOptions& options) {
  out << "\nbackground, threshold and list of lit pixels of a 2048x1536 image in one pass; image and 16-bit limits are "
         "read\n";
  bench_one<std::uint8_t>(out, kShape8, options.rounds);
  bench_one<std::uint16_t>(out, kShape16, options.rounds);
}

}  // namespace rptv::bench
