// SPDX-License-Identifier: Apache-2.0
#include "app/gate_finder.h"

#include <stddef.h>

#include "app/work_picture.h"

// Outer edge of a frame divided by the width of its border: 60 cm / ((60 cm - 40 cm) / 2).
#define BORDERS_PER_EDGE 6

// Minimum score of a frame, in sixteenths of a grey level.
#define LEAST_SCORE_Q4 (8 * 16)
// Minimum contrast while scanning and while refining. A template that is half a scanning step away from its frame has
// half the contrast.
#define LEAST_WHILE_SCANNING_Q4 (LEAST_SCORE_Q4 / 2)
#define LEAST_WHILE_REFINING_Q4 (LEAST_SCORE_Q4 / 4)
// After a frame was found, only positions with a contrast of at least 1 / PART_OF_BEST of its score are considered.
#define PART_OF_BEST 4

// The camera is nearly level, near the height of the gate's middle. Therefore the frame's middle is at most BAND work
// pixels (9 degrees) plus half the frame's edge (0.3 m at the gate) from the picture's middle row.
#define BAND 14

// A template is tested at positions that are a twelfth of its edge apart: half the width of its border.
#define PLACES_PER_EDGE 12

// From this edge on, templates with three quarters of the width are also tested, for frames that are seen from the
// side.
#define LEAST_NARROW_EDGE 20

// Outer edges of the templates in work pixels, in steps of about a fifth. A template that is half a step too large or
// too small still covers two thirds of the frame's border. Borders of one or two pixels need steps of one pixel.
static const uint8_t kEdges[] = {7, 8, 9, 10, 11, 12, 13, 15, 18, 21, 25, 30, 36, 43, 52, 62, 74, 89, 104};
#define EDGE_COUNT ((int)(sizeof(kEdges) / sizeof(kEdges[0])))

// Outer edges of a frame in the work picture [px].
typedef struct {
  int x;
  int y;
  int width;
  int height;
} frame_t;

// Constants for one size of a frame: the widths of its borders, and 2^16 / area of a strip along a vertical and along a
// horizontal beam. The four sides of a frame are called beams.
typedef struct {
  int border_x;
  int border_y;
  uint32_t upright_q16;
  uint32_t level_q16;
} sizes_t;

// Match of a template with a frame, in sixteenths of a grey level. All values are 0 if there is no frame.
typedef struct {
  // Least contrast of a beam with the opening or with the surroundings. The lowest of the four contrasts with the
  // surroundings does not count.
  int weakest_q4;
  int sum_q4;     // sum of all positive contrasts
  int spread_q4;  // brightness of the brightest beam minus that of the darkest beam
} fit_t;

// Returns the score of a frame, which is high if all beams contrast with their surroundings and have similar
// brightness.
static inline int score_q4(const fit_t* fit) {
  return fit->weakest_q4 - fit->spread_q4 / 2;
}

// Static, because a work picture is too large for a stack.
static work_picture_t work __attribute__((section(".noinit.work")));

static inline int min_int(int a, int b) {
  return a < b ? a : b;
}
static inline int max_int(int a, int b) {
  return a > b ? a : b;
}
static inline int abs_int(int a) {
  return a < 0 ? -a : a;
}

static sizes_t sizes_of(int width, int height) {
  sizes_t sizes;
  sizes.border_x = max_int(1, (width + BORDERS_PER_EDGE / 2) / BORDERS_PER_EDGE);
  sizes.border_y = max_int(1, (height + BORDERS_PER_EDGE / 2) / BORDERS_PER_EDGE);
  sizes.upright_q16 = 65536U / (uint32_t)(sizes.border_x * (height - 2 * sizes.border_y));
  sizes.level_q16 = 65536U / (uint32_t)(sizes.border_y * (width - 2 * sizes.border_x));
  return sizes;
}

// Sums of grey levels over a beam (one side of the frame) and over the strips on both sides of it. All strips have the
// same area.
typedef struct {
  int beam;
  int before;  // sum of the beam minus sum of the strip before it
  int after;   // sum of the beam minus sum of the strip after it
} strips_t;

// Returns the sums of three adjacent vertical strips, each `step` columns wide, between the rows of `top` and `bottom`.
static inline strips_t upright_strips(const uint32_t* top, const uint32_t* bottom, ptrdiff_t step) {
  const int c0 = (int)(bottom[0] - top[0]);
  const int c1 = (int)(bottom[step] - top[step]);
  const int c2 = (int)(bottom[2 * step] - top[2 * step]);
  const int c3 = (int)(bottom[3 * step] - top[3 * step]);
  const strips_t strips = {c2 - c1, (c2 - c1) - (c1 - c0), (c2 - c1) - (c3 - c2)};
  return strips;
}

// Returns the sums of three adjacent horizontal strips, each `width` columns wide. `step` is the pitch times the height
// of a strip.
static inline strips_t level_strips(const uint32_t* left, int width, ptrdiff_t step) {
  const int c0 = (int)(left[width] - left[0]);
  const int c1 = (int)(left[step + width] - left[step]);
  const int c2 = (int)(left[2 * step + width] - left[2 * step]);
  const int c3 = (int)(left[3 * step + width] - left[3 * step]);
  const strips_t strips = {c2 - c1, (c2 - c1) - (c1 - c0), (c2 - c1) - (c3 - c2)};
  return strips;
}

// Returns a mean grey level in sixteenths. `reciprocal_q16` is 2^16 / area.
static inline int mean_q4(int sum, uint32_t reciprocal_q16) {
  return (sum * (int)reciprocal_q16) >> 12;
}

// Properties of the beams that were tested up to now.
typedef struct {
  int sign;         // 1: the beams are brighter than the opening, -1: darker
  int weakest;      // least contrast of a beam with the opening
  int outer_least;  // least contrast of a beam with the frame's surroundings
  int outer_next;   // second least contrast with the surroundings
  int sum;          // sum of all contrasts, except for those of the opposite sign
  int brightest;
  int darkest;
} beams_t;

// Adds a beam. Returns false if the beam cannot belong to a frame. Values are in sixteenths of a grey level. One beam
// may have no contrast with its surroundings, such as a white beam in front of a white sky.
static inline bool add_beam(beams_t* beams, int beam_q4, int inner_q4, int outer_q4, int least_q4) {
  const int inner = beams->sign * inner_q4;
  const int outer = beams->sign * outer_q4;
  if (inner < least_q4) {
    return false;
  }
  if (outer < beams->outer_least) {
    beams->outer_next = beams->outer_least;
    beams->outer_least = outer;
  } else {
    beams->outer_next = min_int(beams->outer_next, outer);
  }
  beams->weakest = min_int(beams->weakest, inner);
  beams->sum += inner + max_int(outer, 0);
  beams->brightest = max_int(beams->brightest, beam_q4);
  beams->darkest = min_int(beams->darkest, beam_q4);
  return beams->outer_next >= least_q4;
}

// Compares the picture with a gate of four beams at the position of `frame`. If add_beam() rejects a beam, returns
// zeros. The frame, with a margin of a beam's width, must be inside the picture.
static fit_t fit_at(const frame_t* frame, const sizes_t* sizes, int least_q4) {
  const fit_t none = {0, 0, 0};
  const ptrdiff_t pitch = work.width + 1;
  const int border_x = sizes->border_x;
  const int border_y = sizes->border_y;
  const int inner_width = frame->width - 2 * border_x;
  const int inner_height = frame->height - 2 * border_y;
  const uint32_t upright = sizes->upright_q16;
  const uint32_t level = sizes->level_q16;

  const uint32_t* top = &work.integral[(frame->y + border_y) * pitch + frame->x - border_x];
  const uint32_t* bottom = top + inner_height * pitch;
  strips_t strips = upright_strips(top, bottom, border_x);
  beams_t beams = {strips.after < 0 ? -1 : 1, INT32_MAX, INT32_MAX, INT32_MAX, 0, 0, INT32_MAX};
  if (!add_beam(&beams, mean_q4(strips.beam, upright), mean_q4(strips.after, upright), mean_q4(strips.before, upright),
                least_q4)) {
    return none;
  }
  const int to_right = frame->width - border_x;
  strips = upright_strips(top + to_right, bottom + to_right, border_x);
  if (!add_beam(&beams, mean_q4(strips.beam, upright), mean_q4(strips.before, upright), mean_q4(strips.after, upright),
                least_q4)) {
    return none;
  }
  const uint32_t* corner = &work.integral[(frame->y - border_y) * pitch + frame->x + border_x];
  strips = level_strips(corner, inner_width, border_y * pitch);
  if (!add_beam(&beams, mean_q4(strips.beam, level), mean_q4(strips.after, level), mean_q4(strips.before, level),
                least_q4)) {
    return none;
  }
  strips = level_strips(corner + (frame->height - border_y) * pitch, inner_width, border_y * pitch);
  if (!add_beam(&beams, mean_q4(strips.beam, level), mean_q4(strips.before, level), mean_q4(strips.after, level),
                least_q4)) {
    return none;
  }
  const fit_t fit = {min_int(beams.weakest, beams.outer_next), beams.sum, beams.brightest - beams.darkest};
  return fit;
}

static bool lies_inside(const frame_t* frame, const sizes_t* sizes) {
  return frame->x >= sizes->border_x && frame->y >= sizes->border_y &&
         frame->x + frame->width + sizes->border_x <= work.width &&
         frame->y + frame->height + sizes->border_y <= work.height;
}

// Computes, for each column of the work picture and for its right edge, the sum of all columns to the left between two
// rows of the integral image. The loop computes four sums at a time, so that up to three more sums are stored, but not
// used.
static void sum_columns(int32_t* columns, const uint32_t* top, const uint32_t* bottom) {
  for (const int32_t* end = columns + work.width; columns <= end; columns += 4, top += 4, bottom += 4) {
    columns[0] = (int32_t)(bottom[0] - top[0]);
    columns[1] = (int32_t)(bottom[1] - top[1]);
    columns[2] = (int32_t)(bottom[2] - top[2]);
    columns[3] = (int32_t)(bottom[3] - top[3]);
  }
}

// Positions that are scanned in one row. A position is a pointer to the first column of the left beam.
typedef struct {
  const int32_t* last;
  ptrdiff_t step;
  ptrdiff_t border;
  ptrdiff_t to_right;  // distance from the left beam to the end of the opening
  int32_t least_sum;   // minimum contrast of both vertical beams with the opening
} row_t;

// Returns the first position from `at` on at which both vertical beams are brighter or both are darker than the
// opening. If there is no such position, returns null. Not inlined, so that its loop, which tests most positions, stays
// short.
static __attribute__((noinline)) const int32_t* next_place(const int32_t* at, const row_t* row) {
  const ptrdiff_t border = row->border;
  const ptrdiff_t step = row->step;
  const int32_t least_sum = row->least_sum;
  const int32_t* const last = row->last;
  const int32_t* middle = at + border;
  const int32_t* end = middle + border;
  for (; at <= last; at += step, middle += step, end += step) {
    // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): sum_columns wrote all of the row
    const int32_t left = 2 * *middle - *at - *end;  // left beam minus opening
    if (left < least_sum && left > -least_sum) {
      continue;
    }
    const int32_t* const opposite = at + row->to_right;
    const int32_t right = opposite[0] + opposite[2 * border] - 2 * opposite[border];  // right beam minus opening
    if (left > 0 ? right >= least_sum : right <= -least_sum) {
      return at;
    }
  }
  return NULL;
}

// Finds the best position of a template of width x height pixels whose beams have a contrast of at least `least_q4`.
// Stores the position in *best and returns the match.
//
// Most positions fail at a vertical beam. Therefore vertical beams are tested first, with column sums that all
// positions of a row share: the left beam with the opening to its right, then the right beam with the opening to its
// left.
static fit_t scan(int width, int height, int least_q4, frame_t* best) {
  const sizes_t sizes = sizes_of(width, height);
  const ptrdiff_t pitch = work.width + 1;
  const int border = sizes.border_x;
  const int inner_height = height - 2 * sizes.border_y;
  const int step = max_int(1, height / PLACES_PER_EDGE);
  const int middle_y = (work.height - height) / 2;
  const int reach = BAND + height / 2;
  const int first_y = max_int(sizes.border_y, middle_y - reach);
  const int last_y = min_int(work.height - height - sizes.border_y, middle_y + reach);
  fit_t best_fit = {0, 0, 0};
  int32_t columns[WORK_MAX + 4];
  row_t row = {&columns[work.width - width - border], step, border, width - 2 * border,
               least_q4 * border * inner_height / 16};
  for (int y = first_y; y <= last_y; y += step) {
    const uint32_t* top = &work.integral[(y + sizes.border_y) * pitch];
    sum_columns(columns, top, top + inner_height * pitch);
    for (const int32_t* at = next_place(&columns[border], &row); at != NULL; at = next_place(at + step, &row)) {
      const frame_t frame = {(int)(at - columns), y, width, height};
      const fit_t fit = fit_at(&frame, &sizes, least_q4);
      if (fit.weakest_q4 > best_fit.weakest_q4) {
        best_fit = fit;
        *best = frame;
        least_q4 = fit.weakest_q4;
        row.least_sum = least_q4 * border * inner_height / 16;
      }
    }
  }
  return best_fit;
}

// Moves and stretches the template by one pixel at a time while the sum of its contrasts increases. Returns the match.
static fit_t refine(frame_t* frame, fit_t fit) {
  static const int8_t kMoves[][4] = {{1, 0, 0, 0}, {-1, 0, 0, 0}, {0, 1, 0, 0},  {0, -1, 0, 0},
                                     {0, 0, 1, 0}, {0, 0, -1, 0}, {-1, 0, 1, 0}, {1, 0, -1, 0},
                                     {0, 0, 0, 1}, {0, 0, 0, -1}, {0, -1, 0, 1}, {0, 1, 0, -1}};
  for (int round = 0; round < 24; ++round) {
    frame_t best = *frame;
    fit_t best_fit = fit;
    for (unsigned i = 0; i < sizeof(kMoves) / sizeof(kMoves[0]); ++i) {
      const frame_t moved = {frame->x + kMoves[i][0], frame->y + kMoves[i][1], frame->width + kMoves[i][2],
                             frame->height + kMoves[i][3]};
      if (moved.width < 6 || moved.height < 6 || 2 * moved.width < moved.height || 4 * moved.width > 5 * moved.height) {
        continue;
      }
      const sizes_t sizes = sizes_of(moved.width, moved.height);
      if (!lies_inside(&moved, &sizes)) {
        continue;
      }
      const fit_t moved_fit = fit_at(&moved, &sizes, LEAST_WHILE_REFINING_Q4);
      if (moved_fit.sum_q4 > best_fit.sum_q4) {
        best_fit = moved_fit;
        best = moved;
      }
    }
    if (best_fit.sum_q4 == fit.sum_q4) {
      break;
    }
    *frame = best;
    fit = best_fit;
  }
  return fit;
}

bool find_gate(const uint8_t* frame, int width, int height, gate_view_t* view) {
  if (!work_picture_make(&work, frame, width, height)) {
    return false;
  }
  frame_t best = {0, 0, 0, 0};
  fit_t best_fit = {0, 0, 0};
  for (int i = EDGE_COUNT - 1; i >= 0; --i) {
    for (int narrow = 0; narrow < (kEdges[i] >= LEAST_NARROW_EDGE ? 2 : 1); ++narrow) {
      frame_t place = {0, 0, 0, 0};
      const int least_q4 = max_int(LEAST_WHILE_SCANNING_Q4, score_q4(&best_fit) / PART_OF_BEST);
      fit_t fit = scan(narrow ? (3 * kEdges[i] + 2) / 4 : kEdges[i], kEdges[i], least_q4, &place);
      if (fit.weakest_q4 == 0) {
        continue;
      }
      fit = refine(&place, fit);
      if (score_q4(&fit) > score_q4(&best_fit)) {
        best_fit = fit;
        best = place;
      }
    }
  }
  if (score_q4(&best_fit) < LEAST_SCORE_Q4) {
    return false;
  }
  const int scale_q4 = work.reduction * 16;
  view->center_x_q4 = (2 * best.x + best.width) * scale_q4 / 2;
  view->center_y_q4 = (2 * best.y + best.height) * scale_q4 / 2;
  view->width_q4 = best.width * scale_q4;
  view->height_q4 = best.height * scale_q4;
  view->contrast = (uint8_t)min_int(255, score_q4(&best_fit) / 16);
  return true;
}
