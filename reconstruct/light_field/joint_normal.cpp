// SPDX-License-Identifier: MIT
// Blocks of 4×4, scaled to a unit diagonal, and conjugate gradients over them.
#include "reconstruct/light_field/joint_normal.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

constexpr std::size_t kMostNeighbours = 256, kMeanNeighbours = 32;  // those beyond are not coupled: slower, not wrong
constexpr int kMostIterations = 60;
constexpr float kSolved = 1e-3F;  // of the first residual
constexpr float kRidge = 1e-6F;

using Matrix4 = Eigen::Matrix<float, 4, 4, Eigen::RowMajor>;

float dot(std::span<const JointStep> a, std::span<const JointStep> b) noexcept {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t i = 0; i < 4; ++i) sum += static_cast<double>(a[k][i]) * static_cast<double>(b[k][i]);
  return static_cast<float>(sum);
}

/// to += factor·from
void add(float factor, std::span<const JointStep> from, std::span<JointStep> to) noexcept {
  for (std::size_t k = 0; k < to.size(); ++k)
    for (std::size_t i = 0; i < 4; ++i) to[k][i] += factor * from[k][i];
}

void add_outer(float weight, const JointStep& row, const JointStep& column, std::array<float, 16>& block) noexcept {
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) block[4 * i + j] += weight * row[i] * column[j];
}

JointStep gradient(const JointImages& images, std::size_t entry, float light) noexcept {
  return {light * images.dx()[entry], light * images.dy()[entry], light * images.dz()[entry], images.value()[entry]};
}

}  // namespace

JointNormal::JointNormal(std::size_t sensor_pixels, std::size_t max_particles, std::size_t max_entries,
                         std::size_t threads)
    : threads_(threads),
      newest_(sensor_pixels),
      older_(max_entries),
      owner_(max_entries),
      workspaces_(threads, Workspace{std::vector<std::int32_t>(max_particles, -1), {}}),
      blocks_(max_particles * kMeanNeighbours),
      blocks_of_(max_particles),
      diagonal_(max_particles),
      inverse_(max_particles),
      pull_(max_particles),
      scale_(max_particles),
      x_(max_particles),
      r_(max_particles),
      z_(max_particles),
      p_(max_particles),
      q_(max_particles) {
  for (auto& work : workspaces_) work.blocks.reserve(kMostNeighbours);
}

// What stands behind an entry in its pixel's list belongs to particles of lower numbers.
void JointNormal::list_touches(const JointImages& images) noexcept {
  std::fill(newest_.begin(), newest_.end(), -1);
  for (std::size_t k = 0; k < images.particles(); ++k) {
    const auto image = images.image(k);
    for (std::uint32_t e = image.first; e < image.first + image.count; ++e) {
      auto& newest = newest_[images.pixel()[e]];
      older_[e] = newest;
      newest = static_cast<std::int32_t>(e);
      owner_[e] = static_cast<std::uint32_t>(k);
    }
  }
}

void JointNormal::assemble(const JointImages& images, std::span<const JointParticle> particles,
                           std::span<const float> weight, std::span<const float> rest, double most_light) noexcept {
  count_ = particles.size();
  list_touches(images);
  blocks_end_ = 0, cut_ = false;
  parallel_for(count_, threads_, [&](std::size_t k, std::size_t thread) {
    assemble_one(k, images, particles, weight, rest, workspaces_[thread]);
    for (std::size_t i = 0; i < 4; ++i) scale_[k][i] = 1 / std::sqrt(diagonal_[k][5 * i] + 1e-12F);
    if (particles[k].light >= most_light && pull_[k][3] > 0) scale_[k][3] = 0;
  });
  parallel_for(count_, threads_, [&](std::size_t k, std::size_t) { scale(k); });
}

void JointNormal::assemble_one(std::size_t k, const JointImages& images, std::span<const JointParticle> particles,
                               std::span<const float> weight, std::span<const float> rest, Workspace& work) noexcept {
  const auto image = images.image(k);
  const auto light = static_cast<float>(particles[k].light);
  auto& diagonal = diagonal_[k];
  auto& pull = pull_[k];
  diagonal.fill(0), pull.fill(0);
  work.blocks.clear();
  for (std::uint32_t e = image.first; e < image.first + image.count; ++e) {
    const std::uint32_t pixel = images.pixel()[e];
    const JointStep mine = gradient(images, e, light);
    const float w = weight[pixel];
    add_outer(w, mine, mine, diagonal);
    for (std::size_t i = 0; i < 4; ++i) pull[i] += w * rest[pixel] * mine[i];
    for (std::int32_t touch = older_[e]; touch >= 0; touch = older_[static_cast<std::size_t>(touch)]) {
      const std::uint32_t other = owner_[static_cast<std::size_t>(touch)];
      auto& place = work.place_of[other];
      if (place < 0) {
        if (work.blocks.size() == kMostNeighbours) {
          cut_.store(true, std::memory_order_relaxed);
          continue;
        }
        place = static_cast<std::int32_t>(work.blocks.size());
        work.blocks.push_back({other, {}});
      }
      const JointStep theirs =
          gradient(images, static_cast<std::size_t>(touch), static_cast<float>(particles[other].light));
      add_outer(w, mine, theirs, work.blocks[static_cast<std::size_t>(place)].entries);
    }
  }
  for (const auto& block : work.blocks) work.place_of[block.other] = -1;
  const std::size_t first = blocks_end_.fetch_add(work.blocks.size(), std::memory_order_relaxed);
  const std::size_t room = blocks_.size() - std::min(first, blocks_.size()), count = std::min(work.blocks.size(), room);
  std::copy_n(work.blocks.begin(), count,
              blocks_.begin() + static_cast<std::ptrdiff_t>(std::min(first, blocks_.size())));
  blocks_of_[k] = {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)};
  if (count < work.blocks.size()) cut_.store(true, std::memory_order_relaxed);
}

void JointNormal::scale(std::size_t k) noexcept {
  const auto scale_block = [&](std::array<float, 16>& block, const JointStep& row, const JointStep& column) {
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) block[4 * i + j] *= row[i] * column[j];
  };
  scale_block(diagonal_[k], scale_[k], scale_[k]);
  for (std::size_t i = 0; i < 4; ++i) {
    diagonal_[k][5 * i] = 1;
    pull_[k][i] *= scale_[k][i];
  }
  for (std::size_t b = blocks_of_[k].first; b < blocks_of_[k].first + std::size_t{blocks_of_[k].count}; ++b)
    scale_block(blocks_[b].entries, scale_[k], scale_[blocks_[b].other]);
}

void JointNormal::invert_diagonal(float damping) noexcept {
  for (std::size_t k = 0; k < count_; ++k) {
    Matrix4 block = Eigen::Map<const Matrix4>(diagonal_[k].data());
    block.diagonal().array() += damping + kRidge;
    Eigen::Map<Matrix4>(inverse_[k].data()) = block.inverse();
  }
}

void JointNormal::multiply(std::span<const JointStep> x, float damping, std::span<JointStep> y) const noexcept {
  for (std::size_t k = 0; k < count_; ++k)
    for (std::size_t i = 0; i < 4; ++i) {
      y[k][i] = (damping + kRidge) * x[k][i];
      for (std::size_t j = 0; j < 4; ++j) y[k][i] += diagonal_[k][4 * i + j] * x[k][j];
    }
  for (std::size_t k = 0; k < count_; ++k)
    for (std::size_t b = blocks_of_[k].first; b < blocks_of_[k].first + std::size_t{blocks_of_[k].count}; ++b) {
      const auto& [other, entries] = blocks_[b];
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
          y[k][i] += entries[4 * i + j] * x[other][j];
          y[other][j] += entries[4 * i + j] * x[k][i];
        }
    }
}

void JointNormal::precondition(std::span<const JointStep> x, std::span<JointStep> y) const noexcept {
  for (std::size_t k = 0; k < count_; ++k)
    for (std::size_t i = 0; i < 4; ++i) {
      y[k][i] = 0;
      for (std::size_t j = 0; j < 4; ++j) y[k][i] += inverse_[k][4 * i + j] * x[k][j];
    }
}

std::span<const JointStep> JointNormal::solve(float damping) noexcept {
  const std::span x(x_.data(), count_), r(r_.data(), count_), z(z_.data(), count_), p(p_.data(), count_),
      q(q_.data(), count_);
  invert_diagonal(damping);
  std::fill(x.begin(), x.end(), JointStep{});
  std::copy_n(pull_.begin(), count_, r.begin());
  precondition(r, z);
  std::copy(z.begin(), z.end(), p.begin());
  float along = dot(r, z);
  const float enough = kSolved * kSolved * along;
  for (int iteration = 0; iteration < kMostIterations && along > enough; ++iteration) {
    multiply(p, damping, q);
    const float curvature = dot(p, q);
    if (!(curvature > 0)) break;
    add(along / curvature, p, x);
    add(-along / curvature, q, r);
    precondition(r, z);
    const float next = dot(r, z), keep = next / along;
    for (std::size_t k = 0; k < count_; ++k)
      for (std::size_t i = 0; i < 4; ++i) p[k][i] = z[k][i] + keep * p[k][i];
    along = next;
  }
  for (std::size_t k = 0; k < count_; ++k)
    for (std::size_t i = 0; i < 4; ++i) x[k][i] *= scale_[k][i];
  return x;
}

}  // namespace rptv
