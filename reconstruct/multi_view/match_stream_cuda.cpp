// SPDX-License-Identifier: MIT
// Queues the steps of matching, in the order of Correspondence::match() and MultiView's choice.
#include "reconstruct/multi_view/match_stream_cuda.hpp"

#include <algorithm>
#include <cstring>

#include "reconstruct/cuda_stage_timer.hpp"

namespace rptv {

MatchStream::MatchStream(const MatchRig& rig)
    : rig_(rig), memory_(rig.size(), rig.options()), transfer_(rig.size(), rig.options()) {
  for (const ViewRays& rays : rig.views())
    views_.emplace_back(rays, rig.options().max_detections, rig.judging().scale_mm, false);
  chosen_.reserve(rig.options().max_matches);
}

CudaViews MatchStream::device_views() const noexcept {
  return {rig_.on_device(),
          memory_.ray.data(),
          memory_.u.data(),
          memory_.v.data(),
          memory_.rows.data(),
          memory_.settled.data(),
          memory_.cell_start.data(),
          memory_.cell.data(),
          memory_.cell_entry.data(),
          static_cast<std::uint32_t>(memory_.max_detections),
          static_cast<std::uint32_t>(rig_.size())};
}

CudaMatches MatchStream::device_matches() const noexcept {
  double* value = memory_.match.data();
  const std::size_t most = memory_.max_matches;
  return {memory_.matches.view(rig_.size()), value, value + most, value + 2 * most, value + 3 * most, value + 4 * most};
}

void MatchStream::submit(std::span<const Detections> seen) noexcept {
  for (std::size_t v = 0; v < views_.size(); ++v) {
    counts_.unusable_detections += views_[v].look(seen[v]);
    sizes_[v] = static_cast<std::uint32_t>(views_[v].size());
  }
  queued_ = upload() && search() && choose() && download();
}

bool MatchStream::upload() noexcept {
  const auto copy = [this](const auto& to, const auto& by, const auto* from, std::size_t first, std::size_t count,
                           std::size_t per_item) {
    const std::size_t bytes = count * sizeof *from;
    std::memcpy(static_cast<void*>(by.data() + first), from, bytes);
    return stream_.upload(to.data() + first * per_item, by.data() + first, bytes);
  };
  bool ok = stream_.stage(CudaStage::upload);
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const SeenView& view = views_[v];
    const std::size_t first = v * memory_.max_detections;
    ok = ok && copy(memory_.ray, transfer_.ray, view.rays_begin(), first, view.size(), 1) &&
         copy(memory_.u, transfer_.u, view.u_begin(), first, view.size(), 1) &&
         copy(memory_.v, transfer_.v, view.v_begin(), first, view.size(), 1) &&
         copy(memory_.rows, transfer_.rows, view.rows_begin(), first, view.size(), 8);
  }
  const auto zero = [this](const auto& array) {
    return stream_.fill(array.data(), 0, array.size() * sizeof *array.data());
  };
  return ok && zero(memory_.settled) && zero(memory_.used) && zero(memory_.chosen) && zero(memory_.tuples.count) &&
         zero(memory_.doubtful.count) && zero(memory_.matches.count) && zero(memory_.packed_count) &&
         zero(memory_.counts);
}

bool MatchStream::search() noexcept {
  const CudaViews views = device_views();
  const CudaPairs pairs{memory_.pair_first.data(),
                        memory_.pair_second.data(),
                        memory_.pair_depth_mm.data(),
                        memory_.pair_count.data(),
                        static_cast<std::uint32_t>(memory_.max_pairs),
                        memory_.counts.data()};
  const CudaBins pencil{memory_.bin_start.data(), memory_.bin.data(), memory_.bin_entry.data()};
  const CudaHits hits{memory_.hit.data(), memory_.hits.data()};
  const CorrespondenceOptions& options = rig_.options();
  CudaExtension extension{0, 0, static_cast<std::uint32_t>(options.min_views), options.tolerance_px};
  CudaMatchCounts* counts = memory_.counts.data();
  bool ok = stream_.stage(CudaStage::cells);
  for (std::uint32_t v = 1; v < views.views; ++v)
    ok = ok && sort_into_cells_cuda(views, v, sizes_[v], rig_.cell_of(v), stream_.handle(), rig_.threads_per_block());
  for (std::uint32_t first = 0; first + options.min_views <= views.views; ++first)
    for (std::uint32_t second = first + 1; second + options.min_views <= views.views + 1; ++second) {
      extension.first = first, extension.second = second;
      ok = ok && stream_.stage(CudaStage::pairs) &&
           find_pairs_cuda(rig_.search(views, first, second, sizes_), pencil, pairs, stream_.handle(),
                           rig_.threads_per_block()) &&
           stream_.stage(CudaStage::tuples) &&
           extend_pairs_cuda(views, pairs, extension, hits, memory_.tuples.view(views.views), counts, stream_.handle(),
                             rig_.threads_per_block()) &&
           end_list_cuda(pairs.count, pairs.capacity, &counts->refused_pairs, stream_.handle()) && solve() &&
           settle_cuda(views, device_matches(), options.tolerance_px, stream_.handle(), rig_.threads_per_block());
    }
  return ok;
}

// Tuples that do not meet lose a view at a time.
bool MatchStream::solve() noexcept {
  const CudaViews views = device_views();
  const CudaDltRows rows{memory_.rows.data(), static_cast<std::uint32_t>(memory_.max_detections)};
  double* value = memory_.point.data();
  const std::size_t most = memory_.max_tuples;
  const CudaPoints points{value, value + most, value + 2 * most, value + 3 * most};
  CudaTuples from = memory_.tuples.view(rig_.size()), to = memory_.doubtful.view(rig_.size());
  bool ok = stream_.stage(CudaStage::dlt);
  for (std::size_t left = rig_.size(); left >= rig_.options().min_views; --left) {
    ok = ok && solve_dlt_cuda(rows, from, points, stream_.handle(), rig_.threads_per_block()) &&
         judge_tuples_cuda(views, from, points, rig_.judging(), device_matches(), to, stream_.handle(),
                           rig_.threads_per_block()) &&
         end_list_cuda(from.count, from.capacity, &memory_.counts.data()->refused_tuples, stream_.handle());
    std::swap(from, to);
  }
  return ok;
}

// What a match loses to others may leave enough views to be a particle: such remains compete again.
bool MatchStream::choose() noexcept {
  constexpr int kRounds = 4;
  const CudaMatches matches = device_matches();
  const auto max_detections = static_cast<std::uint32_t>(memory_.max_detections);
  const CudaGhosts ghosts{matches.s, memory_.chosen.data(), memory_.used.data(), memory_.owner.data(), max_detections};
  bool ok = stream_.stage(CudaStage::ghosts);
  for (int round = 0; round < kRounds; ++round) {
    if (round > 0)
      ok = ok &&
           list_remains_cuda(matches, ghosts.chosen, ghosts.used, max_detections, rig_.judging().min_views,
                             memory_.tuples.view(rig_.size()), stream_.handle(), rig_.threads_per_block()) &&
           solve() && stream_.stage(CudaStage::ghosts);
    ok = ok && choose_by_rank_cuda(matches.tuples, ghosts, CudaRank::by_views_then_s, stream_.handle(),
                                   rig_.threads_per_block());
  }
  return ok &&
         pack_chosen_cuda(matches, ghosts.chosen, memory_.packed.data(), memory_.packed_count.data(),
                          static_cast<std::uint32_t>(memory_.max_matches), stream_.handle(), rig_.threads_per_block());
}

bool MatchStream::download() noexcept {
  MatchTransfer::Found& found = transfer_.found[0];
  return stream_.stage(CudaStage::download) &&
         stream_.download(&found.chosen, memory_.packed_count.data(), sizeof found.chosen) &&
         stream_.download(&found.matches, memory_.matches.count.data(), sizeof found.matches) &&
         stream_.download(&found.counts, memory_.counts.data(), sizeof found.counts) && stream_.stage(CudaStage::none);
}

std::span<const ViewMatch> MatchStream::collect() noexcept {
  chosen_.clear();
  const bool done = std::exchange(queued_, false) && stream_.synchronize();
  const MatchTransfer::Found& found = transfer_.found[0];
  if (!done || !stream_.stage(CudaStage::download) ||
      !stream_.download(transfer_.packed.data(), memory_.packed.data(), found.chosen * sizeof(CudaChosen)) ||
      !stream_.stage(CudaStage::none) || !stream_.synchronize()) {
    ++counts_.failed;
    return {};
  }
  counts_.refused_hits += found.counts.refused_hits, counts_.refused_pairs += found.counts.refused_pairs;
  counts_.refused_tuples += found.counts.refused_tuples;
  counts_.rays = found.counts.rays, counts_.pairs = found.counts.pairs;
  counts_.refused_matches += found.matches > memory_.max_matches ? found.matches - memory_.max_matches : 0;
  for (std::size_t i = 0; i < found.chosen; ++i) {
    const CudaChosen& from = transfer_.packed[i];
    ViewMatch match{ViewTuple::none(), {from.at_mm[0], from.at_mm[1], from.at_mm[2]}, from.square_px2, from.s};
    for (std::size_t v = 0; v < rig_.size(); ++v) match.tuple.put(v, from.detection[v]);
    chosen_.push_back(match);
  }
  std::sort(chosen_.begin(), chosen_.end(),
            [](const ViewMatch& a, const ViewMatch& b) { return a.tuple.detection < b.tuple.detection; });
  return chosen_;
}

}  // namespace rptv
