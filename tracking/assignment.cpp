// SPDX-License-Identifier: MIT
// The assignment's three phases. Reduced cost of a link: cost − price(particle) − potential(track), never negative.
#include "tracking/assignment.hpp"

#include <algorithm>

namespace rptv {

Assignment::Assignment(std::size_t max_sources, std::size_t max_targets)
    : target_of_(max_sources, kNone),
      targets_(max_targets),
      free_(max_sources),
      heap_(max_targets),
      done_(max_targets) {}

bool Assignment::solve(const Candidates& candidates, std::span<const std::uint32_t> subnet, double unlinked_cost,
                       Deadline& deadline) noexcept {
  unlinked_cost_ = unlinked_cost;
  start_greedily(candidates, subnet);
  reduce_rows(candidates, 4 * subnet.size());
  while (free_count_ > 0) {
    if (!augment(candidates, free_[free_count_ - 1], deadline)) {
      take_left_over(candidates);
      return false;
    }
    --free_count_;
  }
  return true;
}

void Assignment::approximate(const Candidates& candidates, std::span<const std::uint32_t> subnet,
                             double unlinked_cost) noexcept {
  unlinked_cost_ = unlinked_cost;
  start_greedily(candidates, subnet);
  reduce_rows(candidates, 4 * subnet.size());
  take_left_over(candidates);
}

void Assignment::take_left_over(const Candidates& candidates) noexcept {
  while (free_count_ > 0) {
    const std::uint32_t source = free_[--free_count_];
    for (const Candidate& c : candidates.of(source))
      if (targets_[c.place].owner == kNone) {
        own(source, c.place, c.cost);
        break;
      }
  }
}

void Assignment::own(std::uint32_t source, std::uint32_t target, double cost) noexcept {
  target_of_[source] = target;
  targets_[target].owner = source;
  targets_[target].owner_cost = cost;
}

/// Every track takes its nearest particle if nobody has it. Prices stay 0, so all reduced costs are right.
void Assignment::start_greedily(const Candidates& candidates, std::span<const std::uint32_t> subnet) noexcept {
  for (const std::uint32_t s : subnet)
    for (const Candidate& c : candidates.of(s)) targets_[c.place] = Target{};
  search_ = 0;
  free_count_ = 0;
  for (const std::uint32_t s : subnet) {
    const Candidate& nearest = candidates.of(s).front();
    target_of_[s] = kNone;
    if (targets_[nearest.place].owner == kNone)
      own(s, nearest.place, nearest.cost);
    else
      free_[free_count_++] = s;
  }
}

/// A free track takes its best particle at the price that its second best choice sets, and frees the owner: most
/// conflicts end here, in a few steps. Ties and everything beyond `most_steps` are left to augment().
void Assignment::reduce_rows(const Candidates& candidates, std::size_t most_steps) noexcept {
  std::size_t left_over = 0;
  for (std::size_t next = 0; next < free_count_; ++next) {
    std::uint32_t source = free_[next];
    while (source != kNone) {
      const Choice choice = best_choice(candidates.of(source));
      target_of_[source] = kNone;
      if (choice.target == kNone) break;
      const std::uint32_t owner = targets_[choice.target].owner;
      if (owner != kNone && (choice.gain <= 0 || most_steps == 0)) {
        free_[left_over++] = source;  // never beyond `next`: one of them ends at most one chain
        break;
      }
      if (owner != kNone) --most_steps;
      targets_[choice.target].price -= choice.gain;
      own(source, choice.target, choice.cost);
      source = owner;
    }
  }
  free_count_ = left_over;
}

Assignment::Choice Assignment::best_choice(std::span<const Candidate> row) const noexcept {
  Choice best{kNone, unlinked_cost_, 0};
  double least = unlinked_cost_;
  double second = unlinked_cost_;
  for (const Candidate& c : row) {
    if (c.cost >= second) break;  // nearest first, and prices are never positive
    const double reduced = c.cost - targets_[c.place].price;
    if (reduced < least) {
      second = least;
      least = reduced;
      best = {c.place, c.cost, 0};
    } else {
      second = std::min(second, reduced);
    }
  }
  best.gain = second - least;
  return best;
}

/// Distances are along alternating paths from `source`, whose own potential cancels out. False, and nothing changed,
/// past the deadline.
bool Assignment::augment(const Candidates& candidates, std::uint32_t source, Deadline& deadline) noexcept {
  ++search_;
  heap_size_ = done_count_ = 0;
  PathEnd end{unlinked_cost_, kNone, source};
  relax(candidates.of(source), source, 0.0, end);
  while (heap_size_ > 0 && targets_[heap_[0]].distance < end.distance) {
    const std::uint32_t nearest = pop();
    done_[done_count_++] = nearest;
    const Target& target = targets_[nearest];
    if (deadline.passed(static_cast<std::uint32_t>(candidates.of(target.owner).size()))) return false;
    const double potential = target.owner_cost - target.price;
    relax(candidates.of(target.owner), target.owner, target.distance - potential, end);
  }
  for (std::size_t i = 0; i < done_count_; ++i) {
    Target& target = targets_[done_[i]];
    target.price += target.distance - end.distance;
  }
  flip(end, source);
  return true;
}

void Assignment::relax(std::span<const Candidate> row, std::uint32_t source, double offset, PathEnd& end) noexcept {
  if (offset + unlinked_cost_ < end.distance) end = {offset + unlinked_cost_, kNone, source};
  for (const Candidate& c : row) {
    if (offset + c.cost >= end.distance) break;
    Target& target = targets_[c.place];
    const double distance = offset + c.cost - target.price;
    if (distance >= end.distance) continue;
    const bool seen = target.search == search_;
    if (seen && (target.heap_at == kDone || distance >= target.distance)) continue;
    target.via = source;
    target.via_cost = c.cost;
    target.distance = distance;
    if (target.owner == kNone) {
      end = {distance, c.place, source};
      continue;
    }
    if (!seen) {
      target.search = search_;
      target.heap_at = static_cast<std::uint32_t>(heap_size_++);
      heap_[target.heap_at] = c.place;
    }
    push_or_raise(c.place);
  }
}

/// Moves every link along the path one step on, from its end back to where it began.
void Assignment::flip(const PathEnd& end, std::uint32_t start) noexcept {
  std::uint32_t target = end.target;
  if (target == kNone) {
    target = target_of_[end.source];
    target_of_[end.source] = kNone;
    if (end.source == start) return;
  }
  while (true) {
    const std::uint32_t source = targets_[target].via;
    const std::uint32_t given_up = target_of_[source];
    own(source, target, targets_[target].via_cost);
    if (source == start) return;
    target = given_up;
  }
}

void Assignment::push_or_raise(std::uint32_t target) noexcept {
  const double distance = targets_[target].distance;
  std::uint32_t at = targets_[target].heap_at;
  while (at > 0) {
    const std::uint32_t above = (at - 1) / 2;
    if (targets_[heap_[above]].distance <= distance) break;
    heap_[at] = heap_[above];
    targets_[heap_[at]].heap_at = at;
    at = above;
  }
  heap_[at] = target;
  targets_[target].heap_at = at;
}

std::uint32_t Assignment::pop() noexcept {
  const std::uint32_t top = heap_[0];
  targets_[top].heap_at = kDone;
  const std::uint32_t moved = heap_[--heap_size_];
  if (heap_size_ == 0) return top;
  const double distance = targets_[moved].distance;
  std::uint32_t at = 0;
  while (2 * at + 1 < heap_size_) {
    std::uint32_t below = 2 * at + 1;
    if (below + 1 < heap_size_ && targets_[heap_[below + 1]].distance < targets_[heap_[below]].distance) ++below;
    if (targets_[heap_[below]].distance >= distance) break;
    heap_[at] = heap_[below];
    targets_[heap_[at]].heap_at = at;
    at = below;
  }
  heap_[at] = moved;
  targets_[moved].heap_at = at;
  return top;
}

}  // namespace rptv
