#pragma once

#include "app/library/result/batch_result.h"
#include "app/library/store/shard_number.h"

namespace app {

struct BatchPlan;

/// A program in the plan of a batch, with what must be equal on all computers.
struct PlannedProgram {
    std::string name;   // path, as in its result
    uintmax_t size = 0; // of the file, bytes; 0 if it cannot be read
    std::string terms;  // a digest of options, set-up and files named by options

    bool operator==(const PlannedProgram&) const = default;
};

/// The results of one computer for its part of a batch, with the plan of the whole batch.
struct Shard {
    std::string file;    // from which it was read; not stored
    std::string version; // of Feeler: see build_version
    ShardId id;
    std::vector<PlannedProgram> programs; // of the whole batch, in order
    std::vector<ProgramResult> failures;  // arguments of the whole batch without a match
    std::vector<SkippedFile> skipped;     // of the whole batch
    std::vector<size_t> indices;          // indices in `programs` of the results
    std::vector<ProgramResult> results;
    std::vector<size_t> unchecked; // indices in `programs` not finished because the run was stopped
    double seconds = 0.0;          // wall time of the shard

    bool operator==(const Shard&) const = default;
};

/// The programs of a plan.
std::vector<PlannedProgram> planned_programs(const BatchPlan& plan);

/// The indices of the programs of a shard.
std::vector<size_t> indices_of(const std::vector<PlannedProgram>& programs, const ShardId& id);

/// The part of a plan with these programs. Failures of arguments stay in every part.
BatchPlan part_of_plan(const BatchPlan& plan, const std::vector<size_t>& indices);

/// Adds the results of a part of the plan to a shard that already describes the batch.
Shard shard_of(Shard shard, const std::vector<size_t>& indices, const BatchResult& batch);

/// Converts a shard to a JSON object with one entry per line, and back.
///
/// Errors: unsupported for a file of a newer version; syntax for any other text, an incomplete
///         file, or a wrong seal.
std::string json_of(const Shard& shard);
core::Result<Shard> shard_from_json(const std::string& text);

/// Ends an object with a seal, a digest that reveals damage and manual edits. It does not protect
/// against someone who computes a new seal.
std::string sealed(std::string text);

/// Whether the file exists and begins like a shard.
bool is_shard_file(const std::string& path);

/// The result of the whole batch, as from a single run. Programs that a shard did not reach stay
/// unchecked; skipped files are those that all shards skipped.
///
/// Errors: with the names of the files: shards of different batches or of different versions of
///         their files; a shard that is given twice or missing; a shard with a missing or foreign
///         result.
core::Result<BatchResult> merged(std::vector<Shard> shards);

} // namespace app
