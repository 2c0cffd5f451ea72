// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "record/observer.hpp"

#include <cstdint>
#include <filesystem>

namespace mebots::master {

/// Keeps the frames that an OSMP binary carries, as PNG files named by their time:
/// `0012.345000.png` is the frame that was out at 12.345 s.
class PictureRecorder final : public Observer {
 public:
  /// Throws InputError when the frame or its id is not a variable of the kind that is needed.
  PictureRecorder(const ResolvedSystem& system, Ensemble& ensemble, const PictureDescription& pictures,
                  std::filesystem::path folder);

  /// Throws Error when the folder cannot be made, or the frame is not made of whole rows or cannot be written.
  std::optional<std::string> reached(const Point& point) override;
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "pictures"; }

 private:
  void make_folder() const;
  void remove_pictures() const;
  void write(const Point& point) const;

  const Ensemble* ensemble_;
  PictureDescription pictures_;
  TimeGrid grid_;
  std::filesystem::path folder_;
  SignalId base_lo_;
  SignalId base_hi_;
  SignalId size_;
  SignalId id_;
  bool has_folder_ = false;
  std::int32_t last_id_ = 0;
  std::optional<std::int64_t> last_ns_;  // when a picture was written
};

/// Throws InputError when the variables do not exist or are of the wrong kind, or the FMU says another width.
void check_pictures(const ResolvedSystem& system, const PictureDescription& pictures);

}  // namespace mebots::master
