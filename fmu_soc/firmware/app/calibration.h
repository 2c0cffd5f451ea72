// SPDX-License-Identifier: Apache-2.0
// Constants of the camera and of gates.
#pragma once

// Focal length divided by half the picture's width, in thousandths: 1000 / tan(fov / 2). The field of view is 1.51844
// rad, the lens of the AI-deck with which the data of Stargate, the paper's network, were recorded.
#define CAMERA_FOCAL_OVER_HALF_WIDTH_MILLI 1054

// Outer edge of a gate's frame [mm]. The gate of the paper (examples/paper) has 60 cm.
#define GATE_OUTER_MM 600
