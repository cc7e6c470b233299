#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Geom2d_Curve.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <TopoDS_Face.hxx>

#include "core/base/vec.h"
#include "core/cad/reader/curve_model.h"
#include "core/cad/reader/surface_model.h"

namespace core::cad {

/// A piece of an edge between two neighbouring points of the mesh; all faces at the edge share it.
struct Segment {
    size_t edge = 0;
    double from = 0.0, to = 0.0;  // parameters of the edge's curve
    uint32_t first = 0, last = 0; // points
};

/// The division of a segment: a point near its middle, and the segments before and after it.
struct SegmentHalves {
    uint32_t middle = 0;
    size_t before = 0, after = 0;
};

/// A corner of a triangle: its parameters, and the point of the solid's mesh.
struct FaceNode {
    double u = 0.0, v = 0.0;
    uint32_t point = 0;
};

/// An edge as one side of a face has it: its curve in the parameters of the surface.
struct Border {
    Handle(Geom2d_Curve) curve;
    std::shared_ptr<const CurveModel> model; // empty: its deviation is measured
    bool is_degenerate = false;              // a pole or an apex: one point of space
    bool is_inside = false;                  // the face continues beyond it
    bool is_reversed = false;                // the face runs along it backwards
    double tolerance = 0.0;                  // stated distance between the edge and this curve, mm
};

/// A side of a triangle on a border.
struct BorderPiece {
    size_t border = 0;
    size_t segment = 0;
    uint32_t first = 0, last = 0; // nodes, in the direction of the curve
    double from = 0.0, to = 0.0;  // parameters of the border's curve
};

/// In which parameter a surface is singular at a point, such as u at the pole of a sphere.
enum class Singular : uint8_t { none, in_u, in_v };

/// Nodes of a side, the lower first.
using Side = std::pair<uint32_t, uint32_t>;
Side side_of(uint32_t a, uint32_t b);

/// How far triangles of a face and its border are from the surface, mm; see README.md.
struct FaceDeviation {
    double inside = 0.0;  // of triangles
    double borders = 0.0; // between the chords of a border and its curve
    double gap = 0.0;     // between the surface and the points and edges that belong to it

    double total() const { return inside + borders + gap; }
};

/// The triangles of a face with their parameters, which can be refined.
struct FaceMesh {
    Handle(Geom_Surface) surface;
    std::shared_ptr<const SurfaceModel> model; // empty: deviations are measured
    bool is_plane = false;
    std::optional<Cone> cone;
    std::optional<Ball> ball;
    bool faces_back = false; // the outside of the solid is on the other side of the triangles
    std::vector<FaceNode> nodes;
    std::vector<Vec3> places; // of the nodes, until each has its point
    std::vector<std::array<uint32_t, 3>> triangles;
    std::vector<Border> borders;
    std::map<Side, BorderPiece> pieces;
    std::map<uint32_t, Singular> singular; // by point

    bool is_proven = true; // false: at least one bound of `measured` is in the deviation
    FaceDeviation measured_by(const std::vector<Vec3>& points);

    /// Marks the sides to divide until the deviation can be `wanted`; false if there are none.
    bool mark(const std::vector<Vec3>& points, double wanted, std::set<size_t>& segments);

    /// Also marks a side of a triangle: the longest one inside of the face, or else all of its
    /// segments.
    void mark_triangle(size_t triangle, const std::vector<Vec3>& points,
                       std::set<size_t>& segments);

    /// Divides the marked sides, and those on the segments that are divided.
    void divide(std::vector<Vec3>& points, const std::map<size_t, SegmentHalves>& halves);

    /// Why the triangles do not cover the face once, up to its borders; empty if they do.
    std::string why_no_cover() const;

private:
    struct Judged {              // of a triangle
        double deviation = -1.0; // < 0: not yet known
        Side worst;              // side to divide
    };

    Vec3 point_at(double u, double v) const;
    Singular singular_at(uint32_t node) const;
    Judged judge(const std::array<uint32_t, 3>& triangle, const std::vector<Vec3>& points);
    Judged judge_proven(const std::array<uint32_t, 3>& triangle, const std::vector<Vec3>& points);
    Judged judge_cone(const std::array<uint32_t, 3>& triangle) const;
    Judged judge_ball(const std::array<uint32_t, 3>& triangle,
                      const std::vector<Vec3>& points) const;
    double bow_on_ball(const BorderPiece& piece, const DerivativeBounds& curve,
                       const SurfaceDerivativeBounds& bounds) const;
    double bow_on_cone(const FaceNode& a, const FaceNode& b) const;
    Judged judge_measured(const std::array<uint32_t, 3>& triangle,
                          const std::vector<Vec3>& points) const;
    double extent_of_pole(const BorderPiece& piece);
    double sliver(const BorderPiece& piece);
    std::optional<double> sliver_proven(const BorderPiece& piece) const;
    double sliver_measured(const BorderPiece& piece) const;
    void judge_all(const std::vector<Vec3>& points);
    struct SideUse {
        Side side;
        uint32_t triangle;
    };
    std::vector<SideUse> sides_near(double limit) const;
    void flip_sides(const std::vector<Vec3>& points, double limit);
    bool flip(uint32_t first, uint32_t second, const Side& side, const std::vector<Vec3>& points);
    double area_of(const std::array<uint32_t, 3>& triangle) const;
    uint32_t divide_piece(const BorderPiece& piece, const SegmentHalves& halves);
    uint32_t divide_side(const Side& side, std::vector<Vec3>& points);

    std::optional<GeomAdaptor_Surface> adaptor_;
    std::vector<Judged> judged_;
    std::map<Side, double> slivers_;
    std::map<Side, double> poles_; // lengths on the surface of the pieces that are poles, mm
    std::set<Side> marked_;
    double gap_ = 0.0;
    size_t gap_nodes_ = 0; // nodes whose gap is in `gap_`
};

} // namespace core::cad
