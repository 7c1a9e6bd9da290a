// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// A drawn room of which views measured a part, some of it wrongly.

#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <vector>

#include "tests/support/synthetic_room.h"

namespace tsar {

// With a disc that leans in front of the back wall.
SyntheticRoom RoomWithADisc();

// What each view of the room sees, with textures and edges drawn at random. One
// superpixel in four holds no depths, and one in sixteen wrong ones.
std::vector<ViewEvidence> ObserveInPart(const SyntheticRoom& room);

}  // namespace tsar
