// SPDX-License-Identifier: Apache-2.0
// The Python module mebots._mebots, which wraps mebots::Mission. Docstrings, defaults and NumPy arrays are in
// mebots/*.py.
#include "base/input_text.hpp"
#include "base/signal_guard.hpp"
#include "cases/run_case.hpp"
#include "io/find_fmu.hpp"
#include "io/flight/airframe_file.hpp"
#include "io/study/base_config.hpp"
#include "io/study/study_file.hpp"
#include "mebots/data/csv.hpp"
#include "record/sink/hdf5_tables.hpp"
#include "report/page.hpp"
#include "run/draws.hpp"
#include "run/variable_units.hpp"

#include <mebots/run.hpp>

#include <pybind11/functional.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <span>
#include <string>
#include <string_view>

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

using mebots::InterruptOnSignals;
using mebots::Message;
using mebots::Mission;
using mebots::RunOptions;
using mebots::RunState;
using mebots::Severity;

/// Returns a column as bytes, from which NumPy creates an array with any version. Debian's pybind11 supports only the
/// binary interface of NumPy 1.
py::bytes bytes_of(const std::vector<double>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)};
}

/// Converts a number. Throws InputError if the type cannot represent the value.
template <typename T>
T held_by(const py::object& value, const char* what) {
  try {
    return value.cast<T>();
  } catch (const py::cast_error&) {
    throw mebots::InputError(mebots::ErrorCode::invalid_value,
                             "a value is " + std::string(what) + ", not " +
                                 std::string(py::str(py::module_::import("builtins").attr("ascii")(value))));
  }
}

mebots::Value value_of(const py::object& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
  if (py::isinstance<py::int_>(value)) return held_by<std::int64_t>(value, "a whole number of 64 bits");
  if (py::isinstance<py::str>(value)) return held_by<std::string>(value, "text in Unicode");
  if (py::isinstance<py::float_>(value)) return value.cast<double>();
  // NumPy's scalars and similar types return a plain Python value from item().
  if (py::hasattr(value, "item")) return value_of(value.attr("item")());
  throw py::type_error("a value is a bool, int, float or str, not " + py::repr(value).cast<std::string>());
}

const char* name_of(Severity severity) {
  if (severity == Severity::info) return "info";
  return severity == Severity::warning ? "warning" : "error";
}

/// Steps without the interpreter's lock. Ctrl-C ends the run between two calls to FMUs and writes its reports.
/// Afterwards, raises the signal again for Python's handler, and throws the resulting KeyboardInterrupt.
template <typename Work>
auto stepping(Mission& mission, Work work) {
  const auto result = [&] {
    const py::gil_scoped_release release;
    const InterruptOnSignals guard(mission, true);
    return work();
  }();
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  return result;
}

/// Steps until `time_s`, even if a signal arrives. Afterwards, raises the signal again for its previous handler. A
/// second signal has its default effect.
void run_through(Mission& mission, double time_s) {
  {
    const py::gil_scoped_release release;
    std::atomic<bool> has_arrived{false};
    const mebots::master::SignalGuard guard(has_arrived, mebots::master::SignalGuard::Afterwards::raise);
    mission.run_until(time_s);
  }
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
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

void on_point(Mission& mission, const std::function<void(double)>& listener) {
  mission.on_point([listener](double time_s) {
    const py::gil_scoped_acquire acquire;
    listener(time_s);
  });
}

/// Returns the rows of a CSV file with the header. `errors` is Python's name for the treatment of invalid UTF-8.
py::list read_csv(const std::filesystem::path& file, const std::string& errors) {
  const auto text = mebots::master::input_text(file);
  const auto decoded = [&](std::string_view cell) {
    PyObject* made = PyUnicode_DecodeUTF8(cell.data(), static_cast<Py_ssize_t>(cell.size()), errors.c_str());
    if (made == nullptr) throw py::error_already_set();
    return py::reinterpret_steal<py::str>(made);
  };
  return mebots::master::refused_as_input([&] {
    mebots::data::CsvReader reader(text, file.string());
    py::list rows;
    py::list header;
    for (const auto& name : reader.header()) header.append(decoded(name));
    rows.append(std::move(header));
    while (reader.next()) {
      py::list row;
      for (std::size_t i = 0; i < reader.header().size(); ++i) row.append(decoded(reader.cell(i)));
      rows.append(std::move(row));
    }
    return rows;
  });
}

/// Raises an exception of mebots/errors.py.
void raise_as(const char* type, const mebots::Error& error) {
  const auto kind = py::module_::import("mebots.errors").attr(type);
  const auto raised = kind(error.what(), std::string(mebots::name_of(error.code())));
  PyErr_SetObject(kind.ptr(), raised.ptr());
}

// pybind11 passes the exception by value.
void translate(std::exception_ptr thrown) {  // NOLINT(performance-unnecessary-value-param)
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const mebots::InputError& error) {
    raise_as("InputError", error);
  } catch (const mebots::Error& error) {
    raise_as("Error", error);
  }
}

}  // namespace

PYBIND11_MODULE(_mebots, module) {
  module.attr("__version__") = std::string(mebots::version());
  py::register_exception_translator(&translate);

  py::class_<Mission>(module, "Mission")
      .def(py::init([](const std::filesystem::path& config, const std::optional<std::filesystem::path>& out,
                       bool in_memory, const std::vector<std::filesystem::path>& scenarios,
                       const std::vector<std::filesystem::path>& inputs, std::optional<double> stop_time_s,
                       std::optional<double> step_s, bool isolate, bool statistics,
                       std::optional<double> checkpoint_every_s, std::optional<bool> draws_calibration) {
             RunOptions options;
             if (out) options.out = *out;
             options.in_memory = in_memory;
             options.scenarios = scenarios;
             options.inputs = inputs;
             options.stop_time_s = stop_time_s;
             options.step_s = step_s;
             options.isolate = isolate;
             options.statistics = statistics;
             options.checkpoint_every_s = checkpoint_every_s;
             options.draws_calibration = draws_calibration;
             return std::make_unique<Mission>(config, options);
           }),
           "config"_a, "out"_a, "in_memory"_a, "scenarios"_a, "inputs"_a, "stop_time"_a, "step"_a, "isolate"_a,
           "statistics"_a, "checkpoint_every"_a, "draws_calibration"_a)
      .def_static("resume", &Mission::resume, "folder"_a, "in_memory"_a)
      .def("on_message", &on_message)
      .def("on_point", &on_point)
      .def("set", [](Mission& mission, const std::string& variable,
                     const py::object& value) { mission.set(variable, value_of(value)); })
      .def("add_scenario", &Mission::add_scenario)
      .def("add_inputs", &Mission::add_inputs)
      .def("set_stop_time", &Mission::set_stop_time)
      .def("record", &Mission::record)
      .def("start", [](Mission& mission) { stepping(mission, [&] { return mission.start(), true; }); })
      .def("step", [](Mission& mission) { return stepping(mission, [&] { return mission.step(); }); })
      .def("run", [](Mission& mission) { stepping(mission, [&] { return mission.run(), true; }); })
      .def("run_until",
           [](Mission& mission, double time_s) { stepping(mission, [&] { return mission.run_until(time_s), true; }); })
      .def("run_through", &run_through)
      .def("start_from",
           [](Mission& mission, const std::string_view state) { mission.start_from(std::as_bytes(std::span(state))); })
      .def("save_state",
           [](Mission& mission) {
             const auto state = mission.save_state();
             return py::bytes(reinterpret_cast<const char*>(state.data()), state.size());
           })
      .def("load", &Mission::load)
      .def("free_instances",
           [](Mission& mission) {
             py::list leftovers;
             for (const auto& one : mission.free_instances())
               leftovers.append(py::make_tuple(one.text, one.in_process));
             return leftovers;
           })
      .def("reset", &Mission::reset)
      .def("close", &Mission::close, py::call_guard<py::gil_scoped_release>())
      .def("interrupt", &Mission::interrupt)
      .def("value", &Mission::value, py::call_guard<py::gil_scoped_release>())
      .def("text", &Mission::text, py::call_guard<py::gil_scoped_release>())
      .def("write", &Mission::write, py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("time", &Mission::time_s)
      .def_property_readonly("step_size", &Mission::step_s)
      .def_property_readonly("stop_time", &Mission::stop_time_s)
      .def_property_readonly("state",
                             [](const Mission& mission) { return std::string(mebots::name_of(mission.state())); })
      .def_property_readonly("ended", &Mission::ended)
      .def_property_readonly("outcome", &Mission::outcome)
      .def_property_readonly("end_reason",
                             [](const Mission& mission) -> std::optional<std::string> {
                               const auto reason = mission.end_reason();
                               if (!reason) return std::nullopt;
                               return std::string(mebots::name_of(*reason));
                             })
      .def_property_readonly("end_text", &Mission::end_text)
      .def_property_readonly("error", &Mission::error)
      .def_property_readonly("summary", &Mission::summary)
      .def_property_readonly("variables", &Mission::variables)
      .def_property_readonly("times", [](Mission& mission) { return bytes_of(mission.times()); })
      .def("series", [](Mission& mission, const std::string& variable) {
        const auto series = mission.series(variable);
        return py::make_tuple(series.unit, bytes_of(series.values));
      });

  // Functions for the pytest plug-in of the package mebots.
  namespace cases = mebots::master::cases;
  module.def("case_names", [](const std::filesystem::path& file) {
    std::vector<std::string> names;
    for (const auto& description : cases::read_cases(file).cases) names.push_back(description.name);
    return names;
  });
  module.def("run_case", &cases::run_case_as_json, py::call_guard<py::gil_scoped_release>());

  // Functions for the Python package mebots.flight. Files and mappings are returned as JSON texts.
  namespace flight = mebots::master::flight;
  module.def("read_airframe", [](const std::filesystem::path& file) {
    return mebots::master::refused_as_input([&] { return flight::read_airframe(file); }).dump();
  });
  module.def("read_log_mapping", [](const std::filesystem::path& file) {
    return mebots::master::refused_as_input([&] { return flight::read_log_mapping(file); }).dump();
  });
  module.def("find_fmu", [](const std::string& name) { return mebots::master::find_fmu(name, {}); });
  module.def("log_signals", [] {
    std::vector<std::pair<std::string_view, std::string_view>> found;
    for (const auto& signal : flight::log_signals()) found.emplace_back(signal.name, signal.unit);
    return found;
  });
  module.def("log_unit_factor", [](const std::string& from, const std::string& to) {
    return mebots::master::refused_as_input([&] { return flight::log_unit_factor(from, to); });
  });

  // Functions for the Python package mebots.exploration. Studies are JSON texts.
  namespace study = mebots::master::study;
  module.def("read_study", [](const std::filesystem::path& file) {
    return mebots::master::refused_as_input([&] { return study::read(file); }).dump();
  });
  module.def("check_study", [](const std::string& text, const std::filesystem::path& file) {
    return mebots::master::refused_as_input([&] { return study::read(text, file); }).dump();
  });
  module.def("calibration_parameters", [](const std::filesystem::path& config) {
    const auto names = [&] { return mebots::master::calibration_parameters(config); };
    return mebots::master::refused_as_input(names);
  });
  module.def("variable_units", [](const std::filesystem::path& config) {
    return mebots::master::refused_as_input([&] { return mebots::master::variable_units(config); });
  });
  module.def("unit_draw", &mebots::master::unit_draw);
  py::class_<mebots::master::TableColumn>(module, "TableColumn")
      .def(py::init<std::string, std::string, decltype(mebots::master::TableColumn::values)>());
  py::class_<mebots::master::Table>(module, "Table")
      .def(py::init<std::string, std::vector<mebots::master::TableColumn>>());
  module.def("read_csv", &read_csv, "file"_a, "errors"_a = "strict");
  module.def("write_hdf5", &mebots::master::write_hdf5);
  namespace report = mebots::master::report;
  module.def("data_page", [](const std::string& title, const std::string& data) {
    return py::bytes(report::make_data_page(report::read_data_page_parts(), title, data));
  });
  py::class_<study::BaseConfig>(module, "BaseConfig")
      .def(py::init(&study::read_base_config), "mission"_a, "text"_a = std::nullopt)
      .def_property_readonly("config", [](const study::BaseConfig& base) { return base.config.dump(); })
      .def_property_readonly("fmus", [](const study::BaseConfig& base) { return base.fmus.dump(); })
      .def_property_readonly("texts", [](const study::BaseConfig& base) { return base.texts.dump(); })
      .def_readonly("stop_time_s", &study::BaseConfig::stop_time_s)
      .def_readonly("last_point_s", &study::BaseConfig::last_point_s);
}
