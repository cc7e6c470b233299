#include "core/dbm/stock_mesh.h"

#include <algorithm>
#include <cmath>

#include "core/dbm/contour.h"
#include "core/dbm/cut_model.h"
#include "core/dbm/dual_cell.h"

namespace core {
namespace {

constexpr int32_t no_vertex = -1;

/// Nodes with the same z: where the lines of the three families meet. Node (i, j) is on the
/// lines i - 1 and j - 1; the border nodes have no lines and are outside.
struct NodeLayer {
    std::vector<uint8_t> inside;
    std::array<std::vector<int32_t>, 2> edges; // along X, Y from each node: number of its point
    std::vector<CrossedEdge> points;
};

/// Cells between two layers of nodes; cell (i, j) has node (i, j) as its lowest corner.
struct CellLayer {
    std::vector<uint8_t> inside;       // a bit for each corner
    std::vector<int32_t> first_vertex; // of its pieces
    std::vector<int32_t> z_edges;      // from each node of the lower layer
    std::vector<CrossedEdge> points;
};

using EdgePoints = std::array<const CrossedEdge*, 12>;

const CrossedEdge* point_of(const std::vector<CrossedEdge>& points, int32_t number) {
    return number == no_vertex ? nullptr : &points[static_cast<size_t>(number)];
}

class Contouring {
public:
    explicit Contouring(const CutModel& model)
        : model_(model),
          grid_(model.lines.grid),
          bounds_(bounds(model.solid)),
          width_(grid_.count(0) + 2),
          depth_(grid_.count(1) + 2),
          size_(static_cast<size_t>(width_ * depth_)) {}

    StockMesh run();

private:
    size_t at(int i, int j) const { return static_cast<size_t>(i + j * width_); }
    decltype(auto) line(int axis, int u, int v) const {
        return model_.lines.families[static_cast<size_t>(axis)].line(u, v);
    }

    NodeLayer nodes(int k);
    CellLayer cells(const NodeLayer& below, const NodeLayer& above, int k);
    int32_t cross(int axis, const std::array<int, 3>& node, bool from_inside,
                  std::vector<CrossedEdge>& points);
    void make_vertices(CellLayer& layer, const NodeLayer& below, const NodeLayer& above, int i,
                       int j, int k);
    EdgePoints points_of(const CellLayer& layer, const NodeLayer& below, const NodeLayer& above,
                         int i, int j) const;
    void add_flat_quads(const NodeLayer& nodes, const CellLayer& below, const CellLayer& above);
    void add_upright_quads(const CellLayer& layer);
    int32_t vertex(const CellLayer& layer, int i, int j, size_t edge) const;
    void measure_error();
    void add_quad(std::array<int32_t, 4> corners, const CrossedEdge& edge, bool upwards);

    const CutModel& model_;
    const ScanGrid& grid_;
    Aabb bounds_;
    int width_, depth_;
    size_t size_;
    StockMesh result_;
    std::vector<double> from_own_triangles_; // of each sample, mm
    size_t taken_ = 0;                       // boundary points that became part of the surface
};

/// A node is inside if at least two of its three lines are: they may differ by rounding.
NodeLayer Contouring::nodes(int k) {
    NodeLayer layer;
    layer.inside.assign(size_, 0);
    for (auto& edges : layer.edges) edges.assign(size_, no_vertex);
    const int row = k - 1;
    if (row < 0 || row >= grid_.count(2)) return layer;
    const auto mark_inside = [&](int axis, const LineView& line, const auto& mark) {
        for (const Interval& matter : line) {
            const IndexRange range = lines_within(grid_, axis, matter);
            for (int i = range.first; i <= range.last; ++i) mark(i);
        }
    };
    for (int j = 0; j < grid_.count(1); ++j)
        mark_inside(0, line(0, j, row), [&](int i) { ++layer.inside[at(i + 1, j + 1)]; });
    for (int i = 0; i < grid_.count(0); ++i)
        mark_inside(1, line(1, row, i), [&](int j) { ++layer.inside[at(i + 1, j + 1)]; });
    const double z = grid_.coordinate(2, row);
    for (int j = 0; j < grid_.count(1); ++j)
        for (int i = 0; i < grid_.count(0); ++i)
            layer.inside[at(i + 1, j + 1)] += line(2, i, j).contains(z);
    for (uint8_t& votes : layer.inside) votes = votes >= 2;
    for (int j = 0; j < depth_; ++j)
        for (int i = 0; i < width_; ++i) {
            const bool here = layer.inside[at(i, j)] != 0;
            if (i + 1 < width_ && here != (layer.inside[at(i + 1, j)] != 0))
                layer.edges[0][at(i, j)] = cross(0, {i, j, k}, here, layer.points);
            if (j + 1 < depth_ && here != (layer.inside[at(i, j + 1)] != 0))
                layer.edges[1][at(i, j)] = cross(1, {i, j, k}, here, layer.points);
        }
    return layer;
}

/// The number of the point at which the line along `axis` leaves or enters the material.
int32_t Contouring::cross(int axis, const std::array<int, 3>& node, bool from_inside,
                          std::vector<CrossedEdge>& points) {
    const Crossing crossing = crossing_at(model_.lines, axis, node, from_inside);
    if (crossing.found) ++taken_;
    points.push_back(crossed_edge(model_, crossing));
    return static_cast<int32_t>(points.size()) - 1;
}

CellLayer Contouring::cells(const NodeLayer& below, const NodeLayer& above, int k) {
    CellLayer layer;
    layer.inside.assign(size_, 0);
    layer.first_vertex.assign(size_, no_vertex);
    layer.z_edges.assign(size_, no_vertex);
    for (int j = 0; j < depth_; ++j)
        for (int i = 0; i < width_; ++i)
            if (below.inside[at(i, j)] != above.inside[at(i, j)])
                layer.z_edges[at(i, j)] =
                    cross(2, {i, j, k}, below.inside[at(i, j)] != 0, layer.points);
    for (int j = 0; j + 1 < depth_; ++j)
        for (int i = 0; i + 1 < width_; ++i) make_vertices(layer, below, above, i, j, k);
    return layer;
}

EdgePoints Contouring::points_of(const CellLayer& layer, const NodeLayer& below,
                                 const NodeLayer& above, int i, int j) const {
    const size_t here = at(i, j), right = at(i + 1, j), beyond = at(i, j + 1);
    const auto flat = [](const NodeLayer& nodes, size_t axis, size_t node) {
        return point_of(nodes.points, nodes.edges[axis][node]);
    };
    const auto upright = [&](size_t node) { return point_of(layer.points, layer.z_edges[node]); };
    return {flat(below, 0, here),   flat(below, 0, beyond), flat(above, 0, here),
            flat(above, 0, beyond), flat(below, 1, here),   flat(below, 1, right),
            flat(above, 1, here),   flat(above, 1, right),  upright(here),
            upright(right),         upright(beyond),        upright(at(i + 1, j + 1))};
}

void Contouring::make_vertices(CellLayer& layer, const NodeLayer& below, const NodeLayer& above,
                               int i, int j, int k) {
    unsigned inside = 0;
    for (unsigned c = 0; c < 8; ++c) {
        const NodeLayer& nodes = c & 4U ? above : below;
        const size_t node = at(i + static_cast<int>(c & 1U), j + static_cast<int>(c >> 1U & 1U));
        inside |= static_cast<unsigned>(nodes.inside[node] != 0) << c;
    }
    if (inside == 0 || inside == 255) return;
    layer.inside[at(i, j)] = static_cast<uint8_t>(inside);
    layer.first_vertex[at(i, j)] = static_cast<int32_t>(result_.mesh.vertices.size());
    const DualCell& pieces = dual_cell(static_cast<uint8_t>(inside));
    const EdgePoints edge_points = points_of(layer, below, above, i, j);
    const Aabb room = vertex_room(grid_, bounds_, {i, j, k});
    for (uint8_t piece = 0; piece < pieces.count; ++piece) {
        std::array<TangentPlane, 12> met;
        size_t count = 0;
        for (size_t e = 0; e < 12; ++e)
            if (pieces.piece[e] == piece) met[count++] = edge_points[e]->plane;
        result_.mesh.vertices.push_back(feature_point({met.data(), count}, room));
    }
}

int32_t Contouring::vertex(const CellLayer& layer, int i, int j, size_t edge) const {
    const size_t cell = at(i, j);
    return layer.first_vertex[cell] + dual_cell(layer.inside[cell]).piece[edge];
}

/// The quads across the edges along X and Y of a layer of nodes.
void Contouring::add_flat_quads(const NodeLayer& nodes, const CellLayer& below,
                                const CellLayer& above) {
    // Border nodes are outside the body, so the surface crosses only edges that have all four cells
    // around them.
    for (int j = 0; j + 1 < depth_; ++j)
        for (int i = 0; i + 1 < width_; ++i) {
            const bool here = nodes.inside[at(i, j)] != 0;
            if (const auto* p = point_of(nodes.points, nodes.edges[0][at(i, j)]))
                add_quad({vertex(below, i, j - 1, 3), vertex(below, i, j, 2),
                          vertex(above, i, j, 0), vertex(above, i, j - 1, 1)},
                         *p, here);
            if (const auto* p = point_of(nodes.points, nodes.edges[1][at(i, j)]))
                add_quad({vertex(below, i - 1, j, 7), vertex(above, i - 1, j, 5),
                          vertex(above, i, j, 4), vertex(below, i, j, 6)},
                         *p, here);
        }
}

void Contouring::add_upright_quads(const CellLayer& layer) {
    for (int j = 1; j + 1 < depth_; ++j)
        for (int i = 1; i + 1 < width_; ++i)
            if (const auto* p = point_of(layer.points, layer.z_edges[at(i, j)]))
                add_quad({vertex(layer, i - 1, j - 1, 11), vertex(layer, i, j - 1, 10),
                          vertex(layer, i, j, 8), vertex(layer, i - 1, j, 9)},
                         *p, (layer.inside[at(i, j)] & 1U) != 0);
}

/// Two triangles, split along the diagonal that is closer to the point on the line.
void Contouring::add_quad(std::array<int32_t, 4> corners, const CrossedEdge& edge, bool upwards) {
    if (!upwards) std::swap(corners[1], corners[3]);
    const auto id = [&](size_t i) { return static_cast<uint32_t>(corners[i]); };
    const auto corner = [&](size_t i) { return result_.mesh.vertices[id(i)]; };
    const Vec3& point = edge.plane.position;
    const auto [k, away] = better_diagonal({corner(0), corner(1), corner(2), corner(3)}, point);
    result_.mesh.triangles.push_back({id(k), id(k + 1), id(k + 2)});
    result_.mesh.triangles.push_back({id(k), id(k + 2), id((k + 3) % 4)});
    result_.samples.push_back({point, edge.sweep});
    from_own_triangles_.push_back(away);
}

/// The quads at each vertex, one after the other.
struct QuadsAtVertices {
    std::vector<uint32_t> first, quads;

    explicit QuadsAtVertices(const Mesh& mesh) : first(mesh.vertices.size() + 1, 0) {
        const auto for_corners = [&](const auto& act) {
            for (size_t t = 0; t < mesh.triangles.size(); ++t)
                for (const uint32_t corner : mesh.triangles[t])
                    act(corner, static_cast<uint32_t>(t / 2));
        };
        for_corners([&](uint32_t corner, uint32_t) { ++first[corner + 1]; });
        for (size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
        quads.resize(first.back());
        std::vector<uint32_t> next(first.begin(), first.end() - 1);
        for_corners([&](uint32_t corner, uint32_t quad) { quads[next[corner]++] = quad; });
    }
};

/// An upper bound of the distance of the samples from the mesh: the distance from their own
/// triangles or from adjacent ones. If a vertex is outside its cell, the sample is on an adjacent
/// triangle.
void Contouring::measure_error() {
    std::vector<uint32_t> order;
    for (uint32_t k = 0; k < from_own_triangles_.size(); ++k) order.push_back(k);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return from_own_triangles_[a] > from_own_triangles_[b];
    });
    const Mesh& mesh = result_.mesh;
    const QuadsAtVertices near(mesh);
    for (const uint32_t k : order) {
        double away = from_own_triangles_[k];
        if (away <= result_.error) return;
        for (const uint32_t t : {2 * k, 2 * k + 1})
            for (const uint32_t corner : mesh.triangles[t])
                for (uint32_t i = near.first[corner]; i < near.first[corner + 1]; ++i)
                    for (const uint32_t other : {2 * near.quads[i], 2 * near.quads[i] + 1})
                        away = std::min(
                            away, distance_to(mesh.triangle(other), result_.samples[k].position));
        result_.error = std::max(result_.error, away);
    }
}

StockMesh Contouring::run() {
    NodeLayer below = nodes(0);
    CellLayer last;
    for (int k = 0; k + 1 < grid_.count(2) + 2; ++k) {
        NodeLayer above = nodes(k + 1);
        CellLayer layer = cells(below, above, k);
        if (k > 0) add_flat_quads(below, last, layer);
        add_upright_quads(layer);
        below = std::move(above);
        last = std::move(layer);
    }
    measure_error();
    result_.lost = point_count(model_.lines) - std::min(taken_, point_count(model_.lines));
    return std::move(result_);
}

} // namespace

StockMesh stock_mesh(const CutModel& model) { return Contouring(model).run(); }

} // namespace core
