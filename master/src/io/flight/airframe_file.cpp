// SPDX-License-Identifier: Apache-2.0
#include "io/flight/airframe_file.hpp"

#include "mebots/data/document.hpp"
#include "mebots/data/object.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master::flight {
namespace {

using data::Limits;
using data::Node;
using data::Object;

constexpr std::array<std::string_view, 3> kParts = {"drone", "rotor", "cell"};

bool is_path(std::string_view name) {
  return name.ends_with(".json") || name.find('/') != std::string_view::npos;
}

/// Reads the name of a shipped file or the path of an existing file.
std::string read_part(const Node& node, const std::filesystem::path& folder) {
  auto name = node.readable_text();
  if (is_path(name) && !is_file(folder / name)) {
    node.fail(ErrorCode::file_not_found, fmt::format("there is no file {}; paths are relative to the airframe", name));
  }
  return name;
}

/// Reads `known`, the origin of a value: measured, stated, derived, fitted or assumed.
std::string read_knowledge(const Node& node) {
  const std::vector<std::string> known = {"measured", "stated", "derived", "fitted", "assumed"};
  auto word = node.text();
  if (std::ranges::find(known, word) == known.end()) node.fail_unknown("the word", word, known);
  return word;
}

void check_interval(const Node& node, double value) {
  const auto bounds = data::read_rising_numbers(node, {});
  if (bounds.size() != 2) node.fail(ErrorCode::invalid_value, "two numbers are expected: the lowest and the highest");
  if (value < bounds[0] || value > bounds[1]) {
    node.fail(ErrorCode::invalid_value, fmt::format("the value {} is outside of its interval", value));
  }
}

void check_quantity(const Node& node, std::string_view unit, const Limits& limits) {
  Object object(node);
  double value = 0;
  std::string word;
  const bool sound = object.read("value", value, data::number(limits));
  data::read_unit(object, unit);
  data::read_source(object);
  object.read("known", word, &read_knowledge);
  object.visit_if("interval", [&](const Node& interval) {
    if (sound) check_interval(interval, value);
  });
  object.comment("fitted_on");
  object.finish();
}

void check_fitted(const Node& node, const std::vector<std::string>& decks) {
  for (const auto& element : node.elements()) {
    element.attempt([&] {
      const auto name = element.readable_text();
      if (std::ranges::find(decks, name) == decks.end()) element.fail_unknown("the deck", name, decks);
    });
  }
}

void check_airframe(const Node& root, const std::filesystem::path& folder) {
  Object airframe(root);
  airframe.comment("$schema");
  std::string text;
  airframe.read("name", text, &Node::readable_text);
  airframe.comment("notes");
  for (const auto part : kParts) {
    airframe.read(part, text, [&](const Node& node) { return read_part(node, folder); });
  }
  airframe.visit("mass_without_cell", [](const Node& node) { check_quantity(node, "kg", Limits::positive()); });
  airframe.visit("avionics_power", [](const Node& node) { check_quantity(node, "W", Limits::at_least(0)); });
  std::vector<std::string> decks;
  airframe.visit_if("decks", [&](const Node& node) {
    for (const auto& [name, deck] : node.members()) {
      decks.push_back(name);
      deck.attempt([&deck = deck] { check_quantity(deck, "kg", Limits::positive()); });
    }
  });
  airframe.visit_if("fitted_decks", [&](const Node& node) { check_fitted(node, decks); });
  airframe.finish();
}

}  // namespace

nlohmann::ordered_json read_airframe(const std::filesystem::path& file) {
  const auto folder = std::filesystem::absolute(file).parent_path();
  const auto text = text_of(file);
  data::Document(text, file.string()).read([&](const Node& root) { check_airframe(root, folder); });
  auto airframe = nlohmann::ordered_json::parse(text);
  for (const auto part : kParts) {
    auto& name = airframe[std::string(part)];
    if (is_path(name.get<std::string>())) name = (folder / name.get<std::string>()).lexically_normal().string();
  }
  return airframe;
}

}  // namespace mebots::master::flight
