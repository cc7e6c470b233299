#include "app/setup/presets/preset_solid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "core/base/math.h"
#include "core/base/union_find.h"

namespace app {
namespace {

constexpr double same_within = 1e-7; // mm

/// Sorted values; those within `same_within` of the one before are the same.
class Marks {
public:
    explicit Marks(std::vector<double> values) : values_(std::move(values)) {
        std::sort(values_.begin(), values_.end());
        const auto is_same = [](double a, double b) { return b - a <= same_within; };
        values_.erase(std::unique(values_.begin(), values_.end(), is_same), values_.end());
    }
    size_t size() const { return values_.size(); }
    double operator[](size_t i) const { return values_[i]; }

    /// The index of the nearest value.
    size_t nearest(double value) const {
        const auto after = std::lower_bound(values_.begin(), values_.end(), value);
        const size_t i = static_cast<size_t>(after - values_.begin());
        if (i == 0) return 0;
        const bool is_before = i == size() || value - values_[i - 1] <= values_[i] - value;
        return is_before ? i - 1 : i;
    }

private:
    std::vector<double> values_;
};

/// A side of an outline that is not along the second axis, from left to right.
struct Side {
    PlanPoint left, right;

    double at(double u) const {
        if (u <= left[0]) return left[1];
        if (u >= right[0]) return right[1];
        return left[1] + (right[1] - left[1]) * ((u - left[0]) / (right[0] - left[0]));
    }
};

/// Where two sides cross, inside both; empty if they do not.
std::optional<double> crossing(const Side& a, const Side& b) {
    const double low = std::max(a.left[0], b.left[0]), high = std::min(a.right[0], b.right[0]);
    if (!(low < high)) return std::nullopt;
    const double before = a.at(low) - b.at(low), after = a.at(high) - b.at(high);
    if (!(before * after < 0.0)) return std::nullopt;
    return low + (high - low) * (before / (before - after));
}

/// A convex piece of the plan: corners on its left, from below, and on its right, from below. One
/// of the two may be a single corner.
struct Piece {
    std::vector<uint32_t> left, right;
};

/// The plan, divided into pieces that share corners and sides.
struct Plan {
    std::vector<PlanPoint> corners;
    std::vector<Piece> pieces;
};

/// The corners on one line of equal first coordinates; the first has the number `first`.
struct PlanLine {
    Marks marks;
    uint32_t first;

    uint32_t corner(double v) const { return first + static_cast<uint32_t>(marks.nearest(v)); }
};

/// Replaces each coordinate by the mark that stands for it.
void snap(std::vector<Outline>& outlines, size_t axis) {
    std::vector<double> all;
    for (const Outline& outline : outlines)
        for (const PlanPoint& p : outline) all.push_back(p[axis]);
    const Marks marks(std::move(all));
    for (Outline& outline : outlines)
        for (PlanPoint& p : outline) p[axis] = marks[marks.nearest(p[axis])];
}

std::vector<Side> sides_of(const std::vector<Outline>& outlines) {
    std::vector<Side> sides;
    for (const Outline& outline : outlines)
        for (size_t i = 0; i < outline.size(); ++i) {
            const PlanPoint &a = outline[i], &b = outline[(i + 1) % outline.size()];
            if (a[0] != b[0]) sides.push_back(a[0] < b[0] ? Side{a, b} : Side{b, a});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.left, a.right) < std::tie(b.left, b.right);
    });
    return sides;
}

/// The first coordinates at which a side begins or ends, or two of them cross.
Marks cuts_of(const std::vector<Side>& sides) {
    std::vector<double> all;
    for (const Side& side : sides)
        for (const PlanPoint& p : {side.left, side.right}) all.push_back(p[0]);
    for (size_t i = 0; i < sides.size(); ++i)
        for (size_t k = i + 1; k < sides.size() && sides[k].left[0] < sides[i].right[0]; ++k)
            if (const auto u = crossing(sides[i], sides[k])) all.push_back(*u);
    return Marks(std::move(all));
}

/// The sides that pass between two neighbouring cuts.
std::vector<const Side*> between(const std::vector<Side>& sides, double low, double high) {
    std::vector<const Side*> found;
    const double middle = (low + high) / 2;
    for (const Side& side : sides)
        if (side.left[0] < middle && side.right[0] > middle) found.push_back(&side);
    return found;
}

/// All corners from one to another on the same line.
std::vector<uint32_t> corners_between(uint32_t low, uint32_t high) {
    std::vector<uint32_t> all;
    for (uint32_t i = low; i <= high; ++i) all.push_back(i);
    return all;
}

/// The plan between two neighbouring cuts: the sides that pass through it.
struct Strip {
    std::vector<const Side*> sides;
    double low, high;
};

std::vector<Strip> strips_of(const std::vector<Side>& sides, const Marks& cuts) {
    std::vector<Strip> strips;
    for (size_t i = 0; i + 1 < cuts.size(); ++i)
        strips.push_back({between(sides, cuts[i], cuts[i + 1]), cuts[i], cuts[i + 1]});
    return strips;
}

/// The lines at all cuts, with the corners at which sides of the strips on either side meet them.
std::vector<PlanLine> lines_of(const std::vector<Strip>& strips, const Marks& cuts, Plan& plan) {
    std::vector<PlanLine> lines;
    for (size_t i = 0; i < cuts.size(); ++i) {
        std::vector<double> meets;
        for (size_t k = i == 0 ? 0 : i - 1; k < std::min(i + 1, strips.size()); ++k)
            for (const Side* side : strips[k].sides) meets.push_back(side->at(cuts[i]));
        lines.push_back({Marks(std::move(meets)), static_cast<uint32_t>(plan.corners.size())});
        const Marks& marks = lines.back().marks;
        for (size_t k = 0; k < marks.size(); ++k) plan.corners.push_back({cuts[i], marks[k]});
    }
    return lines;
}

/// The corners of the sides of a strip on its left and right, from below.
///
/// Two sides that cross nearer to a cut than `same_within` can be in another order on its other
/// end: they then have the higher corner there. False if that moves one by more than `most_moved`.
bool find_ends(const Strip& strip, const PlanLine& left, const PlanLine& right, const Plan& plan,
               std::vector<std::array<uint32_t, 2>>& ends) {
    constexpr double most_moved = 1e-5; // mm
    for (const Side* side : strip.sides)
        ends.push_back({left.corner(side->at(strip.low)), right.corner(side->at(strip.high))});
    std::sort(ends.begin(), ends.end());
    for (size_t k = 1; k < ends.size(); ++k) {
        const uint32_t before = ends[k - 1][1], after = std::max(before, ends[k][1]);
        if (plan.corners[after][1] - plan.corners[ends[k][1]][1] > most_moved) return false;
        ends[k][1] = after;
    }
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    return true;
}

/// Empty if sides of the outlines nearly coincide, so that rounding does not tell which is above.
std::optional<Plan> plan_of(std::vector<Outline> outlines) {
    for (const size_t axis : {0, 1}) snap(outlines, axis);
    const std::vector<Side> sides = sides_of(outlines);
    const Marks cuts = cuts_of(sides);
    const std::vector<Strip> strips = strips_of(sides, cuts);
    Plan plan;
    const std::vector<PlanLine> lines = lines_of(strips, cuts, plan);
    for (size_t i = 0; i < strips.size(); ++i) {
        std::vector<std::array<uint32_t, 2>> ends;
        if (!find_ends(strips[i], lines[i], lines[i + 1], plan, ends)) return std::nullopt;
        for (size_t k = 0; k + 1 < ends.size(); ++k)
            plan.pieces.push_back({corners_between(ends[k][0], ends[k + 1][0]),
                                   corners_between(ends[k][1], ends[k + 1][1])});
    }
    return plan;
}

struct PlanBox {
    PlanPoint low, high;
};

PlanBox box_of(const Outline& outline) {
    PlanBox box{outline[0], outline[0]};
    for (const PlanPoint& p : outline)
        for (const size_t axis : {0, 1}) {
            box.low[axis] = std::min(box.low[axis], p[axis]);
            box.high[axis] = std::max(box.high[axis], p[axis]);
        }
    return box;
}

/// The middle of a piece.
PlanPoint middle_of(const Plan& plan, const Piece& piece) {
    PlanPoint sum{0.0, 0.0};
    for (const uint32_t corner :
         {piece.left.front(), piece.left.back(), piece.right.front(), piece.right.back()})
        for (const size_t axis : {0, 1}) sum[axis] += plan.corners[corner][axis] / 4;
    return sum;
}

bool contains(const Outline& outline, const PlanBox& box, const PlanPoint& p) {
    for (const size_t axis : {0, 1})
        if (p[axis] < box.low[axis] || p[axis] > box.high[axis]) return false;
    for (size_t i = 0; i < outline.size(); ++i) {
        const PlanPoint &a = outline[i], &b = outline[(i + 1) % outline.size()];
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) < 0.0) return false;
    }
    return true;
}

/// The triangles of a piece, counter-clockwise.
std::vector<core::Mesh::Corners> triangles_of(const Plan& plan, const Piece& piece) {
    std::vector<core::Mesh::Corners> triangles;
    size_t l = 0, r = 0;
    while (l + 1 < piece.left.size() || r + 1 < piece.right.size()) {
        const bool is_last_left = l + 1 == piece.left.size();
        const bool goes_right =
            is_last_left
            || (r + 1 < piece.right.size()
                && plan.corners[piece.right[r + 1]][1] <= plan.corners[piece.left[l + 1]][1]);
        if (goes_right) {
            triangles.push_back({piece.left[l], piece.right[r], piece.right[r + 1]});
            ++r;
        } else {
            triangles.push_back({piece.left[l], piece.right[r], piece.left[l + 1]});
            ++l;
        }
    }
    return triangles;
}

/// The border of a piece, counter-clockwise.
std::vector<uint32_t> border_of(const Piece& piece) {
    std::vector<uint32_t> border = piece.right;
    border.insert(border.end(), piece.left.rbegin(), piece.left.rend());
    return border;
}

/// Which layers of which pieces are filled.
class Filling {
public:
    Filling(size_t pieces, size_t layers) : layers_(layers), filled_(pieces * layers) {}
    void set(size_t piece, size_t layer, bool filled) { filled_[piece * layers_ + layer] = filled; }
    /// Layers beyond the ends are empty.
    bool at(size_t piece, size_t layer) const {
        return layer < layers_ && filled_[piece * layers_ + layer];
    }
    size_t layers() const { return layers_; }

private:
    size_t layers_;
    std::vector<bool> filled_;
};

/// Which layers of which pieces are filled, after all prisms in turn.
Filling filling_of(const std::vector<PresetPrism>& prisms, const Plan& plan, const Marks& heights) {
    Filling filling(plan.pieces.size(), heights.size() - 1);
    std::vector<PlanBox> boxes;
    for (const PresetPrism& prism : prisms) boxes.push_back(box_of(prism.outline));
    for (size_t piece = 0; piece < plan.pieces.size(); ++piece) {
        const PlanPoint middle = middle_of(plan, plan.pieces[piece]);
        for (size_t i = 0; i < prisms.size(); ++i) {
            const PresetPrism& prism = prisms[i];
            if (!contains(prism.outline, boxes[i], middle)) continue;
            const size_t end = heights.nearest(prism.high);
            for (size_t layer = heights.nearest(prism.low); layer < end; ++layer)
                filling.set(piece, layer, prism.fills);
        }
    }
    return filling;
}

/// Makes the mesh, with vertices for those corners at those heights that are used.
class SurfaceBuilder {
public:
    SurfaceBuilder(const Plan& plan, const Marks& heights, int axis)
        : plan_(plan), heights_(heights), axis_(axis) {}

    void add(uint32_t a, size_t height_a, uint32_t b, size_t height_b, uint32_t c,
             size_t height_c) {
        mesh_.triangles.push_back({vertex(a, height_a), vertex(b, height_b), vertex(c, height_c)});
    }

    core::Mesh mesh() && { return std::move(mesh_); }

private:
    uint32_t vertex(uint32_t corner, size_t height) {
        const auto [at, is_new] =
            numbers_.try_emplace({corner, height}, static_cast<uint32_t>(mesh_.vertices.size()));
        if (is_new) {
            core::Vec3 p(0.0);
            p[axis_] = heights_[height];
            p[(axis_ + 1) % 3] = plan_.corners[corner][0];
            p[(axis_ + 2) % 3] = plan_.corners[corner][1];
            mesh_.vertices.push_back(p);
        }
        return at->second;
    }

    const Plan& plan_;
    const Marks& heights_;
    int axis_;
    std::map<std::pair<uint32_t, size_t>, uint32_t> numbers_;
    core::Mesh mesh_;
};

/// The faces across the axis, where a filled layer meets an empty one.
void add_faces(SurfaceBuilder& surface, const Plan& plan, const Filling& filling) {
    for (size_t piece = 0; piece < plan.pieces.size(); ++piece)
        for (size_t height = 0; height <= filling.layers(); ++height) {
            const bool below = height > 0 && filling.at(piece, height - 1);
            const bool above = filling.at(piece, height);
            if (below == above) continue;
            for (const auto& [a, b, c] : triangles_of(plan, plan.pieces[piece]))
                below ? surface.add(a, height, b, height, c, height)
                      : surface.add(a, height, c, height, b, height);
        }
}

/// The faces along the axis, where a filled piece meets an empty one or the outside.
void add_walls(SurfaceBuilder& surface, const Plan& plan, const Filling& filling) {
    // The piece on the left of each side, by its ends.
    std::map<std::pair<uint32_t, uint32_t>, size_t> piece_at;
    for (size_t piece = 0; piece < plan.pieces.size(); ++piece) {
        const std::vector<uint32_t> border = border_of(plan.pieces[piece]);
        for (size_t i = 0; i < border.size(); ++i)
            piece_at[{border[i], border[(i + 1) % border.size()]}] = piece;
    }
    for (const auto& [ends, piece] : piece_at) {
        const auto [a, b] = ends;
        const auto beyond = piece_at.find({b, a});
        for (size_t layer = 0; layer < filling.layers(); ++layer) {
            const bool is_wall =
                filling.at(piece, layer)
                && (beyond == piece_at.end() || !filling.at(beyond->second, layer));
            if (!is_wall) continue;
            surface.add(a, layer, b, layer, b, layer + 1);
            surface.add(a, layer, b, layer + 1, a, layer + 1);
        }
    }
}

/// Whether each edge has one triangle on either side, each vertex one ring of triangles around it,
/// and all triangles are connected.
bool is_single_solid(const core::Mesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> uses; // the corner 3 t + k at its start
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (uint32_t k = 0; k < 3; ++k) {
            const auto& corners = mesh.triangles[t];
            if (!uses.try_emplace({corners[k], corners[(k + 1) % 3]}, 3 * t + k).second)
                return false;
        }
    // Corners of triangles that meet at an edge belong to one ring.
    core::UnionFind rings(3 * mesh.triangles.size()), pieces(mesh.triangles.size());
    for (const auto& [edge, corner] : uses) {
        const auto other = uses.find({edge.second, edge.first});
        if (other == uses.end()) return false;
        const uint32_t next = other->second % 3 == 2 ? other->second - 2 : other->second + 1;
        rings.join(corner, next);
        pieces.join(corner / 3, other->second / 3);
    }
    size_t ring_count = 0;
    for (uint32_t corner = 0; corner < 3 * mesh.triangles.size(); ++corner)
        if (rings.root(corner) == corner) ++ring_count;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        if (pieces.root(t) != pieces.root(0)) return false;
    return ring_count == mesh.vertices.size();
}

/// The corners of a polygon of `count` sides in the first quadrant, those with both coordinates not
/// below 0, the first at half a side or at a whole one from the first axis.
Outline circle_of(const PlanPoint& centre, double radius, size_t count, double first) {
    // One quadrant is computed, and the others mirror it, so that opposite corners agree exactly.
    Outline quadrant;
    for (size_t i = 0; i < count / 4; ++i) {
        const double angle =
            2.0 * std::numbers::pi * (static_cast<double>(i) + first) / static_cast<double>(count);
        quadrant.push_back({radius * core::cos(angle), radius * core::sin(angle)});
    }
    Outline all;
    for (const auto& [c, s] :
         {PlanPoint{1, 0}, PlanPoint{0, 1}, PlanPoint{-1, 0}, PlanPoint{0, -1}})
        for (const PlanPoint& p : turned(quadrant, c, s))
            all.push_back({centre[0] + p[0], centre[1] + p[1]});
    return all;
}

/// The number of sides, a multiple of 4, for which a polygon is within `round_deviation` of a
/// circle on either side.
size_t side_count(double radius) {
    size_t count = 8;
    while (radius / core::cos(std::numbers::pi / static_cast<double>(count)) - radius
           > round_deviation)
        count += 4;
    return count;
}

} // namespace

Outline rectangle(const PlanPoint& low, const PlanPoint& high) {
    return {low, {high[0], low[1]}, high, {low[0], high[1]}};
}

Outline around_circle(const PlanPoint& centre, double radius) {
    const size_t count = side_count(radius);
    const double outer = radius / core::cos(std::numbers::pi / static_cast<double>(count));
    Outline outline = circle_of({0.0, 0.0}, outer, count, 0.5);
    // The sides across the axes are at the radius exactly.
    for (PlanPoint& p : outline) {
        for (double& x : p)
            if (std::abs(std::abs(x) - radius) < 1e-9 * radius) x = std::copysign(radius, x);
        p = {centre[0] + p[0], centre[1] + p[1]};
    }
    return outline;
}

Outline within_circle(const PlanPoint& centre, double radius) {
    return circle_of(centre, radius, side_count(radius), 0.0);
}

Outline hexagon(const PlanPoint& centre, double across) {
    const double half = across / 2, corner = across / std::sqrt(3.0);
    Outline outline{{corner, 0.0},  {corner / 2, half},   {-corner / 2, half},
                    {-corner, 0.0}, {-corner / 2, -half}, {corner / 2, -half}};
    for (PlanPoint& p : outline) p = {centre[0] + p[0], centre[1] + p[1]};
    return outline;
}

Outline turned(Outline outline, double cosine, double sine) {
    for (PlanPoint& p : outline) p = {cosine * p[0] - sine * p[1], sine * p[0] + cosine * p[1]};
    return outline;
}

void PresetSolid::add(Outline outline, double low, double high) {
    if (low < high) prisms_.push_back({std::move(outline), low, high, true});
}

void PresetSolid::cut(Outline outline, double low, double high) {
    if (low < high) prisms_.push_back({std::move(outline), low, high, false});
}

core::Result<core::Mesh> PresetSolid::mesh() const {
    const auto fail = [](const char* why) {
        return core::fail(core::ErrorCode::invalid_value, why);
    };
    std::vector<Outline> outlines;
    std::vector<double> ends;
    for (const PresetPrism& prism : prisms_) {
        outlines.push_back(prism.outline);
        ends.insert(ends.end(), {prism.low, prism.high});
    }
    if (outlines.empty()) return fail("with these sizes nothing is left");
    const Marks heights(std::move(ends));
    const auto plan = plan_of(std::move(outlines));
    if (!plan) return fail("some of these sizes nearly agree: change one of them by 0.001 mm");
    const Filling filling = filling_of(prisms_, *plan, heights);
    SurfaceBuilder surface(*plan, heights, axis_);
    add_faces(surface, *plan, filling);
    add_walls(surface, *plan, filling);
    core::Mesh mesh = std::move(surface).mesh();
    if (mesh.triangles.empty()) return fail("with these sizes nothing is left");
    if (!is_single_solid(mesh))
        return fail("these sizes give several bodies, or parts that touch along an edge only");
    return mesh;
}

} // namespace app
