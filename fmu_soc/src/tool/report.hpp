// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "observe/text_file.hpp"
#include "soc/soc.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace mebots::soc::tool {

/// Prints what a run did: instructions, cycles, time, energy by component, speed of the host, tohost.
void print_report(const Soc& soc, double host_s, std::optional<std::uint32_t> tohost);

/// The words between the symbols begin_signature and end_signature, 8 hexadecimal digits a line.
class Signature {
 public:
  /// Throws Error, before the run, when the program lacks the symbols, they lie outside its memory, or the file cannot
  /// be written.
  Signature(const std::string& path, const Soc& soc);
  /// Takes the words as they are now.
  void write(const Soc& soc);

 private:
  std::uint32_t begin_ = 0;
  std::uint32_t end_ = 0;
  observe::TextFile file_;
};

}  // namespace mebots::soc::tool
