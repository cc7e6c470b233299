#pragma once

#include <string>
#include <vector>

#include "core/dbm/cutter.h"
#include "core/dbm/solid.h"

namespace core {

struct CutModel;

/// A stock as it was cut, in a form that can be kept: what it was at first, and every move that
/// came near it. From these its lines and its outer model can be had again at any mesh size, with
/// the bounds of the original.
struct StockRecord {
    Solid solid;
    double spacing = 0.0; // of the model it comes from, mm
    std::vector<CutterSweep> sweeps;
};

/// The block of moves that a program before this one made.
constexpr uint32_t earlier_block = 0xffffffff;

StockRecord record_of(const CutModel& stock);

/// The record as the bytes of a file: the text "feeler stock 1", then numbers, lowest byte first.
///
/// Cost: some 26 bytes for a move that goes on where the last one ended.
std::string bytes_of(const StockRecord& record);

/// The record in the bytes of a file. The moves count as those of an earlier program.
///
/// Errors: syntax for bytes that are no such file, are cut off or were changed.
Result<StockRecord> stock_record(const std::string& bytes);

/// The stock turned and moved, with everything that was cut from it.
///
/// Errors: unsupported for a cylinder that would not stand along an axis.
Result<StockRecord> moved(StockRecord record, const Transform& target_from_record);

} // namespace core
