#pragma once

#include <optional>
#include <vector>

#include "core/base/ids.h"
#include "core/motion/kinematics.h"
#include "core/sim/block_result.h"
#include "core/sim/leg/check_memory.h"
#include "core/sim/moving_body.h"

namespace core {

struct Setup;

/// Whether material that the flutes meet is cut or is a collision.
enum class FluteUse : uint8_t { cutting, not_cutting };

/// A turning body is located well enough when its error is at most this share of its clearance.
constexpr double sharp_share = 0.02;

/// The pair of a moving body and a fixture, or the stock.
Pair pair_of(const MovingBody& body, std::optional<size_t> fixture = {});

/// What the checks of a leg have in common: the set-up, the tool with everything that moves with
/// it, and the memory of the run. Refers to all of it.
struct LegContext {
    const Setup& setup;
    const ToolAssembly& tool;
    FluteUse use;
    BlockIndex block;
    const std::vector<bool>& fixtures_there;
    CheckMemory& memory;
    Statistics& statistics;
    std::vector<MovingBody> bodies;

    /// The moving body of a pair.
    const MovingBody& body_of(const Pair& pair) const;

    /// The bodies in the order in which to check them against the stock or a fixture: first the one
    /// that decided the last block.
    std::vector<const MovingBody*> likely_first(std::optional<size_t> fixture) const;

    /// The leg of a body, seen from the stock.
    RelativeLeg against_stock(const MovingBody& body, const Leg& leg) const;

    /// The error of a turning body that is small enough whatever its clearance is, mm.
    double finest_error(const MovingBody& body) const;

    /// Whether the error of a leg is small enough for a body with this lower bound.
    bool is_sharp(const MovingBody& body, const RelativeLeg& relative, double lower) const;

    /// Whether the error of a leg is too large for any clearance within the search limit.
    bool is_too_vague(const RelativeLeg& relative) const;

    /// Whether the tool turns so far on a leg that the leg must be halved.
    bool turns_too_far(const Leg& leg) const;
};

} // namespace core
