#pragma once

#include <vector>

#include "core/dbm/stock_pieces.h"
#include "core/sim/finding.h"
#include "core/sim/setup.h"

namespace core {

/// What is known about the pieces of a stock while it is cut. A plain value.
struct PieceWatch {
    PieceMap map;
    size_t known = 1; // pieces, without crumbs
};

/// The watch over a stock at the start of a run.
PieceWatch watch_of(const CutModel& stock);

/// Looks, with these of the fixtures in place, whether the cuts from `first` on, by their numbers
/// in the log, have parted the stock.
///
/// Result: a finding `loose-piece` for each new piece but the largest, without its block: how large
///         it is, where, and whether a fixture touches it, to within a mesh size.
/// Cost:   some microseconds for cuts above solid matter, else that of PieceMap::pieces().
std::vector<Finding> watch_pieces(const Setup& setup, const std::vector<bool>& fixtures_there,
                                  const CutModel& stock, size_t first, PieceWatch& watch);

} // namespace core
