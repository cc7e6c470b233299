#include "app/batch/line_alignment.h"

#include <algorithm>
#include <limits>

namespace app {
namespace {

/// Beyond so many differences in one stretch the best split so far will do.
constexpr ptrdiff_t most_differences = 2048;

/// A stretch of both lists, ends excluded.
struct Stretch {
    ptrdiff_t a_begin, a_end, b_begin, b_end;
};

struct Split {
    ptrdiff_t a, b;
};

/// Items with their places, less those that the other list has not.
struct Items {
    std::vector<uint32_t> items;
    std::vector<size_t> places;
};

Items known_to(std::span<const uint32_t> others, std::span<const uint32_t> list) {
    std::vector<uint32_t> known(others.begin(), others.end());
    std::sort(known.begin(), known.end());
    Items kept;
    for (size_t i = 0; i < list.size(); ++i) {
        if (!std::binary_search(known.begin(), known.end(), list[i])) continue;
        kept.items.push_back(list[i]);
        kept.places.push_back(i);
    }
    return kept;
}

/// Looks for the way through two lists with the fewest differences, from both ends until they meet.
/// A diagonal is a place in a less one in b; a front holds for each how far in a one has come.
class Fronts {
public:
    Fronts(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b)
        : a_(a),
          b_(b),
          origin_(static_cast<ptrdiff_t>(b.size()) + 1),
          ahead_(a.size() + b.size() + 3),
          back_(a.size() + b.size() + 3) {}

    /// A place on such a way, neither at the beginning nor at the end. The lists differ at both.
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
    bool is_odd_ = false; // they meet in a step ahead
};

/// One diagonal more on each side, or where the border of the stretch is, one less.
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

/// Where the front is that has come farthest.
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
        pairs.emplace_back(in_a.places[x], in_b.places[y]);
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

} // namespace app
