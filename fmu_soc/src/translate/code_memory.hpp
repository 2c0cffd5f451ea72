// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace mebots::soc::translate {

/// Memory for host code. The memory is mapped at two addresses: one is writable, and the other is executable.
class CodeMemory {
 public:
  /// Allocates `size` bytes. Returns null if the host does not allow two mappings of the same memory.
  static std::unique_ptr<CodeMemory> create(std::size_t size);
  ~CodeMemory();
  CodeMemory(const CodeMemory&) = delete;
  CodeMemory& operator=(const CodeMemory&) = delete;

  std::uint8_t* writable() const { return writable_; }
  std::size_t size() const { return size_; }
  /// Returns the executable address of the byte at the writable address `at`.
  const std::uint8_t* executable(const std::uint8_t* at) const { return executable_ + (at - writable_); }

  /// Must be called after executed code was overwritten. Executes a serialising instruction, which the processor
  /// requires because the code is written at another address than the one at which it is executed (Intel SDM volume 3,
  /// 8.1.3).
  static void serialise();

 private:
  CodeMemory(std::uint8_t* writable, const std::uint8_t* executable, std::size_t size)
      : writable_(writable), executable_(executable), size_(size) {}

  std::uint8_t* writable_;
  const std::uint8_t* executable_;
  std::size_t size_;
};

}  // namespace mebots::soc::translate
