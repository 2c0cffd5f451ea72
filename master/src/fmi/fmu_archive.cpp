// SPDX-License-Identifier: Apache-2.0
// Unpacks FMUs. The host process of an FMU gets it unpacked and does without the libraries that this takes.
#include "fmi/fmi2_functions.hpp"
#include "fmi/fmu.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <fmt/format.h>

namespace mebots::master {
namespace {

modeldesc::ModelDescription unpack_and_read(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                            std::vector<std::string>& notices) {
  const auto file = folder / "modelDescription.xml";
  try {
    notices = modeldesc::unpack(archive, folder);
    if (!is_there(file)) {
      throw InputError(ErrorCode::fmu_inconsistent,
                       fmt::format("{}: this is not an FMU: {}", archive.string(),
                                   modeldesc::why_missing(folder, file.filename().string())));
    }
    auto description = modeldesc::read_xml(file);
    if (description.fmi_version != "2.0") {
      throw InputError(ErrorCode::fmu_unsupported,
                       fmt::format("{}: this FMU is of FMI version '{}'; FMI 2.0 is supported", archive.string(),
                                   description.fmi_version));
    }
    return description;
  } catch (const InputError&) {
    throw;
  } catch (const Error& error) {
    // Name the archive rather than the temporary copy of the file inside it.
    std::string what = error.what();
    const auto at = what.find(file.string());
    if (at != std::string::npos) what.replace(at, file.string().size(), "modelDescription.xml");
    if (what.find(archive.string()) == std::string::npos) what = fmt::format("{}: {}", archive.string(), what);
    throw InputError(error.code(), what);
  }
}

}  // namespace

Fmu::Fmu(std::filesystem::path archive)
    : archive_(std::move(archive)),
      own_folder_(std::make_unique<UnpackFolder>()),
      folder_(own_folder_->path()),
      description_(unpack_and_read(archive_, folder_, notices_)) {
  std::filesystem::create_directories(folder_ / "resources");  // an FMU may count on it
}

std::shared_ptr<Fmu> FmuLibrary::open(const std::filesystem::path& archive) {
  auto& fmu = fmus_[archive];
  if (!fmu || fmu->corrupted()) fmu = std::make_shared<Fmu>(archive);
  return fmu;
}

void FmuLibrary::forget_changed() {
  std::erase_if(fmus_, [](const auto& entry) {
    const auto& fmu = entry.second;
    return fmu && fmu->used() && (fmu->uncleanliness() || fmu->difference());
  });
}

}  // namespace mebots::master
