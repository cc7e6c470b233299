#pragma once

#include <cstddef>
#include <optional>

#include "core/dbm/cut_model.h"

namespace core {

/// A model as it was when `moves` of its moves were logged. Only the tiles that later moves may
/// have changed are cut again, from those of `raw`, the uncut model with the same mesh size.
///
/// Result:  its lines, columns and boxes contain what a model cut by these moves contains; empty if
///          more than `most` moves would be cut again.
/// Cost:    some 50 ns for each logged move, and the cuts of those tiles.
std::optional<CutModel> earlier_model(const CutModel& model, const CutModel& raw, size_t moves,
                                      size_t most);

} // namespace core
