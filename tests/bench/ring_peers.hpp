// SPDX-License-Identifier: MIT
// One face, push and pop, for SpscRing and for the queues it is measured against.
#pragma once

#include <cstddef>

#include "core/spsc_ring.hpp"

#if __has_include(<readerwriterqueue/readerwriterqueue.h>)
#define RPTV_HAS_READERWRITERQUEUE
#include <readerwriterqueue/readerwriterqueue.h>
#endif
#if __has_include(<concurrentqueue/concurrentqueue.h>)
#define RPTV_HAS_CONCURRENTQUEUE
#include <concurrentqueue/concurrentqueue.h>
#endif
#if __has_include(<boost/lockfree/spsc_queue.hpp>)
#define RPTV_HAS_BOOST_LOCKFREE
#include <boost/lockfree/spsc_queue.hpp>
#endif

namespace rptv::bench {

template <class T>
struct Ours {
  static constexpr const char* kName = "rptv::SpscRing";
  explicit Ours(std::size_t capacity) : queue(capacity) {}
  bool push(T value) { return queue.try_push(std::move(value)); }
  bool pop(T& value) { return queue.try_pop(value); }
  SpscRing<T> queue;
};

#ifdef RPTV_HAS_READERWRITERQUEUE
template <class T>
struct ReaderWriter {
  static constexpr const char* kName = "moodycamel::ReaderWriterQueue";
  explicit ReaderWriter(std::size_t capacity) : queue(capacity) {}
  bool push(T value) { return queue.try_enqueue(std::move(value)); }
  bool pop(T& value) { return queue.try_dequeue(value); }
  moodycamel::ReaderWriterQueue<T> queue;
};
#endif

#ifdef RPTV_HAS_CONCURRENTQUEUE
template <class T>
struct Concurrent {
  static constexpr const char* kName = "moodycamel::ConcurrentQueue (tokens)";
  explicit Concurrent(std::size_t capacity) : queue(capacity, 1, 0), producer(queue), consumer(queue) {}
  bool push(T value) { return queue.try_enqueue(producer, std::move(value)); }
  bool pop(T& value) { return queue.try_dequeue(consumer, value); }
  moodycamel::ConcurrentQueue<T> queue;
  moodycamel::ProducerToken producer;
  moodycamel::ConsumerToken consumer;
};
#endif

#ifdef RPTV_HAS_BOOST_LOCKFREE
template <class T>
struct BoostSpsc {
  static constexpr const char* kName = "boost::lockfree::spsc_queue";
  explicit BoostSpsc(std::size_t capacity) : queue(capacity) {}
  bool push(T value) { return queue.push(value); }
  bool pop(T& value) { return queue.pop(value); }
  boost::lockfree::spsc_queue<T> queue;
};
#endif

}  // namespace rptv::bench
