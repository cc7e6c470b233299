#pragma once

#include "app/library/result/batch_result.h"
#include "app/library/store/shard_number.h"

namespace app {

struct BatchPlan;

/// A program in the plan of a batch, with what must be equal on all machines.
struct PlannedProgram {
    std::string name;   // its path, as its result has it
    uintmax_t size = 0; // of its file, bytes; 0 if it cannot be read
    std::string terms;  // a digest of its options, of its set-up, and of files that options name

    bool operator==(const PlannedProgram&) const = default;
};

/// The results of one machine for its share of a batch, with the plan of the whole batch.
struct Shard {
    std::string file;    // it was read from; not stored
    std::string version; // of Feeler: see build_version
    ShardId share;
    std::vector<PlannedProgram> programs; // of the whole batch, in their order
    std::vector<ProgramResult> failures;  // words of the whole batch without a match
    std::vector<SkippedFile> skipped;     // of the whole batch
    std::vector<size_t> places;           // in `programs`, of the results
    std::vector<ProgramResult> results;
    std::vector<size_t> unchecked; // indices in `programs` not finished because the run was stopped
    double seconds = 0.0;          // wall time of the share

    bool operator==(const Shard&) const = default;
};

/// The programs of a plan.
std::vector<PlannedProgram> planned_programs(const BatchPlan& plan);

/// The indices of the programs of a share.
std::vector<size_t> places_of(const std::vector<PlannedProgram>& programs, const ShardId& share);

/// The part of a plan with these programs. Failures of words stay in every part.
BatchPlan plan_of_places(const BatchPlan& plan, const std::vector<size_t>& places);

/// Adds the results of a part of the plan to a shard that already describes the batch.
Shard shard_of(Shard shard, const std::vector<size_t>& places, const BatchResult& batch);

/// A shard as a JSON object, an entry to a line, and back.
///
/// Errors: unsupported for a file of a newer version; syntax for any other text, an incomplete
/// file,
///         or a wrong seal.
std::string json_of(const Shard& shard);
core::Result<Shard> shard_from_json(const std::string& text);

/// Ends an object with a seal, a digest that reveals damage and edits by hand. It does not protect
/// against somebody who computes a new seal.
std::string sealed(std::string text);

/// Whether the file exists and begins like a shard.
bool is_shard_file(const std::string& path);

/// The result that one run of the whole batch would have given. Programs that a shard did not reach
/// stay unchecked; skipped files are those that all shards skipped.
///
/// Errors: with the names of the files: shards of different batches or of different versions of
///         their files; a shard that is given twice or missing; a shard with a missing or foreign
///         result.
core::Result<BatchResult> merged(std::vector<Shard> shards);

} // namespace app
