// SPDX-License-Identifier: MIT
// A windowed Fourier transform of the middle of the image, searched for two (square) or three (hexagonal) equal peaks.
#include "calibration/light_field/lattice_peak.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

namespace rptv {

namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

/// In place, radix 2; `stride` apart.
void transform(Complex* data, std::size_t size, std::size_t stride) {
  for (std::size_t i = 1, j = 0; i < size; ++i) {
    std::size_t bit = size >> 1;
    for (; (j & bit) != 0; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(data[i * stride], data[j * stride]);
  }
  for (std::size_t length = 2; length <= size; length <<= 1) {
    const Complex root = std::polar(1.0, -2 * pi / static_cast<double>(length));
    for (std::size_t i = 0; i < size; i += length) {
      Complex turn = 1;
      for (std::size_t k = 0; k < length / 2; ++k, turn *= root) {
        Complex& low = data[(i + k) * stride];
        Complex& high = data[(i + k + length / 2) * stride];
        const Complex other = high * turn;
        high = low - other, low += other;
      }
    }
  }
}

/// The middle of an image times a Hann window, without its mean, and the magnitude of its spectrum.
class Spectrum {
 public:
  explicit Spectrum(const GreyImage& image) {
    constexpr int kLargest = 1024;
    while (size_ * 2 <= std::min({image.width, image.height, kLargest})) size_ *= 2;
    first_ = {(image.width - size_) / 2, (image.height - size_) / 2};
    double sum = 0, weights = 0;
    for (int j = 0; j < size_; ++j)
      for (int i = 0; i < size_; ++i)
        sum += hann(i) * hann(j) * image.at(first_[0] + i, first_[1] + j), weights += hann(i) * hann(j);
    const auto n = static_cast<std::size_t>(size_);
    windowed_.resize(n * n);
    std::vector<Complex> data(n * n);
    for (int j = 0; j < size_; ++j)
      for (int i = 0; i < size_; ++i) {
        const std::size_t at = static_cast<std::size_t>(j) * n + static_cast<std::size_t>(i);
        windowed_[at] = hann(i) * hann(j) * (image.at(first_[0] + i, first_[1] + j) - sum / weights);
        data[at] = windowed_[at];
      }
    for (std::size_t k = 0; k < n; ++k) transform(&data[k * n], n, 1);
    for (std::size_t k = 0; k < n; ++k) transform(&data[k], n, n);
    magnitude_.resize(n * n);
    std::transform(data.begin(), data.end(), magnitude_.begin(), [](const Complex& c) { return std::abs(c); });
  }

  int size() const noexcept { return size_; }
  std::array<double, 2> middle_px() const noexcept {
    return {first_[0] + 0.5 * (size_ - 1), first_[1] + 0.5 * (size_ - 1)};
  }

  /// Magnitude at a frequency in cycles per pixel, between bins.
  double at(double fx, double fy) const noexcept {
    const double x = fx * size_, y = fy * size_, left = std::floor(x), top = std::floor(y);
    const double a = x - left, b = y - top;
    return (1 - b) * ((1 - a) * bin(left, top) + a * bin(left + 1, top)) +
           b * ((1 - a) * bin(left, top + 1) + a * bin(left + 1, top + 1));
  }

  /// The transform at one frequency about the middle.
  Complex exact(double fx, double fy) const {
    const double middle = 0.5 * (size_ - 1);
    std::vector<Complex> turns(static_cast<std::size_t>(size_));
    for (int i = 0; i < size_; ++i) turns[static_cast<std::size_t>(i)] = std::polar(1.0, -2 * pi * fx * (i - middle));
    Complex total = 0;
    for (int j = 0; j < size_; ++j) {
      const double* row = &windowed_[static_cast<std::size_t>(j) * static_cast<std::size_t>(size_)];
      Complex line = 0;
      for (std::size_t i = 0; i < turns.size(); ++i) line += row[i] * turns[i];
      total += line * std::polar(1.0, -2 * pi * fy * (j - middle));
    }
    return total;
  }

 private:
  double hann(int i) const noexcept { return 0.5 - 0.5 * std::cos(2 * pi * (i + 0.5) / size_); }
  double bin(double x, double y) const noexcept {
    const auto wrap = [&](double k) { return static_cast<std::size_t>(static_cast<int>(k) & (size_ - 1)); };
    return magnitude_[wrap(y) * static_cast<std::size_t>(size_) + wrap(x)];
  }

  int size_ = 1;
  std::array<int, 2> first_{};
  std::vector<double> windowed_, magnitude_;
};

/// Directions of the shortest reciprocal vectors from the lattice's rotation, and their length times the pitch.
struct Reciprocal {
  std::vector<double> turn_rad;
  double length;
};
Reciprocal reciprocal_of(const std::string& shape) {
  if (shape == "hexagonal") return {{-pi / 6, pi / 2, pi / 6}, 2 / std::numbers::sqrt3};
  return {{0, pi / 2}, 1};
}

template <class Magnitude>
double weakest(const Reciprocal& reciprocal, double frequency, double rotation, const Magnitude& magnitude) {
  double least = 1e300;
  for (const double turn : reciprocal.turn_rad)
    least = std::min(least, magnitude(frequency * std::cos(rotation + turn), frequency * std::sin(rotation + turn)));
  return least;
}

}  // namespace

LatticePeak find_lattice_peak(const GreyImage& image, const std::string& shape, double shortest_px, double longest_px) {
  const Spectrum spectrum(image);
  const Reciprocal reciprocal = reciprocal_of(shape);
  const double sector = shape == "hexagonal" ? pi / 6 : pi / 4;
  const double step = 0.5 / spectrum.size();
  const auto magnitude = [&](double fx, double fy) { return spectrum.at(fx, fy); };
  const double low = reciprocal.length / longest_px, high = std::min(reciprocal.length / shortest_px, 0.5);
  double best = 0, frequency = low, rotation = 0;
  std::vector<double> ring;
  for (double f = low; f <= high; f += step)
    for (double turn = -sector; turn < sector; turn += step / f) {
      const double score = weakest(reciprocal, f, turn, magnitude);
      ring.push_back(spectrum.at(f * std::cos(turn), f * std::sin(turn)));
      if (score > best) best = score, frequency = f, rotation = turn;
    }
  LatticePeak peak;
  if (ring.empty()) return peak;
  std::nth_element(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(ring.size() / 2), ring.end());
  const auto exact = [&](double fx, double fy) { return std::abs(spectrum.exact(fx, fy)); };
  double exact_best = weakest(reciprocal, frequency, rotation, exact);
  for (double reach = step; reach > step / 200; reach /= 2)  // climb the peak between the bins
    for (const auto& [df, dt] :
         {std::pair{reach, 0.0}, {-reach, 0.0}, {0.0, reach / frequency}, {0.0, -reach / frequency}})
      if (const double score = weakest(reciprocal, frequency + df, rotation + dt, exact); score > exact_best)
        exact_best = score, frequency += df, rotation += dt;
  peak.pitch_px = reciprocal.length / frequency, peak.rotation_rad = rotation;
  const bool inside = peak.pitch_px > 0.99 * shortest_px && peak.pitch_px < 1.01 * longest_px;
  // Outside: the foot of a peak elsewhere.
  peak.significance = inside ? exact_best / std::max(ring[ring.size() / 2], 1e-300) : 0;
  const auto vector_of = [&](std::size_t k) {
    const double turn = rotation + reciprocal.turn_rad[k];
    return std::array<double, 2>{frequency * std::cos(turn), frequency * std::sin(turn)};
  };
  const auto b1 = vector_of(0), b2 = vector_of(1);
  for (const auto& [m, n] : {std::pair{0.5, 0.0}, {0.0, 0.5}, {0.5, 0.5}, {0.5, -0.5}})
    peak.subharmonic = std::max(peak.subharmonic, exact(m * b1[0] + n * b2[0], m * b1[1] + n * b2[1]) / exact_best);
  const double u = -std::arg(spectrum.exact(b1[0], b1[1])) / (2 * pi),
               v = -std::arg(spectrum.exact(b2[0], b2[1])) / (2 * pi);
  const double turn_b = rotation + (shape == "hexagonal" ? pi / 3 : pi / 2);
  const auto middle = spectrum.middle_px();
  peak.origin_px = {middle[0] + peak.pitch_px * (u * std::cos(rotation) + v * std::cos(turn_b)),
                    middle[1] + peak.pitch_px * (u * std::sin(rotation) + v * std::sin(turn_b))};
  return peak;
}

}  // namespace rptv
