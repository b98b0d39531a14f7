// SPDX-License-Identifier: MIT
// Tables as text, in both directions.
#pragma once

#include "core/csv_reader.hpp"
#include "core/csv_writer.hpp"
