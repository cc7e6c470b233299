#include "core/sim/run/cut_forecast.h"

#include <algorithm>

#include "core/motion/path.h"
#include "core/sim/leg/flute_cut.h"
#include "core/sim/setup.h"

namespace core {

struct CutForecast::HeldTool {
    std::vector<bool> no_fixtures;
    Statistics statistics;
    LegContext context;
    FluteCut flutes{context};

    HeldTool(const Setup& setup, const ToolAssembly& tool, CheckMemory& memory)
        : context{setup,       tool,   FluteUse::cutting, BlockIndex{},
                  no_fixtures, memory, statistics,        moving_bodies(setup, tool)} {}
};

CutForecast::CutForecast(const Setup& setup, const SimulatorState& state)
    : setup_(setup), spindle_(state.spindle), is_certain_(state.spread.none()) {
    memory_.cutters = state.memory.cutters;
    hold(state.tool);
}

CutForecast::~CutForecast() = default;

void CutForecast::hold(std::optional<ToolNumber> number) {
    held_.reset();
    const auto tool = number ? setup_.tools.find(*number) : setup_.tools.end();
    if (tool != setup_.tools.end() && !tool->second.parts.empty())
        held_ = std::make_unique<HeldTool>(setup_, tool->second, memory_);
}

bool CutForecast::add(const BlockEvents& block, std::vector<CutterSweep>& moves) {
    for (const Event& event : block.events) {
        if (const auto* change = std::get_if<ToolChange>(&event)) hold(change->tool);
        if (const auto* change = std::get_if<SpindleChange>(&event)) spindle_ = *change;
        const auto* motion = std::get_if<Motion>(&event);
        if (!motion) continue;
        if (block.path >= PathCertainty::pose_unknown || !add(*motion, block.block, moves))
            return false;
    }
    return true;
}

bool CutForecast::add(const Motion& motion, BlockIndex block, std::vector<CutterSweep>& moves) {
    if (!is_certain_ || motion.stops_at_contact) return false;
    if (motion.kind == MotionKind::rapid || !held_) return true;
    const ToolAssembly& tool = held_->context.tool;
    if (!turns_to_cut(spindle_, tool) || !cuts_along(tool, motion)) return true;
    if (tool.oriented) return false;
    for (size_t i = 3; i < 6; ++i)
        if (motion.from[i] != motion.to[i]) return false;
    const Path path = path_of(motion, setup_.machine, chord_error(setup_.mesh_size));
    if (path.legs.empty() || !path.legs[0].start_known) return false;
    held_->context.block = block;
    for (const Leg& leg : path.legs)
        if (leg.straight) moves.push_back(held_->flutes.sweep_on(leg));
    return true;
}

} // namespace core
