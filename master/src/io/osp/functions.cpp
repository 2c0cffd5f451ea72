// SPDX-License-Identifier: Apache-2.0
#include "functions.hpp"

#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

namespace mebots::master::osp {
namespace {

using namespace ssp;

/// A name such as "in[3][1]": the word and the numbers in brackets.
struct SignalName {
  std::string_view word;
  std::vector<std::size_t> indices;
};

std::optional<SignalName> split(std::string_view text) {
  SignalName name{text.substr(0, text.find('[')), {}};
  text.remove_prefix(name.word.size());
  while (!text.empty()) {
    const auto end = text.find(']');
    std::size_t index = 0;
    if (text.front() != '[' || end == std::string_view::npos) return std::nullopt;
    if (std::from_chars(text.data() + 1, text.data() + end, index).ptr != text.data() + end) return std::nullopt;
    name.indices.push_back(index);
    text.remove_prefix(end + 1);
  }
  return name;
}

}  // namespace

void Functions::read(pugi::xml_node functions) {
  for (const auto node : functions.children()) {
    if (node.type() != pugi::node_element) continue;
    const auto kind = local_name(node);
    Function function;
    function.node = node;
    std::size_t inputs = 1;
    std::size_t elements = 1;
    if (kind == "LinearTransformation") {
      function.factor = file_->number(node, "factor", 1);
      function.offset = file_->number(node, "offset", 0);
    } else if (kind == "Sum" || kind == "VectorSum") {
      function.indexed = true;
      function.is_vector = kind == "VectorSum";
      inputs = count(node, "inputCount");
      if (function.is_vector) elements = count(node, "dimension");
    } else {
      file_->fail(node, fmt::format("{} is not a function; use LinearTransformation, Sum or VectorSum", kind));
    }
    function.inputs.assign(inputs, std::vector<OspVariable>(elements));
    function.outputs.resize(elements);
    const auto name = file_->required(node, "name");
    if (!functions_.emplace(name, std::move(function)).second) {
      file_->fail(node, fmt::format("the function \"{}\" occurs twice", name));
    }
    order_.push_back(name);
  }
}

std::size_t Functions::count(pugi::xml_node node, const char* attribute) const {
  constexpr double kMost = 10'000;
  file_->required(node, attribute);
  const auto value = file_->number(node, attribute, 0);
  if (value < 1 || value > kMost || value != std::floor(value)) {
    file_->fail(node, fmt::format("{} is {}, but a whole number from 1 to {} is expected", attribute, value, kMost));
  }
  return static_cast<std::size_t>(value);
}

Functions::Function& Functions::function_of(pugi::xml_node signal) {
  const auto name = file_->required(signal, "function");
  const auto found = functions_.find(name);
  if (found == functions_.end()) {
    file_->fail(signal, fmt::format("there is no function \"{}\". {}", name, suggest(name, order_)));
  }
  return found->second;
}

Functions::Signal Functions::parse(pugi::xml_node signal, const Function& function, Ends ends) const {
  const auto text = file_->required(signal, "name");
  const auto name = split(text);
  const bool is_output = name && name->word == "out";
  const std::size_t own = !is_output && function.indexed ? 1 : 0;  // number of indices that select an input
  const std::size_t inner = function.is_vector && ends == Ends::variable ? 1 : 0;
  const bool fits = name && (is_output || name->word == "in") && name->indices.size() == own + inner &&
                    (ends == Ends::variable || function.is_vector);
  Signal result{is_output, 0, 0};
  if (fits && own == 1) result.input = name->indices.front();
  if (fits && inner == 1) result.element = name->indices.back();
  if (!fits || result.input >= function.inputs.size() || result.element >= function.outputs.size()) {
    file_->fail(signal,
                fmt::format("the function has no {} \"{}\"", ends == Ends::group ? "signal group" : "signal", text));
  }
  return result;
}

void Functions::connect(pugi::xml_node signal, const std::vector<OspVariable>& variables, Ends ends) {
  auto& function = function_of(signal);
  const auto found = parse(signal, function, ends);
  if (ends == Ends::group && variables.size() != function.outputs.size()) {
    file_->fail(signal, fmt::format("the group has {} variables and the function {} elements", variables.size(),
                                    function.outputs.size()));
  }
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const auto element = found.element + i;
    if (found.is_output) {
      function.outputs[element].push_back({variables[i], signal});
      continue;
    }
    auto& input = function.inputs[found.input][element];
    if (!input.simulator.empty()) {
      file_->fail(signal, fmt::format("this signal already gets its value from \"{}\"", input.text()));
    }
    input = variables[i];
  }
}

std::vector<FunctionLink> Functions::links() const {
  std::vector<FunctionLink> links;
  for (const auto& name : order_) {
    const auto& function = functions_.at(name);
    for (std::size_t i = 0; i < function.inputs.size(); ++i) {
      for (std::size_t j = 0; j < function.outputs.size(); ++j) {
        const auto& input = function.inputs[i][j];
        if (input.simulator.empty()) {
          file_->fail(function.node,
                      fmt::format("its input {} is not connected", function.is_vector ? fmt::format("in[{}][{}]", i, j)
                                                                   : function.indexed ? fmt::format("in[{}]", i)
                                                                                      : "in"));
        }
        for (const auto& target : function.outputs[j]) {
          links.push_back({input, target.variable, function.factor, function.offset, target.node});
        }
      }
    }
  }
  return links;
}

}  // namespace mebots::master::osp
