#include <algorithm>
#include <unordered_set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/library/shard/shard.h"

namespace app {
namespace {

core::Error merge_error(const std::string& file, std::string why) {
    return {core::ErrorCode::invalid_value, {}, std::move(why), file};
}

bool has(const std::vector<PlannedProgram>& programs, const std::string& name) {
    return std::any_of(programs.begin(), programs.end(),
                       [&](const PlannedProgram& program) { return program.name == name; });
}

/// How a list of programs differs from the first one; empty if they are equal.
std::string difference(const std::vector<PlannedProgram>& first,
                       const std::vector<PlannedProgram>& other) {
    const auto [a, b] = std::mismatch(first.begin(), first.end(), other.begin(), other.end());
    if (a == first.end() && b == other.end()) return {};
    if (a != first.end() && !has(other, a->name)) return "it does not contain " + a->name;
    if (b != other.end() && !has(first, b->name))
        return "it contains " + b->name + ", the other one does not";
    if (a == first.end() || b == other.end() || a->name != b->name)
        return "its programs are in a different order";
    if (a->size != b->size) return a->name + " has a different size there";
    return a->name + " has different options or a different set-up there";
}

/// Why a shard belongs to a different batch than the first; empty if it does not.
std::string difference(const Shard& first, const Shard& other) {
    if (other.version != first.version) return "it was made by a different version of Feeler";
    if (other.id.n != first.id.n)
        return fmt::format("it is shard {}, not one of {}", text_of(other.id), first.id.n);
    if (other.failures != first.failures) return "different files were missing or unreadable there";
    return difference(first.programs, other.programs);
}

core::Result<void> check_shard_numbers(const std::vector<Shard>& shards) {
    for (size_t i = 1; i < shards.size(); ++i) {
        if (const std::string why = difference(shards[0], shards[i]); !why.empty())
            return tl::unexpected(
                merge_error(shards[i].file, fmt::format("belongs to a different batch than {}: {}",
                                                        shards[0].file, why)));
        if (shards[i].id == shards[i - 1].id)
            return tl::unexpected(merge_error(
                shards[i].file, fmt::format("is shard {}, and so is {}", text_of(shards[i].id),
                                            shards[i - 1].file)));
    }
    return {};
}

core::Result<void> find_missing(const std::vector<Shard>& shards) {
    constexpr size_t shown = 20;
    const size_t n = shards[0].id.n;
    const size_t count = n - std::min(n, shards.size());
    if (count == 0) return {};
    std::vector<std::string> missing;
    size_t at = 0;
    for (size_t i = 1; i <= n && missing.size() < shown; ++i)
        if (at < shards.size() && shards[at].id.i == i)
            ++at;
        else
            missing.push_back(text_of(ShardId{i, n}));
    return core::fail(core::ErrorCode::missing_value,
                      fmt::format("{} missing: {}{}",
                                  count == 1 ? "a shard is" : "these shards are",
                                  fmt::join(missing, ", "), count > shown ? ", ..." : ""));
}

/// The outcome of each program: its result, or null if its shard did not check it.
class Outcomes {
public:
    explicit Outcomes(const std::vector<PlannedProgram>& programs)
        : programs_(programs), is_covered_(programs.size(), false), results_(programs.size()) {}

    core::Result<void> take(const Shard& shard) {
        bool fits = shard.indices.size() == shard.results.size();
        for (size_t i = 0; fits && i < shard.indices.size(); ++i)
            fits = is_new(shard.indices[i])
                   && shard.results[i].program == programs_[shard.indices[i]].name
                   && put(shard.indices[i], &shard.results[i]);
        for (size_t i = 0; fits && i < shard.unchecked.size(); ++i)
            fits = is_new(shard.unchecked[i]) && put(shard.unchecked[i], nullptr);
        if (fits) return {};
        return tl::unexpected(
            merge_error(shard.file, "has a result that belongs to none of its programs"));
    }

    core::Result<BatchResult> batch() const {
        BatchResult batch;
        for (size_t i = 0; i < programs_.size(); ++i) {
            if (!is_covered_[i])
                return core::fail(core::ErrorCode::missing_value,
                                  fmt::format("no shard has a result for {}", programs_[i].name));
            if (results_[i])
                batch.programs.push_back(*results_[i]);
            else
                batch.unchecked.push_back(programs_[i].name);
        }
        return batch;
    }

private:
    bool is_new(size_t index) const { return index < is_covered_.size() && !is_covered_[index]; }

    bool put(size_t index, const ProgramResult* result) {
        results_[index] = result;
        is_covered_[index] = true;
        return true;
    }

    const std::vector<PlannedProgram>& programs_;
    std::vector<bool> is_covered_;
    std::vector<const ProgramResult*> results_;
};

/// The files that all shards skipped. A file that only some machines saw was created or deleted
/// meanwhile, such as a shard file next to the programs. It is not a program, and no result depends
/// on it.
std::vector<SkippedFile> skipped_by_all(const std::vector<Shard>& shards) {
    std::vector<SkippedFile> skipped = shards[0].skipped;
    for (size_t i = 1; i < shards.size(); ++i) {
        if (shards[i].skipped == shards[0].skipped) continue;
        std::unordered_set<std::string> seen;
        for (const SkippedFile& file : shards[i].skipped) seen.insert(file.path + '\n' + file.why);
        std::erase_if(skipped, [&](const SkippedFile& file) {
            return !seen.contains(file.path + '\n' + file.why);
        });
    }
    return skipped;
}

} // namespace

core::Result<BatchResult> merged(std::vector<Shard> shards) {
    if (shards.empty()) return core::fail(core::ErrorCode::missing_value, "there are no shards");
    std::sort(shards.begin(), shards.end(), [](const Shard& a, const Shard& b) {
        return a.id.i != b.id.i ? a.id.i < b.id.i : a.file < b.file;
    });
    if (auto same = check_shard_numbers(shards); !same) return tl::unexpected(same.error());
    if (auto whole = find_missing(shards); !whole) return tl::unexpected(whole.error());
    Outcomes outcomes(shards[0].programs);
    for (const Shard& shard : shards)
        if (auto taken = outcomes.take(shard); !taken) return tl::unexpected(taken.error());
    FEELER_TRY(BatchResult batch, outcomes.batch());
    batch.programs.insert(batch.programs.end(), shards[0].failures.begin(),
                          shards[0].failures.end());
    batch.skipped = skipped_by_all(shards);
    return batch;
}

} // namespace app
