// SPDX-License-Identifier: MIT
// The two tables that enter and leave rapidptv: points and tracks.
#pragma once

#include "core/points_table.hpp"
#include "core/tracks_table.hpp"
