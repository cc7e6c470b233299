#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/palette.h"
#include "render/stock_brick.h"
#include "render/tool_path.h"
#include "render/triangle_mesh.h"

namespace render {

enum class BodyRole : uint8_t { fixture, clamp, machine, flutes, shank, holder, nose, stock, part };

/// Whether a body belongs to the tool or the spindle that carries it.
bool is_of_tool(BodyRole role);

/// The colour that bodies of a role have.
Role color_role(BodyRole role);

/// How much a role covers where nothing else is said: the holder is seen through.
double usual_alpha(BodyRole role);

/// Something solid. Frame: the scene's is that of the stock.
struct Body {
    std::string name;
    BodyRole role = BodyRole::fixture;
    SharedMesh mesh;
    core::Transform stock_from_body = {};
    double alpha = 1.0;
    bool highlighted = false; // one of the pair that is looked at: gets an outline in `mark`
    ClearanceState mark = ClearanceState::none;
    bool visible = true;
};

/// The two points that are nearest to each other.
struct Witness {
    core::Vec3 a = core::Vec3(0.0), b = core::Vec3(0.0);
    ClearanceState state = ClearanceState::none;
};

/// Everything with dot(normal, p) > offset is cut away, and what is cut shows a face.
struct SectionPlane {
    core::Vec3 normal = core::Vec3(0.0, 1.0, 0.0); // length 1
    double offset = 0.0;                           // mm
};

/// What is drawn. Frame: that of the stock, mm. A copy is cheap: what is large is shared.
struct Scene {
    std::vector<Body> bodies;
    std::vector<Body> ghost; // the tool where it is not: drawn as a shadow of itself
    StockBricks stock;
    bool stock_visible = true;
    SharedPath path;
    bool path_visible = true;
    std::optional<uint32_t> current_block; // drawn bright; later ones are drawn faint
    bool fade_later_blocks = true;
    std::optional<uint32_t> hovered_block; // drawn as wide as the current one
    std::optional<Witness> witness;
    std::optional<SectionPlane> section;
    bool section_cuts_tool = false;   // else only stock and fixtures are cut
    std::vector<core::Vec3> measured; // joined in order
};

/// The box of all that is visible, path included.
core::Aabb bounds(const Scene& scene);

/// The box of stock, fixtures and path: what a first look should show; all if there are none.
core::Aabb work_bounds(const Scene& scene);

/// The box of one body in the scene's frame.
core::Aabb bounds(const Body& body);

} // namespace render
