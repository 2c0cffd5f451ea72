// SPDX-License-Identifier: Apache-2.0
#include "tool/run.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <string_view>

namespace mebots::soc::tool {

namespace {

std::uint32_t required_symbol(const std::string& path, const Soc& soc, std::string_view name) {
  const auto address = soc.program().symbol(name);
  if (!address) {
    throw Error(
        fmt::format("--signature {}: {} has no symbol {}; the signature is the words between begin_signature "
                    "and end_signature",
                    path, soc.program().origin(), name));
  }
  return *address;
}

std::uint32_t checked_end(const std::string& path, const Soc& soc, std::uint32_t begin) {
  const auto end = required_symbol(path, soc, "end_signature");
  if (end < begin || (end - begin) % 4 != 0) {
    throw Error(
        fmt::format("--signature {}: from begin_signature 0x{:08x} to end_signature 0x{:08x} is not a whole number "
                    "of words",
                    path, begin, end));
  }
  if (end != begin && soc.memory().find(begin, end - begin) == nullptr) {
    throw Error(fmt::format("--signature {}: no memory from 0x{:08x} to 0x{:08x}", path, begin, end));
  }
  return end;
}

}  // namespace

Signature::Signature(const std::string& path, const Soc& soc)
    : begin_(required_symbol(path, soc, "begin_signature")),
      end_(checked_end(path, soc, begin_)),
      file_("--signature", path) {}

void Signature::write(const Soc& soc) {
  for (auto address = begin_; address < end_; address += 4) {
    std::uint32_t word = 0;
    soc.memory().read(address, {reinterpret_cast<std::uint8_t*>(&word), sizeof word});
    file_.print("{:08x}\n", word);
  }
  file_.close();
}

}  // namespace mebots::soc::tool
