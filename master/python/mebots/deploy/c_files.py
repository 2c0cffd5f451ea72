# SPDX-License-Identifier: Apache-2.0
"""Returns the texts of a network's library: header, source, assembler and CMake files."""

from __future__ import annotations

import math
import re

from mebots.deploy.graph import Tensor
from mebots.deploy.layers import Network
from mebots.deploy.plan import Plan

_KERNELS = ("steps.c", "convolve.c", "convolve_blocks.c", "dense.c", "depthwise.c", "depthwise_3x3.c", "pool.c", "elementwise.c", "direct.c")
_TAG = "// SPDX-License-Identifier: Apache-2.0\n"


def kernels(plan: Plan) -> tuple[str, ...]:
    """Returns the sources of the kernels that a network needs."""
    return _KERNELS if plan.stream is None else (*_KERNELS, "l3.c")


def identifier(name: str) -> str:
    """Returns a C identifier for a tensor."""
    text = re.sub(r"[^0-9A-Za-z]+", "_", name).strip("_").lower()
    return text if re.match(r"[a-z]", text) else f"output_{text}"


def output_names(network: Network) -> list[str]:
    names: list[str] = []
    for one in network.outputs:
        base = identifier(one.name)
        name = base
        while name in names:
            name = f"{base}_{len(names)}"
        names.append(name)
    return names


def header(network: Network, plan: Plan) -> str:
    members, macros = [], []
    for name, tensor in zip(output_names(network), network.outputs, strict=True):
        scale = network.scales[tensor]
        members.append(f"  int32_t {name}[{tensor.size}];  // x NETWORK_{name.upper()}_STEP\n")
        macros.append(f"#define NETWORK_{name.upper()}_STEP {scale.step!r}\n")
    rows, columns, channels = network.input.stored()
    return (
        _TAG
        + f"""// Written by `mebots deploy`. Contract of inputs and outputs: network.json.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {{
#endif

// The picture: bytes row by row, column by column, channels together.
#define NETWORK_ROWS {rows}
#define NETWORK_COLUMNS {columns}
#define NETWORK_CHANNELS {channels}
#define NETWORK_PICTURE_BYTES {math.prod((rows, columns, channels))}
#define NETWORK_LAYERS {len(network.layers)}
// Bytes of L1 that the network uses.
#define NETWORK_L1_BYTES {l1_bytes(plan)}

// Outputs; the real value is the number times the output's step.
{"".join(macros)}
typedef struct {{
{"".join(members)}}} network_result_t;

{_load_text(plan)}
// Computes the outputs of a picture in L2 on all cores of the cluster, which must be on. Returns 0, or -1 if the cores
// are at work. On another machine it computes the same.
int network_run(const uint8_t picture[NETWORK_PICTURE_BYTES], network_result_t* result);

// Does the same on `cores` cores.
int network_run_on(unsigned cores, const uint8_t picture[NETWORK_PICTURE_BYTES], network_result_t* result);

// Computes layers `first` to `first + count - 1` alone, for tests and measurements. Returns the bytes of the output of the
// last one.
const uint8_t* network_run_layers(unsigned cores, const uint8_t picture[NETWORK_PICTURE_BYTES], int first, int count);

// Returns an output value in 127ths. `index` counts the values of all outputs in their order.
int32_t network_in_127ths(const network_result_t* result, int index);

// Returns the network's part of L1, which may be used between two inferences.
uint8_t* network_l1_buffer(void);

#ifdef __cplusplus
}}
#endif
"""
    )


def _load_text(plan: Plan) -> str:
    """Returns the declaration of network_load()."""
    if plan.stream is None:
        return """// Does nothing: the program contains the weights. Networks that do not fit into L2 need it.
static inline void network_load(uint32_t flash) {
  (void)flash;
}
"""
    return """// Copies network.weights from place `flash` of the HyperFlash to the HyperRAM. Call it once before the first inference.
void network_load(uint32_t flash);
"""


def _l3_text(plan: Plan, weight_bytes: int) -> tuple[str, str]:
    """Returns two texts of C code. The first declares the weights or, if they are in L3, defines the buffers for fetched weights and
    network_load(). The second contains initialisers of the network's struct, which refer to weights and memories."""
    if plan.stream is None:
        return "extern const uint8_t network_weights[];\n", "network_weights, network_memory, network_l1, 0, 0, {0, 0}"
    even, odd = plan.stream.buffers
    rows = ", ".join(f"{{{begin}, {size}}}" for begin, size in plan.stream.segments)
    return (
        f"""static uint8_t network_fetched[{even + odd}] NOT_CLEARED;
static const layer_segment_t segments[NETWORK_LAYERS] = {{{rows}}};

void network_load(uint32_t flash) {{
  layer_l3_load(flash, {weight_bytes}, network_fetched, sizeof(network_fetched));
}}
""",
        f"0, network_memory, network_l1, &layer_l3, segments, {{network_fetched, network_fetched + {even}}}",
    )


def l1_bytes(plan: Plan) -> int:
    """Returns the size of the network's part of L1 in bytes. At least 16 KiB, which the rows of a camera's picture need (app/deployed.c)."""
    return max(plan.l1_bytes, 16 << 10)


def _factors(network: Network) -> str:
    rows, end = [], 0
    for tensor in network.outputs:
        end += tensor.size
        rows.append(f"{{{end}, INT64_C({math.floor(127 * network.scales[tensor].step * 2**24 + 0.5)})}}")
    return ", ".join(rows)


def _copy(network: Network) -> str:
    """Returns the C functions that copy the network's outputs to the result: copy() for outputs of bytes, copy_sums() for outputs of 32-bit
    sums. Omits a function that the network does not need."""
    text = {
        1: """static void copy(int32_t* to, const uint8_t* from, int count, int zero) {
  for (int i = 0; i < count; ++i) {
    to[i] = from[i] - zero;
  }
}
""",
        4: """static void copy_sums(int32_t* to, const uint8_t* from, int count, int zero) {
  for (int i = 0; i < count; ++i) {
    to[i] = ((const int32_t*)(const void*)from)[i] - zero;
  }
}
""",
    }
    return "\n".join(text[element] for element in sorted({one.element for one in network.outputs}))


def source(network: Network, plan: Plan, rows: list[str], weight_bytes: int) -> str:
    definitions, members = _l3_text(plan, weight_bytes)
    copies = []
    for name, tensor in zip(output_names(network), network.outputs, strict=True):
        zero = network.scales[tensor].zero
        function = "copy" if tensor.element == 1 else "copy_sums"
        copies.append(f"  {function}(result->{name}, network_memory + {plan.offsets[tensor]}, {tensor.size}, {zero});\n")
    return (
        _TAG
        + f"""// Written by `mebots deploy`.
#include "network.h"

#include "kernels/l3.h"
#ifdef __riscv
#include "runtime/cluster.h"
#define NOT_CLEARED __attribute__((aligned(8), section(".noinit.network")))
#else
#define CLUSTER_L1
#define NOT_CLEARED __attribute__((aligned(8)))
#endif

static uint8_t network_memory[{plan.memory_bytes}] NOT_CLEARED;
static uint8_t network_l1[NETWORK_L1_BYTES] CLUSTER_L1 __attribute__((aligned(8)));

{definitions}
static const layer_t layers[NETWORK_LAYERS] = {{
{"".join(rows)}}};

static const layer_network_t network = {{layers, NETWORK_LAYERS, {members}}};

typedef struct {{
  const uint8_t* picture;
  int first;
  int count;
  unsigned cores;
}} job_t;

static job_t job;

static void work(void* argument) {{
  const job_t* j = argument;
#ifdef __riscv
  const layer_share_t share = {{(int32_t)cluster_core_id(), (int32_t)j->cores}};
#else
  const layer_share_t share = {{0, 1}};
#endif
  layers_run(&network, j->picture, j->first, j->count, share);
}}

static int run(unsigned cores, const uint8_t* picture, int first, int count) {{
  const job_t wanted = {{picture, first, count, cores}};
  job = wanted;
#ifdef __riscv
  if (cluster_fork(work, cores, &job) != 0) {{
    return -1;
  }}
  cluster_wait();
#else
  work(&job);
#endif
  return 0;
}}

{_copy(network)}

int network_run_on(unsigned cores, const uint8_t picture[NETWORK_PICTURE_BYTES], network_result_t* result) {{
  if (run(cores, picture, 0, NETWORK_LAYERS) != 0) {{
    return -1;
  }}
{"".join(copies)}  return 0;
}}

int network_run(const uint8_t picture[NETWORK_PICTURE_BYTES], network_result_t* result) {{
#ifdef __riscv
  return network_run_on(cluster_core_count(), picture, result);
#else
  return network_run_on(1, picture, result);
#endif
}}

const uint8_t* network_run_layers(unsigned cores, const uint8_t picture[NETWORK_PICTURE_BYTES], int first, int count) {{
  run(cores, picture, first, count);
  return network_memory + layers[first + count - 1].out;
}}

int32_t network_in_127ths(const network_result_t* result, int index) {{
  static const struct {{
    int32_t end;
    int64_t factor;  // 127 x the output's step x 2^24
  }} outputs[] = {{{_factors(network)}}};
  const int32_t* values = (const int32_t*)result;
  int i = 0;
  while (index >= outputs[i].end) {{
    ++i;
  }}
  return (int32_t)((values[index] * outputs[i].factor + (1 << 23)) >> 24);
}}

uint8_t* network_l1_buffer(void) {{
  return network_l1;
}}
"""
    )


def assembler(plan: Plan) -> str:
    text = """# SPDX-License-Identifier: Apache-2.0
# Written by `mebots deploy`: the weights as data.
    .section .rodata.network_weights, "a"
    .balign 16
    .globl network_weights
network_weights:
    .incbin "network.weights"
#if defined(__linux__)
    .section .note.GNU-stack, "", @progbits
#endif
"""
    return text if plan.stream is None else f"# In a chip's program, the weights come from the flash.\n#ifndef __riscv\n{text}#endif\n"


def cmake(plan: Plan) -> str:
    files = "\n  ".join(f"${{MEBOTS_ROOT}}/fmu_soc/firmware/kernels/{one}" for one in kernels(plan))
    return f"""# SPDX-License-Identifier: Apache-2.0
# Written by `mebots deploy`. In the CMakeLists.txt of a firmware:
#   include(FOLDER/network.cmake)
#   mebots_add_firmware(NAME SOURCES main.c ${{NETWORK_SOURCES}} OPTIONS ${{NETWORK_OPTIONS}} DATA ${{NETWORK_DATA}})
set(NETWORK_SOURCES
  {files}
  ${{CMAKE_CURRENT_LIST_DIR}}/network.c
  ${{CMAKE_CURRENT_LIST_DIR}}/network_weights.S)
set(NETWORK_OPTIONS -I${{CMAKE_CURRENT_LIST_DIR}})
set(NETWORK_DATA ${{CMAKE_CURRENT_LIST_DIR}}/network.weights)
"""
