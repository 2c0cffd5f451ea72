// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>

/// Code that the tests of battery and motors share.
namespace mebots::test {

/// The folder params/ of the FMU under test.
inline const std::filesystem::path kParams = MEBOTS_PARAMS;
inline constexpr std::int64_t kMillisecond = 1'000'000;

/// Returns the message of the mebots::Error that `call` throws. If it throws none, the test fails.
template <typename Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "no mebots::Error was thrown";
  return {};
}

}  // namespace mebots::test
