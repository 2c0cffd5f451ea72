// SPDX-License-Identifier: Apache-2.0
#include "child.hpp"

#include "mebots/error.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>

namespace mebots::check {
namespace {

/// A page that parent and child share: it survives the child.
struct BlackBox {
  char doing[400];
  bool finished;
};

class SharedBox {
 public:
  SharedBox() : memory_(mmap(nullptr, sizeof(BlackBox), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED)
      throw Error(ErrorCode::system_failure, fmt::format("no shared memory: {}", std::strerror(errno)));
  }
  ~SharedBox() { munmap(memory_, sizeof(BlackBox)); }
  SharedBox(const SharedBox&) = delete;
  SharedBox& operator=(const SharedBox&) = delete;

  BlackBox& operator*() const { return *static_cast<BlackBox*>(memory_); }

 private:
  void* memory_;
};

/// Findings as lines of JSON through a pipe.
class PipeWitness final : public Witness {
 public:
  PipeWitness(int pipe, BlackBox& box) : pipe_(pipe), box_(&box) {}

  void error(std::string text, std::string way_out) override { send("error", text, way_out); }
  void warning(std::string text, std::string way_out) override { send("warning", text, way_out); }
  void doing(std::string_view what) override {
    const auto size = std::min(what.size(), sizeof(box_->doing) - 1);
    std::memcpy(box_->doing, what.data(), size);
    box_->doing[size] = '\0';
  }

 private:
  void send(const char* severity, const std::string& text, const std::string& way_out) const {
    const nlohmann::json json{{"severity", severity}, {"text", text}, {"way_out", way_out}};
    const auto line = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    for (std::size_t at = 0; at < line.size();) {
      const auto count = write(pipe_, line.data() + at, line.size() - at);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return;
      at += static_cast<std::size_t>(count);
    }
  }

  int pipe_;
  BlackBox* box_;
};

[[noreturn]] void be_child(int pipe, BlackBox& box, const std::function<void(Witness&)>& work) {
  constexpr rlim_t kMemory = rlim_t{16} << 30;
  setpgid(0, 0);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they reserve terabytes
  const rlimit memory{kMemory, kMemory};
  setrlimit(RLIMIT_AS, &memory);
#else
  (void)kMemory;
#endif
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGBUS, SIGTERM, SIGINT}) std::signal(signal, SIG_DFL);
  const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  close(nowhere);
  PipeWitness witness(pipe, box);
  try {
    work(witness);
  } catch (const std::exception& error) {
    witness.error(error.what(), "see the FMU's documentation");
  }
  box.finished = true;
  _exit(0);  // no destructors of the parent's copy
}

/// Reads until the child closed its end. False when the deadline came first.
bool read_all(int pipe, double deadline_s, std::string& text) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(deadline_s);
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now()).count();
    if (left <= 0) return false;
    pollfd watched{pipe, POLLIN, 0};
    const int ready = poll(&watched, 1, static_cast<int>(std::min<long>(left, 1000)));
    if (ready < 0 && errno != EINTR) return true;
    if (ready <= 0) continue;
    char buffer[4096];
    const auto count = read(pipe, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return true;
    text.append(buffer, static_cast<std::size_t>(count));
  }
}

void take(const std::string& lines, Findings& findings) {
  for (std::size_t at = 0; at < lines.size();) {
    const auto end = lines.find('\n', at);
    if (end == std::string::npos) return;  // half a line: the child died writing it
    const auto json = nlohmann::json::parse(lines.substr(at, end - at), nullptr, false);
    at = end + 1;
    if (!json.is_object()) continue;
    findings.add(json.value("severity", "") == "warning" ? Severity::warning : Severity::error, json.value("text", ""),
                 json.value("way_out", ""));
  }
}

}  // namespace

void run_in_child(const CrashRule& rule, Findings findings, const std::function<void(Witness&)>& work) {
  SharedBox box;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw Error(ErrorCode::system_failure, fmt::format("no pipe: {}", std::strerror(errno)));
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    throw Error(ErrorCode::system_failure, fmt::format("no child process: {}", std::strerror(errno)));
  }
  if (child == 0) {
    close(ends[0]);
    be_child(ends[1], *box, work);
  }
  close(ends[1]);
  std::string lines;
  const bool in_time = read_all(ends[0], rule.deadline_s, lines);
  close(ends[0]);
  if (!in_time) {
    kill(-child, SIGKILL);
    kill(child, SIGKILL);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  take(lines, findings);
  const std::string doing = (*box).doing[0] == '\0' ? "the start" : (*box).doing;
  if (!in_time) {
    findings.add(rule.severity, fmt::format("no answer within {} s from {}", rule.deadline_s, doing),
                 "give more time with --deadline, or look for an endless loop");
  } else if (WIFSIGNALED(status)) {
    findings.add(
        rule.severity,
        fmt::format(
            "crashed with {} ({}) in {}",
            sigabbrev_np(WTERMSIG(status)) == nullptr ? "signal" : std::string("SIG") + sigabbrev_np(WTERMSIG(status)),
            strsignal(WTERMSIG(status)), doing),
        rule.way_out);
  } else if (!(*box).finished) {
    findings.add(rule.severity, fmt::format("ended the process with exit code {} in {}", WEXITSTATUS(status), doing),
                 "an FMU must never call exit(): answer fmi2Error or fmi2Fatal");
  }
}

}  // namespace mebots::check
