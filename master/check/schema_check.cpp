// SPDX-License-Identifier: Apache-2.0
#include "checks.hpp"

#include "schema_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

namespace mebots::check {
namespace {

class SchemaCheck {
 public:
  /// If `grammar` is empty, uses the grammar of the FMI version in the file.
  SchemaCheck(std::string_view text, Findings findings, std::optional<Grammar> grammar)
      : text_(text), findings_(findings), grammar_(grammar) {}

  void run() {
    check_bytes();
    pugi::xml_document document;
    const auto parsed = document.load_buffer(text_.data(), text_.size(),
                                             pugi::parse_default | pugi::parse_doctype | pugi::parse_declaration);
    if (!parsed) {
      findings_.error(fmt::format("line {}: not well-formed XML: {}", line(parsed.offset), parsed.description()),
                      "write the file with an XML library");
      return;
    }
    const auto root = document.document_element();
    if (!grammar_) grammar_ = grammar_of(root.attribute("fmiVersion").value());
    const char* const wanted = names_terminals() ? "fmiTerminalsAndIcons" : "fmiModelDescription";
    for (const auto node : document.children()) {
      if (node.type() == pugi::node_doctype)
        findings_.warning(fmt::format("line {}: there is a DOCTYPE, which FMI {} does not use",
                                      line(node.offset_debug()), grammar_->version),
                          "remove it: careful tools refuse such files");
      const std::string encoding = node.type() == pugi::node_declaration ? node.attribute("encoding").value() : "";
      const bool is_free = grammar_->version == "1.0";  // FMI 1.0 does not define the encoding
      if (!encoding.empty() && !is_free && encoding != "UTF-8" && encoding != "utf-8")
        findings_.error(
            fmt::format("the file declares the encoding {}; FMI {} requires UTF-8", encoding, grammar_->version),
            "write it in UTF-8");
    }
    if (std::string_view(root.name()) != wanted) {
      findings_.error(fmt::format("the root element is <{}>, not <{}>", root.name(), wanted),
                      "is this the description of an FMU?");
      return;
    }
    check_element(root, *grammar_->root);
  }

 private:
  void check_bytes() {
    // Requires UTF-8 without control characters, which XML 1.0 forbids.
    for (std::size_t i = 0; i < text_.size();) {
      const auto byte = static_cast<unsigned char>(text_[i]);
      if (byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') {
        findings_.error(fmt::format("line {}: control character 0x{:02x}", line(static_cast<std::ptrdiff_t>(i)), byte),
                        "remove it");
        return;
      }
      const std::size_t length = byte < 0x80         ? 1
                                 : (byte >> 5) == 6  ? 2
                                 : (byte >> 4) == 14 ? 3
                                 : (byte >> 3) == 30 ? 4
                                                     : 0;
      bool good = length != 0 && i + length <= text_.size();
      for (std::size_t k = 1; good && k < length; ++k) good = (static_cast<unsigned char>(text_[i + k]) >> 6) == 2;
      if (!good) {
        findings_.error(fmt::format("line {}: byte 0x{:02x} is not UTF-8", line(static_cast<std::ptrdiff_t>(i)), byte),
                        "write the file in UTF-8");
        return;
      }
      i += length;
    }
  }

  void check_element(pugi::xml_node node, const ElementRule& rule) {
    check_attributes(node, rule);
    if (rule.anything) return;
    check_children(node, rule);
  }

  void check_attributes(pugi::xml_node node, const ElementRule& rule) {
    for (const auto attribute : node.attributes()) {
      const std::string_view name = attribute.name();
      if (name.starts_with("xmlns") || name.starts_with("xsi:")) continue;
      if (grammar_->foreign_attributes && name.find(':') != std::string_view::npos) continue;
      const auto found = std::ranges::find(rule.attributes, name, &AttributeRule::name);
      if (found == rule.attributes.end()) {
        if (!rule.anything)
          error(
              node, fmt::format("there is no attribute {} in FMI {}", name, grammar_->version),
              rule.attributes.empty() ? "remove it" : fmt::format("remove it; known here: {}", names(rule.attributes)));
        continue;
      }
      const auto value = trimmed(attribute.value());
      if (!found->form->holds(value))
        error(node, fmt::format("{} is \"{}\"", name, value), fmt::format("write {}", found->form->expected));
    }
    for (const auto& attribute : rule.attributes)
      if (attribute.required && !node.attribute(attribute.name.c_str()))
        error(node, fmt::format("the attribute {} is missing", attribute.name), "add it");
  }

  void check_children(pugi::xml_node node, const ElementRule& rule) {
    std::map<std::string_view, std::size_t> counts;
    std::size_t last = 0;
    std::size_t chosen = 0;
    for (const auto child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      const std::string_view name = child.name();
      const auto found = std::ranges::find(rule.children, name, &ChildRule::name);
      if (found == rule.children.end()) {
        error(child, fmt::format("<{}> has no such child in FMI {}", node.name(), grammar_->version),
              rule.children.empty() ? "remove it" : fmt::format("remove it; known here: {}", names(rule.children)));
        continue;
      }
      const auto position = static_cast<std::size_t>(found - rule.children.begin());
      // FMI permits ModelExchange and CoSimulation in either order.
      const bool swapped = name == "ModelExchange" && last == 1;
      if (position < last && !swapped && !rule.unordered)
        error(child, fmt::format("it must be before <{}>", rule.children[last].name),
              fmt::format("the order is: {}", names(rule.children)));
      last = std::max(last, position);
      if (++counts[name] == found->most + 1)
        error(child, fmt::format("it occurs twice in <{}>", node.name()), "keep one");
      if (rule.alternatives && name != "Annotations" && name != "DirectDependency") ++chosen;
      check_element(child, *found->element);
    }
    for (const auto& child : rule.children)
      if (counts[child.name] < child.least)
        error(node, fmt::format("it contains no <{}>", child.name),
              fmt::format("add one, or remove <{}>", node.name()));
    if (rule.unordered && counts.empty())
      error(node, "it is empty", fmt::format("add one of {}, or remove it", names(rule.children)));
    if (rule.alternatives && chosen != 1)
      error(node, fmt::format("\"{}\" has {} types", node.attribute("name").value(), chosen),
            "use one of <Real>, <Integer>, <Boolean>, <String>, <Enumeration>");
  }

  void error(pugi::xml_node node, std::string_view what, std::string way_out) {
    // Limits the number of findings for an entirely wrong description.
    constexpr std::size_t kMost = 50;
    if (++errors_ > kMost) return;
    findings_.error(fmt::format("line {}, <{}>: {}", line(node.offset_debug()), node.name(), what), std::move(way_out));
  }

  template <typename T>
  static std::string names(const std::vector<T>& list) {
    std::string text;
    for (const auto& item : list) text += (text.empty() ? "" : ", ") + item.name;
    return text;
  }

  std::ptrdiff_t line(std::ptrdiff_t offset) const {
    const auto end = std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text_.size()));
    return 1 + std::count(text_.begin(), text_.begin() + end, '\n');
  }

  bool names_terminals() const { return grammar_->root == grammar_of_terminals().root; }

  std::string_view text_;
  Findings findings_;
  std::optional<Grammar> grammar_;
  std::size_t errors_ = 0;
};

}  // namespace

void check_schema(std::string_view text, Findings findings) {
  SchemaCheck(text, findings, std::nullopt).run();
}

void check_terminals_schema(std::string_view text, Findings findings) {
  SchemaCheck(text, findings, grammar_of_terminals()).run();
}

}  // namespace mebots::check
