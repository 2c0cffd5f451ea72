// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace mebots::soc::translate {

/// Memory for host code, seen twice: writable here, executable there, never both at one address.
class CodeMemory {
 public:
  /// Null when the host gives no such memory.
  static std::unique_ptr<CodeMemory> create(std::size_t size);
  ~CodeMemory();
  CodeMemory(const CodeMemory&) = delete;
  CodeMemory& operator=(const CodeMemory&) = delete;

  std::uint8_t* writable() const { return writable_; }
  std::size_t size() const { return size_; }
  /// Where the bytes written at `at` are executed.
  const std::uint8_t* executable(const std::uint8_t* at) const { return executable_ + (at - writable_); }

  /// To be called after writing over code that may have been executed: the processor may still hold it. Writing goes
  /// by another address than fetching, so a serialising instruction is needed (Intel SDM volume 3, 8.1.3). It is slow
  /// in virtual machines.
  static void serialise();

 private:
  CodeMemory(std::uint8_t* writable, const std::uint8_t* executable, std::size_t size)
      : writable_(writable), executable_(executable), size_(size) {}

  std::uint8_t* writable_;
  const std::uint8_t* executable_;
  std::size_t size_;
};

}  // namespace mebots::soc::translate
