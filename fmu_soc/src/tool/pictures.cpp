// SPDX-License-Identifier: Apache-2.0
#include "tool/pictures.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

namespace mebots::soc::tool {
namespace {

/// No camera has more.
constexpr std::uint32_t kMostPixels = 1U << 24;

struct Picture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> pixels;
};

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw Error(fmt::format("--pictures: {}: {}", path.string(), why));
}

Picture read_png(const std::filesystem::path& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) refuse(path, image.message);
  if (std::uint64_t{image.width} * image.height > kMostPixels) {
    png_image_free(&image);
    refuse(path, fmt::format("{} x {} pixels are too many", image.width, image.height));
  }
  image.format = PNG_FORMAT_GRAY;
  Picture picture{image.width, image.height, std::vector<std::uint8_t>(PNG_IMAGE_SIZE(image))};
  if (png_image_finish_read(&image, nullptr, picture.pixels.data(), 0, nullptr) == 0) refuse(path, image.message);
  return picture;
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
Picture read_pgm(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic(2, '\0');
  file.read(magic.data(), 2);
  if (!file || magic != "P5") refuse(path, "this is not a binary PGM: it does not begin with P5");
  Picture picture;
  picture.width = number_of_head(file);
  picture.height = number_of_head(file);
  const auto most = number_of_head(file);
  if (!file || most != 255) refuse(path, "the head of a PGM with 255 greys is \"P5 WIDTH HEIGHT 255\"");
  if (std::uint64_t{picture.width} * picture.height > kMostPixels) {
    refuse(path, fmt::format("{} x {} pixels are too many", picture.width, picture.height));
  }
  file.get();
  picture.pixels.resize(std::size_t{picture.width} * picture.height);
  file.read(reinterpret_cast<char*>(picture.pixels.data()), static_cast<std::streamsize>(picture.pixels.size()));
  if (!file) refuse(path, fmt::format("it ends before its {} pixels", picture.pixels.size()));
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
    if (picture.width != width || picture.height < least_height) {
      refuse(path, fmt::format("it has {} x {} pixels; the camera takes {} x {} or more rows", picture.width,
                               picture.height, width, least_height));
    }
    pictures.push_back(std::move(picture.pixels));
  }
  return pictures;
}

}  // namespace mebots::soc::tool
