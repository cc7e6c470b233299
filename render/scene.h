#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/palette.h"
#include "render/stock_brick.h"
#include "render/tool_path.h"
#include "render/triangle_mesh.h"

namespace render {

enum class BodyRole : uint8_t {
    fixture,
    vise,
    clamp,
    machine,
    flutes,
    shank,
    holder,
    nose,
    stock,
    part
};

/// Whether a body belongs to the tool or the spindle.
bool is_of_tool(BodyRole role);

/// The colour of bodies of a role.
Role color_role(BodyRole role);

/// The default opacity of a role: the holder is transparent.
double usual_alpha(BodyRole role);

/// Whether a body is one of the selected pair: the one on the tool side, or the one that it must
/// not touch. Each side has a colour of its own.
enum class PairSide : uint8_t { none, tool, body };

/// The colour of a side of the pair, which is not `none`.
Role color_role(PairSide side);

/// A solid body. The frame of the scene is that of the stock.
struct Body {
    std::string name;
    BodyRole role = BodyRole::fixture;
    SharedMesh mesh;
    core::Transform stock_from_body = {};
    double alpha = 1.0;
    PairSide side = PairSide::none;
    ClearanceState mark = ClearanceState::none; // of the pair
    bool visible = true;
};

/// The two nearest points of a pair, or how deep it overlaps.
struct Witness {
    core::Vec3 a = core::Vec3(0.0), b = core::Vec3(0.0);
    ClearanceState state = ClearanceState::none;
    bool is_depth = false;   // a and b are the ends of an overlap
    bool is_contact = false; // the bodies touch as intended, at `a`
};

/// Cuts away everything with dot(normal, p) > offset and shows the cut as a face.
struct SectionPlane {
    core::Vec3 normal = core::Vec3(0.0, 1.0, 0.0); // unit length
    double offset = 0.0;                           // mm
};

/// Three arrows of constant size in the picture at the zero of a coordinate system.
struct Triad {
    std::string name; // such as "G54"
    core::Vec3 origin = core::Vec3(0.0);
    core::Mat3 axes = core::Mat3(1.0); // columns: unit vectors along X, Y, Z
    bool is_minor = false;             // drawn shorter and paler

    bool operator==(const Triad&) const = default;
};

/// The length of the arrows without their heads, pixels at a scale of 1.
constexpr double length_in_pixels(const Triad& triad) { return triad.is_minor ? 26.0 : 40.0; }

/// The ground under the work, with a grid. Frame: Z up, the ground at Z 0; lines are at multiples
/// of the distance from its origin.
struct Ground {
    core::Transform scene_from_ground = {};
    bool inch = false; // the unit of the distance between lines

    bool operator==(const Ground&) const = default;
};

/// What is drawn. Frame: the stock's, mm. Copies are cheap: large data is shared.
struct Scene {
    std::vector<Body> bodies;
    std::vector<Body> ghost; // the tool at another position, drawn faintly
    StockBricks stock;
    bool stock_visible = true;
    PairSide stock_side = PairSide::none;
    SharedPath path;
    bool path_visible = true;
    std::optional<uint32_t> current_block; // drawn bright; later ones faint
    bool fade_later_blocks = true;
    std::optional<uint32_t> hovered_block; // drawn as wide as the current block
    std::optional<Witness> witness;
    std::optional<SectionPlane> section;
    bool section_cuts_tool = false;   // as well as stock and fixtures; never the machine
    std::vector<core::Vec3> measured; // joined in order
    std::vector<Triad> triads;
    std::optional<Ground> ground;
};

/// Whether the section cuts bodies of a role.
bool is_cut_by_section(const Scene& scene, BodyRole role);

/// The box of everything visible, path included.
core::Aabb bounds(const Scene& scene);

/// The box of stock, fixtures and path, for the initial view; of everything if there are none.
core::Aabb work_bounds(const Scene& scene);

/// The box of one body in the scene's frame.
core::Aabb bounds(const Body& body);

} // namespace render
