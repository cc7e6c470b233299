#pragma once

#include <optional>
#include <vector>

#include "core/distance/body_distance.h"
#include "core/motion/kinematics.h"
#include "core/sim/tool_assembly.h"

namespace core {

struct Fixture;
struct Setup;

/// A body on the spindle side that is checked against the work: a part of the tool, or a machine
/// body that the table does not carry.
struct MovingBody {
    PartKind kind = PartKind::flutes;
    size_t carried = 0;                       // index of the machine body
    const RevolvedProfile* profile = nullptr; // set for parts of the tool
    const ExactBody* body = nullptr;          // set for machine bodies
    Mover mover;
};

/// All moving bodies whose place is known; first the parts of the tool, from the flutes up. The
/// result refers to the set-up and the tool.
std::vector<MovingBody> moving_bodies(const Setup& setup, const ToolAssembly& tool);

/// The leg as seen from a fixture, without its play, or from the stock. The deviation of a fixture
/// counts as an error of the leg; that of the stock is in its tolerance.
RelativeLeg leg_against(const Setup& setup, std::optional<size_t> fixture, const MovingBody& body,
                        const Leg& leg);

/// Whether two bodies are never checked against each other: they are fixed to each other, or are
/// machine bodies on neighbouring links.
bool is_exempt(const Machine& machine, const MovingBody& body, const Fixture& fixture);

/// A box that contains the body at all its real positions over a leg; infinite if the leg's error
/// is infinite.
Aabb bounds(const MovingBody& body, const RelativeLeg& leg);

/// Convex shapes, swept along a leg, whose union is the swept profile.
std::vector<ConvexShape> shapes_of(const RevolvedProfile& profile, const RelativeLeg& leg);

/// Convex shapes, swept along a leg, that contain the swept surface of a machine body.
std::vector<ConvexShape> shapes_of(const ExactBody& body, const RelativeLeg& leg);

/// Distance from the body to a fixture over a leg, without the leg's error, mm.
Separation distance_over(const RelativeLeg& leg, const MovingBody& body, const ExactBody& fixture,
                         double limit, size_t& shape_tests);

/// Distance for a profile instead of the body.
Separation distance_over(const RelativeLeg& leg, const RevolvedProfile& profile,
                         const ExactBody& fixture, double limit, size_t& shape_tests);

} // namespace core
