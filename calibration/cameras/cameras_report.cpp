// SPDX-License-Identifier: MIT
// Figures of a camera calibration as text, as JSON and as a table.
#include "calibration/cameras/cameras_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calibration/cameras/rig_accuracy.hpp"
#include "calibration/cameras/volume_accuracy.hpp"
#include "calibration/space_algebra.hpp"
#include "core/json.hpp"

namespace rptv {

namespace {

constexpr std::size_t kWorstShown = 5;
constexpr double kThinCoverage = 0.5;  // of the sensor: less leaves the distortion to extrapolation

struct CameraFigures {
  std::size_t images = 0, points = 0;
  double rms_px = 0;
  double coverage = 0;  ///< share of 8 x 6 fields of the sensor that hold points
};

CameraFigures figures_of(const CameraCalibration& c, std::size_t camera) {
  constexpr int kColumns = 8, kRows = 6;
  CameraFigures f;
  std::vector<bool> field(kColumns * kRows, false);
  const auto& sensor = c.used.cameras[camera];
  for (const auto& image : c.used.images) f.images += image.camera == camera ? 1 : 0;
  for (const auto& r : c.result.residuals) {
    if (c.used.images[r.image].camera != camera) continue;
    ++f.points, f.rms_px += r.error_px[0] * r.error_px[0] + r.error_px[1] * r.error_px[1];
    const int column = static_cast<int>((r.seen.pixel[0] + 0.5) * kColumns / sensor.width_px);
    const int row = static_cast<int>((r.seen.pixel[1] + 0.5) * kRows / sensor.height_px);
    field[static_cast<std::size_t>(std::clamp(row, 0, kRows - 1) * kColumns + std::clamp(column, 0, kColumns - 1))] =
        true;
  }
  if (f.points > 0) f.rms_px = std::sqrt(f.rms_px / static_cast<double>(f.points));
  f.coverage = static_cast<double>(std::count(field.begin(), field.end(), true)) / (kColumns * kRows);
  return f;
}

/// Places of images, worst first.
std::vector<std::size_t> worst_first(const std::vector<double>& rms) {
  std::vector<std::size_t> order(rms.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rms[a] > rms[b]; });
  return order;
}

/// `value ± error`, or the value alone.
std::string with_error(double value, const std::vector<std::vector<double>>& errors, std::size_t camera,
                       std::size_t k) {
  return errors.empty() ? fmt::format("{:.2f}", value) : fmt::format("{:.2f} ± {:.2f}", value, errors[camera][k]);
}

std::string camera_text(const CameraCalibration& c, std::size_t k) {
  const auto& lens = c.result.bundle.lenses[k];
  const Point3 centre = inverse(c.result.bundle.cameras[k]).translation_mm;
  const CameraFigures f = figures_of(c, k);
  const auto& sigma = c.result.lens_sigma;
  return fmt::format(
      "camera {:<10} rms {:.4f} px, {} points in {} images, on {:.0f} % of the sensor{}\n"
      "                  focal length {} and {} px, principal point {}, {}\n"
      "                  at {:.2f} {:.2f} {:.2f} mm\n",
      c.used.cameras[k].name, f.rms_px, f.points, f.images, 100 * f.coverage,
      f.coverage < kThinCoverage ? "; hold the target where it was not yet, towards the borders" : "",
      with_error(lens.fx_px, sigma, k, 0), with_error(lens.fy_px, sigma, k, 1), with_error(lens.cx_px, sigma, k, 2),
      with_error(lens.cy_px, sigma, k, 3), centre[0] + 0.0, centre[1] + 0.0, centre[2] + 0.0);  // no -0.00
}

/// `whose`: nothing where all cameras look through it.
std::string stack_text(const RefractiveStack& stack, const std::string& whose) {
  std::string text;
  for (const auto& interface : stack.interfaces)
    text += fmt::format("interface         {:.3f} mm along the normal {:.6f} {:.6f} {:.6f}, index {} behind{}\n",
                        interface.position_mm, stack.normal[0], stack.normal[1], stack.normal[2],
                        interface.behind.index, whose);
  return text;
}

}  // namespace

std::string to_text(const CameraCalibration& c) {
  const auto& r = c.result;
  std::string text = fmt::format(
      "reprojection      rms {:.4f} px over {} points; standard error of a coordinate {:.4f} px, {} of the points "
      "beyond 5 of them\n",
      r.rms_px, r.residuals.size(), r.sigma_px, r.outliers);
  for (std::size_t k = 0; k < c.used.cameras.size(); ++k) text += camera_text(c, k);
  for (const auto& pair : c.graph.pairs)
    text += fmt::format("pair              {} and {}: {} views, {} points, {:.3f} px from one to the other\n",
                        c.used.cameras[pair.first].name, c.used.cameras[pair.second].name, pair.views, pair.points,
                        pair.transfer_px);
  const auto rms = image_rms_px(c.used, r);
  const auto order = worst_first(rms);
  for (std::size_t i = 0; i < std::min(kWorstShown, order.size()); ++i)
    text += fmt::format("{:<18}{}: rms {:.4f} px\n", i == 0 ? "worst images" : "", c.used.images[order[i]].origin,
                        rms[order[i]]);
  for (const auto& d : c.dropped)
    text += fmt::format("dropped           camera {}, view {}: {}\n", c.used.cameras[d.camera].name,
                        c.used.views[d.view], d.reason);
  text += stack_text(r.bundle.stack, "");
  for (std::size_t k = 0; k < c.used.cameras.size(); ++k)
    if (r.bundle.has_window(k)) text += stack_text(stack_of(r.bundle, k), ", camera " + c.used.cameras[k].name);
  const TargetErrors target = target_errors(c.used, r);
  text += fmt::format("target in space   {} points from two or more cameras: rms {:.4f} mm, largest {:.4f} mm\n",
                      target.points, target.rms_mm, target.largest_mm);
  text += to_text(volume_accuracy(c.used, r));
  return text;
}

namespace {

/// `[a,b,…]` of what `one` says of each.
template <class List, class One>
std::string json_list(const List& list, const One& one) {
  std::string text = "[";
  for (std::size_t i = 0; i < list.size(); ++i) text += (i > 0 ? "," : "") + one(i);
  return text + "]";
}

}  // namespace

std::string to_json(const CameraCalibration& c) {
  const auto& r = c.result;
  const auto name = [&](std::size_t camera) { return json_string(c.used.cameras[camera].name); };
  const auto rms = image_rms_px(c.used, r);
  const TargetErrors target = target_errors(c.used, r);
  return fmt::format(
      "{{\"rms_px\":{},\"sigma_px\":{},\"points\":{},\"outliers\":{},\"cameras\":{},\"pairs\":{},\"images\":{},"
      "\"dropped\":{},\"target_rms_mm\":{},\"target_largest_mm\":{},\"expected\":{}}}",
      json_number(r.rms_px), json_number(r.sigma_px), r.residuals.size(), r.outliers,
      json_list(c.used.cameras,
                [&](std::size_t k) {
                  const CameraFigures f = figures_of(c, k);
                  return fmt::format(
                      "{{\"name\":{},\"rms_px\":{},\"images\":{},\"points\":{},\"coverage\":{},\"centre_mm\":{}}}",
                      name(k), json_number(f.rms_px), f.images, f.points, json_number(f.coverage),
                      json_point(inverse(r.bundle.cameras[k]).translation_mm));
                }),
      json_list(c.graph.pairs,
                [&](std::size_t k) {
                  const CameraPair& pair = c.graph.pairs[k];
                  return fmt::format("{{\"cameras\":[{},{}],\"views\":{},\"points\":{},\"transfer_px\":{}}}",
                                     name(pair.first), name(pair.second), pair.views, pair.points,
                                     json_number(pair.transfer_px));
                }),
      json_list(c.used.images,
                [&](std::size_t k) {
                  const BoardView& image = c.used.images[k];
                  return fmt::format("{{\"camera\":{},\"view\":{},\"points\":{},\"rms_px\":{}}}", name(image.camera),
                                     json_string(c.used.views[image.view]), image.seen.size(), json_number(rms[k]));
                }),
      json_list(c.dropped,
                [&](std::size_t k) {
                  const DroppedView& d = c.dropped[k];
                  return fmt::format("{{\"camera\":{},\"view\":{},\"reason\":{}}}", name(d.camera),
                                     json_string(c.used.views[d.view]), json_string(d.reason));
                }),
      json_number(target.rms_mm), json_number(target.largest_mm), to_json(volume_accuracy(c.used, r)));
}

std::string residual_table(const CameraCalibration& c) {
  std::string text = "camera,view,point,column,row,error_column,error_row\n";
  for (const auto& r : c.result.residuals) {
    const BoardView& image = c.used.images[r.image];
    text += fmt::format("{},{},{},{:.4f},{:.4f},{:.5f},{:.5f}\n", c.used.cameras[image.camera].name,
                        c.used.views[image.view], r.seen.point, r.seen.pixel[0], r.seen.pixel[1], r.error_px[0],
                        r.error_px[1]);
  }
  return text;
}

}  // namespace rptv
