#include "app/library/result/program_diff.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <map>
#include <tuple>
#include <unordered_map>

#include "app/check/check_run.h"
#include "core/base/text.h"

namespace app {
namespace {

constexpr double same_margin = 0.001; // mm

using Symbols = std::unordered_map<std::string, uint32_t>;

/// A number for each block; blocks with equal text have equal numbers.
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

/// The matching blocks, including those of stretches that were rewritten block by block.
std::vector<std::pair<size_t, size_t>> matched(const CheckRun& before, const CheckRun& after) {
    Symbols symbols;
    const std::vector<uint32_t> a = numbers_of(before, symbols), b = numbers_of(after, symbols);
    std::vector<std::pair<size_t, size_t>> pairs;
    size_t x = 0, y = 0; // after the last pair
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

/// The decrease of the margin, mm; 0 if unknown, as beyond the search limit in both.
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

/// Adds the moving blocks in from .. to - 1, which have no match.
void take_alone(const CheckRun& run, size_t from, size_t to, std::vector<BlockMeasure>& alone) {
    for (; from < to; ++from)
        if (const CheckedBlock block = run.blocks[from]; moves(block))
            alone.push_back(measure_of(run, block));
}

/// Compares findings. Those of matching blocks are at the same place, even in rewritten blocks.
ProgramChange change_along(const std::vector<std::pair<size_t, size_t>>& pairs,
                           const ProgramResult& before, const ProgramResult& after) {
    std::unordered_map<size_t, size_t> later;
    for (const auto& [was, is] : pairs) later.emplace(was, is);
    return change_between(
        before, after,
        [&](const StoredFinding& finding) {
            if (!finding.block) return std::string();
            const auto found = later.find(core::value_of(*finding.block));
            return found == later.end() ? "gone" : std::to_string(found->second);
        },
        [](const StoredFinding& finding) {
            return finding.block ? std::to_string(core::value_of(*finding.block)) : std::string();
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
        [](const StoredFinding& finding) { return finding.severity >= core::Severity::warning; });
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
        const CheckedBlock was = before.blocks[next_x], is = after.blocks[next_y];
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

namespace {

/// With more differences than this in a stretch, the best split so far is used.
constexpr ptrdiff_t most_differences = 2048;

/// A stretch of both lists; the ends are excluded.
struct Stretch {
    ptrdiff_t a_begin, a_end, b_begin, b_end;
};

struct Split {
    ptrdiff_t a, b;
};

/// The items of a list that the other list contains, too, with their indices.
struct Items {
    std::vector<uint32_t> items;
    std::vector<size_t> indices;
};

Items known_to(std::span<const uint32_t> others, std::span<const uint32_t> list) {
    std::vector<uint32_t> known(others.begin(), others.end());
    std::sort(known.begin(), known.end());
    Items selected;
    for (size_t i = 0; i < list.size(); ++i) {
        if (!std::binary_search(known.begin(), known.end(), list[i])) continue;
        selected.items.push_back(list[i]);
        selected.indices.push_back(i);
    }
    return selected;
}

/// Searches for the path through two lists with the fewest differences, from both ends until the
/// fronts meet. A diagonal is an index in a minus an index in b. A front stores for each diagonal
/// the index in a that was reached.
class Fronts {
public:
    Fronts(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b)
        : a_(a),
          b_(b),
          origin_(static_cast<ptrdiff_t>(b.size()) + 1),
          ahead_(a.size() + b.size() + 3),
          back_(a.size() + b.size() + 3) {}

    /// A point on such a path, neither the beginning nor the end. The lists must differ at both
    /// ends.
    Split split(const Stretch& stretch);

private:
    struct Range {
        ptrdiff_t low, high; // diagonals
    };

    bool step_ahead(Split& met);
    bool step_back(Split& met);
    Split best() const;
    void widen(Range& range, std::vector<ptrdiff_t>& front, ptrdiff_t outside) const;

    ptrdiff_t& ahead(ptrdiff_t diagonal) { return ahead_[origin_ + diagonal]; }
    ptrdiff_t& back(ptrdiff_t diagonal) { return back_[origin_ + diagonal]; }

    const std::vector<uint32_t>& a_;
    const std::vector<uint32_t>& b_;
    ptrdiff_t origin_;
    std::vector<ptrdiff_t> ahead_, back_;
    Stretch in_{};
    Range ahead_range_{}, back_range_{};
    bool is_odd_ = false; // the fronts meet in a step ahead
};

/// Adds a diagonal on each side, or removes one at the border of the stretch.
void Fronts::widen(Range& range, std::vector<ptrdiff_t>& front, ptrdiff_t outside) const {
    if (range.low > in_.a_begin - in_.b_end)
        front[origin_ + --range.low - 1] = outside;
    else
        ++range.low;
    if (range.high < in_.a_end - in_.b_begin)
        front[origin_ + ++range.high + 1] = outside;
    else
        --range.high;
}

bool Fronts::step_ahead(Split& met) {
    widen(ahead_range_, ahead_, -1);
    for (ptrdiff_t d = ahead_range_.high; d >= ahead_range_.low; d -= 2) {
        ptrdiff_t x = std::max(ahead(d + 1), ahead(d - 1) + 1);
        while (x < in_.a_end && x - d < in_.b_end && a_[x] == b_[x - d]) ++x;
        ahead(d) = x;
        if (!is_odd_ || d < back_range_.low || d > back_range_.high || back(d) > x) continue;
        met = {x, x - d};
        return true;
    }
    return false;
}

bool Fronts::step_back(Split& met) {
    widen(back_range_, back_, std::numeric_limits<ptrdiff_t>::max());
    for (ptrdiff_t d = back_range_.high; d >= back_range_.low; d -= 2) {
        ptrdiff_t x = std::min(back(d - 1), back(d + 1) - 1);
        while (x > in_.a_begin && x - d > in_.b_begin && a_[x - 1] == b_[x - d - 1]) --x;
        back(d) = x;
        if (is_odd_ || d < ahead_range_.low || d > ahead_range_.high || x > ahead(d)) continue;
        met = {x, x - d};
        return true;
    }
    return false;
}

/// The farthest point of the front that has advanced more.
Split Fronts::best() const {
    Split farthest{in_.a_begin, in_.b_begin}, nearest{in_.a_end, in_.b_end};
    for (ptrdiff_t d = ahead_range_.high; d >= ahead_range_.low; d -= 2) {
        const ptrdiff_t x = std::min({ahead_[origin_ + d], in_.a_end, in_.b_end + d});
        if (2 * x - d > farthest.a + farthest.b) farthest = {x, x - d};
    }
    for (ptrdiff_t d = back_range_.high; d >= back_range_.low; d -= 2) {
        const ptrdiff_t x = std::max({back_[origin_ + d], in_.a_begin, in_.b_begin + d});
        if (2 * x - d < nearest.a + nearest.b) nearest = {x, x - d};
    }
    const ptrdiff_t gone_ahead = farthest.a + farthest.b - in_.a_begin - in_.b_begin;
    const ptrdiff_t gone_back = in_.a_end + in_.b_end - nearest.a - nearest.b;
    return gone_ahead >= gone_back ? farthest : nearest;
}

Split Fronts::split(const Stretch& stretch) {
    in_ = stretch;
    const ptrdiff_t first = in_.a_begin - in_.b_begin, last = in_.a_end - in_.b_end;
    ahead_range_ = {first, first};
    back_range_ = {last, last};
    is_odd_ = ((first - last) & 1) != 0;
    ahead(first) = in_.a_begin;
    back(last) = in_.a_end;
    Split met{};
    for (ptrdiff_t differences = 1; differences <= most_differences; ++differences)
        if (step_ahead(met) || step_back(met)) return met;
    return best();
}

} // namespace

std::vector<std::pair<size_t, size_t>> aligned(std::span<const uint32_t> a,
                                               std::span<const uint32_t> b) {
    const Items in_a = known_to(b, a), in_b = known_to(a, b);
    Fronts fronts(in_a.items, in_b.items);
    std::vector<std::pair<size_t, size_t>> pairs;
    const auto pair_up = [&](ptrdiff_t x, ptrdiff_t y) {
        pairs.emplace_back(in_a.indices[x], in_b.indices[y]);
    };
    std::vector<Stretch> open = {{0, static_cast<ptrdiff_t>(in_a.items.size()), 0,
                                  static_cast<ptrdiff_t>(in_b.items.size())}};
    while (!open.empty()) {
        Stretch s = open.back();
        open.pop_back();
        const auto is_open = [&] { return s.a_begin < s.a_end && s.b_begin < s.b_end; };
        while (is_open() && in_a.items[s.a_begin] == in_b.items[s.b_begin])
            pair_up(s.a_begin++, s.b_begin++);
        while (is_open() && in_a.items[s.a_end - 1] == in_b.items[s.b_end - 1])
            pair_up(--s.a_end, --s.b_end);
        if (!is_open()) continue;
        const Split at = fronts.split(s);
        open.push_back({s.a_begin, at.a, s.b_begin, at.b});
        open.push_back({at.a, s.a_end, at.b, s.b_end});
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

namespace {

using Findings = std::vector<StoredFinding>;
using Identity = std::tuple<std::string, core::Severity, std::array<std::string, 2>, std::string>;

std::vector<Identity> identities(const Findings& findings, const FindingKey& key_of) {
    std::vector<Identity> named;
    for (const StoredFinding& finding : findings)
        named.emplace_back(finding.rule, finding.severity, finding.pair, key_of(finding));
    return named;
}

/// The findings without an equal one in `others`; equal findings are matched one to one.
Findings missing_in(const std::vector<Identity>& others, const Findings& findings,
                    const std::vector<Identity>& named) {
    std::map<Identity, size_t> free;
    for (const Identity& identity : others) ++free[identity];
    Findings missing;
    for (size_t i = 0; i < findings.size(); ++i) {
        size_t& left = free[named[i]];
        if (left > 0)
            --left;
        else
            missing.push_back(findings[i]);
    }
    return missing;
}

double margin_of(const Tightest& tightest) {
    return tightest.upper.value_or(tightest.lower) - tightest.allowance;
}

} // namespace

ProgramChange change_between(const ProgramResult& before, const ProgramResult& after) {
    const FindingKey by_text = [](const StoredFinding& finding) {
        return finding.file + "\n" + numberless(finding.text);
    };
    return change_between(before, after, by_text, by_text);
}

ProgramChange change_between(const ProgramResult& before, const ProgramResult& after,
                             const FindingKey& key_before, const FindingKey& key_after) {
    const auto were = identities(before.findings, key_before);
    const auto are = identities(after.findings, key_after);
    ProgramChange change{.verdict_differs = before.verdict != after.verdict,
                         .longer = after.cycle_time - before.cycle_time,
                         .new_findings = missing_in(were, after.findings, are),
                         .gone_findings = missing_in(are, before.findings, were)};
    if (before.tightest && after.tightest && !has_only_contact(before) && !has_only_contact(after))
        change.nearer = margin_of(*before.tightest) - margin_of(*after.tightest);
    return change;
}

std::string without_number(std::string_view block) {
    std::string text;
    for (const char letter : block)
        if (!std::isspace(static_cast<unsigned char>(letter))) text += core::upper(letter);
    const size_t skip = text.starts_with('/') ? 1 : 0;
    // N120, :120, or the bare number of a Klartext line.
    size_t end = skip;
    if (end < text.size() && (text[end] == 'N' || text[end] == ':')) ++end;
    while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end]))) ++end;
    const bool is_number = end > skip && std::isdigit(static_cast<unsigned char>(text[end - 1]));
    return is_number ? text.substr(0, skip) + text.substr(end) : text;
}

std::string numberless(std::string_view block) {
    return without_number(block.substr(0, block.find(';')));
}

} // namespace app
