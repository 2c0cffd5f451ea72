/* SPDX-License-Identifier: Apache-2.0 */
/* GAP8's registers that the runtime uses, but that board.h does not define. The board file defines the devices'
   addresses, but not these registers. Sources: archi/eu/eu_v3.h, archi/cluster_ctrl/cluster_ctrl_v2.h,
   archi/dma/mchan_v6.h, archi/timer/timer_v2.h, archi/fll/fll_v1.h, archi/soc_eu/soc_eu_v1.h, archi/udma/udma_v2.h,
   archi/chips/gap/ and hal/maestro/ of pulp-platform's and GreenWaves' headers. */
#pragma once

#include "board.h"

/* Event unit of the core that makes the access, in the demultiplexed range. The fabric controller and the cluster's
   cores use the same address for their own event units. */
#define EU_BASE EVENT_UNIT_DEMUX_BASE
#define EU_MASK_OFFSET 0x00
#define EU_MASK_OR_OFFSET 0x08
#define EU_MASK_IRQ_OR_OFFSET 0x14
#define EU_BUFFER_OFFSET 0x1C
#define EU_BUFFER_CLEAR_OFFSET 0x28
#define EU_WAIT_OFFSET 0x38
#define EU_WAIT_CLEAR_OFFSET 0x3C
#define EU_BARRIER_OFFSET 0x200

/* Event unit of the fabric controller and event unit of the cluster, at their addresses on the bus. */
#define EU_OF_FABRIC_CONTROLLER_BASE 0x1B200800
#define EU_OF_CLUSTER_BASE (CLUSTER_BASE + 0x800)
#define EU_SOFTWARE_EVENT_OFFSET 0x600
#define EU_SOC_EVENT_OFFSET 0x700
#define EU_LONG_BARRIER_OFFSET 0x400

#define BARRIER_BYTES 0x20
#define BARRIER_TEAM_OFFSET 0x00
#define BARRIER_TARGETS_OFFSET 0x0C
#define BARRIER_ARRIVE_OFFSET 0x14
#define BARRIER_ARRIVE_WAIT_OFFSET 0x1C

/* Events of the cluster's cores. */
#define CLUSTER_EVENT_JOB 0 /* software event of this runtime */
#define CLUSTER_EVENT_DMA 8
#define CLUSTER_EVENT_BARRIER 16

/* Events of the fabric controller. */
#define FABRIC_EVENT_JOB_DONE 0 /* software event of this runtime */
#define FABRIC_EVENT_TIMER 10
#define FABRIC_EVENT_SOC 27

/* Events of the SoC. */
#define SOC_EVENT_UART_SENT 9
#define SOC_EVENT_I2C1_SENT 13
#define SOC_EVENT_CAMERA 18
#define SOC_EVENT_CLUSTER_POWER 31
#define SOC_EVENT_CLUSTER_CLOCK 35
#define SOC_EVENTS 64
#define SOC_EVENT_MASKS_OFFSET 0x04 /* fabric controller's masks: events 32 to 63, then 0 to 31; 1 = masked */

/* Frequency-locked loops: the first belongs to the SoC, and the second to the cluster. */
#define FLL_BYTES 0x10
#define FLL_CONFIG1_OFFSET 0x4
#define REFERENCE_CLOCK_HZ 32768

/* Bits of SOC_CONTROL_CL_BYPASS. */
#define BYPASS_POWER_UNIT 0x1
#define BYPASS_CLUSTER_ON 0x8
#define BYPASS_CLOCK 0x200
#define BYPASS_CLOCK_GATE 0x400
#define BYPASS_CLUSTER_RESET 0x2000

/* Registers of the cluster's control unit and instruction cache. */
#define CLUSTER_FETCH_ENABLE_OFFSET 0x08
#define CLUSTER_BOOT_OFFSET 0x40
#define CLUSTER_CACHE_ENABLE_OFFSET 0x1400

/* DMA of the cluster: address on the bus, and address in a core's demultiplexed range. */
#define DMA_LONG_BASE (CLUSTER_BASE + 0x1800)
#define DMA_BASE 0x00204400
#define DMA_QUEUE_OFFSET 0x0
#define DMA_STATUS_OFFSET 0x4

/* Registers of the timer, whose two counters are used as one counter. */
#define TIMER_CONFIG_LO_OFFSET 0x00
#define TIMER_CONFIG_HI_OFFSET 0x04
#define TIMER_COUNT_LO_OFFSET 0x08
#define TIMER_COUNT_HI_OFFSET 0x0C
#define TIMER_COMPARE_LO_OFFSET 0x10
#define TIMER_COMPARE_HI_OFFSET 0x14

/* Channels of the uDMA. A channel runs one transfer and queues another. */
#define UDMA_HYPER_RECEIVE_OFFSET 0x180
#define UDMA_HYPER_SEND_OFFSET 0x190
#define UDMA_HYPER_OUTSIDE_OFFSET 0x1A0 /* address of the next transfer on the HyperBus */
#define UDMA_UART_SEND_OFFSET 0x210
#define UDMA_UART_STATUS_OFFSET 0x220
#define UDMA_UART_SENDS 0x1
#define UDMA_I2C1_SEND_OFFSET 0x310
#define UDMA_CAMERA_OFFSET 0x480
#define UDMA_ADDRESS_OFFSET 0x0
#define UDMA_SIZE_OFFSET 0x4
#define UDMA_CONFIG_OFFSET 0x8
#define UDMA_CONFIG_RUN 0x10    /* write: start; read: a transfer runs */
#define UDMA_CONFIG_QUEUED 0x20 /* read: another transfer is queued */
#define UDMA_CLOCK_UART 0x10
#define UDMA_CLOCK_I2C1 0x40
#define UDMA_CLOCK_CAMERA 0x200

#ifndef __ASSEMBLER__
#include <stdint.h>

static inline volatile uint32_t* register_at(uint32_t address) {
  return (volatile uint32_t*)(uintptr_t)address;
}
static inline void store(uint32_t address, uint32_t value) {
  *register_at(address) = value;
}
static inline uint32_t load(uint32_t address) {
  return *register_at(address);
}

static inline void udma_start(uint32_t channel, const volatile void* memory, uint32_t bytes) {
  store(UDMA_BASE + channel + UDMA_ADDRESS_OFFSET, (uint32_t)(uintptr_t)memory);
  store(UDMA_BASE + channel + UDMA_SIZE_OFFSET, bytes);
  store(UDMA_BASE + channel + UDMA_CONFIG_OFFSET, UDMA_CONFIG_RUN);
}
static inline int udma_runs(uint32_t channel) {
  return (load(UDMA_BASE + channel + UDMA_CONFIG_OFFSET) & UDMA_CONFIG_RUN) != 0;
}
static inline int udma_is_full(uint32_t channel) {
  return (load(UDMA_BASE + channel + UDMA_CONFIG_OFFSET) & UDMA_CONFIG_QUEUED) != 0;
}
#endif
