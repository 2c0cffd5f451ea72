// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace mebots::soc::translate {

/// Allocates memory for host code and maps it twice: writable at one address, and executable at another address. No
/// address is both writable and executable.
class CodeMemory {
 public:
  /// Allocates `size` bytes. If the host does not allow memory with two mappings, returns null.
  static std::unique_ptr<CodeMemory> create(std::size_t size);
  ~CodeMemory();
  CodeMemory(const CodeMemory&) = delete;
  CodeMemory& operator=(const CodeMemory&) = delete;

  std::uint8_t* writable() const { return writable_; }
  std::size_t size() const { return size_; }
  /// Returns the executable address of the byte whose writable address is `at`.
  const std::uint8_t* executable(const std::uint8_t* at) const { return executable_ + (at - writable_); }

  /// Must be called after executed code was overwritten, because the processor may still hold the old code. Executes a
  /// serialising instruction, which is needed because the code is written at another address than the one at which it
  /// is executed (Intel SDM volume 3, 8.1.3). Such an instruction is slow in virtual machines.
  static void serialise();

 private:
  CodeMemory(std::uint8_t* writable, const std::uint8_t* executable, std::size_t size)
      : writable_(writable), executable_(executable), size_(size) {}

  std::uint8_t* writable_;
  const std::uint8_t* executable_;
  std::size_t size_;
};

}  // namespace mebots::soc::translate
