// SPDX-License-Identifier: Apache-2.0
// Constants of the camera and of the gates.
#pragma once

// Focal length divided by half the picture's width, in thousandths: 1000 / tan(fov / 2). The field of view is 1.51844
// rad, as with the AI-deck's lens that recorded the pictures for Stargate, the paper's network.
#define CAMERA_FOCAL_OVER_HALF_WIDTH_MILLI 1054

// Outer edge of a gate's frame [mm]. The paper (examples/paper) uses gates of 60 cm.
#define GATE_OUTER_MM 600
