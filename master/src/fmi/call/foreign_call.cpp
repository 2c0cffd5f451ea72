// SPDX-License-Identifier: Apache-2.0
#include "fmi/call/foreign_call.hpp"

#include "fmi/call/callback_text.hpp"
#include "fmi/call/exit_guard.hpp"

#include "message/plain_text.hpp"

#include <fmt/format.h>

#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <memory>
#include <typeinfo>

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

}  // namespace mebots::master
