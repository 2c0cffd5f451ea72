// SPDX-License-Identifier: Apache-2.0
#include "record/recorder.hpp"

#include "base/time.hpp"
#include "fmi/call/callbacks.hpp"
#include "mebots/fmu/binary_ref.hpp"
#include "model/picture_size.hpp"
#include "record/sink/png_file.hpp"
#include "slave/slave.hpp"

#include <fmt/format.h>

namespace mebots::master {
namespace {

struct Source {
  std::vector<ResolvedVariable> frame;  // a Binary, or the three variables of an OSMP binary
  ResolvedVariable id;
};

Source find_source(const ResolvedSystem& system, const PictureDescription& pictures) {
  const auto find = [&](const VariableName& name) {
    const auto found = system.find(name, pictures.place);
    if (found.variable->type != modeldesc::Type::integer) {
      throw InputError(ErrorCode::wrong_type, fmt::format("{}: {} is not an Integer, as a part of a picture must be",
                                                          pictures.place, name.text()));
    }
    return found;
  };
  const auto part = [&](const char* ending) {
    return find({pictures.frame.instance, pictures.frame.variable + ending});
  };
  const auto& model = system.instances[system.find(pictures.id, pictures.place).instance].model;
  const auto* whole = pictures.frame.instance == pictures.id.instance ? model->find(pictures.frame.variable) : nullptr;
  if (whole != nullptr && whole->type == modeldesc::Type::binary) {
    return {{system.find(pictures.frame, pictures.place)}, find(pictures.id)};
  }
  return {{part(kOsmpEndings[0]), part(kOsmpEndings[1]), part(kOsmpEndings[2])}, find(pictures.id)};
}

}  // namespace

void check_pictures(const ResolvedSystem& system, const PictureDescription& pictures) {
  find_source(system, pictures);
  const auto width = picture_width(system, pictures.frame);
  if (!width || width->pixels == pictures.width) return;
  throw InputError(
      ErrorCode::invalid_value,
      fmt::format("{0}/width: {1}, but {2} is {3}: pictures cut at another width would be garbled; set it to {3}",
                  pictures.place, pictures.width, width->parameter, width->pixels));
}

PictureRecorder::PictureRecorder(const ResolvedSystem& system, Ensemble& ensemble, const PictureDescription& pictures,
                                 std::filesystem::path folder)
    : ensemble_(&ensemble), pictures_(pictures), grid_(system.description->grid()), folder_(std::move(folder)) {
  const auto source = find_source(system, pictures_);
  for (const auto& part : source.frame) frame_.push_back(ensemble.watch(part));
  id_ = ensemble.watch(source.id);
}

void PictureRecorder::make_folder() const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error)
    throw InputError(ErrorCode::file_unwritable,
                     fmt::format("{}: this folder cannot be created: {}", folder_.string(), error.message()));
}

void PictureRecorder::remove_pictures() const {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    if (entry.path().extension() == ".png") std::filesystem::remove(entry.path(), error);
  }
}

std::optional<std::string> PictureRecorder::reached(const Point& point) {
  if (!has_folder_) make_folder();  // also in a resumed run, because the user may have deleted the folder
  has_folder_ = true;
  if (point.step == 0) remove_pictures();
  const auto id = ensemble_->integer(id_);
  if (id != last_id_) {
    last_id_ = id;
    if (!last_ns_ || grid_.has_passed(*last_ns_, point.time_ns, pictures_.interval_ns)) {
      write(point);
      last_ns_ = point.time_ns;
    }
  }
  return std::nullopt;
}

std::span<const std::uint8_t> PictureRecorder::pixels() const {
  if (frame_.size() == 1) {
    const auto& bytes = ensemble_->string(frame_[0]);
    return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
  }
  const auto part = [&](std::size_t i) { return static_cast<std::int32_t>(ensemble_->integer(frame_[i])); };
  return fmu::BinaryRef{part(0), part(1), part(2)}.bytes();
}

void PictureRecorder::write(const Point& point) const {
  const auto pixels = this->pixels();
  if (pixels.empty()) return;
  const auto width = static_cast<std::size_t>(pictures_.width);
  if (pixels.size() % width != 0) {
    throw Error(
        ErrorCode::invalid_value,
        fmt::format("{}: {} has {} bytes at {} s, which is not a whole number of rows of {} pixels; correct 'width'",
                    pictures_.place, pictures_.frame.text(), pixels.size(), to_seconds(point.time_ns), width));
  }
  if (!is_readable(pixels)) {
    throw SlaveError(
        fmt::format("instance '{}' at {} s: {} returned the address {} for {} bytes, and this memory cannot be read",
                    pictures_.frame.instance, to_seconds(point.time_ns), pictures_.frame.text(),
                    fmt::ptr(pixels.data()), pixels.size()));
  }
  write_png(folder_ / fmt::format("{:011.6f}.png", to_seconds(point.time_ns)), pixels, width);
}

void PictureRecorder::visit(state::Visitor& v) {
  v("last_id", last_id_);
  v("last_ns", last_ns_);
}

}  // namespace mebots::master
