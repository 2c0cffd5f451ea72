// SPDX-License-Identifier: Apache-2.0
#include "fmi/process/process_functions.hpp"

#include <getopt.h>

#include <algorithm>
#include <array>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace mebots::master {
namespace {

constexpr std::string_view kRandom = "random numbers";
constexpr std::string_view kDrand48 = "random numbers of drand48()";
constexpr std::string_view kTokens = "the position of strtok()";
constexpr std::string_view kOptions = "the position of getopt()";
constexpr std::string_view kCharacters = "the shift state of characters";
constexpr std::string_view kSign = "the sign of lgamma()";
constexpr std::string_view kEnvironment = "environment variables";
constexpr std::string_view kLocale = "the locale";
constexpr std::string_view kThreadLocale = "the locale of a thread";
constexpr std::string_view kFolder = "the working directory";
constexpr std::string_view kMask = "the mask of file modes";
constexpr std::string_view kLimits = "limits";
constexpr std::string_view kSignals = "signal handlers and masks";
constexpr std::string_view kTimers = "timers";
constexpr std::string_view kPriority = "priority and affinity";
constexpr std::string_view kThreads = "threads";
constexpr std::string_view kThreadData = "data of threads";
constexpr std::string_view kProcesses = "other processes";
constexpr std::string_view kFiles = "standard input, output and errors";
constexpr std::string_view kInput = "the position in standard input";
constexpr std::string_view kAttributes = "users, groups and attributes of the process";
constexpr std::string_view kMemory = "the settings of malloc()";
constexpr std::string_view kExit = "the functions that run at exit";
constexpr std::string_view kTable = "the hash table of hsearch()";
constexpr std::string_view kLog = "the settings of syslog()";
constexpr std::string_view kHandlers = "handlers of the C++ library";
constexpr std::string_view kStreams = "streams of the C++ library";

using enum Remedy;

constexpr auto kFunctions = std::to_array<ProcessFunction>({
    {"rand", kRandom, renewed},
    {"srand", kRandom, renewed},
    {"random", kRandom, renewed},
    {"srandom", kRandom, renewed},
    {"initstate", kRandom, renewed},
    {"setstate", kRandom, renewed},
    {"drand48", kDrand48, renewed},
    {"erand48", kDrand48, renewed},
    {"lrand48", kDrand48, renewed},
    {"nrand48", kDrand48, renewed},
    {"mrand48", kDrand48, renewed},
    {"jrand48", kDrand48, renewed},
    {"srand48", kDrand48, renewed},
    {"seed48", kDrand48, renewed},
    {"lcong48", kDrand48, renewed},
    {"strtok", kTokens, renewed},
    {"getopt", kOptions, renewed},
    {"getopt_long", kOptions, renewed},
    {"getopt_long_only", kOptions, renewed},
    {"optind", kOptions, renewed},
    {"mblen", kCharacters, renewed},
    {"mbtowc", kCharacters, renewed},
    {"wctomb", kCharacters, renewed},
    {"signgam", kSign, renewed},
    {"setenv", kEnvironment, undone},
    {"putenv", kEnvironment, undone},
    {"unsetenv", kEnvironment, undone},
    {"clearenv", kEnvironment, undone},
    {"environ", kEnvironment, undone},
    {"_environ", kEnvironment, undone},
    {"__environ", kEnvironment, undone},
    {"setlocale", kLocale, undone},
    {"uselocale", kThreadLocale, renewed},
    {"chdir", kFolder, undone},
    {"fchdir", kFolder, undone},
    {"chroot", kFolder, none},
    {"umask", kMask, undone},
    {"setrlimit", kLimits, undone},
    {"setrlimit64", kLimits, undone},
    {"prlimit", kLimits, undone},
    {"prlimit64", kLimits, undone},
    {"signal", kSignals, undone},
    {"bsd_signal", kSignals, undone},
    {"sysv_signal", kSignals, undone},
    {"__sysv_signal", kSignals, undone},
    {"sigaction", kSignals, undone},
    {"sigset", kSignals, undone},
    {"sigignore", kSignals, undone},
    {"siginterrupt", kSignals, undone},
    {"sigprocmask", kSignals, undone},
    {"sigblock", kSignals, undone},
    {"sigsetmask", kSignals, undone},
    {"pthread_sigmask", kSignals, undone},
    {"sigaltstack", kSignals, undone},
    {"alarm", kTimers, undone},
    {"ualarm", kTimers, undone},
    {"setitimer", kTimers, undone},
    {"timer_create", kTimers, undone},
    {"nice", kPriority, undone},
    {"setpriority", kPriority, undone},
    {"sched_setscheduler", kPriority, undone},
    {"sched_setparam", kPriority, undone},
    {"sched_setaffinity", kPriority, undone},
    {"pthread_setaffinity_np", kPriority, undone},
    {"pthread_setschedparam", kPriority, undone},
    {"pthread_create", kThreads, undone},
    {"thrd_create", kThreads, undone},
    {"_ZNSt6thread15_M_start_threadESt10unique_ptrINS_6_StateESt14default_deleteIS1_EEPFvvE", kThreads, undone},
    {"pthread_setspecific", kThreadData, none},
    {"tss_set", kThreadData, none},
    {"fork", kProcesses, undone},
    {"vfork", kProcesses, undone},
    {"clone", kProcesses, undone},
    {"posix_spawn", kProcesses, undone},
    {"posix_spawnp", kProcesses, undone},
    {"system", kProcesses, undone},
    {"popen", kProcesses, undone},
    {"daemon", kProcesses, undone},
    {"setsid", kProcesses, undone},
    {"setpgid", kProcesses, undone},
    {"dup2", kFiles, undone},
    {"dup3", kFiles, undone},
    {"freopen", kFiles, undone},
    {"freopen64", kFiles, undone},
    {"stdin", kInput, none},
    {"getchar", kInput, none},
    {"getchar_unlocked", kInput, none},
    {"scanf", kInput, none},
    {"vscanf", kInput, none},
    {"__isoc99_scanf", kInput, none},
    {"__isoc99_vscanf", kInput, none},
    {"getwchar", kInput, none},
    {"wscanf", kInput, none},
    {"prctl", kAttributes, undone},
    {"personality", kAttributes, none},
    {"unshare", kAttributes, none},
    {"setns", kAttributes, none},
    {"setuid", kAttributes, none},
    {"seteuid", kAttributes, none},
    {"setreuid", kAttributes, none},
    {"setresuid", kAttributes, none},
    {"setgid", kAttributes, none},
    {"setegid", kAttributes, none},
    {"setregid", kAttributes, none},
    {"setresgid", kAttributes, none},
    {"setgroups", kAttributes, none},
    {"mallopt", kMemory, none},
    {"mtrace", kMemory, none},
    {"mcheck", kMemory, none},
    {"mlockall", kMemory, none},
    {"on_exit", kExit, none},
    {"at_quick_exit", kExit, none},
    {"__cxa_at_quick_exit", kExit, none},
    {"hcreate", kTable, none},
    {"hsearch", kTable, none},
    {"hdestroy", kTable, none},
    {"openlog", kLog, none},
    {"setlogmask", kLog, none},
    {"_ZSt15set_new_handlerPFvvE", kHandlers, none},
    {"_ZSt13set_terminatePFvvE", kHandlers, none},
    {"_ZSt14set_unexpectedPFvvE", kHandlers, none},
    {"_ZNSt6locale6globalERKS_", kLocale, none},
    {"_ZNSt8ios_base15sync_with_stdioEb", kStreams, none},
    {"_ZSt3cin", kStreams, none},
    {"_ZSt4wcin", kStreams, none},
    {"_ZSt4cout", kStreams, undone},
    {"_ZSt4cerr", kStreams, undone},
    {"_ZSt4clog", kStreams, undone},
    {"_ZSt5wcout", kStreams, undone},
    {"_ZSt5wcerr", kStreams, undone},
    {"_ZSt5wclog", kStreams, undone},
});

/// Functions that close files. An FMU that imports them can be clean if its instances close only their own files.
constexpr auto kClosing = std::to_array<std::string_view>({"close", "close_range", "closefrom", "fclose", "fcloseall"});
/// Functions by which a library can find functions that it does not import.
constexpr auto kFinding = std::to_array<std::string_view>({"dlsym", "dlvsym", "dlopen", "dlmopen"});

constexpr auto kReadable = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"_ZNSt6thread15_M_start_threadESt10unique_ptrINS_6_StateESt14default_deleteIS1_EEPFvvE", "std::thread"},
    {"_ZSt15set_new_handlerPFvvE", "std::set_new_handler"},
    {"_ZSt13set_terminatePFvvE", "std::set_terminate"},
    {"_ZSt14set_unexpectedPFvvE", "std::set_unexpected"},
    {"_ZNSt6locale6globalERKS_", "std::locale::global"},
    {"_ZNSt8ios_base15sync_with_stdioEb", "std::ios_base::sync_with_stdio"},
    {"_ZSt3cin", "std::cin"},
    {"_ZSt4wcin", "std::wcin"},
    {"_ZSt4cout", "std::cout"},
    {"_ZSt4cerr", "std::cerr"},
    {"_ZSt4clog", "std::clog"},
    {"_ZSt5wcout", "std::wcout"},
    {"_ZSt5wcerr", "std::wcerr"},
    {"_ZSt5wclog", "std::wclog"},
    {"__isoc99_scanf", "scanf"},
    {"__isoc99_vscanf", "vscanf"},
    {"__sysv_signal", "sysv_signal"},
    {"__cxa_at_quick_exit", "at_quick_exit"},
});

void renew_random_numbers() {
  constexpr unsigned kFirstSeed = 1;         // the default seed in POSIX
  static std::array<char, 128> state;        // the size of the default state
  static std::array<char, 128> other_state;  // is active while `state` is written
  initstate(kFirstSeed, other_state.data(), other_state.size());
  initstate(kFirstSeed, state.data(), state.size());
  std::array<unsigned short, 3> zeros{};
  seed48(zeros.data());
}

}  // namespace

std::span<const ProcessFunction> process_functions() {
  return kFunctions;
}

const ProcessFunction* find_process_function(std::string_view symbol) {
  const auto* const found = std::ranges::find(kFunctions, symbol, &ProcessFunction::symbol);
  return found == kFunctions.end() ? nullptr : found;
}

ProcessReach reach_of(std::string_view symbol) {
  if (find_process_function(symbol) != nullptr || std::ranges::find(kFinding, symbol) != kFinding.end())
    return ProcessReach::everything;
  return std::ranges::find(kClosing, symbol) != kClosing.end() ? ProcessReach::descriptors : ProcessReach::nothing;
}

std::string_view readable_name(const ProcessFunction& function) {
  const auto* const found = std::ranges::find(kReadable, function.symbol, [](const auto& row) { return row.first; });
  return found == kReadable.end() ? function.symbol : found->second;
}

void renew_c_library() {
  renew_random_numbers();
  static char nothing[] = "";
  static_cast<void>(std::strtok(nothing, " "));
  optind = 0;  // restarts getopt() of the GNU C library
  static_cast<void>(std::mblen(nullptr, 0));
  static_cast<void>(std::mbtowc(nullptr, nullptr, 0));
  [[maybe_unused]] const int depends_on_shift = std::wctomb(nullptr, L'\0');
  signgam = 0;
  uselocale(LC_GLOBAL_LOCALE);
}

}  // namespace mebots::master
