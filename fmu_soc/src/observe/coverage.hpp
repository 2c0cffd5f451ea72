// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elf/elf.hpp"
#include "hart/observer.hpp"
#include "observe/text_file.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>

namespace mebots::soc::observe {

/// Counts how often all harts together execute each instruction of a program. Writes the counts of source lines,
/// functions and branches in lcov's format, which genhtml and editors can read.
///
/// The count of a line is the greatest count among the first instructions of its statements. Lines of code that the
/// linker dropped are not listed.
class Coverage {
 public:
  /// `option` is the command-line option for error messages. Throws Error if the program has no line numbers, or if the
  /// file cannot be written. `program` must outlive this object.
  Coverage(const std::string& option, const std::string& path, const Elf& program);

  /// Returns the observer, which may be attached to any hart.
  Observer& observer() { return observer_; }
  /// Throws Error if the file cannot be written.
  void finish();

 private:
  struct Count {
    std::uint64_t executed = 0;
    std::uint64_t taken = 0;
    bool branch = false;
  };
  static constexpr unsigned kPageBits = 12;
  using Page = std::array<Count, (1U << kPageBits) / 2>;

  class AnyHart final : public Observer {
   public:
    explicit AnyHart(Coverage& coverage) : coverage_(coverage) {}
    void retired(const Hart& hart, const Retired& instruction) override { coverage_.count(hart, instruction); }

   private:
    Coverage& coverage_;
  };

  void count(const Hart& hart, const Retired& instruction);
  Count& at(std::uint32_t pc);
  Count of(std::uint32_t pc) const;
  struct File;
  void write(const std::string& path, const File& file);

  const Elf& program_;
  TextFile file_;
  AnyHart observer_{*this};
  std::unordered_map<std::uint32_t, std::unique_ptr<Page>> pages_;
  std::uint32_t recent_page_ = ~0U;
  Page* recent_ = nullptr;
};

}  // namespace mebots::soc::observe
