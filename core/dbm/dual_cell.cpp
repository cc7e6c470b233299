#include "core/dbm/dual_cell.h"

#include <cstddef>

namespace core {
namespace {

/// Corners of the sides in cyclic order; edge k of a side joins corners k and k + 1.
constexpr uint8_t sides[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                 {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};

uint8_t edge_between(uint8_t a, uint8_t b) {
    for (uint8_t e = 0; e < 12; ++e)
        if ((cell_edges[e].lower == a && cell_edges[e].upper == b)
            || (cell_edges[e].lower == b && cell_edges[e].upper == a))
            return e;
    return DualCell::none;
}

using Groups = std::array<uint8_t, 12>;

void join(Groups& group, uint8_t a, uint8_t b) {
    const uint8_t kept = group[a], gone = group[b];
    for (uint8_t& g : group)
        if (g == gone) g = kept;
}

void join_on_side(Groups& group, const uint8_t (&side)[4], unsigned inside) {
    const auto is_in = [&](unsigned k) { return (inside >> side[k % 4] & 1U) != 0; };
    for (unsigned k = 0; k < 4; ++k) {
        // The surface cuts a run of inside corners off: it joins the edges at both ends of the run.
        if (!is_in(k) || is_in(k + 3)) continue;
        unsigned last = k;
        while (is_in(last + 1) && last < k + 3) ++last;
        join(group, edge_between(side[(k + 3) % 4], side[k]),
             edge_between(side[last % 4], side[(last + 1) % 4]));
    }
}

DualCell make_cell(unsigned inside) {
    Groups group{};
    for (uint8_t e = 0; e < 12; ++e) group[e] = e;
    for (const auto& side : sides) join_on_side(group, side, inside);
    DualCell cell;
    Groups number;
    number.fill(DualCell::none);
    for (size_t e = 0; e < 12; ++e) {
        const bool passes =
            (inside >> cell_edges[e].lower & 1U) != (inside >> cell_edges[e].upper & 1U);
        cell.piece[e] = DualCell::none;
        if (!passes) continue;
        uint8_t& known = number[group[e]];
        if (known == DualCell::none) known = cell.count++;
        cell.piece[e] = known;
    }
    return cell;
}

} // namespace

const DualCell& dual_cell(uint8_t inside) {
    static const auto cells = [] {
        std::array<DualCell, 256> made;
        for (unsigned i = 0; i < 256; ++i) made[i] = make_cell(i);
        return made;
    }();
    return cells[inside];
}

} // namespace core
