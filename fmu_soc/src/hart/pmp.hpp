// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc {

enum class Mode : std::uint8_t { user = 0, machine = 3 };

/// Physical memory protection: the addresses at which a privilege mode may fetch, load and store. The granularity is
/// four bytes. Source: The RISC-V Instruction Set Manual, volume II (20240411), section 3.7.
class Pmp {
 public:
  static constexpr unsigned kMostEntries = 16;

  enum class Access : std::uint8_t { load = 1, store = 2, fetch = 4 };  // bits of an entry's configuration

  explicit Pmp(unsigned entries) : entries_(entries) { restart(); }

  unsigned entries() const { return entries_; }
  void restart();

  /// Return and set the registers pmpcfg0 to pmpcfg3, which contain four configurations each.
  std::uint32_t configurations(unsigned index) const;
  void set_configurations(unsigned index, std::uint32_t value);
  std::uint32_t address(unsigned entry) const { return entry < entries_ ? addresses_[entry] : 0; }
  void set_address(unsigned entry, std::uint32_t value);

  /// Returns true if the mode may access all of these bytes.
  bool allows(std::uint32_t address, unsigned size, Access access, Mode mode) const;
  /// Returns true if the mode may fetch, load and store at all addresses, so that no access needs a check.
  bool allows_all(Mode mode) const { return mode == Mode::machine ? machine_is_free_ : user_is_free_; }

  void visit(state::Visitor& v);

 private:
  struct Range {
    std::uint64_t first = 0;
    std::uint64_t end = 0;  // if equal to `first`, the range is empty
  };

  bool is_locked(unsigned entry) const;
  Range range_of(unsigned entry) const;
  bool is_free(Mode mode) const;
  void update_free();

  unsigned entries_;
  std::array<std::uint8_t, kMostEntries> configurations_{};
  std::array<std::uint32_t, kMostEntries> addresses_{};
  // Results of allows_all(). They are computed in advance, because each trap needs them.
  bool machine_is_free_ = true;
  bool user_is_free_ = true;
};

}  // namespace mebots::soc
