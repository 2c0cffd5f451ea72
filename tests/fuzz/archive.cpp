// SPDX-License-Identifier: Apache-2.0
//
// Reads any bytes as an .fmu archive. The reader must throw Error, or return entries that are inside the folder and
// within the size limits. Runs in memory. Some inputs are also unpacked on the disk, to test interactions between the
// entries' names.
#include "checks.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/archive_reader.hpp"

#include "require.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace {

namespace fs = std::filesystem;
using mebots::fuzz::require;

constexpr mebots::modeldesc::UnpackLimits kLimits{.total_bytes = 1U << 20, .entries = 100};

/// A folder, in memory if possible, for one archive and its unpacked content.
struct Place {
  mebots::modeldesc::TemporaryFolder folder{"mebots-fuzz", fs::exists("/dev/shm") ? "/dev/shm" : ""};
  fs::path archive = folder.path() / "input.fmu";
  fs::path inner = folder.path() / "inner";
};

void read_in_memory(std::string_view bytes) {
  const mebots::modeldesc::ArchiveReader reader(mebots::modeldesc::open_zip(bytes, "input.fmu"), "input.fmu", kLimits);
  std::uint64_t total = 0;
  for (const auto& entry : reader.entries()) {
    const auto path = fs::path("/folder") / entry.name;
    require(path.lexically_normal().string().starts_with("/folder"), "an entry lies in the folder");
    try {
      reader.read(entry, [&](std::string_view part) { total += part.size(); });
    } catch (const mebots::Error&) {
    }
    require(total <= kLimits.total_bytes, "no more is unpacked than allowed");
  }
}

void unpack_to_disk(std::string_view bytes) {
  static const Place place;
  std::ofstream(place.archive, std::ios::binary | std::ios::trunc).write(bytes.data(), std::ssize(bytes));
  try {
    mebots::modeldesc::unpack(place.archive, place.inner, kLimits);
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
  require(total <= kLimits.total_bytes, "no more is unpacked than allowed");
  std::size_t outside = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(place.folder.path())) ++outside;
  require(outside == 1, "nothing is written beside the folder");
}

/// Returns true for one input in 64, selected by its bytes. For the stored corpus, which is small, returns true for all
/// inputs.
bool chosen_for_disk(std::string_view bytes) {
  unsigned sum = 0;
  for (const char byte : bytes) sum = sum * 31U + static_cast<unsigned char>(byte);
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  return sum % 64 == 0;
#else
  return true;
#endif
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const auto archive = mebots::modeldesc::open_zip(bytes, "input.fmu");
    mebots::check::Check check;
    mebots::check::check_archive(*archive, check);
    read_in_memory(bytes);
    if (chosen_for_disk(bytes)) unpack_to_disk(bytes);
  } catch (const mebots::Error&) {
  }
  return 0;
}
