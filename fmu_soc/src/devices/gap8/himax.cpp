// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/himax.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <algorithm>
#include <bit>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kModelHigh = 0x0000;
constexpr std::uint32_t kModeSelect = 0x0100;
constexpr std::uint32_t kOrientation = 0x0101;
constexpr std::uint32_t kSoftwareReset = 0x0103;
constexpr std::uint32_t kFrameLines = 0x0340;
constexpr std::uint32_t kLineClocks = 0x0342;
constexpr std::uint32_t kIntegrationLines = 0x0202;
constexpr std::uint32_t kBinning = 0x0390;
constexpr std::uint32_t kBinsRows = 1;
constexpr std::uint32_t kBinsColumns = 2;
constexpr std::uint32_t kEverySecondColumn = 0x0383;
constexpr std::uint32_t kEverySecondRow = 0x0387;
constexpr std::uint32_t kWindow = 0x3010;
constexpr std::uint32_t kFrameCount = 0x3020;
constexpr std::uint32_t kModes = 7;
constexpr std::uint32_t kStreaming = 1;
constexpr std::uint32_t kSomeFrames = 3;
constexpr std::uint32_t kMirrored = 1;
constexpr std::uint32_t kUpsideDown = 2;

constexpr std::int64_t kPixelClockHz = 6'000'000;
/// Values after reset: 45 frames per second of the largest format. Source: data sheet, as quoted in the drivers.
constexpr std::uint32_t kResetFrameLines = 0x0158;
constexpr std::uint32_t kResetLineClocks = 0x0178;
constexpr std::uint32_t kModel = 0x01B0;

}  // namespace

void Himax::reset() {
  registers_.assign(kRegisters, 0);
  const auto set = [this](std::size_t at, std::uint32_t value) {
    registers_[at] = static_cast<std::uint8_t>(value >> 8);
    registers_[at + 1] = static_cast<std::uint8_t>(value);
  };
  set(kModelHigh, kModel);
  set(kFrameLines, kResetFrameLines);
  set(kLineClocks, kResetLineClocks);
}

void Himax::select_mode(std::uint32_t mode, Picoseconds now) {
  if ((mode & kStreaming) == 0) return stand_by(now);
  const auto lit_at = now + exposure_time();
  if (!streams_) {
    streams_ = true;
    first_at_ = lit_at;
    port_.begin(now);
  }
  const auto frames = std::max<Picoseconds>(reg(kFrameCount), 1);
  ends_at_ = (mode & kModes) == kSomeFrames ? frame_after(lit_at) + frames * period() : kNever;
}

void Himax::stand_by(Picoseconds now) {
  if (!streams_) return;
  streams_ = false;
  port_.end(now);
}

void Himax::advance(Picoseconds now) {
  if (now >= next_event()) stand_by(ends_at_);
}

void Himax::write(std::uint8_t byte, Picoseconds now) {
  if (address_bytes_ < 2) {
    at_ = (at_ << 8 | byte) & 0xffffU;
    ++address_bytes_;
    return;
  }
  const auto at = at_;
  at_ = (at_ + 1) & 0xffffU;
  if (at == kSoftwareReset) {
    reset();
    stand_by(now);
    return;
  }
  if (at >= kRegisters) return;
  registers_[at] = byte;
  if (at == kModeSelect) select_mode(byte, now);
}

std::uint8_t Himax::read() {
  const auto at = at_;
  at_ = (at_ + 1) & 0xffffU;
  return at < kRegisters ? registers_[at] : std::uint8_t{0};
}

FrameFormat Himax::format() const {
  constexpr std::uint8_t kEverySecond = 3;
  return {.window_height = (reg(kWindow) & 1U) != 0 ? kWindowHeight : kHeight,
          .row_step = reg(kEverySecondRow) == kEverySecond ? 2U : 1U,
          .column_step = reg(kEverySecondColumn) == kEverySecond ? 2U : 1U,
          .binning = reg(kBinning),
          .orientation = reg(kOrientation)};
}

Picoseconds Himax::lines_time(std::uint32_t lines) const {
  const auto clocks = std::int64_t{lines} * std::max(pair(kLineClocks), format().width());
  return clocks * 1'000'000'000'000 / kPixelClockHz;
}

Picoseconds Himax::exposure_time() const {
  return lines_time(pair(kIntegrationLines));
}

Picoseconds Himax::period() const {
  return lines_time(std::max(pair(kFrameLines), format().height()));
}

Picoseconds Himax::frame_after(Picoseconds time) const {
  const auto past = std::max<Picoseconds>(time - first_at_, 0);
  return first_at_ + (past + period() - 1) / period() * period();
}

Picoseconds Himax::frame_at(Picoseconds time) const {
  MEBOTS_ASSERT(streams_);
  const auto begin = frame_after(time);
  return begin < ends_at_ ? begin : kNever;
}

std::uint32_t FrameFormat::width() const {
  return Himax::kWidth / column_step;
}

void FrameFormat::read_out(std::span<const std::uint8_t> picture, std::vector<std::uint8_t>& pixels) const {
  constexpr auto kWidth = Himax::kWidth;
  MEBOTS_ASSERT(picture.size() % kWidth == 0 && picture.size() / kWidth >= window_height);
  const auto top = picture.subspan((picture.size() / kWidth - window_height) / 2 * kWidth);
  const std::size_t rows = height();
  const std::size_t columns = width();
  const std::size_t binned_rows = row_step == 2 && (binning & kBinsRows) != 0 ? 2 : 1;
  const std::size_t binned_columns = column_step == 2 && (binning & kBinsColumns) != 0 ? 2 : 1;
  const auto count = binned_rows * binned_columns;
  const auto shift = std::countr_zero(count);
  pixels.resize(rows * columns);
  auto* to = pixels.data();
  for (std::size_t row = 0; row < rows; ++row) {
    const auto from_row = ((orientation & kUpsideDown) != 0 ? rows - 1 - row : row) * row_step;
    for (std::size_t column = 0; column < columns; ++column) {
      const auto from_column = ((orientation & kMirrored) != 0 ? columns - 1 - column : column) * column_step;
      std::size_t sum = count / 2;
      for (std::size_t i = 0; i < binned_rows; ++i) {
        for (std::size_t j = 0; j < binned_columns; ++j) sum += top[(from_row + i) * kWidth + from_column + j];
      }
      *to++ = static_cast<std::uint8_t>(sum >> shift);
    }
  }
}

void FrameFormat::visit(state::Visitor& v) {
  v("window_height", window_height);
  v("row_step", row_step);
  v("column_step", column_step);
  v("binning", binning);
  v("orientation", orientation);
  const auto is_step = [](std::uint32_t step) { return step == 1 || step == 2; };
  if (window_height > Himax::kHeight || !is_step(row_step) || !is_step(column_step)) {
    throw Error(ErrorCode::state_damaged, "a saved state is damaged: a camera's frame has another format");
  }
}

void Himax::visit(state::Visitor& v) {
  v("registers", registers_);
  v("at", at_);
  v("address_bytes", address_bytes_);
  v("streams", streams_);
  v("first_at", first_at_);
  v("ends_at", ends_at_);
  if (registers_.size() != kRegisters || at_ > 0xffffU) {
    throw Error(ErrorCode::state_damaged, "a saved state is damaged: a camera has other registers");
  }
}

}  // namespace mebots::soc::gap8_devices
