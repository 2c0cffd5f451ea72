// SPDX-License-Identifier: Apache-2.0
#include "record/recorder.hpp"

#include "mebots/assert.hpp"
#include "mebots/hexadecimal.hpp"
#include "message/message_text.hpp"
#include "model/resolved_system.hpp"

#include <bit>

namespace mebots::master {
namespace {

/// A block with this many bytes of text is written even if it is not full.
constexpr std::size_t kBlockTextBytes = 1 << 20;

/// Returns the type in the results. Enumerations of FMI 3.0 have 64 bits.
modeldesc::Type recorded_type(const ResolvedSystem& system, const ResolvedVariable& variable) {
  const auto type = variable.variable->type;
  const bool is_wide = type == modeldesc::Type::enumeration && system.instances[variable.instance].model->is_fmi3();
  return is_wide ? modeldesc::Type::int64 : type;
}

}  // namespace

Recorder::Recorder(const ResolvedSystem& system, Ensemble& ensemble)
    : ensemble_(&ensemble), grid_(system.description->grid()), every_steps_(system.description->record.every_steps) {
  records_step_ = system.description->record.step;
  if (records_step_) columns_.push_back({"step", "s", modeldesc::Type::real});
  for (const auto& variable : recorded_variables(system)) {
    signals_.push_back(ensemble.watch(variable));
    columns_.push_back({system.text(variable), variable.variable->unit, recorded_type(system, variable)});
  }
  block_.cells_per_row = columns_.size() + 1;
  MEBOTS_ASSERT(every_steps_ > 0, "the reader refuses an interval below the step");
  block_.cells.reserve(kBlockCells + block_.cells_per_row);
}

void Recorder::add(std::unique_ptr<RowSink> sink) {
  MEBOTS_ASSERT(sink != nullptr && rows_ == 0, "sinks come before rows");
  writer_.add(*sink);
  sinks_.push_back(std::move(sink));
}

void Recorder::find_sources() {
  MEBOTS_ASSERT(sources_.empty());
  if (records_step_) sources_.push_back({.real = &step_s_});
  for (const auto& signal : signals_) {
    Source source;
    switch (signal.kind) {
      case ValueKind::real:
        source.real = &ensemble_->real(signal);
        break;
      case ValueKind::boolean:
        source.boolean = true;
        [[fallthrough]];
      case ValueKind::integer:
        source.integer = &ensemble_->integer(signal);
        break;
      case ValueKind::binary:
        source.binary = true;
        [[fallthrough]];
      case ValueKind::string:
        source.text = &ensemble_->string(signal);
        break;
      case ValueKind::clock:
        MEBOTS_ASSERT(false, "recorded_variables() leaves clocks out");
    }
    sources_.push_back(source);
  }
}

std::optional<std::string> Recorder::reached(const Point& point) {
  if (records_step_) {
    step_s_ = point_ns_ ? grid_.length_s(*point_ns_, point.time_ns) : 0;
    point_ns_ = point.time_ns;
  }
  if (point.step % every_steps_ == 0) write_row(point);
  return std::nullopt;
}

void Recorder::ended(const Point& point) {
  if (last_step_ != point.step) write_row(point);
}

void Recorder::write_row(const Point& point) {
  MEBOTS_ASSERT(point.step > last_step_, "a point is written once");
  if (sources_.size() != columns_.size()) find_sources();
  const auto size = block_.cells.size();
  block_.cells.resize(size + block_.cells_per_row);
  auto* cell = block_.cells.data() + size;
  *cell++ = std::bit_cast<std::uint64_t>(grid_.time_s(point.time_ns));
  for (const auto& source : sources_) {
    if (source.real != nullptr) {
      *cell++ = std::bit_cast<std::uint64_t>(*source.real);
    } else if (source.integer != nullptr) {
      const std::int64_t value = *source.integer;
      *cell++ = static_cast<std::uint64_t>(source.boolean ? std::int64_t{value != 0} : value);
    } else {
      *cell++ = block_.texts.size();
      block_.texts.push_back(source.binary ? hexadecimal(*source.text) : valid_utf8(*source.text));
      text_bytes_ += source.text->size() + sizeof(std::string);
    }
  }
  MEBOTS_ASSERT(cell == block_.cells.data() + block_.cells.size(), "a row has one cell per column");
  last_step_ = point.step;
  ++rows_;
  if (block_.cells.size() >= kBlockCells || text_bytes_ >= kBlockTextBytes) {
    writer_.submit(block_);
    text_bytes_ = 0;
  }
}

void Recorder::visit(state::Visitor& v) {
  flush();
  for (const auto& sink : sinks_) {
    if (!sink->state_name().empty()) v(sink->state_name(), *sink);
  }
  v("rows", rows_);
  v("last_step", last_step_);
  if (v.restores()) {
    for (const auto& sink : sinks_) sink->keep_rows(rows_);
  }
  if (!records_step_) return;
  v("step_s", step_s_);
  v("point_ns", point_ns_);
}

}  // namespace mebots::master
