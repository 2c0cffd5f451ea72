// SPDX-License-Identifier: Apache-2.0
// Constants of the camera and of gates.
#pragma once

// Focal length over half the picture's width, in thousandths: 1 / tan(fov / 2) for the 1.51844 rad of the AI-deck's
// lens with which Stargate's data were recorded.
#define CAMERA_FOCAL_OVER_HALF_WIDTH_MILLI 1054

// Outer edge of a gate's frame [mm]. The paper's gate has 60 cm.
#define GATE_OUTER_MM 600
