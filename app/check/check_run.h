#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/check/input_file.h"
#include "app/check/stock_file.h"
#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/sim/block_result.h"
#include "core/sim/finding.h"
#include "core/sim/setup.h"
#include "core/sim/verdict.h"

namespace core {
struct CutModel;
struct PartComparison;
struct StockMesh;
} // namespace core
namespace gcode {
enum class DialectId : uint8_t;
}

namespace app {

enum class Engine : uint8_t;

/// One block as executed, and what it did.
struct CheckedBlock {
    core::BlockIndex block{};
    uint32_t line = 0;
    std::string text;
    std::string file;            // of a subprogram's file; empty for the main program
    std::vector<uint32_t> calls; // lines that called it, the outermost first
    core::BlockResult result;
};

/// Seconds of wall time that the parts of a check took.
struct CheckTimes {
    double read = 0.0;  // program and set-up
    double model = 0.0; // scan lines of the stock
    double check = 0.0; // interpreting, cutting, measuring
};

/// A program that was run against a set-up, to its end or to its first error.
struct CheckRun {
    std::string program_file;
    std::string sha256;
    std::vector<InputFile> inputs; // all that was read, and looked for in vain
    gcode::DialectId dialect{};
    Engine engine{}; // exact
    core::Setup setup;
    std::vector<std::string> assumptions;
    std::vector<CheckedBlock> blocks;
    std::vector<core::Finding> findings; // in the order of the blocks
    std::vector<core::Finding> taken_in; // those that another finding tells of
    core::Verdict verdict = core::Verdict::clear;
    std::optional<core::Error> stopped; // why the program could not be run to its end
    core::Statistics statistics;
    size_t points = 0;       // of the stock's model at the end
    size_t lines = 0;        // scan lines
    double cycle_time = 0.0; // of the program, seconds
    double removed = 0.0;    // mm3
    CheckTimes times;
    double memory = 0.0; // bytes that the model of the stock was expected to take
    std::shared_ptr<const core::CutModel> stock;    // what is left of it
    std::shared_ptr<const core::StockMesh> surface; // of it, if it was asked for
    std::optional<SavedStock> saved_stock;
    std::shared_ptr<const core::PartComparison> comparison; // if the set-up has a part

    bool has_errors() const;
};

/// What is known to be kept in a block by all pairs, where none decides; 0 if nothing is known.
double least_clearance(const core::Setup& setup, const core::BlockResult& result);

/// The block whose deciding pair has the least margin; null if no pair decides any block.
const CheckedBlock* nearest_block(const CheckRun& run);

} // namespace app
