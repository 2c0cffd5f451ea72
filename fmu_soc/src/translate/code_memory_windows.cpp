// SPDX-License-Identifier: Apache-2.0
#include "translate/code_memory.hpp"

#include <intrin.h>
#include <windows.h>

namespace mebots::soc::translate {

std::unique_ptr<CodeMemory> CodeMemory::create(std::size_t size) {
  const auto high = static_cast<DWORD>(std::uint64_t{size} >> 32);
  const HANDLE file = CreateFileMappingW(INVALID_HANDLE_VALUE, nullptr, PAGE_EXECUTE_READWRITE, high,
                                         static_cast<DWORD>(size), nullptr);
  if (file == nullptr) return nullptr;
  void* const writable = MapViewOfFile(file, FILE_MAP_WRITE, 0, 0, size);
  void* const executable = MapViewOfFile(file, FILE_MAP_READ | FILE_MAP_EXECUTE, 0, 0, size);
  CloseHandle(file);  // the memory exists as long as its two views
  if (writable == nullptr || executable == nullptr) {
    if (writable != nullptr) UnmapViewOfFile(writable);
    if (executable != nullptr) UnmapViewOfFile(executable);
    return nullptr;
  }
  return std::unique_ptr<CodeMemory>(
      new CodeMemory(static_cast<std::uint8_t*>(writable), static_cast<const std::uint8_t*>(executable), size));
}

CodeMemory::~CodeMemory() {
  UnmapViewOfFile(writable_);
  UnmapViewOfFile(executable_);
}

void CodeMemory::serialise() {
  int registers[4];
  __cpuid(registers, 0);
}

}  // namespace mebots::soc::translate
