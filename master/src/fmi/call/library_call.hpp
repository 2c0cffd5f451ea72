// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/call/callbacks.hpp"
#include "fmi/call/foreign_call.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace mebots::master {

/// Calls code of an FMU's library outside of its instances. Throws InputError if the code throws an exception. The
/// error contains "while it was" and `doing`.
template <typename Work>
auto call_library(const std::filesystem::path& archive, const char* doing, Work work) {
  const auto name = archive.filename().string();
  const LibraryScope scope(name.c_str(), doing);
  try {
    return call_foreign(work);
  } catch (const ForeignException& exception) {
    throw InputError(ErrorCode::fmu_failed, fmt::format("{}: the FMU's library {} while it was {}", archive.string(),
                                                        exception.what(), doing));
  }
}

}  // namespace mebots::master
