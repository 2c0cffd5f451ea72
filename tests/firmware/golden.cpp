// SPDX-License-Identifier: Apache-2.0
#include "golden.hpp"

#include "nn/network.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace mebots::firmware_test {

std::vector<Golden> golden_vectors() {
  const std::string path = std::string(MEBOTS_SOURCE_DIR) + "/examples/paper/training/" + MEBOTS_GOLDEN;
  std::ifstream table(path + ".csv");
  std::ifstream pictures(path + ".pictures", std::ios::binary);
  std::vector<Golden> all;
  std::string line;
  std::getline(table, line);  // heading
  while (std::getline(table, line)) {
    std::istringstream fields(line);
    std::string field;
    Golden golden;
    std::getline(fields, golden.set, ',');
    std::getline(fields, field, ',');  // index in its set
    for (auto& output : golden.outputs) {
      std::getline(fields, field, ',');
      output = std::stoi(field);
    }
    for (auto& checksum : golden.checksums) {
      std::getline(fields, field, ',');
      checksum = static_cast<std::uint32_t>(std::stoul(field, nullptr, 16));
    }
    golden.picture.resize(NN_PICTURE_BYTES);
    pictures.read(reinterpret_cast<char*>(golden.picture.data()), NN_PICTURE_BYTES);
    if (!pictures) throw std::runtime_error(path + ".pictures is shorter than the table says");
    all.push_back(golden);
  }
  if (all.empty()) throw std::runtime_error(path + ".csv has no vectors");
  return all;
}

std::string text_of(const Golden& golden) {
  auto text = fmt::format("{}", fmt::join(golden.outputs, " "));
  for (const auto checksum : golden.checksums) text += fmt::format(" {:x}", checksum);
  return text;
}

}  // namespace mebots::firmware_test
