// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as an .fmu archive: refused with an Error, or unpacked to files that all lie in the folder.
#include "mebots/modeldesc/archive.hpp"
#include "archive_check.hpp"
#include "mebots/error.hpp"

#include "require.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>

namespace {

namespace fs = std::filesystem;

/// A folder of its own, in memory where there is such a place, with room for one archive and what it unpacks to.
struct Place {
  mebots::modeldesc::TemporaryFolder folder{"mebots-fuzz", fs::exists("/dev/shm") ? "/dev/shm" : ""};
  fs::path archive = folder.path() / "input.fmu";
  fs::path inner = folder.path() / "inner";
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using mebots::fuzz::require;
  static const Place place;
  {
    std::ofstream stream(place.archive, std::ios::binary | std::ios::trunc);
    stream.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  }
  try {
    mebots::check::Check check;
    mebots::check::check_archive(place.archive, check);
  } catch (const mebots::Error&) {
  }
  mebots::modeldesc::UnpackLimits limits;
  limits.total_bytes = 1U << 20;
  limits.entries = 100;
  try {
    mebots::modeldesc::unpack(place.archive, place.inner, limits);
  } catch (const mebots::Error&) {
  }
  std::uintmax_t total = 0;
  if (fs::exists(place.inner)) {
    for (const auto& entry : fs::recursive_directory_iterator(place.inner)) {
      require(!entry.is_symlink(), "nothing unpacked is a link");
      if (entry.is_regular_file()) total += entry.file_size();
    }
    fs::remove_all(place.inner);
  }
  require(total <= limits.total_bytes, "no more is unpacked than allowed");
  std::size_t outside = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(place.folder.path())) ++outside;
  require(outside == 1, "nothing is written beside the folder");
  return 0;
}
