#pragma once

#include "app/library/result/batch_result.h"
#include "app/library/store/shard_number.h"

namespace app {

struct BatchPlan;

/// A program as the plan of a batch has it, and what every machine must see alike of it.
struct PlannedProgram {
    std::string name;   // its path, as its result has it
    uintmax_t size = 0; // of its file, bytes; 0 if it cannot be read
    std::string terms;  // a digest of its options, of its set-up, and of files that options name

    bool operator==(const PlannedProgram&) const = default;
};

/// What one machine has done of a batch, and of which.
struct Shard {
    std::string file;    // it was read from; not kept
    std::string version; // of the program that checked: see build_version
    ShardId share;
    std::vector<PlannedProgram> programs; // of the whole batch, in their order
    std::vector<ProgramResult> failures;  // words of the whole batch that stand for nothing
    std::vector<SkippedFile> skipped;     // of the whole batch
    std::vector<size_t> places;           // in `programs`, of the results
    std::vector<ProgramResult> results;
    std::vector<size_t> unchecked; // places in `programs` that it was stopped before or in
    double seconds = 0.0;          // of wall time that all of it took

    bool operator==(const Shard&) const = default;
};

/// What a plan says of its programs.
std::vector<PlannedProgram> planned_programs(const BatchPlan& plan);

/// The places of the programs that a share has.
std::vector<size_t> places_of(const std::vector<PlannedProgram>& programs, const ShardId& share);

/// A plan for some of its programs alone. Words that stand for nothing are everybody's.
BatchPlan plan_of_places(const BatchPlan& plan, const std::vector<size_t>& places);

/// What became of the plan of these places, as a shard. `shard` says of which batch.
Shard shard_of(Shard shard, const std::vector<size_t>& places, const BatchResult& batch);

/// A shard as a JSON object, an entry to a line, and back.
///
/// Errors: unsupported for one that a newer version wrote; syntax for text that is no such object,
///         or not all of one, or whose seal is not that of what stands before it.
std::string json_of(const Shard& shard);
core::Result<Shard> shard_from_json(const std::string& text);

/// An object that lacks its end, with the seal as its last entry: damage shows, and so does an edit
/// by hand. Whoever makes a new seal is not kept from it.
std::string sealed(std::string text);

/// Whether there is a file that begins as a shard does.
bool is_shard_file(const std::string& path);

/// What one run of the whole batch would have given. Programs that a shard was stopped before stay
/// unchecked; of the skipped files those are named that all have seen.
///
/// Errors: with the names of the files: shards of different batches, or of different states of
///         their files; one that is there twice or is missing; one that lacks a program's result or
///         has another's.
core::Result<BatchResult> merged(std::vector<Shard> shards);

} // namespace app
