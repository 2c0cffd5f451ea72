// SPDX-License-Identifier: Apache-2.0
#include "xml_writer.hpp"

#include <fmt/format.h>

#include <sstream>

namespace mebots::modeldesc {

std::string number_text(double value) {
  std::string text = fmt::format("{}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text;
}

void write_identity(Element root, const ModelDescription& description, const char* fmi_version, const char* token_name,
                    const std::string& token) {
  root.text("fmiVersion", fmi_version)
      .text("modelName", description.model_name)
      .text(token_name, token)
      .text_if("description", description.text)
      .text_if("author", description.author)
      .text_if("version", description.version)
      .text_if("copyright", description.copyright)
      .text_if("license", description.license)
      .text_if("generationTool", description.generation_tool);
}

void write_units(Element root, const std::vector<Unit>& units) {
  if (units.empty()) return;
  Element definitions = root.child("UnitDefinitions");
  for (const Unit& unit : units) {
    Element element = definitions.child("Unit").text("name", unit.name);
    if (unit.has_base) {
      Element base = element.child("BaseUnit");
      for (std::size_t i = 0; i < kBaseUnits.size(); ++i)
        if (unit.exponents[i] != 0) base.text(std::string(kBaseUnits[i]).c_str(), std::to_string(unit.exponents[i]));
      if (unit.factor != 1) base.text("factor", number_text(unit.factor));
      if (unit.offset != 0) base.text("offset", number_text(unit.offset));
    }
    for (const DisplayUnit& display : unit.display_units) {
      Element shown = element.child("DisplayUnit").text("name", display.name);
      if (display.factor != 1) shown.text("factor", number_text(display.factor));
      if (display.offset != 0) shown.text("offset", number_text(display.offset));
    }
  }
}

void write_log_categories(Element root, const std::vector<LogCategory>& log_categories) {
  if (log_categories.empty()) return;
  Element categories = root.child("LogCategories");
  for (const LogCategory& category : log_categories)
    categories.child("Category").text("name", category.name).text_if("description", category.text);
}

void write_default_experiment(Element root, const DefaultExperiment& experiment) {
  if (experiment == DefaultExperiment{}) return;
  root.child("DefaultExperiment")
      .number_if("startTime", experiment.start_time_s)
      .number_if("stopTime", experiment.stop_time_s)
      .number_if("tolerance", experiment.tolerance)
      .number_if("stepSize", experiment.step_size_s);
}

XmlText::XmlText(const char* root) {
  pugi::xml_node declaration = document_.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  document_.append_child(root);
}

std::string XmlText::str() const {
  std::ostringstream text;
  document_.save(text, "  ", pugi::format_default, pugi::encoding_utf8);
  return text.str();
}

}  // namespace mebots::modeldesc
