#pragma once

#include <string>
#include <vector>

#include "core/dbm/cutter.h"
#include "core/dbm/solid.h"

namespace core {

struct CutModel;

/// A cut stock in a form that can be stored: the raw stock and every move that came near it. Its
/// lines and outer model can be recomputed at any mesh size, with the bounds of the original.
struct StockRecord {
    Solid solid;
    double spacing = 0.0; // of the original model, mm
    std::vector<CutterSweep> sweeps;
};

/// The block number of moves made by an earlier program.
constexpr uint32_t earlier_block = 0xffffffff;

/// `path_error`: how far the cutters may have been from the logged moves, besides what these count,
/// mm. The stock of the record is uncertain by as much.
StockRecord record_of(const CutModel& stock, double path_error = 0.0);

/// The record as the bytes of a file: the text "feeler stock 1", then numbers in little-endian
/// order.
///
/// Cost:    some 26 bytes for a move that continues where the last one ended.
std::string bytes_of(const StockRecord& record);

/// The record in the bytes of a file. The moves count as those of an earlier program.
///
/// Errors:  syntax if the bytes are not such a file, are truncated or were changed.
Result<StockRecord> stock_record(const std::string& bytes);

/// The stock with all its cuts, rotated and translated.
///
/// Errors:  unsupported for a cylinder that would not be parallel to an axis.
Result<StockRecord> moved(StockRecord record, const Transform& target_from_record);

} // namespace core
