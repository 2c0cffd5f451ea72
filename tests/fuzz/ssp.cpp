// SPDX-License-Identifier: Apache-2.0
//
// Reads any text as the files of an SSP. The reader must throw InputError, or return a config that is JSON and
// describes a consistent system. An input contains SystemStructure.ssd, then further files, each after a line "===
// path".
#include "mebots/input_error.hpp"

#include "io/config/load_system.hpp"
#include "io/ssp/ssp.hpp"
#include "system.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace {

using mebots::InputError;

class MemoryFiles final : public mebots::master::ssp::Files {
 public:
  explicit MemoryFiles(std::string_view input) {
    constexpr std::string_view kMark = "\n=== ";
    std::string name = "SystemStructure.ssd";
    while (true) {
      const auto end = input.find(kMark);
      files_.emplace(name, input.substr(0, end));
      if (end == std::string_view::npos) return;
      input.remove_prefix(end + kMark.size());
      const auto line = input.find('\n');
      name = input.substr(0, line);
      input.remove_prefix(line == std::string_view::npos ? input.size() : line + 1);
    }
  }

  bool holds(const std::filesystem::path& inside) const override { return files_.contains(inside); }
  std::string read(const std::filesystem::path& inside) const override { return files_.at(inside); }
  /// The reader of configs only checks that this path exists.
  std::filesystem::path place(const std::filesystem::path& /*inside*/) const override { return "/"; }

 private:
  std::map<std::filesystem::path, std::string> files_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    auto config = mebots::master::ssp::read(MemoryFiles({reinterpret_cast<const char*>(data), size}), "input.ssp");
    config.config.dump();  // as in convert: throws for text that is not UTF-8
    const auto loaded = mebots::master::config::load_ssp_config(std::move(config), "/input.ssp", {0.001, {}});
    mebots::fuzz::require_sound(loaded.system);
  } catch (const InputError&) {
  }
  return 0;
}
