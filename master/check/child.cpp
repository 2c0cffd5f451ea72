// SPDX-License-Identifier: Apache-2.0
#include "child.hpp"

#include "fmi/call/callbacks.hpp"
#include "mebots/error.hpp"
#include "slave/isolation/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

namespace mebots::check {
namespace {

/// Memory that the child shares with the parent. The memory remains valid after the child's end.
struct BlackBox {
  char doing[400];
  char callback[40];  // name of MEbots' callback in which the child crashed
  std::atomic<pid_t> child;
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

BlackBox* signalled_box = nullptr;

/// Records whether the crash occurred in MEbots' code. Then the signal's default action ends the process, because the
/// handler is installed with SA_RESETHAND.
void on_signal(int signal) {
  const auto callback = master::current_callback();
  // If a callback only allocates or frees memory, a crash results from a bad pointer of the FMU.
  const char* name = callback.only_memory ? nullptr : callback.name;
  for (std::size_t i = 0; name != nullptr && i + 1 < sizeof(BlackBox::callback) && name[i] != '\0'; ++i)
    signalled_box->callback[i] = name[i];
  raise(signal);
}

void catch_crashes(BlackBox& box) {
  signalled_box = &box;
  struct sigaction action {};
  action.sa_handler = &on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGBUS}) sigaction(signal, &action, nullptr);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) std::signal(signal, SIG_DFL);
}

/// Sends findings as JSON lines through a pipe.
class PipeWitness final : public Witness {
 public:
  PipeWitness(int pipe, BlackBox& box) : pipe_(pipe), box_(&box) {}

  void error(std::string text, std::string way_out) override { send("error", text, way_out); }
  void warning(std::string text, std::string way_out) override { send("warning", text, way_out); }
  void remark(std::string text, std::string way_out) override { send("remark", text, way_out); }
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

[[noreturn]] void be_child(pid_t parent, int pipe, BlackBox& box, const std::function<void(Witness&)>& work) {
  constexpr rlim_t kMemory = rlim_t{16} << 30;
  setsid();  // protects the keeper from signals to the parent's group
  try {
    master::isolation::fork_kept(parent);
  } catch (const Error&) {
    _exit(EXIT_FAILURE);
  }
  box.child = getpid();
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers reserve terabytes
  const rlimit memory{kMemory, kMemory};
  setrlimit(RLIMIT_AS, &memory);
#else
  (void)kMemory;
#endif
  catch_crashes(box);
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
  _exit(0);  // skips destructors
}

/// The time that counts towards a child's deadline [s]: processor time and sleeping time, but not waiting for a
/// processor.
class SpentTime {
 public:
  /// `child` contains the process number of the child. The child must have stored it before seconds() is called.
  explicit SpentTime(const std::atomic<pid_t>& child) : child_(&child) {}

  double seconds() {
    const auto now = std::chrono::steady_clock::now();
    const double computed_s = computed();
    if (computed_s == computed_s_ && sleeps()) slept_ += now - last_;
    spent_s_ += computed_s - computed_s_;
    computed_s_ = computed_s;
    last_ = now;
    return spent_s_ + std::chrono::duration<double>(slept_).count();
  }

 private:
  double computed() const {
    clockid_t clock{};
    timespec time{};
    if (*child_ == 0 || clock_getcpuclockid(*child_, &clock) != 0 || clock_gettime(clock, &time) != 0)
      return computed_s_;
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  /// True unless the process is running. In /proc/PID/stat, the state is the letter after the name in parentheses.
  bool sleeps() const {
    std::ifstream file(fmt::format("/proc/{}/stat", child_->load()));
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    const auto name_end = text.rfind(')');
    return name_end == std::string::npos || name_end + 2 >= text.size() || text[name_end + 2] != 'R';
  }

  const std::atomic<pid_t>* child_;
  double computed_s_ = 0;
  double spent_s_ = 0;
  std::chrono::steady_clock::duration slept_{};
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

bool has_ended(pid_t keeper) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(keeper), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != 0;
}

bool is_given_up(const CrashRule& rule) {
  return rule.given_up != nullptr && *rule.given_up;
}

/// Reads until the pipe is closed or the child has ended. Checks both, because a descendant of the child may keep the
/// pipe open. Returns false if the deadline passes or the user cancels the check.
bool read_all(int pipe, pid_t keeper, const BlackBox& box, const CrashRule& rule, std::string& text) {
  constexpr int kLook_ms = 50;
  SpentTime spent(box.child);
  for (bool ended = false;;) {
    if (!ended && (is_given_up(rule) || spent.seconds() > rule.deadline_s)) return false;
    pollfd watched{pipe, POLLIN, 0};
    const int ready = poll(&watched, 1, ended ? 0 : kLook_ms);
    if (ready < 0 && errno != EINTR) return true;
    if (ready <= 0) {
      if (ended) return true;  // no more output
      ended = has_ended(keeper);
      continue;
    }
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
    if (end == std::string::npos) return;  // the child died while writing this line
    const auto json = nlohmann::json::parse(lines.substr(at, end - at), nullptr, false);
    at = end + 1;
    if (!json.is_object()) continue;
    const auto severity = json.value("severity", "");
    const auto level = severity == "remark" ? Level::pedantic : Level::interoperable;
    findings.at(level).add(severity == "error" ? Severity::error : Severity::warning, json.value("text", ""),
                           json.value("way_out", ""));
  }
}

struct ChildEnd {
  bool in_time;
  int status;
  std::string doing;
  std::string callback;  ///< name of MEbots' callback in which the child crashed
  bool finished;
};

int status_of(pid_t keeper) {
  int status = 0;
  while (waitpid(keeper, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

ChildEnd run_once(const CrashRule& rule, Findings& findings, const std::function<void(Witness&)>& work) {
  SharedBox box;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw Error(ErrorCode::system_failure, fmt::format("no pipe: {}", std::strerror(errno)));
  const pid_t parent = getpid();
  const pid_t keeper = fork();
  if (keeper < 0) {
    close(ends[0]);
    close(ends[1]);
    throw Error(ErrorCode::system_failure, fmt::format("no child process: {}", std::strerror(errno)));
  }
  if (keeper == 0) {
    close(ends[0]);
    be_child(parent, ends[1], *box, work);
  }
  close(ends[1]);
  std::string lines;
  const bool in_time = read_all(ends[0], keeper, *box, rule, lines);
  close(ends[0]);
  if (!in_time) master::isolation::end_kept(keeper);
  const int status = status_of(keeper);
  if (is_given_up(rule)) throw Interrupted();
  take(lines, findings);
  return {in_time, status, (*box).doing[0] == '\0' ? "the start" : (*box).doing, (*box).callback, (*box).finished};
}

std::string crash_text(const ChildEnd& end) {
  const int signal = WTERMSIG(end.status);
  const char* name = sigabbrev_np(signal);
  return fmt::format("crashed with {} ({}) in {}", name == nullptr ? "signal" : std::string("SIG") + name,
                     strsignal(signal), end.doing);
}

/// Finds the cause of a crash in a callback by repeating the experiment with empty callbacks.
void judge(const CrashRule& rule, Findings& findings, const ChildEnd& end, const std::function<void(Witness&)>& work) {
  Check dropped;  // the first run already reported its findings
  Findings dropped_findings(dropped);
  const auto without = run_once(rule, dropped_findings, [&](Witness& witness) {
    master::ignore_callbacks();
    work(witness);
  });
  if (without.in_time && WIFSIGNALED(without.status) && without.callback.empty()) {
    findings.add(rule.severity,
                 fmt::format("{}: it damaged memory that it does not own, which made the callback {} fail",
                             crash_text(without), end.callback),
                 rule.way_out);
    return;
  }
  throw Error(ErrorCode::system_failure, fmt::format("mebots itself failed ({}) in its callback {}, called in {}: this "
                                                     "is not an error of the FMU; please report it",
                                                     strsignal(WTERMSIG(end.status)), end.callback, end.doing));
}

}  // namespace

void run_in_child(const CrashRule& rule, Findings findings, const std::function<void(Witness&)>& work) {
  const auto end = run_once(rule, findings, work);
  if (!end.in_time) {
    findings.add(rule.severity,
                 fmt::format("{1} did not return within {0} s of computing or sleeping", rule.deadline_s, end.doing),
                 "set a longer --deadline, or look for an endless loop");
  } else if (WIFSIGNALED(end.status) && !end.callback.empty()) {
    judge(rule, findings, end, work);
  } else if (WIFSIGNALED(end.status)) {
    findings.add(rule.severity, crash_text(end), rule.way_out);
  } else if (!end.finished) {
    findings.add(rule.severity,
                 fmt::format("ended the process with exit code {} in {}", WEXITSTATUS(end.status), end.doing),
                 "an FMU must never call exit(): return fmi2Error or fmi2Fatal");
  }
}

}  // namespace mebots::check
