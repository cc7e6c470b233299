#include "app/batch/program_diff.h"

#include <algorithm>
#include <unordered_map>

#include "app/batch/block_text.h"
#include "app/batch/line_alignment.h"

namespace app {
namespace {

constexpr double same_margin = 0.001; // mm

using Symbols = std::unordered_map<std::string, uint32_t>;

/// For each block a number that those have in common that say the same.
std::vector<uint32_t> numbers_of(const CheckRun& run, Symbols& symbols) {
    std::vector<uint32_t> numbers;
    for (const CheckedBlock& block : run.blocks) {
        const auto next = static_cast<uint32_t>(symbols.size());
        const std::string name = block.file.substr(block.file.find_last_of('/') + 1);
        numbers.push_back(
            symbols.try_emplace(name + "\n" + numberless(block.text), next).first->second);
    }
    return numbers;
}

/// The pairs of places that go together, also in stretches that were rewritten block by block.
std::vector<std::pair<size_t, size_t>> matched(const CheckRun& before, const CheckRun& after) {
    Symbols symbols;
    const std::vector<uint32_t> a = numbers_of(before, symbols), b = numbers_of(after, symbols);
    std::vector<std::pair<size_t, size_t>> pairs;
    size_t x = 0, y = 0; // behind the last pair
    const auto go_to = [&](size_t next_x, size_t next_y) {
        if (next_x - x == next_y - y)
            for (; x < next_x; ++x, ++y) pairs.emplace_back(x, y);
        x = next_x + 1;
        y = next_y + 1;
    };
    for (const auto& [next_x, next_y] : aligned(a, b)) {
        go_to(next_x, next_y);
        pairs.emplace_back(next_x, next_y);
    }
    go_to(a.size(), b.size());
    return pairs;
}

BlockMeasure measure_of(const CheckRun& run, const CheckedBlock& block) {
    const core::BlockResult& result = block.result;
    BlockMeasure measure{.block = core::value_of(block.block),
                         .line = block.line,
                         .file = block.file,
                         .text = block.text,
                         .verdict = result.verdict};
    if (result.motion == core::BlockMotion::none || !result.checked) return measure;
    measure.lower = least_clearance(run.setup, result);
    measure.margin = measure.lower;
    if (!result.deciding) return measure;
    const core::PairClearance& pair = result.pairs[*result.deciding];
    measure.pair = {core::part_name(run.setup, pair.pair), core::body_name(run.setup, pair.pair)};
    measure.lower = pair.lower;
    if (pair.found()) measure.upper = pair.upper;
    measure.allowance = pair.allowance.distance;
    measure.margin = pair.margin();
    return measure;
}

bool moves(const CheckedBlock& block) { return block.result.motion != core::BlockMotion::none; }

/// How far one of two went beyond the search limit nobody knows.
double difference(const BlockMeasure& before, const BlockMeasure& after) {
    const bool both_far = before.pair[0].empty() && after.pair[0].empty();
    if (!before.margin || !after.margin || both_far) return 0.0;
    return *before.margin - *after.margin;
}

void compare(ProgramDiff& diff, BlockMeasure before, BlockMeasure after) {
    ChangedBlock changed{std::move(before), std::move(after)};
    changed.nearer = difference(changed.before, changed.after);
    const core::Verdict was = changed.before.verdict, is = changed.after.verdict;
    if (is > was || (is == was && changed.nearer > same_margin))
        diff.nearer.push_back(std::move(changed));
    else if (is < was || changed.nearer < -same_margin)
        diff.farther.push_back(std::move(changed));
    else
        ++diff.same;
}

/// Those that move between the last pair and the next one.
void take_alone(const CheckRun& run, size_t from, size_t to, std::vector<BlockMeasure>& alone) {
    for (; from < to; ++from)
        if (moves(run.blocks[from])) alone.push_back(measure_of(run, run.blocks[from]));
}

/// Findings go together where their blocks do, rewritten or not.
ProgramChange change_along(const std::vector<std::pair<size_t, size_t>>& pairs,
                           const ProgramResult& before, const ProgramResult& after) {
    std::unordered_map<size_t, size_t> later;
    for (const auto& [was, is] : pairs) later.emplace(was, is);
    return change_between(
        before, after,
        [&](const KeptFinding& finding) {
            if (!finding.block) return std::string();
            const auto found = later.find(*finding.block);
            return found == later.end() ? "gone" : std::to_string(found->second);
        },
        [](const KeptFinding& finding) {
            return finding.block ? std::to_string(*finding.block) : std::string();
        });
}

void sort_worst_first(std::vector<ChangedBlock>& blocks, int sign) {
    std::stable_sort(
        blocks.begin(), blocks.end(), [sign](const ChangedBlock& a, const ChangedBlock& b) {
            const auto steps = [sign](const ChangedBlock& c) {
                return sign
                       * (static_cast<int>(c.after.verdict) - static_cast<int>(c.before.verdict));
            };
            return steps(a) != steps(b) ? steps(a) > steps(b) : sign * a.nearer > sign * b.nearer;
        });
}

} // namespace

bool ProgramDiff::is_worse() const {
    const bool has_new = std::any_of(
        change.new_findings.begin(), change.new_findings.end(),
        [](const KeptFinding& finding) { return finding.severity >= core::Severity::warning; });
    const bool comes_near = std::any_of(nearer.begin(), nearer.end(), [](const ChangedBlock& each) {
        return each.after.verdict > each.before.verdict
               || (each.after.margin && *each.after.margin < each.after.allowance);
    });
    return has_new || comes_near || after.verdict > before.verdict
           || (after.error && !before.error);
}

ProgramDiff diff_of(const CheckRun& before, const CheckRun& after, const std::string& setup_before,
                    const std::string& setup_after) {
    ProgramDiff diff{.before = result_of(before, setup_before),
                     .after = result_of(after, setup_after)};
    const std::vector<std::pair<size_t, size_t>> pairs = matched(before, after);
    diff.change = change_along(pairs, diff.before, diff.after);
    size_t x = 0, y = 0;
    for (const auto& [next_x, next_y] : pairs) {
        take_alone(before, x, next_x, diff.removed);
        take_alone(after, y, next_y, diff.added);
        const CheckedBlock &was = before.blocks[next_x], &is = after.blocks[next_y];
        if (moves(was) && moves(is))
            compare(diff, measure_of(before, was), measure_of(after, is));
        else {
            take_alone(before, next_x, next_x + 1, diff.removed);
            take_alone(after, next_y, next_y + 1, diff.added);
        }
        x = next_x + 1;
        y = next_y + 1;
    }
    take_alone(before, x, before.blocks.size(), diff.removed);
    take_alone(after, y, after.blocks.size(), diff.added);
    sort_worst_first(diff.nearer, 1);
    sort_worst_first(diff.farther, -1);
    return diff;
}

} // namespace app
