// SPDX-License-Identifier: Apache-2.0
#include "run/saved_run.hpp"

#include "base/sha256.hpp"
#include "mebots/input_error.hpp"
#include "mebots/state/save.hpp"
#include "run/input_hash.hpp"

#include <string_view>

namespace mebots::master {
namespace {

constexpr std::string_view kSavedRunMagic = "mebots saved run 1\n";
constexpr std::size_t kHashSize = 64;

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

std::vector<std::byte> to_bytes(const SavedRun& run) {
  const auto content = state::save(run);
  const auto hash = sha256(as_text(content));
  state::Writer writer;
  writer.append(kSavedRunMagic.data(), kSavedRunMagic.size());
  writer.append(hash.data(), hash.size());
  writer.append(content.data(), content.size());
  return writer.take();
}

SavedRun saved_run(std::span<const std::byte> bytes) {
  const auto text = as_text(bytes);
  if (!text.starts_with(kSavedRunMagic) || text.size() < kSavedRunMagic.size() + kHashSize) {
    throw InputError(ErrorCode::state_of_other_build, "this is not a saved state of a run of this version of mebots");
  }
  const auto content = bytes.subspan(kSavedRunMagic.size() + kHashSize);
  if (text.substr(kSavedRunMagic.size(), kHashSize) != sha256(as_text(content))) {
    throw InputError(ErrorCode::state_damaged, "this saved state of a run is damaged");
  }
  SavedRun run;
  state::restore(run, content);
  return run;
}

}  // namespace mebots::master
