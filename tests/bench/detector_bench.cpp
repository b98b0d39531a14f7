// SPDX-License-Identifier: MIT
// rptv_bench_detector [rounds]: a 1920×1200 frame to its list of particle images, beside what OpenCV offers.
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <opencv2/imgproc.hpp>

#include "reconstruct/detector.hpp"
#include "reconstruct/lit_maxima.hpp"
#include "tests/bench/contest.hpp"
#include "tests/reconstruct/painted_spots.hpp"

namespace rptv::bench {

namespace {

constexpr double kBackground = 10, kThreshold = 20;

// Subtract, threshold, label: area and centroid of each component. The way that most front ends begin.
std::size_t opencv_blobs(const cv::Mat& image, const cv::Mat& background) {
  static cv::Mat difference, lit, labels, statistics, centroids;  // kept, so that only the first call allocates
  cv::subtract(image, background, difference);
  cv::threshold(difference, lit, kThreshold, 255, cv::THRESH_BINARY);
  if (lit.type() != CV_8U) lit.convertTo(lit, CV_8U);
  return static_cast<std::size_t>(cv::connectedComponentsWithStats(lit, labels, statistics, centroids, 8)) - 1;
}

void bench_case(std::uint32_t bytes_per_pixel, std::size_t particles, int rounds) {
  testing::Camera camera{{1920, 1200, bytes_per_pixel}, kBackground, 2, 4, bytes_per_pixel == 1 ? 255.0 : 4095.0};
  std::mt19937 random(1);
  const auto spots = testing::scatter_spots(camera.shape, particles, 0, 8, 1.5, 120, random);
  const testing::SpotImage image(camera, spots, random);
  std::vector<std::uint16_t> dark(camera.shape.pixels(), static_cast<std::uint16_t>(kBackground));
  if (bytes_per_pixel == 1)
    std::fill_n(reinterpret_cast<std::uint8_t*>(dark.data()), dark.size(), static_cast<std::uint8_t>(kBackground));
  const ImageView background{reinterpret_cast<const std::byte*>(dark.data()), camera.shape};
  const int type = bytes_per_pixel == 1 ? CV_8U : CV_16U;
  const cv::Mat frame(1200, 1920, type, const_cast<std::byte*>(image.view().data));
  const cv::Mat empty(1200, 1920, type, dark.data());

  Detections found(16384);
  Contest contest;
  std::size_t opencv_count = 0;
  contest.add("OpenCV subtract, threshold, connectedComponentsWithStats",
              [&] { opencv_count = opencv_blobs(frame, empty); });
  const DarkLimit limit(background, kThreshold);
  std::vector<PixelIndex> maxima(65536);
  contest.add("scan for maxima alone", [&] { find_lit_maxima(image.view(), limit, maxima); });
  std::vector<std::pair<std::size_t, Detector>> detectors;
  detectors.reserve(16);
  for (const char* method : {"gaussian", "three_point", "centroid"})
    for (const auto set : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512}) {
      if (set > best_instruction_set()) continue;
      DetectorSettings settings;
      settings.method = method, settings.threshold = kThreshold, settings.noise_grey = 2;
      detectors.emplace_back(0, Detector(settings, camera.shape, background, 0, set));
      contest.add(std::string(method) + ", " + name_of(set), [&found, &image, &one = detectors.back()] {
        one.second.detect(image.view(), found);
        one.first = found.size();
      });
    }
  contest.run(rounds);
  std::cout << "\n  " << 8 * bytes_per_pixel << " bit, " << particles << " particles of sigma 1.5 px (" << opencv_count
            << " components)\n    " << std::left << std::setw(60) << ""
            << "median ms  found   GB/s of image   x OpenCV\n";
  for (std::size_t i = 0; i < contest.size(); ++i) {
    std::cout << "    " << std::left << std::setw(60) << contest.name(i) << std::right << std::fixed
              << std::setprecision(3) << std::setw(9) << contest.median_ms(i) << std::setw(7)
              << (i == 0   ? opencv_count
                  : i == 1 ? 0
                           : detectors[i - 2].first)
              << std::setprecision(1) << std::setw(16)
              << static_cast<double>(camera.shape.bytes()) * 1e-6 / contest.median_ms(i) << std::setw(11)
              << contest.median_ms(0) / contest.median_ms(i) << '\n';
  }
}

}  // namespace

}  // namespace rptv::bench

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 40;
  cv::setNumThreads(1);
  std::cout << rptv::bench::machine() << "; CPU time of one thread, medians of " << rounds << " alternating runs\n";
  for (const std::uint32_t bytes_per_pixel : {1U, 2U})
    for (const std::size_t particles : {300U, 1000U, 4000U})
      rptv::bench::bench_case(bytes_per_pixel, particles, rounds);
}
