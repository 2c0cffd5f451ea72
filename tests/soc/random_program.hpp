// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace mebots::soc::test {

/// Returns assembly text of a program that ends: nested loops of random arithmetic, loads and stores (also misaligned,
/// and in a second, small memory), branches, calls, counters, environment calls. The same seed gives the same text.
/// Interrupts are on, and their handler counts them.
std::string random_program(std::uint32_t seed);

}  // namespace mebots::soc::test
