// SPDX-License-Identifier: MIT
// Debian's libzmq is not built for ThreadSanitizer, which therefore does not see how it hands messages to its threads.
extern "C" const char* __tsan_default_suppressions() { return "called_from_lib:libzmq.so\nrace:libzmq.so\n"; }
