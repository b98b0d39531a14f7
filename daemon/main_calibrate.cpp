// SPDX-License-Identifier: MIT
// rapidptv-calibrate: `rapidptv calibrate`, and the libraries that only it needs (OpenCV, Ceres). Users start it
// through rapidptv (daemon/main.cpp).
#include "daemon/command_line.hpp"

int main(int argc, char** argv) {
  constexpr rptv::AddCommand kCalibrate[] = {rptv::add_calibrate};
  return rptv::run_command_line(argc, argv, kCalibrate);
}
