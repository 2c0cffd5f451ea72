// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"
#include "mebots/modeldesc/model_description.hpp"
#include "mebots/modeldesc/xml.hpp"
#include "mebots/parsed_number.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <pugixml.hpp>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

/// Reads elements of a modelDescription.xml, with checks of types. Also contains code that the readers of all FMI
/// versions share.
namespace mebots::modeldesc {

inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const auto first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// Converts the whole text to a number; empty if the text is not a number. As in XML Schema, infinities are written INF
/// and a plus sign is permitted.
template <typename T>
std::optional<T> parse_number(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  return parsed_number<T>(text);
}

/// A parsed XML document. The constructor does not keep a reference to `text`.
class Document {
 public:
  Document(const std::string& text, std::string_view source) : source_(source) {
    parse_xml(xml_, text, source);
    for (auto at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1)) {
      line_ends_.push_back(static_cast<std::ptrdiff_t>(at));
    }
  }

  pugi::xml_node root() const { return xml_.document_element(); }

  /// Returns a message such as "line 7, <Real>: what".
  std::string located(pugi::xml_node node, std::string_view what) const {
    const auto line = std::ranges::lower_bound(line_ends_, node.offset_debug()) - line_ends_.begin() + 1;
    return fmt::format("line {}, <{}>: {}", line, node.name(), what);
  }
  [[noreturn]] void fail(pugi::xml_node node, std::string_view what) const {
    throw Error(ErrorCode::syntax_error, fmt::format("{}, {}", source_, located(node, what)));
  }

 private:
  std::string source_;
  pugi::xml_document xml_;
  std::vector<std::ptrdiff_t> line_ends_;
};

class Element {
 public:
  Element(const Document& document, pugi::xml_node node) : document_(&document), node_(node) {}

  explicit operator bool() const { return static_cast<bool>(node_); }
  std::string_view name() const { return node_.name(); }
  Element child(const char* name) const { return {*document_, node_.child(name)}; }
  bool has(const char* name) const { return static_cast<bool>(node_.attribute(name)); }
  std::string text(const char* name) const { return node_.attribute(name).value(); }  // empty if missing

  std::string_view content() const { return node_.child_value(); }

  std::string required_text(const char* name) const {
    if (!has(name)) fail(fmt::format("the attribute {} is missing", name));
    return text(name);
  }

  bool flag(const char* name, bool fallback) const {
    if (!has(name)) return fallback;
    return *parse_flag(name);
  }

  template <typename T>
  std::optional<T> number(const char* name, std::string_view expected) const {
    if (!has(name)) return std::nullopt;
    const auto value = parse_number<T>(text(name));
    if (!value) fail(fmt::format("the attribute {} is \"{}\", but {} is expected", name, text(name), expected));
    return value;
  }
  std::optional<double> real(const char* name) const { return number<double>(name, "a number"); }

  /// Converts the word in an attribute to an enumerator, whose number is the index of the word in `words`.
  template <typename T>
  std::optional<T> word(const char* name, std::span<const std::string_view> words) const {
    if (!has(name)) return std::nullopt;
    const auto found = std::ranges::find(words, text(name));
    if (found == words.end())
      fail(fmt::format("the attribute {} is \"{}\"; it must be one of {}", name, text(name), fmt::join(words, ", ")));
    return static_cast<T>(found - words.begin());
  }

  std::optional<bool> parse_flag(const char* name) const {
    const std::string value(trimmed(text(name)));
    if (value == "true" || value == "1") return true;
    if (value == "false" || value == "0") return false;
    fail(fmt::format("the attribute {} is \"{}\", but true or false is expected", name, value));
  }

  template <typename Action>
  void each_child(Action action) const {
    for (const pugi::xml_node node : node_.children())
      if (node.type() == pugi::node_element) action(Element(*document_, node));
  }
  template <typename Action>
  void each_child(const char* name, Action action) const {
    for (const pugi::xml_node node : node_.children(name)) action(Element(*document_, node));
  }
  std::size_t count_children(const char* name) const {
    const auto children = node_.children(name);
    return static_cast<std::size_t>(std::distance(children.begin(), children.end()));
  }
  /// Works as each_child(), but removes each child after its call and so frees the child's memory.
  template <typename Action>
  void consume_children(const char* name, Action action) {
    for (auto node = node_.child(name); node;) {
      action(Element(*document_, node));
      node_.remove_child(std::exchange(node, node.next_sibling(name)));
    }
  }

  std::string located(std::string_view what) const { return document_->located(node_, what); }
  [[noreturn]] void fail(std::string_view what) const { document_->fail(node_, what); }

 private:
  const Document* document_;
  pugi::xml_node node_;
};

/// Each time the reader has read this number of variables, it returns the memory of their XML elements to the system.
/// Otherwise, the XML elements and the variables together would double the peak memory for a description with a million
/// variables.
inline constexpr std::size_t kVariablesPerTrim = 1 << 16;
void release_free_memory();

/// Returns the default of the attribute `initial` (FMI 2.0.4, table on page 51; FMI 3.0.2, section 2.4.7.5).
std::optional<Initial> default_initial(Causality causality, Variability variability);

/// Returns the attribute modelIdentifier. Throws Error if it is empty, or contains a slash or backslash, because it
/// becomes part of a path.
std::string model_identifier(const Element& element);

/// Reads the attributes of the root element that all versions of FMI have into `result`. `guid` is the name of the
/// attribute for ModelDescription::guid: "guid" or "instantiationToken".
void read_head(const Element& root, const char* guid, ModelDescription& result);

/// Reads the elements that have the same form in all versions of FMI into `result`: <UnitDefinitions>, <LogCategories>,
/// <DefaultExperiment>.
void read_common(const Element& root, ModelDescription& result);

/// Reads the attributes that types and variables share into `target`. `Target` is TypeDefinition or Variable.
template <typename Target>
void read_quantities(const Element& element, Target& target) {
  target.quantity = element.text("quantity");
  target.unit = element.text("unit");
  target.display_unit = element.text("displayUnit");
  target.min = element.real("min");
  target.max = element.real("max");
  target.nominal = element.real("nominal");
}

/// Reads the dependencies of an unknown in <ModelStructure>. `find` returns the index of the variable that a word
/// denotes, or nullopt. If a word denotes no variable, the result has no dependencies: the unknown may then depend on
/// all inputs.
template <typename Find>
Unknown read_dependencies(const Element& element, Find find) {
  Unknown unknown;
  const auto words = words_of(element.text("dependencies"));
  if (element.has("dependencies")) unknown.dependencies.emplace();
  bool all_known = true;
  for (const auto& word : words) {
    const std::optional<std::size_t> variable = find(word);
    all_known = all_known && variable;
    if (all_known) unknown.dependencies->push_back(*variable);
  }
  if (!all_known) unknown.dependencies.reset();
  unknown.dependency_kinds = words_of(element.text("dependenciesKind"));
  if (!unknown.dependency_kinds.empty() && unknown.dependency_kinds.size() != words.size())
    element.fail("dependenciesKind and dependencies have different lengths");
  if (!unknown.dependencies) unknown.dependency_kinds.clear();
  return unknown;
}

/// Returns the type of a variable of FMI 1.0 or 2.0, and the child element that declares this type, such as <Real>.
std::pair<Type, Element> type_child(const Element& variable);

/// Reads the start value from the child element that declares the type; empty if the element has no start value.
Value read_start(const Element& details, Type type);

/// Indexes the types of <TypeDefinitions> by name, because a description may have thousands of types.
class DeclaredTypes {
 public:
  /// Appends a type to `types`. `types` must be the same list in every call. Throws Error if the list already contains
  /// a type with this name.
  void add(const Element& element, TypeDefinition type, std::vector<TypeDefinition>& types);
  /// Copies the attributes that the variable lacks from its declared type, if it has one. Throws Error if the declared
  /// type is unknown or does not fit the variable.
  void apply(const Element& element, const std::vector<TypeDefinition>& types, Variable& variable) const;

 private:
  std::unordered_map<std::string, std::size_t> places_;
};

ModelDescription read_fmi1(const Document& document);
ModelDescription read_fmi2(const Document& document);
ModelDescription read_fmi3(const Document& document);

}  // namespace mebots::modeldesc
