#include "core/dbm/covered_path.h"

#include "core/dbm/cut_model.h"

namespace core {
namespace {

constexpr int deepest_division = 12;

bool same_profile(const RevolvedProfile& a, const RevolvedProfile& b) {
    return std::equal(a.elements.begin(), a.elements.end(), b.elements.begin(), b.elements.end(),
                      [](const ProfileElement& p, const ProfileElement& q) {
                          return p.z0 == q.z0 && p.r0 == q.r0 && p.z1 == q.z1 && p.r1 == q.r1
                                 && p.margin == q.margin;
                      });
}

bool widens_upwards(const RevolvedProfile& flutes) {
    double radius = 0.0;
    for (const ProfileElement& e : flutes.elements) {
        if (e.r1 < e.r0 || e.r1 + e.margin < radius) return false;
        radius = e.r1 + e.margin;
    }
    // A ball with nothing above it narrows in its upper half.
    return is_convex(flutes) && flutes.elements.back().margin == 0.0;
}

/// A straight move of a tip in the frame of the tool, in which the tool is upright, and whether its
/// cut is open above.
struct Move {
    Vec3 from, to;
    double near = 0.0; // allowed distance of the tip from it
    bool open = false;
};

/// Whether the tip at `p` is near enough to a position of the move: a tool made smaller by that
/// distance is then inside the tool at that position.
bool passes(const Move& move, const Vec3& p) {
    const Vec3 q = move.from, by = move.to - move.from;
    const double length = glm::dot(by, by);
    const double t = length > 0.0 ? std::clamp(glm::dot(p - q, by) / length, 0.0, 1.0) : 0.0;
    const Vec3 apart = p - (q + t * by);
    return glm::dot(apart, apart) <= move.near * move.near;
}

/// Whether the tip at `p` is in the cut of the move: above a position that is near enough.
bool covers(const Move& move, const Vec3& p) {
    const Vec3 q = move.from, by = move.to - move.from;
    // The positions of the move that are not above p: first .. last of 0 .. 1.
    double first = 0.0, last = 1.0;
    if (by.z > 0.0) last = std::min(last, (p.z - q.z) / by.z);
    if (by.z < 0.0) first = std::max(first, (p.z - q.z) / by.z);
    if (by.z == 0.0 && q.z > p.z) return false;
    if (first > last) return false;
    const double length = by.x * by.x + by.y * by.y;
    const double along = (p.x - q.x) * by.x + (p.y - q.y) * by.y;
    const double t = length > 0.0 ? std::clamp(along / length, first, last) : first;
    const double x = p.x - q.x - t * by.x, y = p.y - q.y - t * by.y;
    return x * x + y * y <= move.near * move.near;
}

/// A search among the candidate moves.
struct Search {
    std::vector<Move> moves;

    /// Whether both ends meet the same one of two criteria of a move: as it and the path are
    /// straight, everything between does too. Otherwise both halves must, so each end some move's.
    bool covered(const Vec3& a, const Vec3& b, int depth) const {
        bool is_a_covered = false, is_b_covered = false;
        for (const Move& move : moves)
            for (const auto criterion : {passes, covers}) {
                if (criterion == covers && !move.open) continue;
                const bool at_a = criterion(move, a), at_b = criterion(move, b);
                if (at_a && at_b) return true;
                is_a_covered = is_a_covered || at_a;
                is_b_covered = is_b_covered || at_b;
            }
        if (!is_a_covered || !is_b_covered || depth == deepest_division) return false;
        const Vec3 middle = 0.5 * (a + b);
        return covered(a, middle, depth + 1) && covered(middle, b, depth + 1);
    }
};

/// The height of the highest point of a box along `up`.
double top_along(const Aabb& box, const Vec3& up) {
    return glm::dot(glm::max(box.min * up, box.max * up), Vec3(1.0));
}

/// The box of a path and of everything below and above it, along `up`, from where flutes of this
/// height may have cut through to the top of the stock.
Aabb over_and_under(const Vec3& from, const Vec3& to, const Vec3& up, const Aabb& stock,
                    double height) {
    Aabb path;
    path.extend(from);
    path.extend(to);
    Aabb all = path;
    all.extend(stock);
    const Vec3 far = (glm::length(all.size()) + height) * up;
    for (const Vec3& position : {from, to}) {
        path.extend(position + far);
        path.extend(position - far);
    }
    return path;
}

/// The candidate moves of a log, among those with these numbers.
Search search_among(const SweepLog& log, const std::vector<uint32_t>& numbers,
                    const PathQuery& question, double top) {
    const bool upwards = widens_upwards(question.flutes);
    const double height = bounds(question.flutes).max.z;
    const Vec3 up = question.orientation[2];
    const Mat3 tool_from_stock = glm::transpose(question.orientation);
    Search search;
    for (const uint32_t number : numbers) {
        const CutterSweep& sweep = log[number].sweep;
        if (sweep.orientation[2] != up) continue;
        if (!same_profile(sweep.cutter->flutes, question.flutes)) continue;
        Move move{tool_from_stock * sweep.from, tool_from_stock * sweep.to,
                  question.sideways - sweep.cutter->path_error};
        if (move.near <= 0.0) continue;
        // The move below the path also cut above it, up to the top of all material and beyond.
        move.open = upwards && std::min(move.from.z, move.to.z) + height >= top;
        search.moves.push_back(move);
    }
    return search;
}

bool is_covered(const Search& search, const PathQuery& question) {
    const Mat3 tool_from_stock = glm::transpose(question.orientation);
    return search.covered(tool_from_stock * question.from, tool_from_stock * question.to, 0);
}

} // namespace

bool runs_in_own_cut(const CutModel& stock, const PathQuery& question) {
    if (question.sideways <= 0.0) return false;
    const Vec3 up = question.orientation[2];
    const Aabb path = over_and_under(question.from, question.to, up, stock.outer_box,
                                     bounds(question.flutes).max.z);
    const auto numbers = tips_near(stock, path.grown(question.sideways));
    return is_covered(search_among(stock.log, numbers, question, top_along(stock.outer_box, up)),
                      question);
}

bool runs_in_own_cut(const SweepLog& log, const Aabb& box, const PathQuery& question) {
    if (question.sideways <= 0.0) return false;
    const Vec3 up = question.orientation[2];
    const Aabb path =
        over_and_under(question.from, question.to, up, box, bounds(question.flutes).max.z)
            .grown(question.sideways);
    std::vector<uint32_t> numbers;
    for (uint32_t number = 0; number < log.size(); ++number)
        if (overlaps(log.path_box(number), path)) numbers.push_back(number);
    return is_covered(search_among(log, numbers, question, top_along(box, up)), question);
}

} // namespace core
