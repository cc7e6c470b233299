#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/check/input_file.h"
#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/sim/block_result.h"
#include "core/sim/finding.h"
#include "core/sim/setup.h"
#include "core/sim/verdict.h"

namespace core {
struct BlockTime;
struct CutModel;
struct PartComparison;
struct StockMesh;
} // namespace core
namespace gcode {
enum class DialectId : uint8_t;
}

namespace app {

struct ShownClearance;
enum class ClearanceStyle : uint8_t;

enum class Engine : uint8_t;
struct Coverage;
struct SavedStock;
struct Tolerances;

/// One block as executed, with its result.
struct CheckedBlock {
    core::BlockIndex block{};
    uint32_t line = 0;
    std::string text;
    std::string file;            // file of a subprogram; empty for the main program
    std::vector<uint32_t> calls; // lines of the calls, the outermost first
    core::BlockResult result;
};

/// The blocks of a check in the order in which they are executed, packed: a block with a measured
/// pair takes about 130 bytes, a quarter of a CheckedBlock. Nothing is rounded.
///
/// Blocks are returned by value. An iterator unpacks into a block of its own: a reference from it
/// is valid until it is incremented.
///
/// Cost:    O(1) for each block read, appended or replaced; growing does not move what is there.
class CheckedBlocks {
public:
    class Iterator {
    public:
        using iterator_category = std::input_iterator_tag;
        using value_type = CheckedBlock;
        using difference_type = std::ptrdiff_t;
        using pointer = const CheckedBlock*;
        using reference = const CheckedBlock&;

        Iterator(const CheckedBlocks& all, size_t at, bool with_texts)
            : all_(&all), at_(at), with_texts_(with_texts) {
            unpack();
        }
        const CheckedBlock& operator*() const { return here_; }
        const CheckedBlock* operator->() const { return &here_; }
        Iterator& operator++() {
            ++at_;
            unpack();
            return *this;
        }
        bool operator==(const Iterator& other) const { return at_ == other.at_; }

    private:
        void unpack() {
            if (at_ < all_->size()) all_->unpack(at_, here_, with_texts_);
        }

        const CheckedBlocks* all_;
        size_t at_;
        bool with_texts_;
        CheckedBlock here_;
    };
    /// All blocks, but with empty texts: half the work.
    struct WithoutTexts {
        const CheckedBlocks& all;
        Iterator begin() const { return {all, 0, false}; }
        Iterator end() const { return {all, all.size(), false}; }
    };

    size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    CheckedBlock operator[](size_t i) const;
    /// The line of a block, without unpacking the rest.
    uint32_t line(size_t i) const;
    CheckedBlock front() const { return (*this)[0]; }
    CheckedBlock back() const { return (*this)[size_ - 1]; }
    Iterator begin() const { return {*this, 0, true}; }
    Iterator end() const { return {*this, size_, true}; }
    WithoutTexts without_texts() const { return {*this}; }

    void push_back(const CheckedBlock& block);
    void replace(size_t i, const CheckedBlock& block);
    /// Replaces a block by what `act` makes of it.
    template <typename Act>
    void change(size_t i, const Act& act) {
        CheckedBlock block = (*this)[i];
        act(block);
        replace(i, block);
    }
    /// Likewise every block, from the first to the last.
    template <typename Act>
    void change_all(const Act& act) {
        for (size_t i = 0; i < size_; ++i) change(i, act);
    }
    /// core::settle_time for the result of a block.
    void settle_time(size_t i, const core::BlockTime& time);
    /// Removes the last blocks, so that this many remain.
    void truncate(size_t size);

private:
    static constexpr size_t chunk_size = 256; // blocks

    struct Chunk {
        std::vector<uint8_t> bytes;
        std::vector<uint32_t> starts; // of the blocks in `bytes`
    };
    /// What is the same in many blocks: a pair of bodies with its allowance.
    struct PairKind {
        core::Pair pair;
        core::Allowance allowance;
    };

    void unpack(size_t i, CheckedBlock& block, bool with_text) const;
    void pack(const CheckedBlock& block, size_t i, std::vector<uint8_t>& bytes);
    void pack_pair(const core::PairClearance& pair, std::vector<uint8_t>& bytes);
    uint64_t kind_of(const core::PairClearance& pair);

    std::vector<Chunk> chunks_;
    size_t size_ = 0;
    std::vector<PairKind> kinds_;
    std::vector<std::string> files_;           // of subprograms
    std::vector<std::vector<uint32_t>> calls_; // each list of calls once
    std::map<std::vector<uint32_t>, size_t> call_numbers_;
    std::map<size_t, std::vector<core::Finding>> findings_; // of the few blocks that have some
    std::vector<uint8_t> scratch_;
};

/// An error that occurs with another reading of an open premise, but not with the assumed one.
struct ReadingError {
    uint32_t line = 0;
    std::string file; // of a subprogram; empty for the main program
    core::Finding finding;
};

/// An open premise in the words of the report.
struct PremiseText {
    std::string reason;  // "The set-up does not state parameter 5006#6 (TOS)"
    std::string assumed; // a clause: "parameter 5006#6 (TOS) is 1"
    std::string cure;    // a sentence: how to state it
};

/// What a check found with another reading of an open premise.
struct ReadingResult {
    PremiseText premise;
    std::vector<PremiseText> earlier; // those that the run has read differently before
    std::vector<std::string> when;    // clauses, of this reading; the premises met first come first
    std::string effect;               // what the control then does; may be empty
    core::BlockIndex block{};         // of the assumed reading, in which the premise matters
    uint32_t line = 0;                // of that block
    std::string file;
    core::Verdict verdict = core::Verdict::clear; // of the blocks from there on
    // The highest severity that the set-up leaves to its findings, where it has no error.
    core::Severity lowered = core::Severity::off;
    std::vector<ReadingError> errors; // the first few
    size_t error_count = 0;
    std::optional<core::Error> stopped; // why this reading ended early
    bool ends_early = false;            // it has so many errors that it was not followed to the end
    bool is_condition = false;          // of the program; otherwise a parameter of the control
    bool continues = false;             // it goes on where another reading had been stopped
    std::optional<ReadingError>
        avoided; // the first error of the assumed reading that this one lacks

    /// How to state all the premises that differ, each once.
    std::string cure() const;
};

/// Wall time of the stages of a check, seconds.
struct CheckTimes {
    double read = 0.0;  // program and set-up
    double model = 0.0; // scan lines of the stock
    double check = 0.0; // interpreting, cutting, measuring
};

/// The input of a check: everything read, inferred and assumed before the first block. A run does
/// not change it.
struct CheckInput {
    std::string program_file;
    std::string sha256; // of the program
    gcode::DialectId dialect{};
    Engine engine{}; // exact
    core::Setup setup;
    std::vector<std::string> assumptions;
    std::shared_ptr<const Coverage> coverage; // without holders and motion, which the run shows
    double memory = 0.0;                      // expected size of the model of the stock, bytes
};

/// The results by block. They only grow while the program runs.
struct CheckRecord {
    std::vector<InputFile> inputs; // files that were read or looked for, also by the run
    std::vector<std::string> later_assumptions; // those that the run adds to the input's
    CheckedBlocks blocks;
    std::vector<core::Finding> findings; // after the run in the order of the blocks
    core::Verdict verdict = core::Verdict::clear;
    std::vector<ReadingResult> readings; // other readings of open premises
    std::optional<core::Error> stopped;  // why the program stopped early
    double removed = 0.0;                // mm3
    CheckTimes times;
};

/// The results after the last block.
struct CheckReport {
    std::vector<core::Finding> combined_findings; // findings that were combined into another one
    core::Statistics statistics;
    size_t points = 0;                           // of the stock's model at the end
    size_t lines = 0;                            // scan lines
    double cycle_time = 0.0;                     // of the program, seconds
    std::shared_ptr<const core::CutModel> stock; // the remaining stock
    double stock_error = 0.0; // how far its cuts may be off: corners, tolerances of axes, mm
    std::shared_ptr<const core::StockMesh> surface;         // of the remaining stock, if requested
    std::shared_ptr<const SavedStock> saved_stock;          // if the stock was written to a file
    std::shared_ptr<const core::PartComparison> comparison; // if the set-up has a part
    std::shared_ptr<const Tolerances> tolerances;           // of the set-up's values, if requested
};

/// A check of a program against a set-up, in its three stages: read_check fills the input,
/// ProgramRunner the record, and conclude the report.
struct CheckRun : CheckInput, CheckRecord, CheckReport {
    bool has_errors() const;
    /// What is known of all that the verdict rests on, with the tools that have fed so far.
    Coverage full_coverage() const;
    /// The verdict in words that say no more than was checked; see headline_of.
    std::string headline() const;
    /// The assumptions of the input, then those of the run.
    std::vector<std::string> all_assumptions() const;
};

/// Progress of a check.
struct CheckProgress {
    size_t blocks = 0;
    double fraction = 0.0; // of the program's lines, 0 to 1; loops make it decrease
    size_t findings = 0;
};

/// A lower bound of the clearance of all pairs in a block that no pair decides; 0 if unknown.
double least_clearance(const core::Setup& setup, const core::BlockResult& result);

/// The bounds of a block's clearance: those of its deciding pair, else the lower bound of all
/// pairs.
ShownClearance shown_clearance(const core::Setup& setup, const core::BlockResult& result);

/// Whether the deciding pair of a block may touch, and perhaps does: it cuts, or leaves its own
/// cut.
bool is_permitted_contact(const core::BlockResult& result);

/// The block whose deciding pair has the worst verdict, and of those the least margin; permitted
/// contact counts only if there is nothing else. Empty if no pair decides any block.
std::optional<CheckedBlock> tightest_block(const CheckRun& run);

/// What the tightest block keeps: "3.605 mm (minimum 2.000 mm)"; "permitted contact only".
std::string tightest_words(const core::BlockResult& result, ClearanceStyle style);

} // namespace app
