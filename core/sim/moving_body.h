#pragma once

#include <vector>

#include "core/distance/body_distance.h"
#include "core/motion/kinematics.h"
#include "core/sim/tool_assembly.h"

namespace core {

struct Fixture;
struct Setup;

/// A body of the tool's side as it is checked against the work: a part of the tool, or a body of
/// the machine that the table does not carry.
struct MovingBody {
    PartKind kind = PartKind::flutes;
    size_t carried = 0;                       // index of the machine's body
    const RevolvedProfile* profile = nullptr; // of a part of the tool
    const ExactBody* body = nullptr;          // of the machine
    Mover mover;
};

/// All of them; parts of the tool come first, from the flutes up. Refers to the set-up and the
/// tool.
std::vector<MovingBody> moving_bodies(const Setup& setup, const ToolAssembly& tool);

/// Whether two bodies are never compared: fixed to each other, or parts of the machine that are
/// neighbours.
bool is_exempt(const Machine& machine, const MovingBody& body, const Fixture& fixture);

/// A box that holds the body wherever it really is over a leg; infinite where its error is.
Aabb bounds(const MovingBody& body, const RelativeLeg& leg);

/// Convex shapes whose union is the profile, as they pass over a leg.
std::vector<ConvexShape> shapes_of(const RevolvedProfile& profile, const RelativeLeg& leg);

/// Convex shapes that hold the surface of a machine's body, as they pass over a leg.
std::vector<ConvexShape> shapes_of(const ExactBody& body, const RelativeLeg& leg);

/// How far the body is from a fixture over a leg, the leg's error not counted.
Separation distance_over(const RelativeLeg& leg, const MovingBody& body, const ExactBody& fixture,
                         double limit, size_t& shape_tests);

/// The same for a profile in the body's place.
Separation distance_over(const RelativeLeg& leg, const RevolvedProfile& profile,
                         const ExactBody& fixture, double limit, size_t& shape_tests);

} // namespace core
