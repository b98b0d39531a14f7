// SPDX-License-Identifier: MIT
// Walls and poses from frame to frame.
#include "calibration/cameras/bundle.hpp"

#include "calibration/cameras/camera_graph.hpp"
#include "calibration/space_algebra.hpp"

namespace rptv {

namespace {

RefractiveStack stack_in_frame(RefractiveStack stack, const CameraPose& frame) {
  for (auto& interface : stack.interfaces) interface.position_mm -= dot(stack.normal, frame.translation_mm);
  stack.normal = transpose(frame.rotation) * stack.normal;
  return stack;
}

}  // namespace

RefractiveStack stack_of(const Bundle& bundle, std::size_t camera) {
  return bundle.has_window(camera) ? stack_in_frame(bundle.windows[camera], bundle.cameras[camera]) : bundle.stack;
}

Bundle in_frame(const Bundle& bundle, const CameraPose& frame) {
  Bundle moved = bundle;
  for (auto& camera : moved.cameras) camera = after(camera, frame);
  for (auto& target : moved.targets)
    if (target) target = after(inverse(frame), *target);
  moved.stack = stack_in_frame(bundle.stack, frame);
  return moved;
}

}  // namespace rptv
