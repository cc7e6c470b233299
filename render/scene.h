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

/// Whether a body belongs to the tool or the spindle.
bool is_of_tool(BodyRole role);

/// The colour of bodies of a role.
Role color_role(BodyRole role);

/// The default opacity of a role: the holder is transparent.
double usual_alpha(BodyRole role);

/// A solid body. The frame of the scene is that of the stock.
struct Body {
    std::string name;
    BodyRole role = BodyRole::fixture;
    SharedMesh mesh;
    core::Transform stock_from_body = {};
    double alpha = 1.0;
    bool highlighted = false; // one of the selected pair: outlined in the colour of `mark`
    ClearanceState mark = ClearanceState::none;
    bool visible = true;
};

/// The two nearest points of a pair.
struct Witness {
    core::Vec3 a = core::Vec3(0.0), b = core::Vec3(0.0);
    ClearanceState state = ClearanceState::none;
};

/// Cuts away everything with dot(normal, p) > offset and shows the cut as a face.
struct SectionPlane {
    core::Vec3 normal = core::Vec3(0.0, 1.0, 0.0); // unit length
    double offset = 0.0;                           // mm
};

/// What is drawn. Frame: the stock's, mm. Copies are cheap: large data is shared.
struct Scene {
    std::vector<Body> bodies;
    std::vector<Body> ghost; // the tool at another position, drawn faintly
    StockBricks stock;
    bool stock_visible = true;
    SharedPath path;
    bool path_visible = true;
    std::optional<uint32_t> current_block; // drawn bright; later ones faint
    bool fade_later_blocks = true;
    std::optional<uint32_t> hovered_block; // drawn as wide as the current block
    std::optional<Witness> witness;
    std::optional<SectionPlane> section;
    bool section_cuts_tool = false;   // otherwise only stock and fixtures are cut
    std::vector<core::Vec3> measured; // joined in order
};

/// The box of everything visible, path included.
core::Aabb bounds(const Scene& scene);

/// The box of stock, fixtures and path, for the initial view; of everything if there are none.
core::Aabb work_bounds(const Scene& scene);

/// The box of one body in the scene's frame.
core::Aabb bounds(const Body& body);

} // namespace render
