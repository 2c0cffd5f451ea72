// SPDX-License-Identifier: Apache-2.0
// Tests that all implementations of the neural network give the same bits as the definition in Python.

#include "nn/network.h"

#include "devices/generic/camera.hpp"
#include "golden.hpp"
#include "rendered_world.hpp"
#include "soc/soc.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace mebots::firmware_test {
namespace {

using testing::HasSubstr;

std::string text_of_output(const nn_output_t& output) {
  std::string text;
  for (int i = 0; i < NN_OUTPUTS; ++i) text += fmt::format("{}{}", i > 0 ? " " : "", NN_OUTPUT(output, i));
  return text;
}

std::string plain_text_of(const std::vector<std::int8_t>& picture) {
  const auto a = std::make_unique<nn_activations_t>();
  auto text = text_of_output(nn_plain_infer(picture.data(), a.get()));
  const auto add = [&](const auto& layer) {
    text += fmt::format(" {:x}", nn_checksum(layer, sizeof(layer), NN_CHECKSUM_START));
  };
  add(a->pooled);
  add(a->second);
  add(a->third);
  add(a->fourth);
  add(a->fifth);
  add(a->sixth);
  add(a->seventh);
  return text;
}

TEST(Network, ThereAreManyGoldenVectorsAndTheyDiffer) {
  const auto all = golden_vectors();
  EXPECT_GE(all.size(), NN_OUTPUTS == 1 ? 32U : 12U);
  std::vector<int> yaws;
  for (const auto& golden : all) yaws.push_back(golden.outputs[0]);
  EXPECT_LT(*std::min_element(yaws.begin(), yaws.end()), -30);
  EXPECT_GT(*std::max_element(yaws.begin(), yaws.end()), 30);
}

TEST(Network, PlainCodeAgreesWithTheDefinitionInPythonOnEveryGoldenVector) {
  for (const auto& golden : golden_vectors()) EXPECT_EQ(plain_text_of(golden.picture), text_of(golden)) << golden.set;
}

TEST(Network, ShrunkPictureAgreesWithTheDefinitionInPython) {
  // The formula of the picture and the hash must be the same as in examples/paper/training/export.py.
  for (const auto [width, height, expected] :
       {std::array<std::uint32_t, 3>{320, 320, 0x5c9579f5}, std::array<std::uint32_t, 3>{324, 244, 0xb893bb05}}) {
    std::vector<std::uint8_t> picture(static_cast<std::size_t>(width) * height);
    for (std::uint32_t y = 0; y < height; ++y) {
      for (std::uint32_t x = 0; x < width; ++x) {
        picture[y * width + x] = static_cast<std::uint8_t>(3 * x * x + 7 * y + x * y);
      }
    }
    std::array<std::uint16_t, SHRUNK_EDGE> columns{};
    shrink_columns(static_cast<int>(width), columns.data());
    std::vector<std::int8_t> small(NN_PICTURE_BYTES);
    for (int y = 0; y < SHRUNK_EDGE; ++y) {
      shrink_row(&picture[static_cast<std::size_t>(shrink_place(y, static_cast<int>(height))) * width],
                 static_cast<int>(width), columns.data(), &small[static_cast<std::size_t>(y) * SHRUNK_EDGE]);
    }
    EXPECT_EQ(nn_checksum(small.data(), NN_PICTURE_BYTES, NN_CHECKSUM_START), expected) << width << " x " << height;
  }
}

/// Returns the lines that the check firmware prints for the given pictures, each of `edge` x `edge` grey levels.
std::vector<std::string> on_chip(const std::vector<std::vector<std::uint8_t>>& pictures, std::uint32_t edge) {
  std::vector<std::string> lines;
  soc::Listeners listeners;
  listeners.console = [&](std::string_view line) { lines.emplace_back(line); };
  const auto board = soc::read_board(std::string(MEBOTS_SOURCE_DIR) + "/configs/boards/ai_deck.json");
  const auto program = soc::Elf::read(std::string(MEBOTS_BINARY_DIR) + "/firmware/" + MEBOTS_NETWORK_CHECK);
  soc::Soc chip(board, soc::gap8(), {}, program, listeners);
  *chip.devices().input("camera.frame_width") = edge;
  *chip.devices().input("camera.frame_height") = edge;
  auto& camera = dynamic_cast<soc::Camera&>(*chip.devices().find("camera"));
  constexpr std::int64_t kStep = 2'000'000;
  std::int32_t id = 0;
  for (std::int64_t k = 0; chip.running() && k < 100'000; ++k) {
    chip.advance((k + 1) * kStep);
    const auto requests = camera.requests();
    if (requests != id && static_cast<std::size_t>(requests) <= pictures.size()) id = requests;
    if (camera.wants(id)) camera.offer(pictures[static_cast<std::size_t>(id) - 1], chip.now());
  }
  if (!chip.fault_text().empty()) lines.push_back(chip.fault_text());
  return lines;
}

/// Returns the lines that the check firmware prints on GAP8's own devices. The camera interface reads a window in the
/// centre of the sensor's pictures.
std::vector<std::string> on_gap8(const std::vector<std::vector<std::uint8_t>>& pictures) {
  constexpr std::size_t kSensor = 324;
  constexpr std::size_t kMargin = (kSensor - SHRUNK_EDGE) / 2;
  soc::Settings settings;
  for (const auto& picture : pictures) {
    auto& whole = settings.pictures.emplace_back(kSensor * kSensor);
    for (std::size_t y = 0; y < SHRUNK_EDGE; ++y) {
      std::copy_n(&picture[y * SHRUNK_EDGE], SHRUNK_EDGE, &whole[(kMargin + y) * kSensor + kMargin]);
    }
  }
  std::vector<std::string> lines;
  soc::Listeners listeners;
  listeners.console = [&](std::string_view line) { lines.emplace_back(line); };
  listeners.faults = listeners.console;
  const auto board = soc::read_board(std::string(MEBOTS_SOURCE_DIR) + "/configs/boards/gap8.json");
  const auto program = soc::Elf::read(std::string(MEBOTS_BINARY_DIR) + "/firmware/gap8_" + MEBOTS_NETWORK_CHECK);
  soc::Soc chip(board, soc::gap8(), settings, program, listeners);
  constexpr std::int64_t kStep = 100'000'000;
  for (std::int64_t time = kStep; chip.running() && time < 600 * kStep; time += kStep) chip.advance(time);
  return lines;
}

/// Returns the lines that start with a word, in order and without this word.
std::vector<std::string> lines_of(const std::vector<std::string>& lines, const std::string& word) {
  std::vector<std::string> found;
  for (const auto& line : lines) {
    if (line.rfind(word + " ", 0) == 0) found.push_back(line.substr(word.size() + 1));
  }
  return found;
}

class NetworkOn : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Boards, NetworkOn, testing::Values("ai_deck", "gap8"),
                         [](const auto& each) { return std::string(each.param); });

TEST_P(NetworkOn, EveryKernelOnTheChipAgreesWithTheDefinitionInPythonOnEveryGoldenVector) {
  std::vector<std::string> expected;
  std::vector<std::vector<std::uint8_t>> pictures;
  for (const auto& golden : golden_vectors()) {
    expected.push_back(text_of(golden));
    auto& grey = pictures.emplace_back(golden.picture.size());
    std::transform(golden.picture.begin(), golden.picture.end(), grey.begin(),
                   [](std::int8_t p) { return static_cast<std::uint8_t>(p + 128); });
  }
  const auto lines = GetParam() == std::string("gap8") ? on_gap8(pictures) : on_chip(pictures, SHRUNK_EDGE);
  ASSERT_FALSE(lines.empty());
  EXPECT_THAT(lines.back(), HasSubstr(fmt::format("{} pictures", pictures.size())));
  for (const auto* kernel : {"alone", "cluster1", "cluster2", "cluster4", "cluster8"}) {
    EXPECT_EQ(lines_of(lines, kernel), expected) << kernel;
  }
  // Plain code is slow on the chip, so the check runs it on the first two pictures only.
  EXPECT_EQ(lines_of(lines, "plain"), (std::vector<std::string>{expected[0], expected[1]}));
}

TEST(Network, ClusterMakesOfTheCamerasPictureWhatPlainCodeDoes) {
  Camera camera(load_scene("gate_easy"));
  Uniform random(7);
  std::vector<std::vector<std::uint8_t>> pictures;
  std::vector<std::string> expected;
  for (int i = 0; i < 6; ++i) {
    const BodyPose pose{{random(0.0, 4.0), random(-1.0, 1.0), 1.0}, random(-0.6, 0.6), 0.0, 0.0};
    pictures.push_back(camera.take(pose, 3));
    std::array<std::uint16_t, SHRUNK_EDGE> columns{};
    shrink_columns(320, columns.data());
    std::vector<std::int8_t> small(NN_PICTURE_BYTES);
    for (int y = 0; y < SHRUNK_EDGE; ++y) {
      shrink_row(&pictures.back()[static_cast<std::size_t>(shrink_place(y, 320)) * 320], 320, columns.data(),
                 &small[static_cast<std::size_t>(y) * SHRUNK_EDGE]);
    }
    const auto activations = std::make_unique<nn_activations_t>();
    expected.push_back(text_of_output(nn_plain_infer(small.data(), activations.get())));
  }
  const auto lines = on_chip(pictures, 320);
  for (const auto* kernel : {"whole1", "whole2", "whole4", "whole8"}) {
    EXPECT_EQ(lines_of(lines, kernel), expected) << kernel;
  }
}

}  // namespace
}  // namespace mebots::firmware_test
