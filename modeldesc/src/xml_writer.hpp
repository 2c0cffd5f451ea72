// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <pugixml.hpp>

#include <optional>
#include <string>
#include <vector>

namespace mebots::modeldesc {

/// Returns the shortest text that converts back to the same number.
std::string number_text(double value);

class Element {
 public:
  explicit Element(pugi::xml_node node) : node_(node) {}

  Element child(const char* name) { return Element(node_.append_child(name)); }
  Element& text(const char* name, const std::string& value) {
    node_.append_attribute(name).set_value(value.c_str());
    return *this;
  }
  Element& text_if(const char* name, const std::string& value) { return value.empty() ? *this : text(name, value); }
  Element& number_if(const char* name, const std::optional<double>& value) {
    return value ? text(name, number_text(*value)) : *this;
  }
  Element& flag_if(const char* name, bool value) { return value ? text(name, "true") : *this; }
  void comment(const char* value) { node_.append_child(pugi::node_comment).set_value(value); }

 private:
  pugi::xml_node node_;
};

/// Builds a document with one root element.
class XmlText {
 public:
  explicit XmlText(const char* root);
  Element root() { return Element(document_.document_element()); }
  std::string str() const;

 private:
  pugi::xml_document document_;
};

/// Writes the attributes of <fmiModelDescription> from fmiVersion to generationTool. `token_name` is the attribute that
/// identifies the build: guid or instantiationToken.
void write_identity(Element root, const ModelDescription& description, const char* fmi_version, const char* token_name,
                    const std::string& token);
void write_units(Element root, const std::vector<Unit>& units);
void write_log_categories(Element root, const std::vector<LogCategory>& categories);
void write_default_experiment(Element root, const DefaultExperiment& experiment);

}  // namespace mebots::modeldesc
