// SPDX-License-Identifier: Apache-2.0
#include "translate/code_memory.hpp"

#include <cpuid.h>
#include <sys/mman.h>
#include <unistd.h>

namespace mebots::soc::translate {

std::unique_ptr<CodeMemory> CodeMemory::create(std::size_t size) {
  const int file = memfd_create("mebots-soc-code", MFD_CLOEXEC);
  if (file < 0) return nullptr;
  void* writable = MAP_FAILED;
  void* executable = MAP_FAILED;
  if (ftruncate(file, static_cast<off_t>(size)) == 0) {
    writable = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    executable = mmap(nullptr, size, PROT_READ | PROT_EXEC, MAP_SHARED, file, 0);
  }
  close(file);
  if (writable == MAP_FAILED || executable == MAP_FAILED) {
    if (writable != MAP_FAILED) munmap(writable, size);
    if (executable != MAP_FAILED) munmap(executable, size);
    return nullptr;
  }
  return std::unique_ptr<CodeMemory>(
      new CodeMemory(static_cast<std::uint8_t*>(writable), static_cast<const std::uint8_t*>(executable), size));
}

CodeMemory::~CodeMemory() {
  munmap(writable_, size_);
  munmap(const_cast<std::uint8_t*>(executable_), size_);
}

void CodeMemory::serialise() {
  unsigned a = 0;
  unsigned b = 0;
  unsigned c = 0;
  unsigned d = 0;
  __cpuid(0, a, b, c, d);
}

}  // namespace mebots::soc::translate
