// SPDX-License-Identifier: Apache-2.0
#include "tool/pictures.hpp"

#include "mebots/error.hpp"
#include "mebots/png_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>

namespace mebots::soc::tool {
namespace {

/// No camera has more.
constexpr std::uint32_t kMostPixels = 1U << 24;

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw Error(fmt::format("--pictures: {}: {}", path.string(), why));
}

/// The next number of a PGM's head, behind white space and comments.
std::uint32_t number_of_head(std::istream& file) {
  file >> std::ws;
  while (file.peek() == '#') {
    std::string comment;
    std::getline(file, comment);
    file >> std::ws;
  }
  std::uint32_t number = 0;
  file >> number;
  return number;
}

/// Netpbm's binary greymap of 8 bits.
GreyPicture read_pgm(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic(2, '\0');
  file.read(magic.data(), 2);
  if (!file || magic != "P5") refuse(path, "this is not a binary PGM: it does not begin with P5");
  const auto width = number_of_head(file);
  const auto height = number_of_head(file);
  const auto most = number_of_head(file);
  if (!file || most != 255) refuse(path, "the head of a PGM with 255 greys is \"P5 WIDTH HEIGHT 255\"");
  if (std::uint64_t{width} * height > kMostPixels) {
    refuse(path, fmt::format("{} x {} pixels are too many", width, height));
  }
  file.get();
  GreyPicture picture{static_cast<int>(width), static_cast<int>(height),
                      std::vector<std::uint8_t>(std::size_t{width} * height)};
  file.read(reinterpret_cast<char*>(picture.grey.data()), static_cast<std::streamsize>(picture.grey.size()));
  if (!file) refuse(path, fmt::format("it ends before its {} pixels", picture.grey.size()));
  return picture;
}

}  // namespace

std::vector<std::vector<std::uint8_t>> read_pictures(const std::filesystem::path& folder, std::uint32_t width,
                                                     std::uint32_t least_height) {
  std::error_code error;
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const auto extension = entry.path().extension();
    if (extension == ".png" || extension == ".pgm") paths.push_back(entry.path());
  }
  if (error) refuse(folder, "this is not a folder that can be read");
  if (paths.empty()) refuse(folder, "there is no .png or .pgm file in this folder");
  std::ranges::sort(paths);
  std::vector<std::vector<std::uint8_t>> pictures;
  for (const auto& path : paths) {
    auto picture = path.extension() == ".png" ? read_png(path) : read_pgm(path);
    if (std::cmp_not_equal(picture.width, width) || std::cmp_less(picture.height, least_height)) {
      refuse(path, fmt::format("it has {} x {} pixels; the camera takes {} x {} or more rows", picture.width,
                               picture.height, width, least_height));
    }
    pictures.push_back(std::move(picture.grey));
  }
  return pictures;
}

}  // namespace mebots::soc::tool
