// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc {

enum class Mode : std::uint8_t { user = 0, machine = 3 };

/// Physical memory protection: determines which addresses a privilege mode may fetch, load and store. Source: The
/// RISC-V Instruction Set Manual, volume II (20240411), section 3.7. The granularity is four bytes.
class Pmp {
 public:
  static constexpr unsigned kMostEntries = 16;

  enum class Access : std::uint8_t { load = 1, store = 2, fetch = 4 };  // bits of a configuration

  explicit Pmp(unsigned entries) : entries_(entries) { restart(); }

  unsigned entries() const { return entries_; }
  void restart();

  /// pmpcfg0 to pmpcfg3: four configurations each.
  std::uint32_t configurations(unsigned index) const;
  void set_configurations(unsigned index, std::uint32_t value);
  std::uint32_t address(unsigned entry) const { return entry < entries_ ? addresses_[entry] : 0; }
  void set_address(unsigned entry, std::uint32_t value);

  /// True if the mode may access all of the bytes.
  bool allows(std::uint32_t address, unsigned size, Access access, Mode mode) const;
  /// True if the mode may fetch, load and store at all addresses. If so, no access needs a check.
  bool allows_all(Mode mode) const { return mode == Mode::machine ? machine_is_free_ : user_is_free_; }

  void visit(state::Visitor& v);

 private:
  struct Range {
    std::uint64_t first = 0;
    std::uint64_t end = 0;  // equal to `first`: no address
  };

  bool is_locked(unsigned entry) const;
  Range range_of(unsigned entry) const;
  bool is_free(Mode mode) const;
  void update_free();

  unsigned entries_;
  std::array<std::uint8_t, kMostEntries> configurations_{};
  std::array<std::uint32_t, kMostEntries> addresses_{};
  // Results of allows_all(): computed from the entries, because each trap needs them.
  bool machine_is_free_ = true;
  bool user_is_free_ = true;
};

}  // namespace mebots::soc
