#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "core/distance/body_distance.h"
#include "core/motion/kinematics.h"
#include "core/sim/tool_assembly.h"

namespace core {

struct CutModel;
struct Fixture;
struct Path;
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

/// The leg of a body, and those of the parts of which it consists (core/sim/leg/turning_parts.h) if
/// these follow it more closely.
struct BodyLeg : RelativeLeg {
    struct Part {
        const RevolvedProfile* profile;
        RelativeLeg leg;
    };
    std::vector<Part> parts = {};
    /// The parts of the body shrunk by `shrink`, unless its own parts can be shrunk: between parts
    /// of a body that is not convex, gaps would open.
    std::vector<Part> shrunk_parts = {};
    double shrink = 0.0;
    double overlap = 0.0; // of neighbouring parts, mm

    /// Whether shapes_of(body, leg, by) is within `shape_error` of the body shrunk by that.
    bool can_shrink(const RevolvedProfile& profile, double by) const {
        return parts.empty() || (!shrunk_parts.empty() && by == shrink)
               || (is_convex(profile) && by <= 0.25 * overlap);
    }

    /// How far the body may be from shapes_of(body, leg), mm: at most `error`.
    double shape_error() const {
        double most = parts.empty() ? error : 0.0;
        for (const Part& part : parts) most = std::max(most, part.leg.error);
        for (const Part& part : shrunk_parts) most = std::max(most, part.leg.error);
        return most;
    }
    /// The part of it that shorter legs reduce, mm.
    double reducible_shape_error() const { return shape_error() - lasting_error; }
};

/// All moving bodies whose place is known; first the parts of the tool, from the flutes up. The
/// result refers to the set-up and the tool.
std::vector<MovingBody> moving_bodies(const Setup& setup, const ToolAssembly& tool);

/// A bound of how far any body is from where it is measured on a path, because axes of rotation of
/// the machine are only known with tolerances, mm; see axis_tolerance_error. No tool: null.
double axis_tolerance_error(const Setup& setup, const ToolAssembly* tool, const Path& path);

/// The leg as seen from a fixture, without its play, or from the stock. The deviation of a fixture
/// counts as an error of the leg; that of the stock is in its tolerance.
RelativeLeg leg_against(const Setup& setup, std::optional<size_t> fixture, const MovingBody& body,
                        const Leg& leg);

/// The moves of a stock's log in whose cuts a part of the tool may stay.
struct OwnMoves {
    size_t first = 0;
    size_t before_block = 0; // number of the first move of the current block
    double sideways = 0.0;   // allowed distance, mm
};

/// Whether a part of a tool stays on a leg where its flutes have cut: see stays_in_own_cut. Moves
/// of the block count unless the leg rises sideways, where flutes come after the part.
bool follows_flutes(const Setup& setup, const ToolAssembly& tool, const MovingBody& part,
                    const Leg& leg, const CutModel& stock, const OwnMoves& own, int depth = 0);

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

/// The same for a body, with its parts; a profile is shrunk by `shrink` first.
std::vector<ConvexShape> shapes_of(const MovingBody& body, const BodyLeg& leg, double shrink = 0.0);

/// Distance from the body to a fixture over a leg, without the leg's error, mm.
Separation distance_over(const RelativeLeg& leg, const MovingBody& body, const ExactBody& fixture,
                         double limit, size_t& shape_tests);

/// Distance for a profile instead of the body.
Separation distance_over(const RelativeLeg& leg, const RevolvedProfile& profile,
                         const ExactBody& fixture, double limit, size_t& shape_tests);

} // namespace core
