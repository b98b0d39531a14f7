// SPDX-License-Identifier: MIT
// The chain rule from pixels back to lens, camera, target and interfaces.
#include "calibration/cameras/bundle_projection.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "calibration/cameras/eigen_space.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

/// [v]x: crossed(a)·b = a x b.
Matrix crossed(const Vector& v) {
  Matrix m;
  m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return m;
}

Matrix rotation_of(const Vector& r) {
  const double angle = r.norm();
  return angle < 1e-12 ? Matrix(Matrix::Identity() + crossed(r))
                       : Eigen::AngleAxisd(angle, r / angle).toRotationMatrix();
}

/// How a rotation turns when its vector changes: R(r + d) = R(r)·R(J·d) (right Jacobian, Sola et al. 2018, eq. 143).
Matrix right_jacobian(const Vector& r) {
  const double angle = r.norm(), square = angle * angle;
  const double a = angle < 1e-4 ? 0.5 - square / 24 : (1 - std::cos(angle)) / square;
  const double b = angle < 1e-4 ? 1.0 / 6 - square / 120 : (angle - std::sin(angle)) / (square * angle);
  const Matrix k = crossed(r);
  return Matrix::Identity() - a * k + b * k * k;
}

/// Two unit vectors across `normal`.
std::array<Vector, 2> across(const Vector& normal) {
  const Vector first = normal.unitOrthogonal();
  return {first, normal.cross(first)};
}

/// Direction in which light from a point reaches the camera (rig's frame), and its derivatives.
struct Sight {
  Vector direction;
  Matrix by_point = Matrix::Identity(), by_centre = -Matrix::Identity();
  Eigen::Matrix<double, 3, 3> by_stack = Matrix::Zero();
};

/// Through interfaces. A sideways shift of the camera is one of the point the other way. Along the normal n, the layer
/// in front of the camera grows instead of the one before the point: that changes the direction by the ratio of the
/// tangents of the ray's angles in the two. Moving the stack is moving camera and point the other way.
bool see_through(const RefractiveStack& stack, const std::array<Vector, 2>& turn_axes, const Vector& centre,
                 const Vector& point, Sight& sight) {
  const RefractedPath path(point_of(centre), stack, "bundle");
  const auto seen = path.derivative_to(point_of(point));
  if (!seen) return false;
  sight.direction = vector_of(seen->direction);
  sight.by_point = matrix_of(seen->derivative);
  const Vector n = vector_of(stack.normal);
  if (n.dot(point) > stack.interfaces.front().position_mm) return true;  // on the camera's side: no refraction
  const double tangent = (sight.direction + n).norm(), sine = tangent / std::sqrt(1 + tangent * tangent);
  const double first = stack.before.index, last = stack.interfaces.back().behind.index, sine_last = first / last * sine;
  const double ratio = tangent > 0 ? tangent / (sine_last / std::sqrt(1 - sine_last * sine_last)) : last / first;
  const Vector along = sight.by_point * n;
  sight.by_centre = -sight.by_point * (Matrix::Identity() - n * n.transpose()) - ratio * along * n.transpose();
  const Matrix by_turn =
      -crossed(sight.direction) + sight.by_point * crossed(point) + sight.by_centre * crossed(centre);
  sight.by_stack << by_turn * turn_axes[0], by_turn * turn_axes[1], (ratio - 1) * along;
  return true;
}

}  // namespace

LensParameters parameters_of(const CameraIntrinsics& l) {
  return {l.fx_px, l.fy_px, l.cx_px, l.cy_px, l.k1, l.k2, l.p1, l.p2, l.k3};
}

PoseParameters parameters_of(const CameraPose& pose) {
  const Eigen::AngleAxisd turn(matrix_of(pose.rotation));
  const Vector r = turn.angle() * turn.axis();
  return {r[0], r[1], r[2], pose.translation_mm[0], pose.translation_mm[1], pose.translation_mm[2]};
}

CameraIntrinsics lens_of(std::span<const double, 9> p, const CameraIntrinsics& like) {
  CameraIntrinsics lens;
  lens.width_px = like.width_px, lens.height_px = like.height_px;
  lens.fx_px = p[0], lens.fy_px = p[1], lens.cx_px = p[2], lens.cy_px = p[3];
  lens.k1 = p[4], lens.k2 = p[5], lens.p1 = p[6], lens.p2 = p[7], lens.k3 = p[8];
  return lens;
}

BrownDistortion distortion_of(std::span<const double, 9> lens) { return {lens[4], lens[5], lens[8], lens[6], lens[7]}; }

CameraPose pose_of(std::span<const double, 6> p) {
  return {matrix3_of(rotation_of({p[0], p[1], p[2]})), {p[3], p[4], p[5]}};
}

RefractiveStack moved(const RefractiveStack& stack, std::span<const double, 3> move) {
  RefractiveStack result = stack;
  const Vector n = vector_of(stack.normal);
  const auto axes = across(n);
  result.normal = point_of(rotation_of(move[0] * axes[0] + move[1] * axes[1]) * n);
  for (auto& interface : result.interfaces) interface.position_mm += move[2];
  return result;
}

bool BundleProjection::project(const Point3& point_mm, Pixel& pixel, ProjectionDerivatives* derivatives) const {
  const Vector inner = vector_of(point_mm), turn_target(target[0], target[1], target[2]);
  const Vector turn_camera(camera[0], camera[1], camera[2]), shift(camera[3], camera[4], camera[5]);
  const Matrix to_rig = rotation_of(turn_target), to_camera = rotation_of(turn_camera);
  const Vector point = to_rig * inner + Vector(target[3], target[4], target[5]);
  // Light is traced in the frame that the stack is given in.
  const Matrix to_frame = in_camera ? to_camera : Matrix::Identity(),
               from_frame = in_camera ? Matrix::Identity() : to_camera;
  const Vector at = in_camera ? to_camera * point + shift : point;
  const Vector centre = in_camera ? Vector(Vector::Zero()) : Vector(-to_camera.transpose() * shift);
  Sight sight{at - centre};
  if (stack != nullptr && !stack->interfaces.empty()) {
    try {
      const auto axes = across(vector_of(stack->normal));
      const RefractiveStack here = moved(*stack, stack_move);
      const Matrix turn_stack = rotation_of(stack_move[0] * axes[0] + stack_move[1] * axes[1]);
      const Matrix spread = turn_stack * right_jacobian(stack_move[0] * axes[0] + stack_move[1] * axes[1]);
      if (!see_through(here, {spread * axes[0], spread * axes[1]}, centre, at, sight)) return false;
    } catch (const Error&) {
      return false;  // a step too far: the camera behind the glass
    }
  }
  const Vector seen = from_frame * sight.direction;
  if (!(seen[2] > 0)) return false;
  const double x = seen[0] / seen[2], y = seen[1] / seen[2], r2 = x * x + y * y;
  const auto bent = distortion->distort({x, y});
  if (!bent) return false;
  pixel = {lens[0] * (*bent)[0] + lens[2], lens[1] * (*bent)[1] + lens[3]};
  if (derivatives == nullptr) return true;

  using Rows = Eigen::Matrix<double, 2, 3>;
  const Matrix2 bend = distortion->derivative({x, y});
  Eigen::Matrix2d by_ideal;
  by_ideal << lens[0] * bend[0][0], lens[0] * bend[0][1], lens[1] * bend[1][0], lens[1] * bend[1][1];
  Rows pinhole;
  pinhole << 1 / seen[2], 0, -x / seen[2], 0, 1 / seen[2], -y / seen[2];
  const Rows by_seen = by_ideal * pinhole, by_direction = by_seen * from_frame;
  const Rows by_at = by_direction * sight.by_point, by_centre = by_direction * sight.by_centre;
  const Rows by_point = by_at * to_frame;

  Eigen::Map<Eigen::Matrix<double, 2, 9, Eigen::RowMajor>> by_lens(derivatives->by_lens.data());
  by_lens.row(0) << (*bent)[0], 0, 1, 0, lens[0] * x * r2, lens[0] * x * r2 * r2, lens[0] * 2 * x * y,
      lens[0] * (r2 + 2 * x * x), lens[0] * x * r2 * r2 * r2;
  by_lens.row(1) << 0, (*bent)[1], 0, 1, lens[1] * y * r2, lens[1] * y * r2 * r2, lens[1] * (r2 + 2 * y * y),
      lens[1] * 2 * x * y, lens[1] * y * r2 * r2 * r2;
  Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>> by_camera(derivatives->by_camera.data());
  // R(r)·d turns by -R·[d]x·J; the centre is -R(-r)·t.
  if (in_camera)
    by_camera << -by_point * crossed(point) * right_jacobian(turn_camera), by_at;
  else
    by_camera << -by_direction * crossed(sight.direction) * right_jacobian(turn_camera) -
                     by_centre * to_camera.transpose() * crossed(shift) * right_jacobian(-turn_camera),
        -by_centre * to_camera.transpose();
  Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>> by_target(derivatives->by_target.data());
  by_target.leftCols<3>() = -by_point * to_rig * crossed(inner) * right_jacobian(turn_target);
  by_target.rightCols<3>() = by_point;
  Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>(derivatives->by_stack.data()) =
      by_direction * sight.by_stack;
  return true;
}

}  // namespace rptv
