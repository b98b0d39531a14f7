// SPDX-License-Identifier: MIT
// Richardson-Lucy deconvolution by FFTW.
#include <fftw3.h>

#include <algorithm>

#include "tests/bench/baselines.hpp"

namespace rptv::bench {

struct RichardsonLucy::Plans {
  std::size_t size, frequencies;
  float* real;
  fftwf_complex *transform, *psf;
  fftwf_plan forward, backward;
};

RichardsonLucy::RichardsonLucy(const VoxelVolume& psf) : plans_(new Plans{}) {
  auto& p = *plans_;
  const auto [nx, ny, nz] = psf.size;
  p.size = nx * ny * nz, p.frequencies = ny * nx * (nz / 2 + 1);
  p.real = fftwf_alloc_real(p.size);
  p.transform = fftwf_alloc_complex(p.frequencies), p.psf = fftwf_alloc_complex(p.frequencies);
  const auto y = static_cast<int>(ny), x = static_cast<int>(nx), z = static_cast<int>(nz);
  p.forward = fftwf_plan_dft_r2c_3d(y, x, z, p.real, p.transform, FFTW_MEASURE);
  p.backward = fftwf_plan_dft_c2r_3d(y, x, z, p.transform, p.real, FFTW_MEASURE);
  for (std::size_t j = 0; j < ny; ++j)  // its middle to the origin
    for (std::size_t i = 0; i < nx; ++i)
      for (std::size_t k = 0; k < nz; ++k)
        p.real[psf.column((i + nx - nx / 2) % nx, (j + ny - ny / 2) % ny) + (k + nz - nz / 2) % nz] = psf.at(i, j, k);
  fftwf_execute(p.forward);
  std::copy_n(&p.transform[0][0], 2 * p.frequencies, &p.psf[0][0]);
}

RichardsonLucy::~RichardsonLucy() {
  fftwf_destroy_plan(plans_->forward), fftwf_destroy_plan(plans_->backward);
  fftwf_free(plans_->real), fftwf_free(plans_->transform), fftwf_free(plans_->psf);
  delete plans_;
}

// Convolution with the point spread, or with its mirror image (correlation).
void RichardsonLucy::blur(const float* in, bool mirrored) {
  auto& p = *plans_;
  std::copy_n(in, p.size, p.real);
  fftwf_execute(p.forward);
  const float scale = 1 / static_cast<float>(p.size), sign = mirrored ? -1.0F : 1.0F;
  for (std::size_t i = 0; i < p.frequencies; ++i) {
    const float re = p.transform[i][0] * scale, im = p.transform[i][1] * scale;
    const float psf_re = p.psf[i][0], psf_im = sign * p.psf[i][1];
    p.transform[i][0] = re * psf_re - im * psf_im, p.transform[i][1] = re * psf_im + im * psf_re;
  }
  fftwf_execute(p.backward);
}

void RichardsonLucy::run(const VoxelVolume& stack, int iterations, VoxelVolume& out) {
  constexpr float kLeast = 1e-6F;
  std::vector<float> ratio(stack.value.size());
  out.value = stack.value;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    blur(out.value.data(), false);
    for (std::size_t i = 0; i < ratio.size(); ++i) ratio[i] = stack.value[i] / std::max(plans_->real[i], kLeast);
    blur(ratio.data(), true);
    for (std::size_t i = 0; i < ratio.size(); ++i) out.value[i] *= std::max(plans_->real[i], 0.0F);
  }
}

}  // namespace rptv::bench
