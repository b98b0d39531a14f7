// SPDX-License-Identifier: MIT
// How much light of a particle a point of a sub-image gets, and how that changes with the particle's position. Host and
// device.
#pragma once

#include <cmath>

#include "reconstruct/light_field/gauss_edge_kernel.hpp"

namespace rptv {

/// A rim that cuts the exit pupil: what lies inside |p + shift·a| < radius, for the pupil's point p and the array's
/// point a, is open (PupilRim).
struct RimView {
  float shift, radius;
  float edge;  ///< 1/(σ√2) of its border
};

/// A particle seen through one lenslet. A ray of slope s meets the array at a = particle - s·z; it belongs to this
/// lenslet when a lies in its square cell, and it exists when it comes from the exit pupil, a disc at z = D: all depth
/// information is in the borders of the cells, which cut the pupil's image into pieces (one piece a lenslet).
/// Lengths in mm, slopes dimensionless; image space.
struct ParticleView {
  float x, y, z;       ///< particle
  float cosine, sine;  ///< of the array's rotation
  float half_pitch;
  float edge, edge_z;   ///< 1/(σ√2) of a cell's border on the array plane, and d(edge)/dz / edge
  float flatness;       ///< of that border's blur, see blurred_edge()
  float to_pupil;       ///< D - z (telecentric: 1)
  float with_position;  ///< 1: the pupil is at a finite distance; 0: telecentric, the "pupil" is a disc of slopes
  float pupil_radius;   ///< of the half-light contour (telecentric: of the cone, as a slope)
  float pupil_edge;     ///< 1/(σ√2) of the pupil's border
  float rim_pull;  ///< covariance of a ray's errors on the pupil and on the array, over σ√2 of the pupil's border
  float light_z;   ///< d(light)/dz / light: light spreads over a smaller cone of slopes nearer to the pupil
  float light;     ///< per point and unit of light, where neither border cuts
  RimView rims[2];
  bool has_rims;
};

/// Light and its derivatives with respect to the particle's x, y and z.
struct ParticleLight {
  float value, dx, dy, dz;
};

/// What rims leave of the light, and its derivatives with respect to x and y.
struct RimLight {
  float share, dx, dy;
};

RPTV_HOST_DEVICE_INLINE RimLight past_rims(const ParticleView& v, float p_x, float p_y, float array_x,
                                           float array_y) noexcept {
  RimLight all{1, 0, 0};
  for (const RimView& rim : v.rims) {
    const float q_x = p_x + rim.shift * array_x, q_y = p_y + rim.shift * array_y;
    const float radius = sqrtf(q_x * q_x + q_y * q_y) + 1e-12F;
    const GaussEdge edge = gauss_edge((rim.radius - radius) * rim.edge);
    const float per_radius = -edge.bell * rim.edge * (1 + rim.shift) / radius;
    all = {all.share * edge.share, all.dx * edge.share + all.share * per_radius * q_x,
           all.dy * edge.share + all.share * per_radius * q_y};
  }
  return all;
}

/// A point of slope (s_x, s_y) of the lenslet whose centre is at (c_x, c_y).
template <bool kRims>
RPTV_HOST_DEVICE_INLINE ParticleLight light_at(const ParticleView& v, float c_x, float c_y, float s_x,
                                               float s_y) noexcept {
  // Where the ray leaves the pupil.
  const float p_x = v.with_position * v.x + s_x * v.to_pupil, p_y = v.with_position * v.y + s_y * v.to_pupil;
  const float radius = sqrtf(p_x * p_x + p_y * p_y) + 1e-12F;
  const GaussEdge rim = gauss_edge((v.pupil_radius - radius) * v.pupil_edge);
  // Where it meets the array, from the cell's centre, in the cell's axes. Light that just passes the rim has been moved
  // inwards, by the particle's size and the pixel's, and that moves it on the array too.
  const float moved = v.rim_pull * rim.bell / (rim.share * radius + 1e-30F);
  const float a_x = v.x - s_x * v.z - c_x - moved * p_x, a_y = v.y - s_y * v.z - c_y - moved * p_y;
  const float along = v.cosine * a_x + v.sine * a_y, across = v.cosine * a_y - v.sine * a_x;
  const float low_u = (along + v.half_pitch) * v.edge, high_u = (along - v.half_pitch) * v.edge;
  const float low_v = (across + v.half_pitch) * v.edge, high_v = (across - v.half_pitch) * v.edge;
  const GaussEdge u0 = blurred_edge(low_u, v.flatness), u1 = blurred_edge(high_u, v.flatness);
  const GaussEdge v0 = blurred_edge(low_v, v.flatness), v1 = blurred_edge(high_v, v.flatness);
  const float in_u = u0.share - u1.share, in_v = v0.share - v1.share;
  const float du = (u0.bell - u1.bell) * v.edge, dv = (v0.bell - v1.bell) * v.edge;
  // The blur of the border grows with |z|.
  const float widening =
      v.edge_z * ((low_u * u0.bell - high_u * u1.bell) * in_v + (low_v * v0.bell - high_v * v1.bell) * in_u);
  const float per_radius = -rim.bell * v.pupil_edge * v.with_position / radius;
  const float cell_x = v.cosine * du * in_v - v.sine * in_u * dv, cell_y = v.sine * du * in_v + v.cosine * in_u * dv;
  const float in_cell = in_u * in_v, pupil_x = in_cell * per_radius * p_x, pupil_y = in_cell * per_radius * p_y;
  float d_x = rim.share * cell_x + pupil_x, d_y = rim.share * cell_y + pupil_y;
  float value = rim.share * in_cell, wider = rim.share * widening;
  if constexpr (kRims) {
    const RimLight rims = past_rims(v, p_x, p_y, v.x - s_x * v.z, v.y - s_y * v.z);
    d_x = d_x * rims.share + value * rims.dx, d_y = d_y * rims.share + value * rims.dy;
    value *= rims.share, wider *= rims.share;
  }
  return {v.light * value, v.light * d_x, v.light * d_y, v.light * (wider + v.light_z * value - s_x * d_x - s_y * d_y)};
}

}  // namespace rptv
