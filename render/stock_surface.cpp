#include "render/stock_surface.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/math.h"
#include "core/dbm/dual_cell.h"
#include "render/triangle_mesh.h"

namespace render {
namespace {

using core::CrossedEdge;
using core::Vec3;

constexpr int side = BrickWorkspace::side;
constexpr size_t nodes = static_cast<size_t>(side) * side * side;
constexpr int32_t nowhere = -1;
static_assert(side == lattice_side);
using GridNode = std::array<int, 3>;

constexpr size_t row(int j, int k) {
    return static_cast<size_t>(j) + static_cast<size_t>(k) * side;
}
constexpr size_t at(const GridNode& n) {
    return static_cast<size_t>(n[0]) + static_cast<size_t>(side) * row(n[1], n[2]);
}
constexpr size_t step_of(size_t axis) {
    constexpr std::array<size_t, 3> steps = {1, side, static_cast<size_t>(side) * side};
    return steps[axis];
}

/// A cell around an edge, and the number of the edge in that cell. Cells are listed
/// counter-clockwise, seen from the end of the edge.
struct Around {
    GridNode cell;
    uint8_t edge;
};
constexpr std::array<std::array<Around, 4>, 3> cells_around = {
    {{{{{0, -1, -1}, 3}, {{0, 0, -1}, 2}, {{0, 0, 0}, 0}, {{0, -1, 0}, 1}}},
     {{{{-1, 0, -1}, 7}, {{-1, 0, 0}, 5}, {{0, 0, 0}, 4}, {{0, 0, -1}, 6}}},
     {{{{-1, -1, 0}, 11}, {{0, -1, 0}, 10}, {{0, 0, 0}, 8}, {{-1, 0, 0}, 9}}}}};

/// The edges in the face of a cell towards lower values of an axis, and their numbers in the
/// adjacent cell.
struct Shared {
    uint8_t here, there;
};
constexpr std::array<std::array<Shared, 4>, 3> side_edges = {{{{{4, 5}, {6, 7}, {8, 9}, {10, 11}}},
                                                              {{{0, 1}, {2, 3}, {8, 10}, {9, 11}}},
                                                              {{{0, 2}, {1, 3}, {4, 6}, {5, 7}}}}};

/// A piece of the surface in a cell: its vertex and the edges that it passes through.
struct Piece {
    Vec3 position;
    std::array<int32_t, 12> edges{};
    size_t count = 0;
    bool flat = true;               // one normal everywhere
    int32_t first_vertex = nowhere; // first of the vertices at its position, one for each normal
};

class BrickContour {
public:
    BrickContour(const core::CutModel& model, const GridNode& brick, BrickMemory& memory,
                 BrickWorkspace& workspace)
        : model_(model),
          grid_(model.lines.grid),
          bounds_(core::bounds(model.solid)),
          memory_(memory),
          room_(workspace) {
        for (size_t i = 0; i < 3; ++i) first_[i] = brick_cells * brick[i] - 1;
    }

    StockBrick run();

private:
    GridNode global(const GridNode& n) const {
        return {first_[0] + n[0], first_[1] + n[1], first_[2] + n[2]};
    }
    bool is_inside(const GridNode& n) const {
        return (room_.inside[row(n[1], n[2])] >> n[0] & 1U) != 0;
    }
    void vote(int axis);
    bool mark_inside();
    void cross_edges();
    void cross(int axis, const GridNode& node, std::vector<BrickMemory::Known>& now, size_t& next);
    void make_cells();
    void make_cell(const GridNode& cell, uint8_t corners);
    void add_quads();
    void add_quad(size_t axis, size_t node, const CrossedEdge& edge);
    Piece& piece_at(size_t cell, uint8_t edge);
    uint32_t corner(Piece& piece, const CrossedEdge& edge, uint8_t tint);
    void add_creases();
    void add_crease(size_t axis, size_t cell);
    uint32_t block_of(const CrossedEdge& edge) const {
        return edge.sweep ? model_.log.block(*edge.sweep) : StockBrick::raw;
    }
    const CrossedEdge& edge(int32_t number) const {
        return memory_.edges[static_cast<size_t>(number)].crossing;
    }

    const core::CutModel& model_;
    const core::ScanGrid& grid_;
    core::Aabb bounds_;
    BrickMemory& memory_;
    BrickWorkspace& room_;
    GridNode first_{}; // global number of the lowest node
    std::vector<Piece> pieces_;
    std::vector<size_t> cells_; // those with pieces
    std::vector<int32_t> next_vertex_;
    StockBrick result_;
    std::vector<LatticeQuad> quads_; // of the result
};

/// Marks the nodes inside according to the lines along an axis.
void BrickContour::vote(int axis) {
    auto& votes = room_.votes[static_cast<size_t>(axis)];
    votes.assign(static_cast<size_t>(side) * side, 0);
    const core::ScanLines& family = model_.lines.families[static_cast<size_t>(axis)];
    const auto ua = static_cast<size_t>(core::u_axis(axis));
    const auto va = static_cast<size_t>(core::v_axis(axis));
    const int start = first_[static_cast<size_t>(axis)] - 1; // scan line of node 0
    GridNode n{};
    for (n[va] = 0; n[va] < side; ++n[va])
        for (n[ua] = 0; n[ua] < side; ++n[ua]) {
            const int u = first_[ua] + n[ua] - 1, v = first_[va] + n[va] - 1;
            if (u < 0 || v < 0 || u >= family.u_count() || v >= family.v_count()) continue;
            for (const core::Interval& matter : family.line(u, v)) {
                const core::IndexRange all = core::lines_within(grid_, axis, matter);
                const int low = std::max(all.first - start, 0);
                const int high = std::min(all.last - start, side - 1);
                if (low > high) continue;
                if (axis == 0)
                    votes[row(n[1], n[2])] |= ((uint64_t{2} << (high - low)) - 1) << low;
                else if (axis == 1)
                    for (int j = low; j <= high; ++j) votes[row(j, n[2])] |= uint64_t{1} << n[0];
                else
                    for (int k = low; k <= high; ++k) votes[row(n[1], k)] |= uint64_t{1} << n[0];
            }
        }
}

/// A node is inside if most of its lines are. Returns whether there can be any surface.
bool BrickContour::mark_inside() {
    for (int axis = 0; axis < 3; ++axis) vote(axis);
    room_.inside.resize(static_cast<size_t>(side) * side);
    constexpr uint64_t full = (uint64_t{1} << side) - 1;
    bool any = false, all = true;
    for (size_t i = 0; i < room_.inside.size(); ++i) {
        const uint64_t x = room_.votes[0][i], y = room_.votes[1][i], z = room_.votes[2][i];
        room_.inside[i] = (x & y) | (y & z) | (z & x);
        any = any || room_.inside[i] != 0;
        all = all && room_.inside[i] == full;
    }
    return any && !all;
}

/// The surface where a line crosses it; a known result for the same end is reused.
void BrickContour::cross(int axis, const GridNode& node, std::vector<BrickMemory::Known>& now,
                         size_t& next) {
    const auto number = static_cast<uint32_t>(at(node) + nodes * static_cast<size_t>(axis));
    const core::Crossing crossing =
        core::crossing_at(model_.lines, axis, global(node), is_inside(node));
    while (next < memory_.edges.size() && memory_.edges[next].edge < number) ++next;
    room_.edges[static_cast<size_t>(axis)][at(node)] = static_cast<int32_t>(now.size());
    if (next < memory_.edges.size() && crossing.found) {
        const BrickMemory::Known& known = memory_.edges[next];
        if (known.edge == number && known.along == crossing.along && known.found
            && known.upper == crossing.end.upper
            && known.crossing.sweep == core::sweep_at(model_, crossing.end)) {
            now.push_back(known);
            return;
        }
    }
    now.push_back({number, crossing.along, crossing.found, crossing.end.upper,
                   core::crossed_edge(model_, crossing)});
}

void BrickContour::cross_edges() {
    std::vector<BrickMemory::Known> now;
    now.reserve(memory_.edges.size() + 64);
    size_t next = 0;
    for (auto& edges : room_.edges) edges.assign(nodes, nowhere);
    constexpr uint64_t inner = (uint64_t{1} << (side - 1)) - 1;
    for (int axis = 0; axis < 3; ++axis)
        for (int k = 0; k < side - (axis == 2 ? 1 : 0); ++k)
            for (int j = 0; j < side - (axis == 1 ? 1 : 0); ++j) {
                const uint64_t here = room_.inside[row(j, k)];
                uint64_t differ = axis == 0   ? (here ^ here >> 1) & inner
                                  : axis == 1 ? here ^ room_.inside[row(j + 1, k)]
                                              : here ^ room_.inside[row(j, k + 1)];
                for (; differ != 0; differ &= differ - 1)
                    cross(axis, {std::countr_zero(differ), j, k}, now, next);
            }
    memory_.edges = std::move(now);
}

void BrickContour::make_cells() {
    room_.cells.assign(nodes, nowhere);
    room_.corners.assign(nodes, 0);
    constexpr uint64_t inner = (uint64_t{1} << (side - 1)) - 1;
    for (int k = 0; k + 1 < side; ++k)
        for (int j = 0; j + 1 < side; ++j) {
            const std::array<uint64_t, 4> rows = {
                room_.inside[row(j, k)], room_.inside[row(j + 1, k)], room_.inside[row(j, k + 1)],
                room_.inside[row(j + 1, k + 1)]};
            const uint64_t any = rows[0] | rows[1] | rows[2] | rows[3];
            const uint64_t all = rows[0] & rows[1] & rows[2] & rows[3];
            uint64_t passed = (any | any >> 1) & ~(all & all >> 1) & inner;
            for (; passed != 0; passed &= passed - 1) {
                const int i = std::countr_zero(passed);
                unsigned corners = 0;
                for (unsigned r = 0; r < 4; ++r)
                    corners |= static_cast<unsigned>(rows[r] >> i & 3U) << (2 * r);
                make_cell({i, j, k}, static_cast<uint8_t>(corners));
            }
        }
}

void BrickContour::make_cell(const GridNode& cell, uint8_t corners) {
    const core::DualCell& dual = core::dual_cell(corners);
    room_.cells[at(cell)] = static_cast<int32_t>(pieces_.size());
    room_.corners[at(cell)] = corners;
    cells_.push_back(at(cell));
    const core::Aabb room = core::vertex_room(grid_, bounds_, global(cell));
    for (uint8_t number = 0; number < dual.count; ++number) {
        Piece piece;
        std::array<core::TangentPlane, 12> planes;
        for (size_t e = 0; e < 12; ++e) {
            if (dual.piece[e] != number) continue;
            const unsigned low = core::cell_edges[e].lower;
            const size_t node =
                at(cell) + (low & 1U) + (low >> 1U & 1U) * step_of(1) + (low >> 2U) * step_of(2);
            piece.edges[piece.count] = room_.edges[e / 4][node];
            planes[piece.count] = edge(piece.edges[piece.count]).plane;
            piece.flat = piece.flat && planes[piece.count].normal == planes[0].normal;
            ++piece.count;
        }
        piece.position = core::feature_point({planes.data(), piece.count}, room);
        pieces_.push_back(piece);
    }
}

Piece& BrickContour::piece_at(size_t cell, uint8_t edge) {
    const uint8_t piece = core::dual_cell(room_.corners[cell]).piece[edge];
    return pieces_[static_cast<size_t>(room_.cells[cell]) + piece];
}

/// The vertex of a piece for a quad: its normal is the mean of those in the piece within the crease
/// angle of the quad's own.
uint32_t BrickContour::corner(Piece& piece, const CrossedEdge& edge_of_quad, uint8_t tint) {
    static const double limit = core::cos(crease_angle);
    Vec3 sum = edge_of_quad.plane.normal;
    if (!piece.flat) {
        sum = Vec3(0.0);
        for (size_t i = 0; i < piece.count; ++i) {
            const Vec3& normal = edge(piece.edges[i]).plane.normal;
            if (glm::dot(normal, edge_of_quad.plane.normal) >= limit) sum += normal;
        }
        sum /= std::max(glm::length(sum), 1e-9);
    }
    const auto packed = packed_normal(sum);
    for (int32_t v = piece.first_vertex; v != nowhere; v = next_vertex_[static_cast<size_t>(v)]) {
        const MeshVertex& made = result_.mesh.vertices[static_cast<size_t>(v)];
        if (made.normal == packed && made.tint == tint) return static_cast<uint32_t>(v);
    }
    const auto vertex = static_cast<int32_t>(result_.mesh.vertices.size());
    result_.mesh.vertices.push_back({glm::vec3(piece.position), packed, tint});
    next_vertex_.push_back(piece.first_vertex);
    piece.first_vertex = vertex;
    return static_cast<uint32_t>(vertex);
}

void BrickContour::add_quad(size_t axis, size_t node, const CrossedEdge& crossed) {
    std::array<uint32_t, 4> corners{};
    std::array<Vec3, 4> positions;
    bool flat = true;
    const uint8_t tint = crossed.sweep ? 1 : 0;
    for (size_t i = 0; i < 4; ++i) {
        const Around& around = cells_around[axis][i];
        size_t cell = node;
        for (size_t a = 0; a < 3; ++a)
            if (around.cell[a] < 0) cell -= step_of(a);
        Piece& piece = piece_at(cell, around.edge);
        corners[i] = corner(piece, crossed, tint);
        positions[i] = piece.position;
        flat = flat && piece.flat;
    }
    const bool upwards = (room_.inside[node / side] >> (node % side) & 1U) != 0;
    if (!upwards) {
        std::swap(corners[1], corners[3]);
        std::swap(positions[1], positions[3]);
    }
    // All planes coincide: the point is on both triangles for either diagonal.
    const size_t k = flat ? 0 : core::better_diagonal(positions, crossed.plane.position).from;
    result_.mesh.triangles.push_back({corners[k], corners[k + 1], corners[k + 2]});
    result_.mesh.triangles.push_back({corners[k], corners[k + 2], corners[(k + 3) % 4]});
    result_.blocks.push_back(block_of(crossed));
    const auto part = [](size_t n) { return static_cast<uint8_t>(n % side); };
    quads_.push_back({static_cast<uint8_t>(axis),
                      {part(node), part(node / side), part(node / (size_t{side} * side))},
                      flat});
    for (const Vec3& position : positions) result_.mesh.bounds.extend(position);
}

/// Quads belong to the brick in which their edge begins; the first nodes of a brick belong to its
/// neighbour.
void BrickContour::add_quads() {
    for (const BrickMemory::Known& known : memory_.edges) {
        const size_t axis = known.edge / nodes, node = known.edge % nodes;
        const GridNode n = {static_cast<int>(node % side), static_cast<int>(node / side % side),
                            static_cast<int>(node / (static_cast<size_t>(side) * side))};
        if (std::all_of(n.begin(), n.end(), [](int i) { return i > 0 && i <= brick_cells; }))
            add_quad(axis, node, known.crossing);
    }
}

/// A feature line from the piece of a cell to that of the previous one along the axis, if the
/// surface bends at the face between them.
void BrickContour::add_crease(size_t axis, size_t cell) {
    static const double limit = core::cos(crease_angle);
    const size_t other = cell - step_of(axis);
    if (room_.cells[other] == nowhere) return;
    const core::DualCell& dual = core::dual_cell(room_.corners[cell]);
    for (uint8_t number = 0; number < dual.count; ++number) {
        std::array<Shared, 4> passed{};
        size_t count = 0;
        for (const Shared& shared : side_edges[axis])
            if (dual.piece[shared.here] == number) passed[count++] = shared;
        if (count != 2) continue;
        const Piece& here = piece_at(cell, passed[0].here);
        const Piece& there = piece_at(other, passed[0].there);
        const auto normal = [&](const Shared& shared) {
            const unsigned low = core::cell_edges[shared.here].lower;
            const size_t node =
                cell + (low & 1U) + (low >> 1U & 1U) * step_of(1) + (low >> 2U) * step_of(2);
            return edge(room_.edges[shared.here / 4U][node]).plane.normal;
        };
        if (glm::dot(normal(passed[0]), normal(passed[1])) < limit)
            result_.mesh.edges.push_back({glm::vec3(here.position), glm::vec3(there.position)});
    }
}

void BrickContour::add_creases() {
    for (const size_t cell : cells_) {
        const GridNode n = {static_cast<int>(cell % side), static_cast<int>(cell / side % side),
                            static_cast<int>(cell / (static_cast<size_t>(side) * side))};
        if (std::any_of(n.begin(), n.end(), [](int i) { return i == 0; })) continue;
        for (size_t axis = 0; axis < 3; ++axis) add_crease(axis, cell);
    }
}

StockBrick BrickContour::run() {
    result_.mesh.closed = false;
    if (!mark_inside()) {
        memory_.edges.clear();
        return std::move(result_);
    }
    cross_edges();
    make_cells();
    add_quads();
    add_creases();
    result_.drawn = with_large_faces(result_.mesh, quads_);
    return std::move(result_);
}

} // namespace

StockBrick contour_brick(const core::CutModel& model, const std::array<int, 3>& brick,
                         BrickMemory& memory, BrickWorkspace& workspace) {
    return BrickContour(model, brick, memory, workspace).run();
}

namespace {

using core::Interval;
using core::ScanLines;

/// One end of an interval, with its mark.
struct MarkedEnd {
    double along;
    uint32_t mark;
    uint8_t tilt;

    bool operator==(const MarkedEnd&) const = default;
};

/// The ends on a line, upwards; caches the last line.
class LineEnds {
public:
    LineEnds(const ScanLines& lines, int u, int v)
        : lines_(lines), line_(lines.line(u, v)), u_(u), v_(v) {}

    size_t size() const { return 2 * line_.size(); }
    MarkedEnd operator[](size_t i) const {
        const Interval matter = line_[i / 2];
        const core::EndMarks marks = lines_.marks(u_, v_, i / 2);
        return i % 2 == 0 ? MarkedEnd{matter.lower, marks.lower, marks.lower_tilt}
                          : MarkedEnd{matter.upper, marks.upper, marks.upper_tilt};
    }

private:
    const ScanLines& lines_;
    core::LineView line_;
    int u_, v_;
};

/// The range in which two states of a line differ; empty if equal.
std::optional<Interval> changed(const ScanLines& was, const ScanLines& is, int u, int v) {
    const LineEnds a(was, u, v), b(is, u, v);
    const size_t common = std::min(a.size(), b.size());
    size_t front = 0, back = 0;
    while (front < common && a[front] == b[front]) ++front;
    if (front == a.size() && front == b.size()) return std::nullopt;
    while (back < common - front && a[a.size() - 1 - back] == b[b.size() - 1 - back]) ++back;
    Interval range{core::infinity, -core::infinity};
    for (const LineEnds* ends : {&a, &b}) {
        if (front >= ends->size() - back) continue;
        range.lower = std::min(range.lower, (*ends)[front].along);
        range.upper = std::max(range.upper, (*ends)[ends->size() - 1 - back].along);
    }
    return range;
}

/// The bricks that contain any of the nodes first .. last along one axis.
core::IndexRange bricks_with(int first, int last, int count) {
    const auto floor_div = [](int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); };
    return {std::max(0, -floor_div(brick_cells - first, brick_cells)),
            std::min(count - 1, floor_div(last + 1, brick_cells))};
}

/// Marks the bricks affected by a change of one family of lines.
class TouchedBricks {
public:
    TouchedBricks(const core::ScanGrid& grid, const std::array<int, 3>& counts)
        : grid_(grid),
          counts_(counts),
          touched_(static_cast<size_t>(counts[0]) * static_cast<size_t>(counts[1])
                       * static_cast<size_t>(counts[2]),
                   0) {}

    void compare(const ScanLines& was, const ScanLines& is);
    const std::vector<uint8_t>& touched() const { return touched_; }

private:
    void touch(int axis, int u, int v, const Interval& range);

    const core::ScanGrid& grid_;
    std::array<int, 3> counts_;
    std::vector<uint8_t> touched_;
};

void TouchedBricks::compare(const ScanLines& was, const ScanLines& is) {
    constexpr int tile = ScanLines::tile_side;
    for (int v0 = 0; v0 < is.v_count(); v0 += tile)
        for (int u0 = 0; u0 < is.u_count(); u0 += tile) {
            if (was.shares_tile(is, u0, v0)) continue;
            for (int v = v0; v < std::min(v0 + tile, is.v_count()); ++v)
                for (int u = u0; u < std::min(u0 + tile, is.u_count()); ++u)
                    if (const auto range = changed(was, is, u, v)) touch(is.axis(), u, v, *range);
        }
}

void TouchedBricks::touch(int axis, int u, int v, const Interval& range) {
    std::array<core::IndexRange, 3> bricks;
    const auto position = [&](int along) { return static_cast<size_t>(along); };
    const auto node = [&](double x) { // whose line is at or below x
        const double lines = (x - grid_.coordinate(axis, 0)) / grid_.spacing;
        return static_cast<int>(std::floor(
                   std::clamp(lines, -2.0, static_cast<double>(grid_.count(axis)) + 2.0)))
               + 1;
    };
    // Two more nodes: an end slightly beyond an edge counts as on the edge.
    bricks[position(axis)] =
        bricks_with(node(range.lower) - 1, node(range.upper) + 2, counts_[position(axis)]);
    bricks[position(core::u_axis(axis))] =
        bricks_with(u + 1, u + 1, counts_[position(core::u_axis(axis))]);
    bricks[position(core::v_axis(axis))] =
        bricks_with(v + 1, v + 1, counts_[position(core::v_axis(axis))]);
    for (int k = bricks[2].first; k <= bricks[2].last; ++k)
        for (int j = bricks[1].first; j <= bricks[1].last; ++j)
            for (int i = bricks[0].first; i <= bricks[0].last; ++i)
                touched_[position(i + counts_[0] * (j + counts_[1] * k))] = 1;
}

} // namespace

void StockSurface::reset() {
    started_ = false;
    lines_ = {};
    memory_.clear();
    bricks_.clear();
    shown_.clear();
}

bool StockSurface::is_same_grid(const core::CutModel& model) const {
    if (!started_ || !(lines_.grid == model.lines.grid)) return false;
    for (size_t i = 0; i < 3; ++i)
        if (lines_.families[i].u_count() != model.lines.families[i].u_count()
            || lines_.families[i].v_count() != model.lines.families[i].v_count())
            return false;
    return true;
}

void StockSurface::start(const core::CutModel& model) {
    reset();
    for (size_t i = 0; i < 3; ++i) // cells 0 .. count, quads at nodes 0 .. count
        counts_[i] = model.lines.grid.count(static_cast<int>(i)) / brick_cells + 1;
    const size_t count = static_cast<size_t>(counts_[0]) * static_cast<size_t>(counts_[1])
                         * static_cast<size_t>(counts_[2]);
    memory_.resize(count);
    bricks_.resize(count);
    started_ = true;
}

size_t StockSurface::update(const core::CutModel& model) {
    const bool all = !is_same_grid(model);
    if (all) start(model);
    TouchedBricks changes(model.lines.grid, counts_);
    if (!all)
        for (size_t i = 0; i < 3; ++i) changes.compare(lines_.families[i], model.lines.families[i]);
    lines_ = model.lines;
    size_t made = 0;
    for (int k = 0; k < counts_[2]; ++k)
        for (int j = 0; j < counts_[1]; ++j)
            for (int i = 0; i < counts_[0]; ++i) {
                const auto brick = static_cast<size_t>(i + counts_[0] * (j + counts_[1] * k));
                if (!all && changes.touched()[brick] == 0) continue;
                StockBrick surface = contour_brick(model, {i, j, k}, memory_[brick], workspace_);
                bricks_[brick] = surface.blocks.empty()
                                     ? nullptr
                                     : std::make_shared<const StockBrick>(std::move(surface));
                ++made;
            }
    if (made == 0) return 0;
    shown_.clear();
    for (const auto& brick : bricks_)
        if (brick) shown_.push_back(brick);
    return made;
}

} // namespace render
