// SPDX-License-Identifier: Apache-2.0
// Unpacks FMUs. A separate file, because the host process does not need this code. It receives an unpacked FMU.
#include "io/fmu_archive.hpp"
#include "fmi/fmu.hpp"
#include "fmi/windows_library.hpp"

namespace mebots::master {

Fmu::Fmu(std::filesystem::path archive, std::optional<FmuKind> wish)
    : archive_(std::move(archive)),
      wish_(wish),
      own_folder_(std::make_unique<UnpackFolder>()),
      folder_(own_folder_->path()),
      description_(unpack_fmu(archive_, folder_, notices_)) {
  std::filesystem::create_directories(folder_ / "resources");  // FMUs may rely on this folder
}

std::shared_ptr<Fmu> FmuLibrary::open(const std::filesystem::path& archive, std::optional<FmuKind> wish) {
  auto& fmu = fmus_[{archive, wish}];
  if (!fmu || fmu->corrupted()) fmu = std::make_shared<Fmu>(archive, wish);
  return fmu;
}

void FmuLibrary::forget_changed() {
  std::erase_if(fmus_, [](const auto& entry) {
    const auto& fmu = entry.second;
    return fmu && fmu->used() && (fmu->uncleanliness() || fmu->difference());
  });
}

}  // namespace mebots::master
