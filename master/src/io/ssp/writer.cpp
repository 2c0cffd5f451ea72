// SPDX-License-Identifier: Apache-2.0
#include "base/time.hpp"
#include "io/ssp/ssp.hpp"
#include "mebots/modeldesc/archive.hpp"

#include "definitions_writer.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <fstream>
#include <set>

namespace mebots::master {
namespace {

using namespace ssp;
using modeldesc::Causality;
using modeldesc::Type;
using modeldesc::Variable;
using Json = nlohmann::ordered_json;

/// Returns unique names for a system's FMU files. Files that differ only in their folder get numbers.
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

/// Returns a file name as a relative URI.
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
    case Causality::structural_parameter:
    case Causality::dependent:
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
        {"xmlns:oms", "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"}};
    for (const auto& [name, uri] : namespaces) root.append_attribute(name) = uri;
    root.append_attribute("name") = system_.description->name.c_str();
    root.append_attribute("version") = kWrittenVersion;
    root.append_attribute("generationTool") = "MEbots " MEBOTS_VERSION;
    auto system = root.append_child("ssd:System");
    system.append_attribute("name") = "root";
    write_elements(system.append_child("ssd:Elements"));
    write_connections(system);
    write_annotations(system.append_child("ssd:Annotations"));
    definitions_.write(root, "ssd:");
    auto experiment = root.append_child("ssd:DefaultExperiment");
    experiment.append_attribute("startTime") =
        fmt::format("{}", to_seconds(system_.description->start_time_ns)).c_str();
    experiment.append_attribute("stopTime") =
        fmt::format("{}", system_.description->grid().time_s(system_.description->stop_time_ns)).c_str();
    return document_;
  }
  /// Returns the parameter sets to which write() refers, by file name in resources/.
  const std::map<std::string, pugi::xml_document>& parameter_sets() const { return parameter_sets_; }

 private:
  /// Returns the connected variables of an instance, in the order of the description.
  std::vector<const Variable*> connected(std::size_t instance) const {
    std::set<const Variable*> used;
    for (const auto& connection : system_.connections) {
      if (connection.from.instance == instance) used.insert(connection.from.variable);
      if (connection.to.instance == instance) used.insert(connection.to.variable);
    }
    std::vector<const Variable*> result;
    for (const auto& variable : system_.instances[instance].model->variables) {
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
      component.append_attribute("implementation") = std::string(element_of(instance.kind)).c_str();
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
    const auto& model = *system_.instances[instance].model;
    auto type = connector.append_child(fmt::format("ssc:{}", modeldesc::to_string(variable.type)).c_str());
    if (variable.type == Type::enumeration) {
      definitions_.add_enumeration(model, variable);
      type.append_attribute("name") = variable.declared_type.c_str();
    }
    const auto unit = definitions_.unit_of(model, variable);
    if (!unit.empty()) type.append_attribute("unit") = unit.c_str();
  }

  void write_parameters(pugi::xml_node component, const ResolvedInstance& instance) {
    if (instance.starts.empty()) return;
    const auto name = free_name(instance.description->name);
    component.append_child("ssd:ParameterBindings").append_child("ssd:ParameterBinding").append_attribute("source") =
        ("resources/" + name).c_str();
    write_parameter_set(instance, parameter_sets_[name]);
  }

  /// Returns a plain file name that no other parameter set has.
  std::string free_name(const std::string& instance) const {
    std::string stem = instance;
    for (auto& c : stem) {
      const bool plain =
          (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
      if (!plain) c = '_';
    }
    auto name = stem + ".ssv";
    for (int number = 2; parameter_sets_.contains(name); ++number) name = fmt::format("{}_{}.ssv", stem, number);
    return name;
  }

  /// Writes each connection of the config as connections of scalar variables. An OSMP binary has three of them.
  void write_connections(pugi::xml_node system) {
    if (system_.description->connections.empty()) return;
    auto connections = system.append_child("ssd:Connections");
    const auto& written = config_.at("connections");
    for (std::size_t i = 0; i < system_.description->connections.size(); ++i) {
      const auto& connection = system_.description->connections[i];
      if (connection.sum) continue;  // SSP cannot express it
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
        write_transformation(node, connection);
        if (!binary) break;
      }
    }
    if (!connections.first_child()) system.remove_child(connections);
  }

  void write_transformation(pugi::xml_node node, const ConnectionDescription& connection) const {
    if (connection.factor != 1 || connection.offset != 0) {
      auto linear = node.append_child("ssc:LinearTransformation");
      linear.append_attribute("factor") = fmt::format("{}", connection.factor).c_str();
      linear.append_attribute("offset") = fmt::format("{}", connection.offset).c_str();
    }
    if (connection.map.empty()) return;
    const auto to = system_.find(connection.to, connection.place);
    const auto resolved = std::ranges::find(system_.connections, to, &ResolvedConnection::to);
    const bool flags = to.variable->type == Type::boolean;
    auto map = node.append_child(flags ? "ssc:BooleanMappingTransformation" : "ssc:IntegerMappingTransformation");
    for (const auto& pair : resolved->map) {
      const auto text = [&](std::int64_t value) {
        return flags ? std::string(value != 0 ? "true" : "false") : fmt::format("{}", value);
      };
      auto entry = map.append_child("ssc:MapEntry");
      entry.append_attribute("source") = text(pair.from).c_str();
      entry.append_attribute("target") = text(pair.to).c_str();
    }
  }

  bool has_variable(const VariableName& name) const {
    return std::ranges::any_of(system_.instances, [&](const ResolvedInstance& instance) {
      return instance.description->name == name.instance && instance.model->find(name.variable) != nullptr;
    });
  }

  void write_annotations(pugi::xml_node annotations) {
    // The sections of a config for which SSP has no elements are written to an annotation.
    Json rest = Json::object();
    for (const auto& [key, value] : config_.items()) {
      if (key != "$schema" && key != "instances" && key != "connections" && key != "start_time" && key != "stop_time") {
        rest[key] = value;
      }
    }
    for (std::size_t i = 0; i < system_.description->connections.size(); ++i) {
      if (system_.description->connections[i].sum) rest["connections"].push_back(config_.at("connections").at(i));
    }
    for (const auto& [name, keys] : config_.at("instances").items()) {
      for (const auto& [key, value] : keys.items()) {
        if (key != "fmu" && key != "parameters" && key != "text") rest["instances"][name][key] = value;
      }
    }
    // OMSimulator stores the kind and step of a system in its own annotation. It reads only the first annotation, so
    // its annotation is written first.
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
    // In SSP 1.0 an annotation contains elements only, not text.
    auto holder = own.append_child("mebots:Config");
    holder.append_attribute("xmlns:mebots") = fmt::format("urn:{}", kSspAnnotation).c_str();
    holder.text().set(rest.dump(2).c_str());
  }

  const ResolvedSystem& system_;
  const Json& config_;
  pugi::xml_document document_;
  DefinitionsWriter definitions_;
  std::map<std::string, pugi::xml_document> parameter_sets_;  // by file name
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
  std::vector<modeldesc::PackedFile> files;
  const auto add = [&](const pugi::xml_document& document, const std::string& entry) {
    const auto file = folder.path() / fmt::format("{}.xml", files.size());
    if (!document.save_file(file.c_str(), "  "))
      throw Error(ErrorCode::file_unwritable, fmt::format("{}: cannot be written", file.string()));
    files.push_back({entry, file});
  };
  SspWriter writer(system, config);
  add(writer.write(), "SystemStructure.ssd");
  for (const auto& [name, set] : writer.parameter_sets()) add(set, "resources/" + name);
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
                fmt::format("{}: the folder cannot be created: {}", target.string(), error.message()));
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
