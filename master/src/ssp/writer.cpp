// SPDX-License-Identifier: Apache-2.0
#include "base/time.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "ssp/ssp.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <fstream>
#include <set>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;
using modeldesc::Variable;
using Json = nlohmann::ordered_json;

constexpr const char* kVersion = "1.0";  // version of SSD and SSV

/// Names for the FMU files of a system: those they have, numbered where two differ in folder only.
std::map<std::filesystem::path, std::string> file_names(const SystemDescription& system) {
  std::map<std::filesystem::path, std::string> names;
  std::set<std::string> taken;
  for (const auto& instance : system.instances) {
    if (names.count(instance.fmu_path) != 0) continue;
    auto name = instance.fmu_path.filename().string();
    for (int number = 2; !taken.insert(name).second; ++number) {
      name = fmt::format("{}_{}{}", instance.fmu_path.stem().string(), number, instance.fmu_path.extension().string());
    }
    names[instance.fmu_path] = name;
  }
  return names;
}

/// A file name as a relative URI.
std::string as_uri(const std::string& name) {
  constexpr std::string_view kPlain = "-._~()[]";
  std::string uri;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       kPlain.find(c) != std::string_view::npos;
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

const char* kind_of_connector(Causality causality) {
  switch (causality) {
    case Causality::input:
      return "input";
    case Causality::output:
      return "output";
    case Causality::calculated_parameter:
      return "calculatedParameter";
    case Causality::parameter:
    case Causality::local:
    case Causality::independent:
      break;
  }
  return "parameter";
}

class SspWriter {
 public:
  SspWriter(const ResolvedSystem& system, const Json& config) : system_(system), config_(config) {}

  pugi::xml_document& write() {
    auto root = document_.append_child("ssd:SystemStructureDescription");
    const std::pair<const char*, const char*> namespaces[] = {
        {"xmlns:ssc", "http://ssp-standard.org/SSP1/SystemStructureCommon"},
        {"xmlns:ssd", "http://ssp-standard.org/SSP1/SystemStructureDescription"},
        {"xmlns:ssv", "http://ssp-standard.org/SSP1/SystemStructureParameterValues"},
        {"xmlns:oms", "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"}};
    for (const auto& [name, uri] : namespaces) root.append_attribute(name) = uri;
    root.append_attribute("name") = system_.description->name.c_str();
    root.append_attribute("version") = kVersion;
    root.append_attribute("generationTool") = "MEbots " MEBOTS_VERSION;
    auto system = root.append_child("ssd:System");
    system.append_attribute("name") = "root";
    write_elements(system.append_child("ssd:Elements"));
    write_connections(system);
    write_annotations(system.append_child("ssd:Annotations"));
    write_enumerations(root);
    write_units(root);
    auto experiment = root.append_child("ssd:DefaultExperiment");
    experiment.append_attribute("startTime") =
        fmt::format("{}", to_seconds(system_.description->start_time_ns)).c_str();
    experiment.append_attribute("stopTime") =
        fmt::format("{}", system_.description->grid().time_s(system_.description->stop_time_ns)).c_str();
    return document_;
  }

 private:
  /// The variables of an instance that connections name, in the order of the description.
  std::vector<const Variable*> connected(std::size_t instance) const {
    std::set<const Variable*> used;
    for (const auto& connection : system_.connections) {
      if (connection.from.instance == instance) used.insert(connection.from.variable);
      if (connection.to.instance == instance) used.insert(connection.to.variable);
    }
    std::vector<const Variable*> result;
    for (const auto& variable : system_.instances[instance].fmu->description().variables) {
      if (used.count(&variable) != 0) result.push_back(&variable);
    }
    return result;
  }

  void write_elements(pugi::xml_node elements) {
    const auto files = file_names(*system_.description);
    for (std::size_t i = 0; i < system_.instances.size(); ++i) {
      const auto& instance = system_.instances[i];
      const auto& name = instance.description->name;
      auto component = elements.append_child("ssd:Component");
      component.append_attribute("name") = name.c_str();
      component.append_attribute("type") = "application/x-fmu-sharedlibrary";
      component.append_attribute("source") = ("resources/" + as_uri(files.at(instance.description->fmu_path))).c_str();
      component.append_attribute("implementation") = "CoSimulation";
      const auto& keys = config_.at("instances").at(name);
      if (keys.contains("text")) {
        component.append_attribute("description") = keys.at("text").get<std::string>().c_str();
      }
      const auto variables = connected(i);
      if (!variables.empty()) {
        auto connectors = component.append_child("ssd:Connectors");
        for (const auto* variable : variables) write_connector(connectors, i, *variable);
      }
      write_parameters(component, instance);
    }
  }

  void write_connector(pugi::xml_node connectors, std::size_t instance, const Variable& variable) {
    auto connector = connectors.append_child("ssd:Connector");
    connector.append_attribute("name") = variable.name.c_str();
    connector.append_attribute("kind") = kind_of_connector(variable.causality);
    const auto& model = system_.instances[instance].fmu->description();
    auto type = connector.append_child(fmt::format("ssc:{}", modeldesc::to_string(variable.type)).c_str());
    if (variable.type == Type::enumeration) {
      const auto* definition = model.type_definition(variable.declared_type);
      if (definition != nullptr) enumerations_.emplace(definition->name, definition);
      type.append_attribute("name") = variable.declared_type.c_str();
    }
    // A unit only where its definition is at hand, and does not clash with that of another FMU.
    const auto* unit = model.unit(variable.unit);
    if (variable.type != Type::real || unit == nullptr || !unit->has_base) return;
    const auto [known, added] = units_.emplace(unit->name, unit);
    if (!added && !modeldesc::same_unit(*known->second, *unit)) return;
    type.append_attribute("unit") = unit->name.c_str();
  }

  static void write_parameters(pugi::xml_node component, const ResolvedInstance& instance) {
    if (instance.starts.empty()) return;
    auto set = component.append_child("ssd:ParameterBindings")
                   .append_child("ssd:ParameterBinding")
                   .append_child("ssd:ParameterValues")
                   .append_child("ssv:ParameterSet");
    set.append_attribute("version") = kVersion;
    set.append_attribute("name") = "parameters";
    auto parameters = set.append_child("ssv:Parameters");
    const auto& model = instance.fmu->description();
    for (const auto& start : instance.starts) {
      auto parameter = parameters.append_child("ssv:Parameter");
      parameter.append_attribute("name") = start.variable->name.c_str();
      auto type = parameter.append_child(fmt::format("ssv:{}", modeldesc::to_string(start.variable->type)).c_str());
      type.append_attribute("value") = text_of(model, start).c_str();
    }
  }

  static std::string text_of(const modeldesc::ModelDescription& model, const StartValue& start) {
    if (const auto* number = std::get_if<double>(&start.value)) return fmt::format("{}", *number);
    if (const auto* flag = std::get_if<bool>(&start.value)) return *flag ? "true" : "false";
    if (const auto* text = std::get_if<std::string>(&start.value)) return *text;
    const auto number = std::get<std::int32_t>(start.value);
    const auto* type =
        start.variable->type == Type::enumeration ? model.type_definition(start.variable->declared_type) : nullptr;
    if (type != nullptr) {
      for (const auto& item : type->items) {
        if (item.value == number) return item.name;
      }
    }
    return fmt::format("{}", number);
  }

  /// The scalar variables that a connection of the config stands for: three for an OSMP binary.
  void write_connections(pugi::xml_node system) {
    if (system_.description->connections.empty()) return;
    auto connections = system.append_child("ssd:Connections");
    const auto& written = config_.at("connections");
    for (std::size_t i = 0; i < system_.description->connections.size(); ++i) {
      const auto& connection = system_.description->connections[i];
      const auto text = written.at(i).value("text", std::string());
      const bool binary = !has_variable(connection.from);
      for (const std::string ending : {".base.lo", ".base.hi", ".size"}) {
        auto node = connections.append_child("ssd:Connection");
        node.append_attribute("startElement") = connection.from.instance.c_str();
        node.append_attribute("startConnector") = (connection.from.variable + (binary ? ending : "")).c_str();
        node.append_attribute("endElement") = connection.to.instance.c_str();
        node.append_attribute("endConnector") = (connection.to.variable + (binary ? ending : "")).c_str();
        if (!connection.convert_units) node.append_attribute("suppressUnitConversion") = "true";
        if (!text.empty()) node.append_attribute("description") = text.c_str();
        if (connection.factor != 1 || connection.offset != 0) {
          auto linear = node.append_child("ssc:LinearTransformation");
          linear.append_attribute("factor") = fmt::format("{}", connection.factor).c_str();
          linear.append_attribute("offset") = fmt::format("{}", connection.offset).c_str();
        }
        if (!binary) break;
      }
    }
  }

  bool has_variable(const VariableName& name) const {
    return std::ranges::any_of(system_.instances, [&](const ResolvedInstance& instance) {
      return instance.description->name == name.instance && instance.fmu->description().find(name.variable) != nullptr;
    });
  }

  void write_annotations(pugi::xml_node annotations) {
    // Sections that SSP has no words for.
    Json rest = Json::object();
    for (const auto& [key, value] : config_.items()) {
      if (key != "$schema" && key != "instances" && key != "connections" && key != "start_time" && key != "stop_time") {
        rest[key] = value;
      }
    }
    for (const auto& [name, keys] : config_.at("instances").items()) {
      for (const auto& [key, value] : keys.items()) {
        if (key != "fmu" && key != "parameters" && key != "text") rest["instances"][name][key] = value;
      }
    }
    // OMSimulator keeps kind and step of a system in an annotation of its own, and reads the first one only.
    auto theirs = annotations.append_child("ssc:Annotation");
    theirs.append_attribute("type") = "org.openmodelica";
    theirs.append_child("oms:Annotations")
        .append_child("oms:SimulationInformation")
        .append_child("oms:FixedStepMaster")
        .append_attribute("stepSize") = fmt::format("{}", to_seconds(system_.description->step)).c_str();
    auto master = theirs.first_child().first_child().first_child();
    master.append_attribute("description") = "oms-ma";
    master.append_attribute("absoluteTolerance") = "0.0001";
    master.append_attribute("relativeTolerance") = "0.0001";
    auto own = annotations.append_child("ssc:Annotation");
    own.append_attribute("type") = std::string(kSspAnnotation).c_str();
    own.text().set(rest.dump(2).c_str());
  }

  void write_enumerations(pugi::xml_node root) const {
    if (enumerations_.empty()) return;
    auto enumerations = root.append_child("ssd:Enumerations");
    for (const auto& [name, type] : enumerations_) {
      auto enumeration = enumerations.append_child("ssc:Enumeration");
      enumeration.append_attribute("name") = name.c_str();
      for (const auto& item : type->items) {
        auto node = enumeration.append_child("ssc:Item");
        node.append_attribute("name") = item.name.c_str();
        node.append_attribute("value") = item.value;
      }
    }
  }

  void write_units(pugi::xml_node root) const {
    if (units_.empty()) return;
    auto units = root.append_child("ssd:Units");
    for (const auto& [name, unit] : units_) {
      auto node = units.append_child("ssc:Unit");
      node.append_attribute("name") = name.c_str();
      auto base = node.append_child("ssc:BaseUnit");
      for (std::size_t i = 0; i < modeldesc::kBaseUnits.size(); ++i) {
        if (unit->exponents[i] != 0) {
          base.append_attribute(std::string(modeldesc::kBaseUnits[i]).c_str()) = unit->exponents[i];
        }
      }
      if (unit->factor != 1) base.append_attribute("factor") = fmt::format("{}", unit->factor).c_str();
      if (unit->offset != 0) base.append_attribute("offset") = fmt::format("{}", unit->offset).c_str();
    }
  }

  const ResolvedSystem& system_;
  const Json& config_;
  pugi::xml_document document_;
  std::map<std::string, const modeldesc::TypeDefinition*> enumerations_;
  std::map<std::string, const modeldesc::Unit*> units_;
};

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: cannot be written; check permissions and free space", file.string()));
}

}  // namespace

void write_ssp(const ResolvedSystem& system, const Json& config, const std::filesystem::path& archive) {
  const modeldesc::TemporaryFolder folder("mebots");
  const auto ssd = folder.path() / "SystemStructure.ssd";
  SspWriter writer(system, config);
  if (!writer.write().save_file(ssd.c_str(), "  "))
    throw Error(ErrorCode::file_unwritable, fmt::format("{}: cannot be written", ssd.string()));
  std::vector<modeldesc::PackedFile> files{{"SystemStructure.ssd", ssd}};
  for (const auto& [path, name] : file_names(*system.description)) files.push_back({"resources/" + name, path});
  modeldesc::pack(archive, files);
}

void write_config(const SystemDescription& system, Json config, const std::filesystem::path& file) {
  const auto folder = std::filesystem::path(file.stem().string() + "_fmus");
  const auto target = file.parent_path() / folder;
  std::error_code error;
  std::filesystem::create_directories(target, error);
  if (error)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: the folder cannot be made: {}", target.string(), error.message()));
  const auto names = file_names(system);
  for (const auto& [path, name] : names) {
    std::filesystem::copy_file(path, target / name, std::filesystem::copy_options::overwrite_existing, error);
    if (error)
      throw Error(ErrorCode::file_unwritable,
                  fmt::format("{}: cannot be written: {}", (target / name).string(), error.message()));
  }
  for (const auto& instance : system.instances) {
    config["instances"][instance.name]["fmu"] = (folder / names.at(instance.fmu_path)).string();
  }
  write_text(file, config.dump(2) + "\n");
}

}  // namespace mebots::master
