// SPDX-License-Identifier: Apache-2.0
// Layers of a network that `mebots deploy` has written, and their arithmetic.
//
// A tensor consists of unsigned bytes, row by row, column by column, with all channels of a position together. Its real
// values are (byte - zero point) x scale. Sums have 32 bits. A sum becomes a byte by
//
//   clip((sum x multiplier + addend) >> shift, low, high)
//
// The addend contains the output's zero point and half of 1 << shift. `scaling` selects the width of the product.
// master/python/mebots/deploy/layers.py has the same arithmetic in NumPy.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
  SCALING_NARROW,  // all values fit in 32 bits
  SCALING_WIDE,    // 64 bits; the addend's lower word is 0; stored are addend >> 32 and shift - 32
  SCALING_EXACT,   // as SCALING_WIDE, but the lower word of the addend follows the group
  SCALING_NONE     // the output consists of the sums, four bytes each
};

enum {
  LAYER_TILED,   // computed by a kernel in steps that fit in L1
  LAYER_MOVE,    // copies bytes, with any strides
  LAYER_SOFTMAX  // over the channels of each position
};

// Offset that selects the input picture instead of an address in the network's memory.
#define LAYER_PICTURE UINT32_C(0xffffffff)

#define LAYER_MOVE_DIMENSIONS 6

typedef struct {
  int32_t core;
  int32_t cores;
} layer_share_t;

// A step of a layer, which a kernel computes (work.h). A program contains only the kernels of its network.
typedef struct layer_step layer_step_t;
typedef void layer_kernel_t(const layer_step_t* step, layer_share_t share);

#define LAYER_SCALED_(name) layer_kernel_t name##_narrow, name##_wide, name##_exact
LAYER_SCALED_(layer_convolve);
LAYER_SCALED_(layer_convolve_blocks);         // convolutions without groups
LAYER_SCALED_(layer_convolve_blocks_pooled);  // followed by the maximum of 2 x 2 positions
LAYER_SCALED_(layer_depthwise);               // a separate kernel for each channel
LAYER_SCALED_(layer_depthwise_3x3);
LAYER_SCALED_(layer_dense);  // one output position
#undef LAYER_SCALED_
layer_kernel_t layer_convolve_none, layer_convolve_blocks_none, layer_dense_none;
layer_kernel_t layer_max_pool;
layer_kernel_t layer_average_pool;
layer_kernel_t layer_add;       // clip((a x factors[0] + b x factors[1] + addend) >> shift)
layer_kernel_t layer_multiply;  // (a - zeros[0]) x (b - zeros[1]), requantised
layer_kernel_t layer_table;     // table[a]

// A block of output channels with its weights.
typedef struct {
  uint32_t data;   // offset in the weights
  uint32_t bytes;  // size of the data; 0 = no data
  int32_t first;
  int32_t channels;
  int32_t groups;  // groups of channels in a convolution
} layer_block_t;

// A layer is computed in steps: a step is a block of channels of a tile of rows. Buffers in L1 are given by offsets.
// Each buffer exists twice, because the DMA fills one while the cores work on the other.
typedef struct {
  layer_kernel_t* kernel;
  layer_kernel_t* then;  // kernel that pools the convolution's output in l1_unpooled; null = no pool
  uint8_t kind;
  uint8_t operands;  // 1 or 2 inputs
  uint8_t low;
  uint8_t high;
  uint8_t outside;  // value of positions outside the input
  uint8_t scaling;
  uint8_t element;     // bytes of an output value: 1, or 4 for sums
  uint8_t by_tile;     // 1: all blocks of a tile, then the next tile; 0: all tiles of a block first
  uint8_t sliced;      // 1: a block only needs the input of its own channels
  uint8_t pool;        // a convolution's output is pooled: maximum of pool x pool
  uint8_t outer_rows;  // 1: the input in L1 has rows outside the input. 0: the kernel provides their values
  uint8_t early;       // 1: the first block's data are fetched while the cores compute the previous layer
  int32_t in_rows, in_columns, in_channels;
  int32_t out_rows, out_columns, out_channels;  // after pooling
  int32_t kernel_rows, kernel_columns;          // including dilation
  int32_t stride_rows, stride_columns;
  int32_t pad_top, pad_left, pad_right;  // pad_left and pad_right: columns in L1
  int32_t outside_left, outside_right;   // columns that the kernel provides
  int32_t tile_rows, tiles;              // tiles of the output
  int32_t block_count;
  uint32_t in, other, out;  // offsets in the network's memory
  uint32_t blocks;          // offset of layer_block_t in the weights
  uint32_t l1_in[2], l1_other[2], l1_data[2], l1_out[2], l1_unpooled;
  // Convolution: a run is a range of contiguous bytes in a patch. `run_words` is its length in words. If the last word
  // exceeds the run, the weights of the extra bytes are zero. Steps are bytes from the end of a run to the start of the
  // next run. Depthwise: runs are positions of the kernel, and `run_words` is the number of positions divided by four.
  // Steps are in rows and columns of the input.
  int32_t runs_y, runs_x, run_words;
  int32_t step_x, step_y;
  int32_t group_bytes;
  // Convolution in blocks: if gather_runs > 0, a core first copies the patches of four output positions to its part of
  // l1_gathered. A patch has gather_rows rows of gather_runs runs of gather_bytes bytes. gather_step is the distance
  // between runs, gather_row_step between rows [bytes].
  int32_t gather_rows, gather_runs, gather_bytes;
  int32_t gather_step, gather_row_step;
  int32_t gathered_bytes;   // of a patch, rounded up to whole words
  int32_t gathered_stride;  // bytes of a core's part of l1_gathered; a copy may write past the end of its patch
  uint32_t l1_gathered;
  int32_t strip;  // depthwise, 3 x 3: passes of a unit of work. A pass computes one or two output rows
  // For the kinds that add and multiply:
  int32_t factors[2];
  int32_t zeros[2];
  int32_t addend;
  int32_t shift;
  // Mean pool: zeros[0] is 1 if the mean excludes positions outside the input. LAYER_MOVE: the data of each block are a
  // layer_move_t. Softmax and tables: the data are the table.
} layer_t;

// Four output channels of a convolution. After this struct follow the lower words of the addends (SCALING_EXACT only),
// and the weights: runs_y x runs_x x run_words words for each channel. For blocks, the words of the channels are
// interleaved.
typedef struct {
  uint16_t in;   // offset of the input channels in a position
  uint16_t out;  // offset of the first channel in a position of the block's output
  uint8_t shift[4];
  int32_t count;
  int32_t bias[4];
  int32_t multiplier[4];
  int32_t addend[4];
} layer_group_t;

// Entry of the table of a mean pool. If the mean excludes positions outside the input, entry n - 1 belongs to windows
// with n positions inside the input. Otherwise, the table has one entry.
typedef struct {
  int32_t multiplier;
  int32_t addend;
  int32_t shift;
} layer_mean_t;

typedef struct {
  uint32_t source;  // offset of the input in the network's memory
  int32_t fill;     // byte with which the whole output is filled first; -1 = no fill
  int32_t fill_bytes;
  int32_t table;  // 1: a table of 256 bytes follows, which maps each byte
  int32_t in;     // offset of the first byte in the input
  int32_t out;
  int32_t count[LAYER_MOVE_DIMENSIONS];
  int32_t in_step[LAYER_MOVE_DIMENSIONS];
  int32_t out_step[LAYER_MOVE_DIMENSIONS];
} layer_move_t;

// Address and size of a layer's weights in L3.
typedef struct {
  uint32_t from;
  uint32_t bytes;
} layer_segment_t;

// Functions that read weights from L3, one fetch at a time. Only core 0 calls them.
typedef struct {
  void (*fetch)(uint8_t* to, uint32_t from, uint32_t bytes);
  void (*advance)(void);  // continues a fetch of several transfers
  void (*wait)(void);     // returns after the end of the fetch
} layer_l3_t;

typedef struct {
  const layer_t* layers;
  int32_t layer_count;
  const uint8_t* weights;  // weights in L2; null = weights in L3
  uint8_t* memory;
  uint8_t* l1;
  const layer_l3_t* l3;             // null if the weights are in L2
  const layer_segment_t* segments;  // one for each layer
  uint8_t* fetched[2];              // buffers in L2: weights of layers with even and odd numbers
} layer_network_t;

// Computes `count` layers from `first` on. Every core of the cluster must call this function with its own number. On
// other machines, one call is sufficient. The first LAYER_L1_RESERVED bytes of network->l1 contain copies of the
// layer_t of the present and of the next layer.
void layers_run(const layer_network_t* network, const uint8_t* picture, int32_t first, int32_t count,
                layer_share_t share);

#define LAYER_L1_RESERVED 640

#ifdef __cplusplus
}
#endif
