// SPDX-License-Identifier: MIT
// Coordinates in which every particle alone has unit covariance; groups; elimination without pivots.
#include "reconstruct/light_field/joint_covariance.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

constexpr float kFaintPath = 0.03F;                    // a path of this strength moves a variance by its square
constexpr float kLeastPivot = 1e-7F;                   // of 1: two that cannot be told apart
constexpr double kMostStrength = 0.9;                  // of what a group leaves out
constexpr double kOwnRidge = 1e-7, kHarderRidge = 10;  // where rounding leaves a block that is not positive

using Matrix4f = Eigen::Matrix<float, 4, 4, Eigen::RowMajor>;

FitCovariance covariance_in_mm2(const Eigen::Matrix4d& c) noexcept {
  return {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
}

}  // namespace

JointCovariance::JointCovariance(std::size_t max_particles, std::size_t max_blocks, std::size_t threads)
    : threads_(threads),
      root_(max_particles),
      first_link_(max_particles + 1),
      next_link_(max_particles),
      links_(2 * max_blocks),
      workspaces_(threads) {
  for (auto& work : workspaces_) {
    work.strength_of.resize(max_particles), work.place_of.assign(max_particles, -1);
    work.matrix.resize(16 * kMostGroup * kMostGroup);
    work.group.reserve(kMostGroup), work.border.reserve(max_particles);
  }
}

void JointCovariance::find(const JointNormal& normal, std::span<JointSpread> spreads) noexcept {
  parallel_for(normal.particles(), threads_, [&](std::size_t k, std::size_t) { whiten(normal, k); });
  link(normal);
  parallel_for(normal.particles(), threads_, [&](std::size_t k, std::size_t thread) {
    spreads[k] = spread_of(normal, static_cast<std::uint32_t>(k), workspaces_[thread]);
  });
}

void JointCovariance::whiten(const JointNormal& normal, std::size_t k) noexcept {
  Eigen::Matrix4d own = Eigen::Map<const Matrix4f>(normal.diagonal(k).data()).cast<double>();
  Eigen::LLT<Eigen::Matrix4d> factor(own);
  for (double ridge = kOwnRidge; factor.info() != Eigen::Success && ridge <= 1; ridge *= kHarderRidge)
    factor.compute(own + ridge * Eigen::Matrix4d::Identity());
  const Eigen::Matrix4d root = factor.matrixL().solve(Eigen::Matrix4d::Identity());
  Eigen::Map<Matrix4f>(root_[k].data()) = root.cast<float>();
}

// Blocks stand with one of their two particles; here both have them.
void JointCovariance::link(const JointNormal& normal) noexcept {
  const std::size_t count = normal.particles();
  std::fill_n(first_link_.begin(), count + 1, 0U);
  for (std::size_t k = 0; k < count; ++k)
    for (const auto& block : normal.blocks_of(k)) ++first_link_[k + 1], ++first_link_[block.other + 1];
  for (std::size_t k = 0; k < count; ++k) first_link_[k + 1] += first_link_[k], next_link_[k] = first_link_[k];
  for (std::size_t k = 0; k < count; ++k)
    for (const auto& block : normal.blocks_of(k)) {
      const Eigen::Map<const Matrix4f> mine(root_[k].data()), theirs(root_[block.other].data());
      std::array<float, 16> there{}, back{};
      Eigen::Map<Matrix4f> forth(there.data());
      forth = mine * Eigen::Map<const Matrix4f>(block.entries.data()) * theirs.transpose();
      Eigen::Map<Matrix4f>(back.data()) = forth.transpose();
      add_link(static_cast<std::uint32_t>(k), block.other, there);
      add_link(block.other, static_cast<std::uint32_t>(k), back);
    }
}

void JointCovariance::add_link(std::uint32_t from, std::uint32_t to, const std::array<float, 16>& entries) noexcept {
  const float norm = Eigen::Map<const Matrix4f>(entries.data()).norm();
  links_[next_link_[from]++] = {to, std::min(norm, 1.0F), entries};
}

// Into the group; whoever it is coupled to comes to its border.
void JointCovariance::take_in(const Near& near, Workspace& work) const noexcept {
  work.place_of[near.particle] = static_cast<std::int32_t>(work.group.size());
  work.group.push_back(near);
  for (std::uint32_t l = first_link_[near.particle]; l < first_link_[near.particle + 1]; ++l) {
    const Link& link = links_[l];
    const float strength = near.strength * link.strength;
    if (work.place_of[link.other] >= 0 || strength < kFaintPath) continue;
    if (!(work.strength_of[link.other] > 0)) work.border.push_back({link.other, 0});
    work.strength_of[link.other] = std::max(work.strength_of[link.other], strength);
  }
}

// Returns the strength² of the strongest for which there was no room.
float JointCovariance::gather_group(std::uint32_t k, Workspace& work) const noexcept {
  work.group.clear(), work.border.clear();
  take_in({k, 1}, work);
  const auto weaker = [&](const Near& a, const Near& b) {
    const float of_a = work.strength_of[a.particle], of_b = work.strength_of[b.particle];
    return of_a != of_b ? of_a < of_b : a.particle > b.particle;
  };
  while (!work.border.empty() && work.group.size() < kMostGroup) {
    const auto next = std::max_element(work.border.begin(), work.border.end(), weaker);
    const Near near{next->particle, work.strength_of[next->particle]};
    *next = work.border.back();
    work.border.pop_back();
    work.strength_of[near.particle] = 0;
    take_in(near, work);
  }
  float left = 0;
  for (const auto& near : work.border) {
    left = std::max(left, work.strength_of[near.particle] * work.strength_of[near.particle]);
    work.strength_of[near.particle] = 0;
  }
  return left;
}

// The group's matrix, the particle itself last; then all columns but its own, from the first on.
void JointCovariance::eliminate(Workspace& work) const noexcept {
  const std::size_t members = work.group.size(), size = 4 * members;
  float* a = work.matrix.data();
  std::fill_n(a, size * size, 0.0F);
  const auto row_of = [&](std::size_t place) { return 4 * (members - 1 - place); };
  for (std::size_t m = 0; m < members; ++m) {
    const std::uint32_t particle = work.group[m].particle;
    for (std::size_t i = 0; i < 4; ++i) a[(row_of(m) + i) * size + row_of(m) + i] = 1;
    for (std::uint32_t l = first_link_[particle]; l < first_link_[particle + 1]; ++l) {
      const std::int32_t place = work.place_of[links_[l].other];
      if (place < 0) continue;
      const std::size_t column = row_of(static_cast<std::size_t>(place));
      for (std::size_t i = 0; i < 4; ++i)
        std::copy_n(links_[l].entries.data() + 4 * i, 4, a + (row_of(m) + i) * size + column);
    }
  }
  for (std::size_t c = 0; c + 4 < size; ++c) {
    const float* pivot = a + c * size;
    const float per_pivot = 1 / std::max(pivot[c], kLeastPivot);
    for (std::size_t r = c + 1; r < size; ++r) {
      const float factor = pivot[r] * per_pivot;
      if (factor == 0) continue;
      float* row = a + r * size;
      for (std::size_t k = r; k < size; ++k) row[k] -= factor * pivot[k];
    }
  }
}

JointSpread JointCovariance::spread_of(const JointNormal& normal, std::uint32_t k, Workspace& work) const noexcept {
  const float left = gather_group(k, work);
  eliminate(work);
  const std::size_t size = 4 * work.group.size();
  Eigen::Matrix4d rest;  // what the particle's own block still knows
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i; j < 4; ++j)
      rest(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          rest(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) =
              static_cast<double>(work.matrix[(size - 4 + i) * size + size - 4 + j]);
  for (const auto& near : work.group) work.place_of[near.particle] = -1;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(rest);
  Eigen::Vector4d gain = solver.eigenvalues().cwiseMax(static_cast<double>(kLeastPivot)).cwiseMin(1.0).cwiseInverse();
  if (left > 0) gain /= 1 - std::min(static_cast<double>(left), kMostStrength);
  const auto& s = normal.scale_of(k);
  const Eigen::Matrix4d back = Eigen::Vector4d(s[0], s[1], s[2], s[3]).asDiagonal() *
                               Eigen::Map<const Matrix4f>(root_[k].data()).cast<double>().transpose();
  const Eigen::Matrix4d turned = back * solver.eigenvectors();
  return {covariance_in_mm2(back * back.transpose()),
          covariance_in_mm2(turned * (gain.array() - 1).matrix().asDiagonal() * turned.transpose()),
          left > 0 || normal.is_cut()};
}

}  // namespace rptv
