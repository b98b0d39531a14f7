// SPDX-License-Identifier: MIT
// The probe in a build without CUDA.
#include "reconstruct/cuda_probe.hpp"

namespace rptv {

CudaProbe probe_cuda() {
  return {false, -1, "this rapidptv is built without CUDA; build it with RPTV_CUDA=ON and the CUDA toolkit"};
}

}  // namespace rptv
