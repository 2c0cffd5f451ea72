// SPDX-License-Identifier: Apache-2.0
// The Python module mebots._mebots: a thin face of master::Mission. Names and texts for people are in
// mebots/__init__.pyi.
#include "base/input_error.hpp"
#include "run/mission.hpp"

#include <pybind11/functional.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

using mebots::master::Message;
using mebots::master::Mission;
using mebots::master::Series;
using mebots::master::Severity;
using mebots::master::WrittenValue;

/// A NumPy array of its own: the mission may go on and grow its series. Made by NumPy from bytes, so that any NumPy
/// will do: the binary interface changed from 1 to 2, and Debian's pybind11 knows the first one only.
py::object array_of(std::span<const double> values) {
  const py::bytes bytes(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  return py::module_::import("numpy").attr("frombuffer")(bytes, "float64").attr("copy")();
}

WrittenValue written(const py::object& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
  if (py::isinstance<py::int_>(value)) return value.cast<std::int64_t>();
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  return value.cast<double>();
}

const char* name_of(Severity severity) {
  if (severity == Severity::info) return "info";
  return severity == Severity::warning ? "warning" : "error";
}

const Series& series_of(const Mission& mission, const std::string& variable) {
  for (const auto& series : mission.series())
    if (series.name == variable) return series;
  throw py::key_error(variable + " is not recorded: name it in record() before start()");
}

/// Steps to the end; Ctrl-C ends it as it ends any Python loop.
void run(Mission& mission) {
  constexpr int kStepsBetweenLooks = 1000;
  for (bool more = true; more;) {
    {
      const py::gil_scoped_release release;
      for (int i = 0; more && i < kStepsBetweenLooks; ++i) more = mission.step();
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

void on_message(
    Mission& mission,
    const std::function<void(const std::string&, const std::string&, const std::string&, double)>& listener) {
  mission.on_message([listener](const Message& message) {
    const py::gil_scoped_acquire acquire;
    listener(std::string(message.instance), name_of(message.severity), std::string(message.text),
             1e-9 * static_cast<double>(message.time_ns));
  });
}

}  // namespace

PYBIND11_MODULE(_mebots, module) {
  module.doc() = "Drives MEbots missions. See mebots/__init__.pyi.";
  module.attr("__version__") = MEBOTS_VERSION;
  const auto& error = py::register_exception<mebots::Error>(module, "Error", PyExc_RuntimeError);
  py::register_exception<mebots::master::InputError>(module, "InputError", error);

  py::class_<Mission>(module, "Mission")
      .def(py::init([](const py::object& config) {
             return std::make_unique<Mission>(
                 py::str(py::module_::import("os").attr("fspath")(config)).cast<std::string>());
           }),
           "config"_a)
      .def("on_message", &on_message, "listener"_a)
      .def(
          "set",
          [](Mission& mission, const std::string& variable, const py::object& value) {
            mission.set(variable, written(value));
          },
          "variable"_a, "value"_a)
      .def("set_stop_time", &Mission::set_stop_time, "stop_time_s"_a)
      .def("record", &Mission::record, "patterns"_a)
      .def("start", &Mission::start, py::call_guard<py::gil_scoped_release>())
      .def("step", &Mission::step, py::call_guard<py::gil_scoped_release>())
      .def("run", &run)
      .def("run_until", &Mission::run_until, "time_s"_a, py::call_guard<py::gil_scoped_release>())
      .def("value", &Mission::value, "variable"_a)
      .def("text", &Mission::text, "variable"_a)
      .def("write", &Mission::write, "variable"_a, "value"_a)
      .def_property_readonly("time", &Mission::time_s)
      .def_property_readonly("step_size", &Mission::step_s)
      .def_property_readonly("stop_time", &Mission::stop_time_s)
      .def_property_readonly("ended", &Mission::ended)
      .def_property_readonly("outcome", &Mission::outcome)
      .def_property_readonly("end_text", &Mission::end_text)
      .def_property_readonly("times", [](const Mission& mission) { return array_of(mission.times()); })
      .def_property_readonly("variables",
                             [](const Mission& mission) {
                               std::vector<std::string> names;
                               for (const auto& series : mission.series()) names.push_back(series.name);
                               return names;
                             })
      .def(
          "__getitem__",
          [](const Mission& mission, const std::string& variable) {
            return array_of(series_of(mission, variable).values);
          },
          "variable"_a)
      .def(
          "unit", [](const Mission& mission, const std::string& variable) { return series_of(mission, variable).unit; },
          "variable"_a);
}
