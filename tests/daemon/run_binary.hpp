// SPDX-License-Identifier: MIT
// Runs the real rapidptv as another process and keeps what it said.
#pragma once

#include <fcntl.h>
#include <grp.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

namespace rptv::testing {

struct Said {
  int code = -1;    ///< exit code; -1 when a signal ended it
  int signal = 0;   ///< SIGALRM: it did not end by itself
  std::string out;  ///< standard output
  std::string err;  ///< standard error
};

namespace detail {

inline int scratch_file() {
  std::string name = "/tmp/rapidptv-said-XXXXXX";
  const int file = mkostemp(name.data(), O_CLOEXEC);
  unlink(name.c_str());
  return file;
}

inline std::string content(int file) {
  std::string text(static_cast<std::size_t>(lseek(file, 0, SEEK_END)), '\0');
  if (pread(file, text.data(), text.size(), 0) < 0) text.clear();
  close(file);
  return text;
}

}  // namespace detail

/// `arguments` without the program's name. Environment variable RAPIDPTV names the binary. It is ended after 60 s.
/// `as_nobody`: root runs it as user 65534, whom file permissions bind. It need not be reachable for that user, so it
/// is rapidptv-daemon itself, which rapidptv would look for by its path.
inline Said run_rapidptv(const std::vector<std::string>& arguments, bool as_nobody = false) {
  const char* binary = std::getenv("RAPIDPTV");
  if (binary == nullptr) std::abort();
  std::vector<char*> words{const_cast<char*>("rapidptv")};
  for (const auto& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const bool drops = as_nobody && geteuid() == 0;
  const int program = open((std::string(binary) + (drops ? "-daemon" : "")).c_str(), O_RDONLY | O_CLOEXEC),
            out = detail::scratch_file(), err = detail::scratch_file();
  const pid_t child = fork();
  if (child == 0) {
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    alarm(60);
    if (drops && (setgroups(0, nullptr) != 0 || setgid(65534) != 0 || setuid(65534) != 0)) _exit(126);
    fexecve(program, words.data(), environ);
    _exit(127);
  }
  int status = 0;
  waitpid(child, &status, 0);
  close(program);
  Said said;
  if (WIFEXITED(status)) said.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) said.signal = WTERMSIG(status);
  said.out = detail::content(out);
  said.err = detail::content(err);
  return said;
}

}  // namespace rptv::testing
