#include "app/session/guessed_stock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace app {
namespace {

using core::Aabb;
using core::Vec3;

constexpr double below_the_cuts = 2.0; // mm of stock under the deepest cut
constexpr double smallest_height = 1.0;

/// Where the top of the material lies above a zero, and why.
struct Top {
    double z = 0.0;
    std::string why;
};

Top top_of(const ProgramSurvey& seen, double zero) {
    constexpr double near = 2.0, share = 0.25; // how far above zero ramps and leads begin
    const double lowest = seen.lowest - zero;
    if (seen.retract && *seen.retract - zero < 0.0 && *seen.retract > seen.lowest)
        return {*seen.retract - zero, "where rapids travel"};
    if (!seen.cuts_sideways)
        return lowest < 0.0 ? Top{0.0, "at Z0, where cuts go below it"}
                            : Top{lowest + smallest_height, "just above the deepest feed"};
    const double highest = seen.highest_cut - zero;
    const bool at_zero = lowest < 0.0 && highest <= std::max(near, -share * lowest);
    if (at_zero) return {0.0, "at Z0, where cuts go below it"};
    return {highest, "at the highest cut"};
}

/// A top above zero is no higher than where rapids go down to, holes before they are drilled.
void lower_top(const std::vector<UncutPlunge>& plunges, double zero, Aabb& box, Top& top) {
    for (const UncutPlunge& plunge : plunges) {
        const double z = plunge.tip.z;
        if (z < zero || z >= box.max.z || z < box.min.z + smallest_height) continue;
        box.max.z = z;
        top.why = fmt::format("where line {} goes down to by rapid", plunge.line);
    }
}

/// The sides of a box that go back, and the plunge that each ends at.
struct Sides {
    Aabb whole, box;
    std::array<const UncutPlunge*, 4> ends{}; // X from, X to, Y from, Y to

    double& place(size_t side) {
        return side % 2 == 0 ? box.min[static_cast<int>(side / 2)]
                             : box.max[static_cast<int>(side / 2)];
    }

    /// Where a side has to stand so that a plunge comes down beside it.
    static double beside(const UncutPlunge& plunge, size_t side) {
        const double at = plunge.tip[static_cast<int>(side / 2)];
        return side % 2 == 0 ? at + plunge.radius : at - plunge.radius;
    }

    bool holds(const UncutPlunge& plunge) {
        for (size_t side = 0; side < 4; ++side)
            if ((side % 2 == 0) == (beside(plunge, side) <= place(side))) return false;
        return true;
    }

    void go_back(const UncutPlunge& plunge) {
        constexpr double most = 0.2; // of the whole, from both sides together
        double least = most;
        std::optional<size_t> chosen;
        for (size_t side = 0; side < 4; ++side) {
            const int axis = static_cast<int>(side / 2);
            const double gone = std::abs(beside(plunge, side) - place(side)) + whole.size()[axis]
                                - box.size()[axis];
            const double share = gone / whole.size()[axis];
            if (share >= least) continue;
            least = share;
            chosen = side;
        }
        if (!chosen) return;
        place(*chosen) = beside(plunge, *chosen);
        ends[*chosen] = &plunge;
    }

    std::string why(const Vec3& frame) {
        constexpr const char* names[] = {"X", "X", "Y", "Y"};
        std::string text;
        for (size_t side = 0; side < 4; ++side)
            if (ends[side])
                text +=
                    fmt::format("{} {} {:.3f}, where line {} goes down beside it by rapid",
                                text.empty() ? "; it ends at" : " and at", names[side],
                                place(side) - frame[static_cast<int>(side / 2)], ends[side]->line);
        return text;
    }
};

} // namespace

GuessedStock guessed_stock(const ProgramSurvey& seen, const Vec3& frame, double margin) {
    return guessed_stock(seen, frame, margin, {});
}

GuessedStock guessed_stock(const ProgramSurvey& seen, const Vec3& frame, double margin,
                           const std::vector<UncutPlunge>& plunges) {
    if (!seen.feeds)
        return {{frame + Vec3(-5, -5, -5), frame + Vec3(5, 5, 0)},
                "the program cuts nothing, so the stock is a cube of 10 mm at its zero"};
    Top top = top_of(seen, seen.zero.z);
    const double below = std::max(margin, below_the_cuts);
    Aabb box{seen.cutting.min - Vec3(margin, margin, 0.0),
             seen.cutting.max + Vec3(margin, margin, 0.0)};
    box.min.z = seen.lowest - below;
    box.max.z = std::max(top.z + seen.zero.z, box.min.z + smallest_height);
    lower_top(plunges, seen.zero.z, box, top);
    Sides sides{box, box};
    for (const UncutPlunge& plunge : plunges)
        if (plunge.tip.z < box.max.z && sides.holds(plunge)) sides.go_back(plunge);
    const Vec3 low = sides.box.min - frame, high = sides.box.max - frame;
    return {sides.box,
            fmt::format("the stock is what the tools reach on cutting moves{}: X {:.3f} to {:.3f}, "
                        "Y {:.3f} to {:.3f}, Z {:.3f} ({:g} mm below the deepest cut) to {:.3f} "
                        "({}){}",
                        margin > 0.0 ? fmt::format(" and {:g} mm around", margin) : "", low.x,
                        high.x, low.y, high.y, low.z, below, high.z, top.why, sides.why(frame))};
}

std::string box_text(const Aabb& box) {
    return fmt::format("X {:.3f} to {:.3f}, Y {:.3f} to {:.3f}, Z {:.3f} to {:.3f}", box.min.x,
                       box.max.x, box.min.y, box.max.y, box.min.z, box.max.z);
}

core::Aabb stock_out_of_the_way() { return {{-5, -5, -100'010}, {5, 5, -100'000}}; }

} // namespace app
