// SPDX-License-Identifier: Apache-2.0
#include "fmi/call/foreign_call.hpp"

#include "fmi/call/callbacks.hpp"
#include "fmi/call/exit_guard.hpp"
#include "message/message_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <exception>
#include <memory>
#include <typeinfo>
#include <vector>

namespace mebots::master {
namespace {

std::string type_text(const std::type_info& type) {
  int problem = 0;
  const std::unique_ptr<char, decltype(&std::free)> name(abi::__cxa_demangle(type.name(), nullptr, nullptr, &problem),
                                                         &std::free);
  return name ? name.get() : type.name();
}

}  // namespace

std::string escaped_exception_text() {
  const auto* const type = abi::__cxa_current_exception_type();
  if (type == nullptr) return "threw an exception of another language through its C interface";
  std::string said;
  try {
    throw;
  } catch (const std::exception& error) {
    said = fmt::format(" ({})", one_line(valid_utf8(read_text(error.what()).value_or("unreadable"))));
  } catch (...) {  // NOLINT(bugprone-empty-catch): its type is all that is known
  }
  return fmt::format("threw {}{} through its C interface", type_text(*type), said);
}

void end_with_thread() {
  constexpr const char* kWhat = "ended the thread that called it (pthread_exit or pthread_cancel)";
  end_busy_runs(kWhat);
  std::fprintf(stderr, "mebots: error: an FMU %s\n", kWhat);
  for (;;) syscall(SYS_exit_group, EXIT_FAILURE);
}

// Bits of the registers: Intel 64 and IA-32 Architectures Software Developer's Manual, volume 1, figures 10-3 (MXCSR)
// and 8-6 (control word).
std::string difference_text(const FloatEnvironment& found, const FloatEnvironment& wanted) {
  constexpr std::array kRounding = {"to nearest", "downward", "upward", "toward zero"};
  constexpr std::uint32_t kTraps = 0x1f80;
  constexpr std::uint32_t kFlushToZero = 0x8000;
  constexpr std::uint32_t kDenormalsAreZero = 0x0040;
  const auto rounding = [](const FloatEnvironment& environment) { return (environment.mxcsr >> 13) & 3; };
  const auto differs = [&](std::uint32_t bits) { return ((found.mxcsr ^ wanted.mxcsr) & bits) != 0; };
  std::vector<std::string> parts;
  if (rounding(found) != rounding(wanted)) parts.push_back(fmt::format("rounding {}", kRounding[rounding(found)]));
  if (differs(kFlushToZero | kDenormalsAreZero)) {
    parts.emplace_back((found.mxcsr & (kFlushToZero | kDenormalsAreZero)) != 0
                           ? "denormal numbers become 0"
                           : "denormal numbers are not flushed to 0");
  }
  if (differs(kTraps)) parts.emplace_back("exceptions end the process");
  if (found.x87 != wanted.x87) {
    parts.push_back(fmt::format("x87 control word {:#06x} instead of {:#06x}", found.x87, wanted.x87));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace mebots::master
