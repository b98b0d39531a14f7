// SPDX-License-Identifier: MIT
// The two measurements, hand-over and round trip, and their table.
#include "tests/bench/ring_bench.hpp"

#include <array>
#include <cstdint>
#include <iomanip>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/clock.hpp"
#include "tests/bench/contest.hpp"
#include "tests/bench/ring_peers.hpp"

namespace rptv {
namespace {

// What travels: `key` tells whether order and content survived.
struct Small {
  std::uint64_t key = 0;
};
struct CacheLine {
  std::uint64_t key = 0;
  std::array<std::uint64_t, 7> rest{};
};

// Spins, and lets others run on a crowded machine; the same for every queue.
class Backoff {
 public:
  void pause() noexcept {
    if (++spins_ % 4096 == 0) std::this_thread::yield();
    __builtin_ia32_pause();
  }

 private:
  unsigned spins_ = 0;
};

template <class Queue, class T>
void send(Queue& queue, std::uint64_t key) {
  T value;
  value.key = key;
  for (Backoff backoff; !queue.push(value);) backoff.pause();
}

template <class Queue, class T>
void receive(Queue& queue, std::uint64_t expected_key) {
  T value;
  for (Backoff backoff; !queue.pop(value);) backoff.pause();
  if (value.key != expected_key) throw std::runtime_error(std::string(Queue::kName) + " lost or reordered a value");
}

template <class Queue, class T>
double hand_over_ns(const RingBenchOptions& options) {
  const auto queue = std::make_unique<Queue>(static_cast<std::size_t>(options.capacity));
  const auto n = static_cast<std::uint64_t>(options.items);
  std::atomic<bool> ready{false};
  std::thread producer([&] {
    ready = true;
    for (std::uint64_t i = 1; i <= n; ++i) send<Queue, T>(*queue, i);
  });
  while (!ready) __builtin_ia32_pause();
  const std::int64_t begin_ns = host_now_ns();
  for (std::uint64_t i = 1; i <= n; ++i) receive<Queue, T>(*queue, i);
  const std::int64_t end_ns = host_now_ns();
  producer.join();
  return static_cast<double>(end_ns - begin_ns) / static_cast<double>(n);
}

template <class Queue, class T>
double round_trip_ns(const RingBenchOptions& options) {
  const auto there = std::make_unique<Queue>(static_cast<std::size_t>(options.capacity));
  const auto back = std::make_unique<Queue>(static_cast<std::size_t>(options.capacity));
  const auto n = static_cast<std::uint64_t>(options.round_trips);
  std::thread echo([&] {
    for (std::uint64_t i = 0; i <= n; ++i) {
      receive<Queue, T>(*there, i);
      send<Queue, T>(*back, i);
    }
  });
  std::int64_t begin_ns = 0;
  for (std::uint64_t i = 0; i <= n; ++i) {
    send<Queue, T>(*there, i);
    receive<Queue, T>(*back, i);
    if (i == 0) begin_ns = host_now_ns();  // the first one waits for the thread to start
  }
  const std::int64_t end_ns = host_now_ns();
  echo.join();
  return static_cast<double>(end_ns - begin_ns) / static_cast<double>(n);
}

struct Contender {
  const char* name;
  double (*hand_over)(const RingBenchOptions&);
  double (*round_trip)(const RingBenchOptions&);
  std::vector<double> hand_over_ns;
  std::vector<double> round_trip_ns;
};

template <class Queue, class T>
Contender contender() {
  return {Queue::kName, hand_over_ns<Queue, T>, round_trip_ns<Queue, T>, {}, {}};
}

template <class T>
std::vector<Contender> contenders() {
  std::vector<Contender> all{contender<bench::Ours<T>, T>()};
#ifdef RPTV_HAS_READERWRITERQUEUE
  all.push_back(contender<bench::ReaderWriter<T>, T>());
#endif
#ifdef RPTV_HAS_CONCURRENTQUEUE
  all.push_back(contender<bench::Concurrent<T>, T>());
#endif
#ifdef RPTV_HAS_BOOST_LOCKFREE
  all.push_back(contender<bench::BoostSpsc<T>, T>());
#endif
  return all;
}

// Median over the rounds of one's time over ours in the same round: virtual cores move between rounds, and a hand-over
// between neighbours takes a fifth of one across the chip.
double paired_ratio(const std::vector<double>& one, const std::vector<double>& ours) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < one.size(); ++i) ratios.push_back(one[i] / ours[i]);
  return bench::median(ratios);
}

void print_row(std::ostream& out, const Contender& one, const Contender& ours) {
  out << "  " << std::left << std::setw(38) << one.name << std::right << std::fixed << std::setprecision(2)
      << std::setw(9) << bench::median(one.hand_over_ns) << std::setw(8)
      << paired_ratio(one.hand_over_ns, ours.hand_over_ns) << std::setprecision(1) << std::setw(12)
      << bench::median(one.round_trip_ns) << std::setprecision(2) << std::setw(8)
      << paired_ratio(one.round_trip_ns, ours.round_trip_ns) << '\n';
}

template <class T>
void measure(std::ostream& out, const RingBenchOptions& options) {
  std::vector<Contender> all = contenders<T>();
  for (int round = 0; round < options.rounds; ++round) {
    for (Contender& one : all) one.hand_over_ns.push_back(one.hand_over(options));
    for (Contender& one : all) one.round_trip_ns.push_back(one.round_trip(options));
  }
  out << "\npayload " << sizeof(T) << " bytes" << std::setw(42) << "hand-over" << std::setw(20) << "round trip\n"
      << std::setw(49) << "ns" << std::setw(8) << "ratio" << std::setw(12) << "ns" << std::setw(8) << "ratio\n";
  for (const Contender& one : all) print_row(out, one, all.front());
}

}  // namespace

void bench_ring(std::ostream& out, const RingBenchOptions& options) {
  out << "one producer, one consumer, capacity " << options.capacity << "; medians of " << options.rounds
      << " alternating runs of " << options.items << " values and " << options.round_trips << " round trips\non "
      << bench::machine() << "; ratio: time over rptv::SpscRing's in the same round\n";
  measure<Small>(out, options);
  measure<CacheLine>(out, options);
}

}  // namespace rptv
