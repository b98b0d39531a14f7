// SPDX-License-Identifier: MIT
// rptv_bench_detector [rounds]: a 1920×1200 frame to its list of particle images, beside what OpenCV offers.
#include <cstdlib>
#include <deque>
#include <functional>
#include <iomanip>
#include <iostream>
#include <opencv2/imgproc.hpp>

#include "reconstruct/detection/detector.hpp"
#include "reconstruct/detection/lit_maxima.hpp"
#include "tests/bench/contest.hpp"
#include "tests/reconstruct/detection/painted_spots.hpp"

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

struct Scene {
  std::uint32_t bytes_per_pixel;
  std::size_t particles;
  bool background_image;  ///< limits and mean of each pixel are read; otherwise one for all
};

struct Contender {
  std::string name;
  std::function<std::size_t()> run;  ///< returns how many it finds
};

// Medians: alternating, so that all find their memory in no cache, and each again and again.
void race(const std::vector<Contender>& contenders, const ImageShape& shape, int rounds) {
  Contest alternating;
  for (const auto& one : contenders) alternating.add(one.name, one.run);
  alternating.run(rounds);
  double opencv_ms = 0;
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    Contest repeated;
    repeated.add(contenders[i].name, contenders[i].run);
    repeated.run(rounds);
    const double cold_ms = alternating.median_ms(i), warm_ms = repeated.median_ms(0);
    if (i == 0) opencv_ms = warm_ms;
    std::cout << "    " << std::left << std::setw(58) << contenders[i].name << std::right << std::fixed << std::setw(6)
              << contenders[i].run() << std::setprecision(3) << std::setw(9) << cold_ms << std::setw(9) << warm_ms
              << std::setprecision(1) << std::setw(12) << static_cast<double>(shape.bytes()) * 1e-6 / warm_ms
              << std::setw(10) << alternating.median_ms(0) / cold_ms << std::setw(8) << opencv_ms / warm_ms << '\n';
  }
}

void bench_scene(const Scene& scene, int rounds) {
  const testing::Camera camera{
      {1920, 1200, scene.bytes_per_pixel}, kBackground, 2, 4, scene.bytes_per_pixel == 1 ? 255.0 : 4095.0};
  std::mt19937 random(1);
  const testing::SpotImage image(camera, testing::scatter_spots(camera.shape, scene.particles, 0, 8, 1.5, 120, random),
                                 random);
  const testing::SpotImage dark({camera.shape, kBackground, 0, 1, 255}, {}, random);
  const int type = scene.bytes_per_pixel == 1 ? CV_8U : CV_16U;
  const cv::Mat frame(1200, 1920, type, const_cast<std::byte*>(image.view().data));
  const cv::Mat empty(1200, 1920, type, const_cast<std::byte*>(dark.view().data));
  const ImageView background = scene.background_image ? dark.view() : ImageView{};

  std::vector<Contender> contenders{
      {"OpenCV subtract, threshold, connectedComponentsWithStats", [&] { return opencv_blobs(frame, empty); }}};
  const auto limit =
      scene.background_image ? DarkLimit(dark.view(), kThreshold) : DarkLimit(camera.shape, kBackground, kThreshold);
  std::vector<PixelIndex> maxima(65536);
  contenders.push_back({"scan for maxima alone", [&] { return find_lit_maxima(image.view(), limit, maxima); }});
  Detections found(16384);
  std::deque<Detector> detectors;
  for (const std::string method : {"gaussian", "gaussian, no sweeps", "three_point", "centroid", "blob"})
    for (const auto set : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512}) {
      if (set > best_instruction_set() || (set != best_instruction_set() && method != "gaussian, no sweeps")) continue;
      DetectorSettings settings;
      settings.method = method.substr(0, method.find(','));
      if (settings.method != method) settings.overlap_sweeps = 0;
      settings.threshold = kThreshold, settings.noise_grey = 2, settings.background = kBackground;
      auto& detector = detectors.emplace_back(settings, camera.shape, background, 0, set);
      contenders.push_back({method + ", " + name_of(set), [&found, &image, &detector] {
                              detector.detect(image.view(), found);
                              return found.size();
                            }});
    }
  std::cout << "\n  " << 8 * scene.bytes_per_pixel << " bit, " << scene.particles << " particles, "
            << (scene.background_image ? "background of each pixel" : "one background") << "\n    " << std::setw(113)
            << "found  cold ms  warm ms   GB/s warm x OpenCV cold  warm\n";
  race(contenders, camera.shape, rounds);
}

}  // namespace

}  // namespace rptv::bench

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 40;
  cv::setNumThreads(1);
  std::cout << rptv::bench::machine() << "; CPU time of one thread, medians of " << rounds << " alternating runs\n";
  std::cout
      << "spots of sigma 1.5 px; GB/s: bytes of the image; cold: in turns with the others, warm: again and again\n";
  for (const std::uint32_t bytes_per_pixel : {1U, 2U})
    for (const bool background_image : {false, true})
      for (const std::size_t particles : {300U, 1000U, 4000U})
        rptv::bench::bench_scene({bytes_per_pixel, particles, background_image}, rounds);
}
