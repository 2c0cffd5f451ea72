// SPDX-License-Identifier: Apache-2.0
#include "io/fmu_archive.hpp"
#include "io/ssp/ssp.hpp"
#include "mebots/data/document.hpp"
#include "mebots/parsed_number.hpp"

#include "network.hpp"
#include "ssp.hpp"
#include "values.hpp"
#include "xml_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace mebots::master {
namespace {

using namespace ssp;

/// True if the output can have this value. Entries of a map with other source values are ignored (SSP 2.0, 4.5.2.3).
bool may_give(const Port& port, const std::string& source) {
  if (port.variable == nullptr || port.variable->type == modeldesc::Type::boolean) return true;
  const auto number = parsed_number<std::int64_t>(source);
  if (port.variable->type != modeldesc::Type::enumeration) {
    return number && (!port.variable->min || static_cast<double>(*number) >= *port.variable->min) &&
           (!port.variable->max || static_cast<double>(*number) <= *port.variable->max);
  }
  const auto* type = port.model->type_definition(port.variable->declared_type);
  if (type == nullptr) return false;
  return std::ranges::any_of(
      type->items, [&](const modeldesc::EnumerationItem& item) { return item.name == source || item.value == number; });
}

Json map_json(const ValueMap& map, const Port& from) {
  Json json = Json::object();
  for (const auto& [source, target] : map.entries) {
    if (!may_give(from, source)) continue;
    if (map.kind == ValueMap::Kind::boolean) {
      json[source] = target == "true";
    } else if (const auto number = parsed_number<std::int64_t>(target)) {
      json[source] = *number;
    } else {
      json[source] = target;
    }
  }
  return json;
}

/// An annotation in which another tool stores the communication step.
struct StepAnnotation {
  std::string_view type;
  std::string_view element;
  const char* attribute;
};

constexpr StepAnnotation kStepAnnotations[] = {
    {"org.openmodelica", "FixedStepMaster", "stepSize"},
    {"com.opensimulationplatform", "FixedStepAlgorithm", "baseStepSize"},
};

class ConfigMaker {
 public:
  ConfigMaker(const Files& files, const Document& document, std::vector<std::string>& notices)
      : files_(files),
        file_(document.file.get()),
        notices_(notices),
        network_(document.system, descriptions_, [&](const auto& path) { return files.place(path); }) {}

  SspConfig make() {
    write_instances();
    auto values = starting_values(network_, value_notices_);
    write_ways(values);
    write_values(values);
    write_parameters();
    for (auto& notice : value_notices_.texts()) notices_.push_back(std::move(notice));
    const auto root = file_->root();
    read_experiment(child(root, "DefaultExperiment"));
    for (const auto owner : {root, child(root, "System"), child(root, "DefaultExperiment")}) read_annotations(owner);
    return std::move(result_);
  }

 private:
  using StartingValues = std::map<Endpoint, StartingValue>;

  void write_instances() {
    auto& instances = result_.config["instances"] = Json::object();
    result_.places["/instances"] = file_->place(file_->root());
    for (const auto& [path, component] : network_.components()) {
      auto& instance = instances[path] = Json::object();
      result_.places["/instances" + data::pointer_step(path)] = component->place;
      instance["fmu"] = files_.place(component->fmu).string();
      if (component->in_own_process) instance["process"] = "own";
      if (!component->fmu_kind.empty()) instance["kind"] = component->fmu_kind;
      if (!component->description.empty()) instance["text"] = component->description;
    }
  }

  /// Sets the value of a component's variable. Must be called only once for a variable.
  void set_parameter(const Endpoint& endpoint, const Json& value, const std::string& place) {
    parameters_[endpoint.element].emplace_back(endpoint.connector, value);
    result_.places["/instances" + data::pointer_step(endpoint.element) + "/parameters" +
                   data::pointer_step(endpoint.connector)] = place;
  }

  void write_ways(StartingValues& values) {
    result_.config["connections"] = Json::array();
    for (const auto& way : network_.ways()) {
      if (network_.is_component(way.front().from.element)) {
        connect(way, values);
      } else {
        for (const auto& part : parts_with_values(way, values)) feed(part, values);
      }
    }
  }

  /// Returns the combined effect of the transformations and unit conversions of a chain, from its connection with the
  /// index `first`. `unit` is the unit of the value before this connection, if known.
  Course course_of(const Way& way, std::size_t first, const std::optional<modeldesc::Unit>& unit) const {
    const auto from = network_.port(way[first].from);
    const auto to = network_.port(way.back().to);
    const auto difference = [](const Port& port) {
      return port.variable != nullptr && port.variable->relative_quantity;
    };
    Course course(unit, difference(from) && difference(to));
    for (std::size_t i = first; i < way.size(); ++i) {
      course.pass(way[i].connection->transformation, network_.port(way[i].to).unit());
    }
    if (course.shifts_units() && from.variable != nullptr && difference(from) != difference(to)) {
      throw InputError(
          ErrorCode::wrong_unit,
          fmt::format("{}: one of {} and {} is a difference (relativeQuantity) and the other is not, so the "
                      "unit cannot be converted",
                      way.back().connection->place, way[first].from.text(), way.back().to.text()));
    }
    return course;
  }

  /// Adds one connection to the config, from the first to the last variable of `way`. It combines the transformations
  /// of all connections of `way`. If their combined factor is 0, sets the last variable to the offset instead.
  void connect(const Way& way, StartingValues& values) {
    const auto& from = way.front().from;
    const auto& to = way.back().to;
    for (const auto& hop : way)
      leave_out(values, hop.to,
                fmt::format("values are ignored, because the variable gets its value from {}", from.text()));
    const auto course = course_of(way, 0, network_.port(from).unit());
    if (course.factor() == 0) {  // only the offset has an effect
      set_parameter(to, course.offset(), way.back().connection->place);
      return;
    }
    auto& connections = result_.config["connections"];
    result_.places[fmt::format("/connections/{}", connections.size())] = way.back().connection->place;
    Json json = {{"from", from.text()}, {"to", to.text()}};
    if (converts_by_itself(way)) {
      const auto& transformation = way.front().connection->transformation;
      if (const auto* linear = std::get_if<Linear>(&transformation.what)) put_numbers(json, *linear);
      if (!transformation.convert_units) json["convert_units"] = false;
    } else {
      put_numbers(json, {course.factor(), course.offset()});
      json["convert_units"] = false;
      if (course.converts_units()) {
        notices_.push_back(fmt::format("{} -> {}: converted to [{}]", from.text(), to.text(),
                                       course.unit() ? course.unit()->name : ""));
      }
    }
    if (course.map()) json["map"] = map_json(*course.map(), network_.port(from));
    for (const auto& hop : way) {
      if (!hop.connection->description.empty()) json["text"] = hop.connection->description;
    }
    connections.push_back(std::move(json));
  }

  static void put_numbers(Json& json, const Linear& linear) {
    if (linear.factor != 1) json["factor"] = linear.factor;
    if (linear.offset != 0) json["offset"] = linear.offset;
  }

  /// True for a single connection whose FMUs both declare their units. The master then converts the value, and adds a
  /// notice.
  bool converts_by_itself(const Way& way) const {
    return way.size() == 1 && network_.port(way.front().from).has_own_unit() &&
           network_.port(way.front().to).has_own_unit();
  }

  std::vector<std::string> elements_with_values(const StartingValues& values, const Endpoint& array) const {
    std::vector<std::string> elements;
    for (auto value = values.lower_bound({array.element, array.connector + "["}); value != values.end(); ++value) {
      const auto& [element, connector] = value->first;
      if (element != array.element || !connector.starts_with(array.connector + "[")) break;
      auto indices = network_.indices_of(value->first);
      if (array.connector.size() + indices.size() == connector.size()) elements.push_back(std::move(indices));
    }
    return elements;
  }

  /// If connectors of a system have values for single elements of the array, returns a chain for each of these
  /// elements. Omits elements with a connection of their own. If no element has such a value or connection, returns
  /// only `way`.
  std::vector<Way> parts_with_values(const Way& way, const StartingValues& values) const {
    std::set<std::string> elements;
    for (const auto& hop : way) {
      for (auto& indices : elements_with_values(values, hop.from)) elements.insert(std::move(indices));
    }
    const auto connected = network_.connected_elements(way.front().from);
    for (const auto& indices : connected) elements.erase(indices);
    std::vector<Way> parts;
    for (const auto& indices : elements) parts.push_back(element_of(way, indices));
    if (parts.empty() && connected.empty()) parts.push_back(way);
    return parts;
  }

  /// Sets the start value of the last variable of `way`, which begins at a connector of a system. Uses the value of the
  /// outermost connector of `way` that has one.
  void feed(const Way& way, StartingValues& values) {
    const auto& to = way.back().to;
    std::size_t first = 0;
    while (first < way.size() && !values.contains(way[first].from)) ++first;
    if (first == way.size()) {
      if (!values.contains(to)) {
        notices_.push_back(fmt::format("{}: {} is connected to the system's connector \"{}\", which has no source",
                                       way.back().connection->place, to.text(), way.front().from.text()));
      }
      return;
    }
    for (std::size_t i = first; i < way.size(); ++i) {
      leave_out(values, way[i].to,
                fmt::format("values are ignored, because the variable gets its value from {}", way[first].from.text()));
    }
    const auto& value = values.at(way[first].from);
    used_.insert(way[first].from);
    const auto course = course_of(way, first, value.unit);
    const auto name = fmt::format("{}: \"{}\"", value.place, way[first].from.text());
    set_parameter(to, fitting(course.apply(value.value, name), network_.port(to)), value.place);
  }

  /// Removes the values of a variable, or of all elements of an array, and adds a notice.
  void leave_out(StartingValues& values, const Endpoint& endpoint, const std::string& reason) {
    std::vector<std::string> names{endpoint.connector};
    for (const auto& indices : elements_with_values(values, endpoint)) names.push_back(endpoint.connector + indices);
    for (auto& name : names) {
      const auto value = values.find({endpoint.element, std::move(name)});
      if (value == values.end()) continue;
      value_notices_.add(value->second.file, reason, value->first.text());
      values.erase(value);
    }
  }

  /// Writes the start values that write_ways() has not used to the parameters of components. Adds a notice for values
  /// of connectors without a connection.
  void write_values(const StartingValues& values) {
    for (const auto& [endpoint, value] : values) {
      if (network_.is_component(endpoint.element)) {
        set_parameter(endpoint, value.value, value.place);
      } else if (!used_.contains(endpoint)) {
        value_notices_.add(value.file, "values are ignored, because the connector has no connection", endpoint.text());
      }
    }
  }

  void write_parameters() {
    for (auto& [element, parameters] : parameters_)
      result_.config["instances"][element]["parameters"] = std::move(parameters);
  }

  void read_experiment(pugi::xml_node node) {
    if (!node) return;
    if (file_->number(node, "startTime", 0) != 0) {
      result_.config["start_time"] = file_->number(node, "startTime", 0);
      result_.places["/start_time"] = file_->place(node);
    }
    if (!node.attribute("stopTime")) return;
    result_.config["stop_time"] = file_->number(node, "stopTime", 0);
    result_.places["/stop_time"] = file_->place(node);
  }

  void read_annotations(pugi::xml_node owner) {
    for (const auto annotation : children(child(owner, "Annotations"), "Annotation")) {
      const std::string_view type = annotation.attribute("type").value();
      if (type == kSspAnnotation) read_own(annotation);
      for (const auto& tool : kStepAnnotations) {
        if (type == tool.type) read_step(annotation, tool);
      }
    }
  }

  /// Reads the communication step from the annotation of another tool. MEbots' own annotation takes precedence.
  void read_step(pugi::xml_node annotation, const StepAnnotation& tool) {
    const auto holder = annotation.find_node([&](pugi::xml_node node) { return local_name(node) == tool.element; });
    if (!holder || !holder.attribute(tool.attribute) || result_.config.contains("step")) return;
    result_.config["step"] = file_->number(holder, tool.attribute, 0);
    result_.places["/step"] = file_->place(holder);
  }

  void read_own(pugi::xml_node annotation) {
    // SSP 2.0 permits text in an annotation. SSP 1.0 requires an element around it.
    const auto element = annotation.find_child([](pugi::xml_node node) { return node.type() == pugi::node_element; });
    const std::string text = (element ? element : annotation).text().get();
    try {
      data::Document(text, file_->place(annotation)).read([&](const data::Node& root) {
        static_cast<void>(root.members());  // throws if the text is not an object
      });
    } catch (const data::Mistakes& mistakes) {
      throw InputError(mistakes.code(), mistakes.what());
    }
    const auto own = Json::parse(text);
    for (const auto& [key, value] : own.items()) {
      if (key == "instances") {
        add_to_instances(annotation, value);
      } else if (key == "connections" && value.is_array()) {
        add_connections(annotation, value);
      } else {
        result_.config[key] = value;
        result_.places[data::pointer_step(key)] = file_->place(annotation);
      }
    }
  }

  void add_connections(pugi::xml_node annotation, const Json& more) {
    auto& connections = result_.config["connections"];
    for (const auto& connection : more) {
      result_.places[fmt::format("/connections/{}", connections.size())] = file_->place(annotation);
      connections.push_back(connection);
    }
  }

  void add_to_instances(pugi::xml_node annotation, const Json& more) {
    if (!more.is_object()) file_->fail(annotation, "\"instances\" must be an object");
    for (const auto& [name, keys] : more.items()) {
      auto& instances = result_.config["instances"];
      if (!instances.contains(name) || !keys.is_object()) {
        file_->fail(annotation, fmt::format("\"instances\" names \"{}\", which is not a component of this SSP", name));
      }
      for (const auto& [key, value] : keys.items()) {
        instances[name][key] = value;
        result_.places["/instances" + data::pointer_step(name) + data::pointer_step(key)] = file_->place(annotation);
      }
    }
  }

  const Files& files_;
  const XmlFile* file_;
  std::vector<std::string>& notices_;
  FmuDescriptions descriptions_;
  Network network_;
  ValueNotices value_notices_;
  std::set<Endpoint> used_;                           // connectors of systems whose values are used
  std::map<std::string, Json::object_t> parameters_;  // key: component
  SspConfig result_;
};

}  // namespace

SspConfig ssp::read(const Files& files, const std::string& archive, const std::string& ssd) {
  if (!files.holds(ssd)) {
    throw InputError(ErrorCode::archive_damaged,
                     fmt::format("{}: this is not an SSP: it contains no {}", archive, ssd));
  }
  std::vector<std::string> notices;
  const Source source{files, archive, "", notices};
  const auto document = read_document(source, ssd);
  auto result = ConfigMaker(files, document, notices).make();
  result.notices = std::move(notices);
  return result;
}

SspConfig read_ssp(const std::filesystem::path& folder, const std::filesystem::path& archive, SspReach reach,
                   const std::string& ssd) {
  const FolderFiles files(folder, reach == SspReach::anywhere);
  auto result = ssp::read(files, archive.string(), ssd);
  result.source = files.bytes_read();
  return result;
}

}  // namespace mebots::master
