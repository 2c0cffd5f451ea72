// SPDX-License-Identifier: Apache-2.0
// Runs the layers of a network in steps. While the cores compute a step, the DMA fetches the input of the next step and
// stores the output of the previous step.
#include "kernels/machine.h"
#include "kernels/work.h"

_Static_assert(2 * sizeof(layer_t) <= LAYER_L1_RESERVED, "the descriptions of two layers do not fit into their place");

// Maximum number of running copies: half of the 16 copies of GAP8's DMA.
#define COPIES 8

typedef struct {
  uint32_t under_way[COPIES];
  uint32_t begun, ended;
} copies_t;

static void wait_for_one(copies_t* copies) {
  machine_wait(copies->under_way[copies->ended++ % COPIES]);
}

static void wait_for_all(copies_t* copies) {
  while (copies->ended != copies->begun) {
    wait_for_one(copies);
  }
}

static void note(copies_t* copies, uint32_t copy) {
  copies->under_way[copies->begun++ % COPIES] = copy;
}

static void make_place(copies_t* copies) {
  if (copies->begun - copies->ended == COPIES) {
    wait_for_one(copies);
  }
}

// Position of a step in its layer, and the indices of its buffers.
typedef struct {
  int32_t block, tile;
  int in, data, out;
  int needs_in, needs_data;
} cursor_t;

// Sets the cursor to the first step. Assigns the members one by one, because the compiler would copy an initialiser
// from L2.
static void begin(cursor_t* at, int needs_data) {
  at->block = at->tile = 0;
  at->in = at->data = at->out = 0;
  at->needs_in = 1;
  at->needs_data = needs_data;
}

static cursor_t next_of(const layer_t* layer, const cursor_t* now) {
  cursor_t next = *now;
  if (layer->by_tile) {
    if (++next.block == layer->block_count) {
      next.block = 0;
      ++next.tile;
    }
  } else if (++next.tile == layer->tiles) {
    next.tile = 0;
    ++next.block;
  }
  next.needs_in = next.tile != now->tile || (layer->sliced && next.block != now->block);
  next.needs_data = next.block != now->block;
  next.in ^= next.needs_in;
  next.data ^= next.needs_data;
  next.out ^= 1;
  return next;
}

static int32_t rows_of(const layer_t* layer, int32_t tile) {
  return smaller(layer->tile_rows, layer->out_rows - tile * layer->tile_rows);
}

static const layer_block_t* block_of(const layer_network_t* n, const layer_t* layer, int32_t block) {
  return (const layer_block_t*)(const void*)(n->weights + layer->blocks) + block;
}

static int32_t in_channels_of(const layer_t* layer, const layer_block_t* block) {
  return layer->sliced ? block->channels : layer->in_channels;
}

static void fill(uint8_t* at, int32_t bytes, uint8_t value) {
#ifdef __riscv
  const uint32_t word = value * UINT32_C(0x01010101);
  for (; bytes > 3; bytes -= 4) {
    xpulp_sw_post(at, 4, word);
  }
#endif
  for (; bytes > 0; --bytes) {
    *at++ = value;
  }
}

// Starts to fetch rows, which are contiguous in L1. In L2, channels that the block does not need may be between them.
static void copy_in(copies_t* copies, uint8_t* to, const uint8_t* from, int32_t bytes, int32_t channels,
                    int32_t all_channels) {
  make_place(copies);
  if (channels == all_channels) {
    note(copies, machine_copy_in(to, from, (uint32_t)bytes));
  } else {
    note(copies, machine_copy_in_rows(to, from, (uint32_t)bytes, (uint32_t)channels, (uint32_t)all_channels));
  }
}

// Fetches the input rows of a tile. If the layer has `outer_rows`, rows outside the input get the value `outside`.
static void fetch_rows(copies_t* copies, const layer_t* layer, const layer_block_t* block, const uint8_t* from,
                       uint8_t* to, int32_t tile) {
  const int32_t channels = in_channels_of(layer, block);
  const int32_t pitch = (layer->pad_left + layer->in_columns + layer->pad_right) * channels;
  const int32_t step = layer->stride_rows * layer->pool;
  const int32_t first = tile * layer->tile_rows * step - layer->pad_top;
  const int32_t rows = (rows_of(layer, tile) * layer->pool - 1) * layer->stride_rows + layer->kernel_rows;
  const int32_t begin = first < 0 ? 0 : first;
  const int32_t end = smaller(first + rows, layer->in_rows);
  const int32_t row = layer->in_columns * channels;
  const int32_t stride = layer->in_columns * layer->in_channels;
  if (layer->sliced) {
    from += block->first;
  }
  if (layer->outer_rows) {
    fill(to, smaller(begin - first, rows) * pitch, layer->outside);
    const int32_t inside = end > first ? end - first : 0;
    fill(to + inside * pitch, (rows - inside) * pitch, layer->outside);
  }
  if (end <= begin) {
    return;
  }
  from += begin * stride;
  to += (begin - first) * pitch + layer->pad_left * channels;
  if (row == pitch) {
    copy_in(copies, to, from, (end - begin) * row, channels, layer->in_channels);
    return;
  }
  for (int32_t y = begin; y < end; ++y, from += stride, to += pitch) {
    copy_in(copies, to, from, row, channels, layer->in_channels);
  }
}

typedef struct {
  const uint8_t* in;
  const uint8_t* other;
  uint8_t* out;
} tensors_t;

static void load_data(const layer_network_t* n, const layer_t* layer, copies_t* copies, const cursor_t* at) {
  const layer_block_t* block = block_of(n, layer, at->block);
  if (block->bytes > 0) {
    make_place(copies);
    note(copies, machine_copy_in(n->l1 + layer->l1_data[at->data], n->weights + block->data, block->bytes));
  }
}

static void load_step(const layer_network_t* n, const layer_t* layer, const tensors_t* t, copies_t* copies,
                      const cursor_t* at) {
  const layer_block_t* block = block_of(n, layer, at->block);
  if (at->needs_data) {
    load_data(n, layer, copies, at);
  }
  if (at->needs_in) {
    fetch_rows(copies, layer, block, t->in, n->l1 + layer->l1_in[at->in], at->tile);
    if (t->other != 0) {
      fetch_rows(copies, layer, block, t->other, n->l1 + layer->l1_other[at->in], at->tile);
    }
  }
}

static void store_step(const layer_network_t* n, const layer_t* layer, const tensors_t* t, copies_t* copies,
                       const cursor_t* at) {
  const layer_block_t* block = block_of(n, layer, at->block);
  const uint32_t places = (uint32_t)(rows_of(layer, at->tile) * layer->out_columns);
  const uint32_t channels = (uint32_t)(block->channels * layer->element);
  const uint32_t all = (uint32_t)(layer->out_channels * layer->element);
  uint8_t* to =
      t->out + (uint32_t)(at->tile * layer->tile_rows * layer->out_columns) * all + block->first * layer->element;
  const uint8_t* from = n->l1 + layer->l1_out[at->out];
  make_place(copies);
  if (channels == all) {
    note(copies, machine_copy_out(to, from, places * all));
  } else {
    note(copies, machine_copy_out_rows(to, from, places * channels, channels, all));
  }
}

static void compute(const layer_network_t* n, const layer_t* layer, const cursor_t* at, layer_share_t share) {
  const layer_block_t* block = block_of(n, layer, at->block);
  layer_step_t step;
  step.layer = layer;
  step.in = n->l1 + layer->l1_in[at->in];
  step.other = n->l1 + layer->l1_other[at->in];
  step.data = n->l1 + layer->l1_data[at->data];
  step.out = n->l1 + layer->l1_out[at->out];
  step.unpooled = n->l1 + layer->l1_unpooled;
  step.gathered = n->l1 + layer->l1_gathered + share.core * layer->gathered_stride;
  step.rows = rows_of(layer, at->tile);
  step.channels = block->channels;
  step.groups = block->groups;
  step.in_channels = in_channels_of(layer, block);
  step.in_pitch = (layer->pad_left + layer->in_columns + layer->pad_right) * step.in_channels;
  step.first_row = at->tile * layer->tile_rows;
  layer->kernel(&step, share);
  if (layer->then != 0) {
    machine_barrier();
    layer->then(&step, share);
  }
}

// Fills the columns to the left and right of the input in both buffers, once: copies never change them.
static void fill_sides(const layer_network_t* n, const layer_t* layer, layer_share_t share) {
  const layer_block_t* block = block_of(n, layer, 0);
  const int32_t channels = in_channels_of(layer, block);
  const int32_t left = layer->pad_left * channels;
  const int32_t right = layer->pad_right * channels;
  const int32_t inside = layer->in_columns * channels;
  const int32_t rows = (layer->tile_rows * layer->pool - 1) * layer->stride_rows + layer->kernel_rows;
  for (int32_t y = share.core; y < rows; y += share.cores) {
    for (int buffer = 0; buffer < 2; ++buffer) {
      uint8_t* row = n->l1 + layer->l1_in[buffer] + y * (left + inside + right);
      fill(row, left, layer->outside);
      fill(row + left + inside, right, layer->outside);
    }
  }
}

// True if the data of a layer's first block are fetched during the previous layer. If weights are in L3, returns false,
// because those of the next layer may not be in L2 yet.
static int is_early(const layer_network_t* n, const layer_t* layer) {
  return layer->early && n->l3 == 0;
}

// Returns the place in L1 for a copy of a layer's description, which the cores read in one cycle. There are two places,
// so that the next layer's description can be fetched.
static layer_t* layer_in_l1(const layer_network_t* n, int32_t number) {
  return (layer_t*)(void*)n->l1 + number % 2;
}

// Begins to copy the description of layer `number` to L1. If `number` is -1, there is no next layer, and the function
// has no effect.
static void load_layer(const layer_network_t* n, int32_t number, copies_t* copies) {
  if (number < 0) {
    return;
  }
  make_place(copies);
  note(copies, machine_copy_in(layer_in_l1(n, number), &n->layers[number], sizeof(layer_t)));
}

// If is_early() is true for layer `number`, begins to fetch the data of its first block. Its description must be in L1.
// If `number` is -1, there is no next layer, and the function has no effect.
static void load_ahead(const layer_network_t* n, int32_t number, copies_t* copies) {
  const layer_t* next = layer_in_l1(n, number);
  if (number >= 0 && is_early(n, next)) {
    cursor_t first;
    begin(&first, 1);
    load_data(n, next, copies, &first);
  }
}

static void run_tiles(const layer_network_t* n, const layer_t* layer, int32_t next_number, const tensors_t* t,
                      copies_t* copies, int has_data, layer_share_t share) {
  cursor_t now;
  begin(&now, !has_data);
  cursor_t last = now;
  if (layer->pad_left + layer->pad_right > 0) {
    fill_sides(n, layer, share);
  }
  if (share.core == 0) {
    load_step(n, layer, t, copies, &now);
    load_layer(n, next_number, copies);
  }
  const int32_t steps = layer->block_count * layer->tiles;
  for (int32_t i = 0; i < steps; ++i) {
    const cursor_t next = next_of(layer, &now);
    if (share.core == 0) {
      wait_for_all(copies);
    }
    // The data of the step have arrived, and all cores have finished the previous step.
    machine_barrier();
    if (share.core == 0) {
      if (i > 0) {
        store_step(n, layer, t, copies, &last);
      }
      if (i + 1 < steps) {
        load_step(n, layer, t, copies, &next);
      } else {
        load_ahead(n, next_number, copies);
      }
      if (n->l3 != 0) {
        n->l3->advance();
      }
    }
    compute(n, layer, &now, share);
    last = now;
    now = next;
  }
  machine_barrier();
  if (share.core == 0) {
    store_step(n, layer, t, copies, &last);
  }
}

static const uint8_t* input_of(const layer_network_t* n, const uint8_t* picture, uint32_t at) {
  return at == LAYER_PICTURE ? picture : n->memory + at;
}

static void fetch_weights(const layer_network_t* n, int32_t number) {
  n->l3->fetch(n->fetched[number % 2], n->segments[number].from, n->segments[number].bytes);
}

// Waits for the weights of a layer, and starts to fetch those of the next layer. The buffer for the next layer belonged
// to the previous layer, which all cores have finished.
static void change_weights(layer_network_t* n, int32_t number, int32_t end, layer_share_t share) {
  if (share.core == 0) {
    n->l3->wait();
    if (number + 1 < end) {
      fetch_weights(n, number + 1);
    }
  }
  // A layer's offsets are relative to the start of all weights.
  n->weights = (const uint8_t*)((uintptr_t)n->fetched[number % 2] - n->segments[number].from);
}

static tensors_t tensors_of(const layer_network_t* n, const layer_t* layer, const uint8_t* picture) {
  const tensors_t t = {input_of(n, picture, layer->in), layer->operands > 1 ? input_of(n, picture, layer->other) : 0,
                       n->memory + layer->out};
  return t;
}

// Runs a layer without tiles.
static void run_direct(const layer_network_t* n, const layer_t* layer, const tensors_t* t, const uint8_t* picture,
                       layer_share_t share) {
  const layer_block_t* block = block_of(n, layer, 0);
  if (layer->kind == LAYER_SOFTMAX) {
    layer_softmax(layer, (const uint32_t*)(const void*)(n->weights + block->data), t->in, t->out, share);
    return;
  }
  for (int32_t j = 0; j < layer->block_count; ++j) {
    const layer_move_t* move = (const layer_move_t*)(const void*)(n->weights + block[j].data);
    layer_move(move, input_of(n, picture, move->source), t->out, share);
  }
}

void layers_run(const layer_network_t* network, const uint8_t* picture, int32_t first, int32_t count,
                layer_share_t share) {
  layer_network_t own = *network;
  layer_network_t* n = &own;
  const int32_t end = first + count;
  copies_t copies;
  copies.begun = 0;
  copies.ended = 0;
  if (share.core == 0 && count > 0) {
    load_layer(n, first, &copies);
    if (n->l3 != 0) {
      fetch_weights(n, first);
    }
    wait_for_all(&copies);
  }
  machine_barrier();
  for (int32_t i = first; i < end; ++i) {
    if (n->l3 != 0) {
      change_weights(n, i, end, share);
      machine_barrier();
    }
    const layer_t* layer = layer_in_l1(n, i);
    const int32_t next = i + 1 < end ? i + 1 : -1;
    const tensors_t t = tensors_of(n, layer, picture);
    if (layer->kind == LAYER_TILED) {
      run_tiles(n, layer, next, &t, &copies, i > first && is_early(n, layer), share);
    } else {
      if (share.core == 0) {
        load_layer(n, next, &copies);
        wait_for_all(&copies);
        load_ahead(n, next, &copies);
      }
      run_direct(n, layer, &t, picture, share);
    }
    // Waits until all copies have ended, such as those of the output and of the next layer's description, and until all
    // cores have finished the layer.
    if (share.core == 0) {
      wait_for_all(&copies);
    }
    machine_barrier();
  }
}
