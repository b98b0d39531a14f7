// SPDX-License-Identifier: MIT
// Switches stacks by Boost.Context, which needs no system call, and tells the sanitizers.
#include "tests/cuda_host/fiber.hpp"

#include <sys/mman.h>

#include <boost/context/detail/fcontext.hpp>
#include <new>

#include "tests/cuda_host/sanitizer_hooks.hpp"

namespace rptv::cuda_host {
namespace {

using boost::context::detail::jump_fcontext;
using boost::context::detail::make_fcontext;
using boost::context::detail::transfer_t;

constexpr std::size_t kGuardBytes = 4096;
constexpr std::size_t kStackBytes = 256 * 1024;  // touched pages only take memory

/// Who resumed the fiber that runs.
struct Resumer {
  void* context;
  void* fake_stack;
  const void* stack_bottom;
  std::size_t stack_bytes;
  void* identity;
};
Resumer resumer;
Fiber* running = nullptr;

char* stack_of(void* mapping) { return static_cast<char*>(mapping) + kGuardBytes; }

void begin(transfer_t from) {
  enter_stack(nullptr, &resumer.stack_bottom, &resumer.stack_bytes);
  resumer.context = from.fctx;
  running->live();
}

}  // namespace

Fiber::Fiber(void (*body)()) : body_(body), identity_(new_identity()) {
  const Unobserved unobserved;
  mapping_ = mmap(nullptr, kGuardBytes + kStackBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapping_ == MAP_FAILED) throw std::bad_alloc();
  mprotect(mapping_, kGuardBytes, PROT_NONE);
  context_ = make_fcontext(stack_of(mapping_) + kStackBytes, kStackBytes, &begin);
}

Fiber::~Fiber() {
  const Unobserved unobserved;
  permit(mapping_, kGuardBytes + kStackBytes);
  munmap(mapping_, kGuardBytes + kStackBytes);
  drop_identity(identity_);
}

void Fiber::resume() {
  running = this;
  resumer.identity = current_identity();
  leave_stack(&resumer.fake_stack, stack_of(mapping_), kStackBytes);
  assume_identity(identity_);
  context_ = jump_fcontext(context_, nullptr).fctx;
  enter_stack(resumer.fake_stack, nullptr, nullptr);
}

void Fiber::leave() {
  Fiber& left = *running;
  leave_stack(&left.fake_stack_, resumer.stack_bottom, resumer.stack_bytes);
  assume_identity(resumer.identity);
  resumer.context = jump_fcontext(resumer.context, nullptr).fctx;
  enter_stack(left.fake_stack_, &resumer.stack_bottom, &resumer.stack_bytes);
}

void Fiber::release_order(void* token) const {
  void* const caller = current_identity();
  assume_identity(identity_);
  release(token);
  assume_identity(caller);
}

void Fiber::live() {
  for (;;) {
    body_();
    leave();
  }
}

}  // namespace rptv::cuda_host
