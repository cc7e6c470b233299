#include "core/cad/reader/solid_mesher.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <BRepAdaptor_Curve.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <fmt/format.h>

#include "core/base/union_find.h"
#include "core/cad/reader/face_mesh.h"

namespace core::cad {

namespace {

Vec3 vector_of(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

std::string place_text(const Vec3& p) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
}

/// The ends of an edge, for a message.
std::string edge_text(const TopoDS_Edge& edge) {
    const BRepAdaptor_Curve curve(edge);
    return fmt::format("from {} to {}", place_text(vector_of(curve.Value(curve.FirstParameter()))),
                       place_text(vector_of(curve.Value(curve.LastParameter()))));
}

std::vector<TopoDS_Face> faces_of(const TopoDS_Shape& solid) {
    std::vector<TopoDS_Face> faces;
    for (TopExp_Explorer e(solid, TopAbs_FACE); e.More(); e.Next())
        faces.push_back(TopoDS::Face(e.Current()));
    return faces;
}

/// The edges of a face that bound it or lie in it, each as often as its wires use it.
std::vector<TopoDS_Edge> edges_of(const TopoDS_Face& face) {
    std::vector<TopoDS_Edge> edges;
    for (TopExp_Explorer e(face.Oriented(TopAbs_FORWARD), TopAbs_EDGE); e.More(); e.Next())
        if (e.Current().Orientation() != TopAbs_EXTERNAL)
            edges.push_back(TopoDS::Edge(e.Current()));
    return edges;
}

/// Errors if an edge has only one face.
Result<bool> check_closed(const std::vector<TopoDS_Face>& faces) {
    TopTools_IndexedMapOfShape edges;
    std::vector<int> uses;
    for (const TopoDS_Face& face : faces)
        for (const TopoDS_Edge& edge : edges_of(face)) {
            const auto i = static_cast<size_t>(edges.Add(edge));
            uses.resize(std::max(uses.size(), i), 0);
            const bool bounds = edge.Orientation() != TopAbs_INTERNAL;
            if (bounds && !BRep_Tool::Degenerated(edge)) ++uses[i - 1];
        }
    const auto open = std::count(uses.begin(), uses.end(), 1);
    if (open == 0) return true;
    const auto first = std::find(uses.begin(), uses.end(), 1) - uses.begin();
    const TopoDS_Edge edge = TopoDS::Edge(edges(static_cast<int>(first) + 1));
    return fail(ErrorCode::invalid_value,
                fmt::format("its surface is open: {} {} a face on one side only, one of them {}; "
                            "close it in the CAD system, or export a solid",
                            open, open == 1 ? "edge has" : "edges have", edge_text(edge)));
}

bool is_plane(Handle(Geom_Surface) surface) {
    while (true) {
        const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
        if (trimmed.IsNull()) return !Handle(Geom_Plane)::DownCast(surface).IsNull();
        surface = trimmed->BasisSurface();
    }
}

/// What is wrong with a face, with a point of it.
tl::unexpected<Error> fail_face(const TopoDS_Face& face, const std::string& what) {
    std::string where;
    const std::vector<TopoDS_Edge> edges = edges_of(face);
    for (const TopoDS_Edge& edge : edges)
        if (!BRep_Tool::Degenerated(edge)) {
            where = " that has an edge " + edge_text(edge);
            break;
        }
    return fail(ErrorCode::invalid_value,
                fmt::format("Open CASCADE cannot mesh the face{}: {}; repair it in the CAD system, "
                            "or export the body as STL",
                            where, what));
}

/// The index of a shape among those seen so far, whatever its orientation; they count from 0.
size_t number_of(TopTools_IndexedMapOfShape& shapes, const TopoDS_Shape& shape) {
    return static_cast<size_t>(shapes.Add(shape)) - 1;
}

/// Builds the mesh of one solid; see README.md for what is proven about it.
class SolidMesher {
public:
    SolidMesher(const TopoDS_Shape& solid, const MeshWish& wish)
        : wish_(wish), faces_(faces_of(solid)) {}

    Result<bool> take_triangulation();
    Result<bool> refine();
    MeshedSolid result();

private:
    struct Edge {
        TopoDS_Edge shape;
        std::vector<size_t> segments;
    };
    /// An edge on the triangles of a face.
    struct EdgeUse {
        Border border;
        size_t edge = 0;
        std::vector<uint32_t> nodes;    // in the direction of the curve
        std::vector<double> parameters; // of the border's curve
    };

    Result<FaceMesh> face_mesh(const TopoDS_Face& face);
    std::optional<EdgeUse> use_of(const TopoDS_Edge& edge, const TopoDS_Face& face);
    bool add_border(FaceMesh& mesh, const EdgeUse& use);
    void place_nodes(FaceMesh& mesh, const EdgeUse& use);
    void assign(FaceNode& node, uint32_t point);
    uint32_t point_of(const TopoDS_Vertex& vertex, const Vec3& at);
    uint32_t new_point(const Vec3& at);
    void unite_points();
    Vec3 middle_of(const Segment& segment) const;
    std::map<size_t, SegmentHalves> divided(const std::set<size_t>& segments);
    bool mark_folds(std::set<size_t>& segments);
    void divide(const std::set<size_t>& segments);
    size_t triangle_count() const;

    MeshWish wish_;
    std::vector<TopoDS_Face> faces_;
    std::vector<FaceMesh> meshes_;
    std::vector<Edge> edges_;
    TopTools_IndexedMapOfShape edge_numbers_, vertex_numbers_;
    std::vector<uint32_t> vertex_points_;
    std::vector<Vec3> points_;
    std::vector<std::pair<uint32_t, uint32_t>> same_; // points at one node: vertices that coincide
    std::vector<Segment> segments_;
};

uint32_t SolidMesher::new_point(const Vec3& at) {
    points_.push_back(at);
    return static_cast<uint32_t>(points_.size() - 1);
}

uint32_t SolidMesher::point_of(const TopoDS_Vertex& vertex, const Vec3& at) {
    if (vertex.IsNull()) return new_point(at);
    const size_t number = number_of(vertex_numbers_, vertex);
    if (number == vertex_points_.size()) vertex_points_.push_back(new_point(at));
    return vertex_points_[number];
}

void SolidMesher::assign(FaceNode& node, uint32_t point) {
    if (node.point == UINT32_MAX)
        node.point = point;
    else if (node.point != point)
        same_.emplace_back(node.point, point);
}

/// How far the nodes of an edge are from its curve in the parameters.
double misfit(const Poly_PolygonOnTriangulation& polygon, const Poly_Triangulation& triangles,
              const Geom2d_Curve& curve) {
    double most = 0.0;
    for (int i = 1; i <= polygon.NbNodes(); ++i)
        most = std::max(
            most, curve.Value(polygon.Parameter(i)).Distance(triangles.UVNode(polygon.Node(i))));
    return most;
}

/// The nodes of an edge of a face. A seam has two sets, which are not always in the order of its
/// two curves.
Handle(Poly_PolygonOnTriangulation)
    polygon_of(const TopoDS_Edge& edge, const Handle(Poly_Triangulation) & triangles,
               const TopLoc_Location& place, const Geom2d_Curve& curve) {
    const auto own = BRep_Tool::PolygonOnTriangulation(edge, triangles, place);
    const auto other =
        BRep_Tool::PolygonOnTriangulation(TopoDS::Edge(edge.Reversed()), triangles, place);
    const auto is_whole = [](const auto& polygon) {
        return !polygon.IsNull() && polygon->HasParameters();
    };
    if (!is_whole(own)) return {};
    if (!is_whole(other) || own == other) return own;
    return misfit(*own, *triangles, curve) <= misfit(*other, *triangles, curve) ? own : other;
}

std::optional<SolidMesher::EdgeUse> SolidMesher::use_of(const TopoDS_Edge& edge,
                                                        const TopoDS_Face& face) {
    TopLoc_Location place;
    const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face, place);
    double first = 0.0, last = 0.0;
    EdgeUse use;
    use.border.curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (use.border.curve.IsNull()) return std::nullopt;
    const auto polygon = polygon_of(edge, triangles, place, *use.border.curve);
    if (polygon.IsNull()) return std::nullopt;
    use.border.model = model_of(use.border.curve);
    use.border.is_degenerate = BRep_Tool::Degenerated(edge);
    use.border.is_inside = edge.Orientation() == TopAbs_INTERNAL;
    use.border.is_reversed = edge.Orientation() == TopAbs_REVERSED;
    use.border.tolerance = use.border.is_degenerate ? 0.0 : BRep_Tool::Tolerance(edge);
    for (int i = 1; i <= polygon->NbNodes(); ++i) {
        use.nodes.push_back(static_cast<uint32_t>(polygon->Node(i) - 1));
        use.parameters.push_back(polygon->Parameter(i));
    }
    use.edge = number_of(edge_numbers_, edge);
    if (use.edge == edges_.size()) edges_.push_back({edge, {}});
    return use;
}

/// Gives the nodes of an edge their points: new ones if no face before has this edge.
void SolidMesher::place_nodes(FaceMesh& mesh, const EdgeUse& use) {
    Edge& edge = edges_[use.edge];
    const bool is_new = edge.segments.empty();
    TopoDS_Vertex first, last;
    TopExp::Vertices(TopoDS::Edge(edge.shape.Oriented(TopAbs_FORWARD)), first, last);
    const size_t count = use.nodes.size();
    std::vector<uint32_t> at;
    for (size_t i = 0; i < count; ++i) {
        const FaceNode& node = mesh.nodes[use.nodes[i]];
        const Vec3 place = mesh.places[use.nodes[i]];
        const bool is_end = i == 0 || i + 1 == count;
        if (!is_new)
            at.push_back(i == 0 ? segments_[edge.segments[0]].first
                                : segments_[edge.segments[i - 1]].last);
        else if (is_end)
            at.push_back(point_of(i == 0 ? first : last, place));
        else
            at.push_back(node.point != UINT32_MAX ? node.point : new_point(place));
        assign(mesh.nodes[use.nodes[i]], at.back());
    }
    for (size_t i = 1; is_new && i < count; ++i) {
        edge.segments.push_back(segments_.size());
        segments_.push_back({use.edge, use.parameters[i - 1], use.parameters[i], at[i - 1], at[i]});
    }
}

/// Adds an edge to a face; false if its other face divides it otherwise.
bool SolidMesher::add_border(FaceMesh& mesh, const EdgeUse& use) {
    const std::vector<size_t>& segments = edges_[use.edge].segments;
    if (use.nodes.size() < 2 || (!segments.empty() && use.nodes.size() != segments.size() + 1))
        return false;
    place_nodes(mesh, use);
    const size_t border = mesh.borders.size();
    mesh.borders.push_back(use.border);
    for (size_t i = 1; i < use.nodes.size(); ++i) {
        const uint32_t a = use.nodes[i - 1], b = use.nodes[i];
        const BorderPiece piece{
            border,           edges_[use.edge].segments[i - 1], a, b, use.parameters[i - 1],
            use.parameters[i]};
        const auto [other, is_new] = mesh.pieces.emplace(side_of(a, b), piece);
        // A wire that runs to and fro along an edge: the face lies on both sides of it.
        if (!is_new) mesh.borders[other->second.border].is_inside = true;
    }
    return true;
}

/// The parameter in which the surface is singular along a degenerate edge: that in which it runs.
Singular singular_along(const FaceMesh& mesh, const std::vector<uint32_t>& nodes) {
    const FaceNode &a = mesh.nodes[nodes.front()], &b = mesh.nodes[nodes.back()];
    return std::abs(a.u - b.u) >= std::abs(a.v - b.v) ? Singular::in_u : Singular::in_v;
}

Result<FaceMesh> SolidMesher::face_mesh(const TopoDS_Face& face) {
    const TopoDS_Face forward = TopoDS::Face(face.Oriented(TopAbs_FORWARD));
    FaceMesh mesh;
    mesh.surface = BRep_Tool::Surface(forward);
    if (mesh.surface.IsNull())
        return fail_face(face, "it has no surface, so its file holds triangles only");
    TopLoc_Location place;
    const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(forward, place);
    if (triangles.IsNull() || !triangles->HasUVNodes() || triangles->NbTriangles() == 0)
        return fail_face(face, "it finds no triangles");
    mesh.model = model_of(mesh.surface);
    mesh.is_plane = is_plane(mesh.surface);
    mesh.cone = cone_of(mesh.surface);
    mesh.ball = ball_of(mesh.surface);
    mesh.faces_back = face.Orientation() == TopAbs_REVERSED;
    for (int i = 1; i <= triangles->NbNodes(); ++i) {
        const gp_Pnt2d uv = triangles->UVNode(i);
        mesh.nodes.push_back({uv.X(), uv.Y(), UINT32_MAX});
        mesh.places.push_back(vector_of(triangles->Node(i).Transformed(place)));
    }
    for (int i = 1; i <= triangles->NbTriangles(); ++i) {
        int a = 0, b = 0, c = 0;
        triangles->Triangle(i).Get(a, b, c);
        mesh.triangles.push_back({static_cast<uint32_t>(a - 1), static_cast<uint32_t>(b - 1),
                                  static_cast<uint32_t>(c - 1)});
    }
    for (const TopoDS_Edge& edge : edges_of(forward)) {
        const std::optional<EdgeUse> use = use_of(edge, forward);
        if (!use || !add_border(mesh, *use)) return fail_face(face, "its borders are not meshed");
        if (use->border.is_degenerate)
            for (const uint32_t node : use->nodes)
                mesh.singular[mesh.nodes[node].point] = singular_along(mesh, use->nodes);
    }
    for (size_t i = 0; i < mesh.nodes.size(); ++i)
        if (mesh.nodes[i].point == UINT32_MAX) mesh.nodes[i].point = new_point(mesh.places[i]);
    mesh.places.clear();
    return mesh;
}

/// Makes one point of those that a node of a face has in common.
void SolidMesher::unite_points() {
    if (same_.empty()) return;
    UnionFind sets(points_.size());
    for (const auto& [a, b] : same_) sets.join(a, b);
    same_.clear();
    for (FaceMesh& mesh : meshes_) {
        for (FaceNode& node : mesh.nodes) node.point = sets.root(node.point);
        std::map<uint32_t, Singular> singular;
        for (const auto& [point, kind] : mesh.singular) singular[sets.root(point)] = kind;
        mesh.singular = std::move(singular);
    }
    for (Segment& segment : segments_) {
        segment.first = sets.root(segment.first);
        segment.last = sets.root(segment.last);
    }
}

Result<bool> SolidMesher::take_triangulation() {
    for (const TopoDS_Face& face : faces_) {
        FEELER_TRY(FaceMesh mesh, face_mesh(face));
        meshes_.push_back(std::move(mesh));
    }
    unite_points();
    for (size_t i = 0; i < faces_.size(); ++i)
        if (const std::string why = meshes_[i].why_no_cover(); !why.empty())
            return fail_face(faces_[i], why);
    return true;
}

size_t SolidMesher::triangle_count() const {
    size_t count = 0;
    for (const FaceMesh& mesh : meshes_) count += mesh.triangles.size();
    return count;
}

/// A point of the edge between the ends of a segment.
Vec3 SolidMesher::middle_of(const Segment& segment) const {
    const double middle = 0.5 * (segment.from + segment.to);
    return vector_of(BRepAdaptor_Curve(edges_[segment.edge].shape).Value(middle));
}

std::map<size_t, SegmentHalves> SolidMesher::divided(const std::set<size_t>& segments) {
    std::map<size_t, SegmentHalves> halves;
    for (const size_t number : segments) {
        const Segment whole = segments_[number];
        const double middle = 0.5 * (whole.from + whole.to);
        const uint32_t point = new_point(middle_of(whole));
        halves[number] = {point, segments_.size(), segments_.size() + 1};
        segments_.push_back({whole.edge, whole.from, middle, whole.first, point});
        segments_.push_back({whole.edge, middle, whole.to, point, whole.last});
    }
    return halves;
}

void SolidMesher::divide(const std::set<size_t>& segments) {
    const std::map<size_t, SegmentHalves> halves = divided(segments);
    for (FaceMesh& mesh : meshes_) mesh.divide(points_, halves);
}

Result<bool> SolidMesher::refine() {
    constexpr int most_rounds = 200; // near a pole, few sides are divided in each
    constexpr int most_openings = 6;
    int openings = 0;
    for (int round = 0; round < most_rounds; ++round) {
        std::set<size_t> segments;
        bool any = false;
        for (FaceMesh& mesh : meshes_) any = mesh.mark(points_, wish_.deviation, segments) || any;
        if (!any && (openings++ == most_openings || !mark_folds(segments))) return true;
        divide(segments);
        if (triangle_count() > wish_.most_triangles) break;
    }
    return fail(ErrorCode::unsupported,
                fmt::format("a mesh within {:g} mm of its surface has too many triangles: allow a "
                            "larger deviation (mesh_deviation)",
                            wish_.deviation));
}

/// For each point, the first one at the same place. Around a pole, sides of several triangles are
/// at one place, and so are their middles.
std::vector<uint32_t> first_at_place(const std::vector<Vec3>& points) {
    std::vector<uint32_t> order(points.size()), first(points.size());
    std::iota(order.begin(), order.end(), uint32_t{0});
    const auto place = [&](uint32_t i) {
        return std::tuple(points[i].x, points[i].y, points[i].z);
    };
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return place(a) != place(b) ? place(a) < place(b) : a < b;
    });
    for (size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && place(order[i]) == place(order[i - 1]);
        first[order[i]] = same ? first[order[i - 1]] : order[i];
    }
    return first;
}

/// Pairs of triangles with the same corners that face each other: folds without thickness.
std::vector<std::pair<uint32_t, uint32_t>> folds_of(const std::vector<Mesh::Corners>& triangles) {
    const auto sorted = [](Mesh::Corners corners) {
        std::sort(corners.begin(), corners.end());
        return corners;
    };
    const auto turns = [](const Mesh::Corners& c) { // whether the corners ascend in some rotation
        return (c[0] < c[1]) + (c[1] < c[2]) + (c[2] < c[0]) == 2;
    };
    std::vector<uint32_t> order(triangles.size());
    std::iota(order.begin(), order.end(), uint32_t{0});
    std::vector<Mesh::Corners> keys;
    for (const Mesh::Corners& corners : triangles) keys.push_back(sorted(corners));
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return keys[a] != keys[b] ? keys[a] < keys[b] : a < b;
    });
    std::vector<std::pair<uint32_t, uint32_t>> folds;
    for (size_t i = 0; i + 1 < order.size(); ++i) {
        const uint32_t a = order[i], b = order[i + 1];
        if (keys[a] != keys[b] || turns(triangles[a]) == turns(triangles[b])) continue;
        folds.emplace_back(a, b);
        ++i;
    }
    return folds;
}

/// Removes folds. No point of them is farther from what remains than the result, mm.
double without_folds(Mesh& mesh) {
    const auto folds = folds_of(mesh.triangles);
    std::vector<bool> removed(mesh.triangles.size(), false);
    for (const auto& [a, b] : folds) removed[a] = removed[b] = true;
    std::vector<bool> remains(mesh.vertices.size(), false);
    for (size_t i = 0; i < mesh.triangles.size(); ++i)
        if (!removed[i])
            for (const uint32_t corner : mesh.triangles[i]) remains[corner] = true;
    double most = 0.0;
    for (const auto& [fold, other] : folds) {
        const Triangle t = mesh.triangle(fold);
        const double size =
            std::max({glm::distance(t.a, t.b), glm::distance(t.b, t.c), glm::distance(t.c, t.a)});
        double away = infinity; // of the first corner
        for (size_t i = 0; i < mesh.vertices.size(); ++i)
            if (remains[i]) away = std::min(away, glm::distance(t.a, mesh.vertices[i]));
        most = std::max(most, away + size);
    }
    size_t i = 0;
    std::erase_if(mesh.triangles, [&](const Mesh::Corners&) { return removed[i++]; });
    return most;
}

/// The points of a triangle of a face, facing outwards.
Mesh::Corners corners_of(const FaceMesh& face, const std::array<uint32_t, 3>& triangle,
                         const std::vector<uint32_t>& first) {
    const auto& [a, b, c] = triangle;
    Mesh::Corners corners = {first[face.nodes[a].point], first[face.nodes[b].point],
                             first[face.nodes[c].point]};
    if (face.faces_back) std::swap(corners[1], corners[2]);
    return corners;
}

bool has_area(const Mesh::Corners& corners) {
    const auto& [p, q, r] = corners;
    return p != q && q != r && r != p;
}

/// Marks sides of the triangles of two faces that lie on each other: where the solid is thin, they
/// would cancel out. False if there are none.
bool SolidMesher::mark_folds(std::set<size_t>& segments) {
    struct Place {
        size_t face, triangle;
    };
    std::vector<Place> places;
    std::vector<Mesh::Corners> all;
    const std::vector<uint32_t> first = first_at_place(points_);
    for (size_t face = 0; face < meshes_.size(); ++face)
        for (size_t i = 0; i < meshes_[face].triangles.size(); ++i) {
            const Mesh::Corners corners =
                corners_of(meshes_[face], meshes_[face].triangles[i], first);
            if (!has_area(corners)) continue;
            places.push_back({face, i});
            all.push_back(corners);
        }
    const auto folds = folds_of(all);
    for (const auto& [a, b] : folds)
        for (const Place& at : {places[a], places[b]})
            meshes_[at.face].mark_triangle(at.triangle, points_, segments);
    return !folds.empty();
}

MeshedSolid SolidMesher::result() {
    MeshedSolid solid;
    double reach = 0.0;
    const std::vector<uint32_t> first = first_at_place(points_);
    for (const Vec3& p : points_) reach = std::max(reach, glm::length(p));
    for (FaceMesh& face : meshes_) {
        const FaceDeviation of_face = face.measured_by(points_);
        solid.deviation = std::max(solid.deviation, of_face.total());
        solid.gap = std::max(solid.gap, of_face.gap);
        solid.is_proven = solid.is_proven && face.is_proven;
        for (const auto& triangle : face.triangles)
            if (const Mesh::Corners corners = corners_of(face, triangle, first); has_area(corners))
                solid.mesh.triangles.push_back(corners);
    }
    solid.mesh.vertices = std::move(points_);
    constexpr double rounding = 1e-12; // of a coordinate: thousands of operations
    solid.deviation += without_folds(solid.mesh) + rounding * reach;
    return solid;
}

/// The mesh of a solid whose faces Open CASCADE has meshed.
Result<MeshedSolid> meshed(const TopoDS_Shape& solid, const MeshWish& wish) {
    SolidMesher mesher(solid, wish);
    FEELER_TRY([[maybe_unused]] const bool taken, mesher.take_triangulation());
    FEELER_TRY([[maybe_unused]] const bool refined, mesher.refine());
    return mesher.result();
}

} // namespace

Result<MeshedSolid> mesh_solid(const TopoDS_Shape& solid, const MeshWish& wish) {
    FEELER_TRY([[maybe_unused]] const bool is_closed, check_closed(faces_of(solid)));
    Result<MeshedSolid> found;
    // Open CASCADE fails at some faces with one deflection and not with another.
    for (const double part : {0.95, 0.4, 0.15}) {
        IMeshTools_Parameters parameters;
        parameters.Deflection = part * wish.deviation;
        // Inside of faces, dividing is quicker than Open CASCADE.
        parameters.DeflectionInterior = 4.0 * parameters.Deflection;
        parameters.Angle = 0.5;
        BRepTools::Clean(solid);
        BRepMesh_IncrementalMesh mesher(solid, parameters);
        found = meshed(solid, wish);
        if (found || found.error().code == ErrorCode::unsupported) break;
    }
    return found;
}

} // namespace core::cad
