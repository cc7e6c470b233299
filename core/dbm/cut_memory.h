#pragma once

#include "core/dbm/cut_model.h"

namespace core {

/// Bytes that a model of a stock with these bounds takes before anything is cut, once every tile
/// keeps marks: lines, columns, and the boxes round both.
///
/// What cuts add: a layer where lines are divided, up to 26 bytes for each of a tile's lines; some
/// 36 bytes for a move.
double cut_memory_estimate(const Aabb& bounds, double spacing,
                           WithColumns with_columns = WithColumns::yes);

/// Bytes that a model holds now, those included that it shares with copies, but for its log.
double memory_of(const CutModel& model);

} // namespace core
