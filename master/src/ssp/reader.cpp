// SPDX-License-Identifier: Apache-2.0
#include "mebots/data/document.hpp"
#include "ssp/ssp.hpp"

#include "parameters.hpp"
#include "read.hpp"
#include "xml_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

namespace mebots::master {
namespace {

using namespace ssp;
using Json = nlohmann::ordered_json;

/// A connector: of a component, or of a system as seen from inside and outside.
struct Endpoint {
  std::string element;  // dotted path, empty = the root system
  std::string connector;

  bool operator<(const Endpoint& other) const {
    return std::tie(element, connector) < std::tie(other.element, other.connector);
  }
  std::string text() const { return element.empty() ? connector : element + "." + connector; }
};

/// What comes into an endpoint.
struct Edge {
  Endpoint from;
  double factor = 1;
  double offset = 0;
  bool convert_units = true;
  std::string description;
  std::string place;
};

struct Component {
  std::string path;
  std::filesystem::path fmu;
  std::string description;
  std::string place;
};

class SspReader {
 public:
  SspReader(const Files& files, const std::string& archive, const std::string& ssd)
      : source_{files, archive}, file_(files.read(ssd), archive + ": " + ssd) {}

  SspConfig read() {
    const auto root = file_.root();
    if (local_name(root) != "SystemStructureDescription") {
      file_.fail(root, "the root element must be SystemStructureDescription");
    }
    const auto version = file_.required(root, "version");
    // 2.0 adds to 1.0, in the same namespaces; what is new and matters here is refused where it is met.
    if (version != "1.0" && version != "2.0") {
      file_.fail(root, fmt::format("this is SSP {}; 1.0 and 2.0 can be read", version));
    }
    const auto system = child(root, "System");
    if (!system) file_.fail(root, "the element System is missing");
    read_system(system, "");
    write_instances();
    write_connections();
    read_experiment(child(root, "DefaultExperiment"));
    for (const auto owner : {root, system}) read_annotations(owner);
    return std::move(result_);
  }

 private:
  static std::string join(const std::string& path, const std::string& name) {
    return path.empty() ? name : path + "." + name;
  }

  void read_system(pugi::xml_node system, const std::string& path) {
    std::set<std::string> names;
    for (const auto connector : children(child(system, "Connectors"), "Connector")) {
      system_connectors_.insert({path, file_.required(connector, "name")});
    }
    for (const auto element : child(system, "Elements").children()) {
      const auto kind = local_name(element);
      if (element.type() != pugi::node_element) continue;
      const auto name = file_.required(element, "name");
      if (name.empty()) file_.fail(element, "the name is empty");
      if (!names.insert(name).second) file_.fail(element, fmt::format("the name \"{}\" is there twice", name));
      const auto inner = join(path, name);
      if (kind == "System") {
        read_system(element, inner);
      } else if (kind == "Component") {
        read_component(element, inner);
      } else {
        file_.fail(element, fmt::format("{} cannot be used; components and systems can", kind));
      }
    }
    for (const auto connection : children(child(system, "Connections"), "Connection")) {
      read_connection(connection, path, names);
    }
    // Inner bindings come first, so that those of an outer system override them.
    for (auto& parameter : read_parameter_bindings(source_, file_, system)) {
      assign(path, parameter.name, parameter.value, parameter.place);
    }
  }

  void read_component(pugi::xml_node element, const std::string& path) {
    const auto type = std::string_view(element.attribute("type").as_string("application/x-fmu-sharedlibrary"));
    if (type != "application/x-fmu-sharedlibrary") {
      file_.fail(element,
                 fmt::format("\"{}\" is of type {}; FMUs (application/x-fmu-sharedlibrary) can be used", path, type));
    }
    const auto implementation = std::string_view(element.attribute("implementation").as_string("any"));
    if (implementation != "any" && implementation != "CoSimulation") {
      file_.fail(element, fmt::format("\"{}\" asks for {}; co-simulation is what mebots does", path, implementation));
    }
    if (!element.attribute("source")) {
      file_.fail(element, fmt::format("\"{}\" has no source, so there is nothing to simulate", path));
    }
    const auto inside = resolve_uri(source_, file_, element, element.attribute("source").value());
    components_.push_back(
        {path, source_.files.place(inside), element.attribute("description").value(), file_.place(element)});
    component_paths_.insert(path);
    for (auto& parameter : read_parameter_bindings(source_, file_, element)) {
      assign(path, parameter.name, parameter.value, parameter.place);
    }
  }

  void read_connection(pugi::xml_node node, const std::string& path, const std::set<std::string>& names) {
    const auto end = [&](const char* element, const char* connector) -> Endpoint {
      const auto attribute = node.attribute(element);
      // The system's own connector; some tools write an empty name for it.
      if (!attribute || *attribute.value() == '\0') return {path, file_.required(node, connector)};
      if (names.count(attribute.value()) == 0) {
        file_.fail(node, fmt::format("there is no element \"{}\" in this system", attribute.value()));
      }
      return {join(path, attribute.value()), file_.required(node, connector)};
    };
    for (const auto* unsupported :
         {"BooleanMappingTransformation", "IntegerMappingTransformation", "EnumerationMappingTransformation"}) {
      if (child(node, unsupported)) file_.fail(node, fmt::format("{} is not supported on a connection", unsupported));
    }
    const auto linear = child(node, "LinearTransformation");
    Edge edge;
    edge.from = end("startElement", "startConnector");
    edge.factor = file_.number(linear, "factor", 1);
    edge.offset = file_.number(linear, "offset", 0);
    edge.convert_units = !file_.flag(node, "suppressUnitConversion", false);
    edge.description = node.attribute("description").value();
    edge.place = file_.place(node);
    const auto to = end("endElement", "endConnector");
    const auto [existing, added] = edges_.emplace(to, edge);
    if (!added) {
      file_.fail(node,
                 fmt::format("\"{}\" has two sources; the other one is at {}", to.text(), existing->second.place));
    }
    order_.push_back(to);
  }

  /// A value for a connector of the system at `path`, or for something in one of its elements.
  void assign(const std::string& path, const std::string& name, const Json& value, const std::string& place) {
    values_[resolve(path, name)] = {path, name, value, place};
  }

  Endpoint resolve(const std::string& path, const std::string& name) const {
    if (system_connectors_.count({path, name}) != 0 || component_paths_.count(path) != 0) return {path, name};
    // The longest element path wins, so that names with dots find their way.
    for (auto dot = name.rfind('.'); dot != std::string::npos && dot > 0; dot = name.rfind('.', dot - 1)) {
      Endpoint endpoint{join(path, name.substr(0, dot)), name.substr(dot + 1)};
      if (component_paths_.count(endpoint.element) != 0 || system_connectors_.count(endpoint) != 0) return endpoint;
    }
    return {path, name};
  }

  void write_instances() {
    auto& instances = result_.config["instances"] = Json::object();
    result_.places["/instances"] = file_.place(file_.root());
    for (const auto& component : components_) {
      auto& instance = instances[component.path] = Json::object();
      const auto pointer = "/instances" + data::pointer_step(component.path);
      result_.places[pointer] = component.place;
      instance["fmu"] = component.fmu.string();
      if (!component.description.empty()) instance["text"] = component.description;
    }
    for (const auto& [endpoint, value] : values_) {
      if (component_paths_.count(endpoint.element) != 0) {
        set_parameter(endpoint, value.value, value.place);
      } else if (system_connectors_.count(endpoint) == 0) {
        result_.notices.push_back(fmt::format("{}: nothing in the system is named \"{}\", so its value is left out",
                                              value.place, value.name));
      }
    }
  }

  void set_parameter(const Endpoint& endpoint, const Json& value, const std::string& place) {
    result_.config["instances"][endpoint.element]["parameters"][endpoint.connector] = value;
    result_.places["/instances" + data::pointer_step(endpoint.element) + "/parameters" +
                   data::pointer_step(endpoint.connector)] = place;
  }

  /// Follows each connection into a component back through the connectors of systems to where it begins.
  void write_connections() {
    auto& connections = result_.config["connections"] = Json::array();
    for (const auto& to : order_) {
      if (component_paths_.count(to.element) == 0) continue;  // a system's connector is only a way through
      Edge whole = edges_.at(to);
      std::set<Endpoint> seen;
      while (component_paths_.count(whole.from.element) == 0) {
        if (!seen.insert(whole.from).second) {
          throw InputError(ErrorCode::invalid_connection,
                           fmt::format("{}: the connection to {} runs in a circle through \"{}\"", whole.place,
                                       to.text(), whole.from.text()));
        }
        const auto before = edges_.find(whole.from);
        if (before == edges_.end()) break;
        // whole(before(x)): what comes first is applied first.
        whole.offset += whole.factor * before->second.offset;
        whole.factor *= before->second.factor;
        whole.convert_units = whole.convert_units && before->second.convert_units;
        whole.from = before->second.from;
        if (!std::isfinite(whole.factor) || !std::isfinite(whole.offset)) throw out_of_range(whole, to);
      }
      if (component_paths_.count(whole.from.element) == 0) {
        feed_from_outside(to, whole);
        continue;
      }
      result_.places[fmt::format("/connections/{}", connections.size())] = whole.place;
      Json connection;
      connection["from"] = whole.from.text();
      connection["to"] = to.text();
      if (whole.factor != 1) connection["factor"] = whole.factor;
      if (whole.offset != 0) connection["offset"] = whole.offset;
      if (!whole.convert_units) connection["convert_units"] = false;
      if (!whole.description.empty()) connection["text"] = whole.description;
      connections.push_back(std::move(connection));
    }
  }

  /// An input or parameter that hangs on a connector of the root system: its value there is a start value here.
  void feed_from_outside(const Endpoint& to, const Edge& edge) {
    const auto value = values_.find(edge.from);
    if (value == values_.end()) {
      result_.notices.push_back(fmt::format("{}: {} is connected to the system's connector \"{}\", which nothing feeds",
                                            edge.place, to.text(), edge.from.text()));
      return;
    }
    auto number = value->second.value;
    if (edge.factor != 1 || edge.offset != 0) {
      if (!number.is_number()) {
        throw InputError(ErrorCode::wrong_type,
                         fmt::format("{}: the value of \"{}\" is {}, but only numbers can be transformed linearly",
                                     edge.place, edge.from.text(), number.dump()));
      }
      number = edge.factor * number.get<double>() + edge.offset;
      if (!std::isfinite(number.get<double>())) throw out_of_range(edge, to);
    }
    set_parameter(to, number, value->second.place);
  }

  static InputError out_of_range(const Edge& edge, const Endpoint& to) {
    return InputError(
        fmt::format("{}: the transformations on the way to {} leave the range of numbers", edge.place, to.text()));
  }

  void read_experiment(pugi::xml_node node) {
    if (!node) return;
    if (file_.number(node, "startTime", 0) != 0) {
      result_.config["start_time"] = file_.number(node, "startTime", 0);
      result_.places["/start_time"] = file_.place(node);
    }
    if (!node.attribute("stopTime")) return;
    result_.config["stop_time"] = file_.number(node, "stopTime", 0);
    result_.places["/stop_time"] = file_.place(node);
  }

  void read_annotations(pugi::xml_node owner) {
    for (const auto annotation : children(child(owner, "Annotations"), "Annotation")) {
      const std::string_view type = annotation.attribute("type").value();
      if (type == kSspAnnotation) read_own(annotation);
      if (type == "org.openmodelica") read_openmodelica(annotation);
    }
  }

  /// The step of OMSimulator's fixed-step master.
  void read_openmodelica(pugi::xml_node annotation) {
    const auto master = annotation.find_node([](pugi::xml_node node) { return local_name(node) == "FixedStepMaster"; });
    if (!master || !master.attribute("stepSize") || result_.config.contains("step")) return;
    result_.config["step"] = file_.number(master, "stepSize", 0);
    result_.places["/step"] = file_.place(master);
  }

  void read_own(pugi::xml_node annotation) {
    const std::string text = annotation.text().get();
    try {
      data::Document(text, file_.place(annotation)).read([&](const data::Node& root) {
        static_cast<void>(root.members());  // which fails when it is not an object
      });
    } catch (const data::Mistakes& mistakes) {
      throw InputError(mistakes.code(), mistakes.what());
    }
    const auto own = Json::parse(text);
    for (const auto& [key, value] : own.items()) {
      if (key == "instances") {
        add_to_instances(annotation, value);
      } else {
        result_.config[key] = value;
        result_.places[data::pointer_step(key)] = file_.place(annotation);
      }
    }
  }

  void add_to_instances(pugi::xml_node annotation, const Json& more) {
    if (!more.is_object()) file_.fail(annotation, "\"instances\" must be an object");
    for (const auto& [name, keys] : more.items()) {
      auto& instances = result_.config["instances"];
      if (!instances.contains(name) || !keys.is_object()) {
        file_.fail(annotation, fmt::format("\"instances\" names \"{}\", which is not a component of this SSP", name));
      }
      for (const auto& [key, value] : keys.items()) {
        instances[name][key] = value;
        result_.places["/instances" + data::pointer_step(name) + data::pointer_step(key)] = file_.place(annotation);
      }
    }
  }

  struct Assigned {
    std::string path;
    std::string name;
    Json value;
    std::string place;
  };

  Source source_;
  XmlFile file_;
  SspConfig result_;
  std::vector<Component> components_;
  std::set<std::string> component_paths_;
  std::set<Endpoint> system_connectors_;
  std::map<Endpoint, Edge> edges_;
  std::vector<Endpoint> order_;  // of the connections in the file
  std::map<Endpoint, Assigned> values_;
};

}  // namespace

SspConfig ssp::read(const Files& files, const std::string& archive, const std::string& ssd) {
  if (!files.holds(ssd)) {
    throw InputError(ErrorCode::archive_damaged, fmt::format("{}: this is not an SSP: it holds no {}", archive, ssd));
  }
  return SspReader(files, archive, ssd).read();
}

SspConfig read_ssp(const std::filesystem::path& folder, const std::filesystem::path& archive, const std::string& ssd) {
  const FolderFiles files(folder);
  auto result = ssp::read(files, archive.string(), ssd);
  result.source = files.bytes_read();
  return result;
}

}  // namespace mebots::master
