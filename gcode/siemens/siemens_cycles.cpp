#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"
#include "gcode/siemens/siemens.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// The parameters of a cycle.
class Values {
public:
    Values(std::vector<std::optional<double>> values, LengthUnit unit)
        : values_(std::move(values)), unit_(unit) {}

    bool has(size_t index) const { return index < values_.size() && values_[index].has_value(); }
    double plain(size_t index, double absent = 0.0) const {
        return has(index) ? *values_[index] : absent;
    }
    double length(size_t index) const { return to_mm(plain(index), unit_); }
    int whole(size_t index, double absent) const {
        return static_cast<int>(std::clamp(plain(index, absent), -1e6, 1e6));
    }

    /// A digit of a mode parameter, counted from the right.
    int digit(size_t index, int digit_index) const {
        return static_cast<int>(
            std::fmod(std::floor(std::abs(plain(index)) / core::pow(10.0, digit_index)), 10.0));
    }

private:
    std::vector<std::optional<double>> values_;
    LengthUnit unit_;
};

tl::unexpected<core::Error> refuse_use(const SiemensKeywordUse& use, std::string_view why,
                                       ErrorCode code = ErrorCode::invalid_value) {
    return core::fail(code, fmt::format("{}: {}", use.keyword->name, why), use.span);
}

/// Coarse pitches of metric threads, ISO 261.
struct SiemensThread {
    double size, pitch;
};
constexpr SiemensThread threads[] = {
    {3, 0.5},  {4, 0.7},  {5, 0.8},  {6, 1},    {8, 1.25}, {10, 1.5}, {12, 1.75},
    {14, 2},   {16, 2},   {18, 2.5}, {20, 2.5}, {22, 2.5}, {24, 3},   {27, 3},
    {30, 3.5}, {33, 3.5}, {36, 4},   {39, 4},   {42, 4.5}, {45, 4.5}, {48, 5}};

/// The pitch from MPIT, a thread size, or PIT, a pitch; the sign gives the direction of the thread.
core::Result<double> pitch_of(const SiemensKeywordUse& use, const Values& values, size_t mpit,
                              size_t pit, size_t unit) {
    if (values.plain(unit) > 1.0)
        return refuse_use(use,
                          "pitches in inches or threads per inch are not supported yet: give the "
                          "pitch in mm",
                          ErrorCode::unsupported);
    if (values.plain(pit) != 0.0) return values.plain(pit);
    const double size = values.plain(mpit);
    if (size == 0.0) return 0.0;
    for (const SiemensThread& thread : threads)
        if (std::abs(size) == thread.size) return std::copysign(thread.pitch, size);
    return refuse_use(
        use,
        fmt::format("M{:.12g} is not a metric coarse thread from M3 to M48: give the pitch as PIT",
                    std::abs(size)));
}

/// Index of the first parameter that the older controls do not have: GMODE, DMODE and AMODE.
size_t first_mode_of(int number) {
    switch (number) {
    case 81:
    case 82:
        return 6;
    case 83:
        return 17;
    case 85:
        return 8;
    case 86:
        return 11;
    default:
        return 100;
    }
}

/// Reports modes that are not implemented as an error.
core::Result<void> check_modes(const Execution& execution, const SiemensKeywordUse& use,
                               const Values& values, int number) {
    const size_t first = first_mode_of(number);
    const int by_shank = number == 81 ? values.digit(first, 0) : values.digit(first, 1);
    if (by_shank != 0)
        return refuse_use(
            use,
            fmt::format("parameter {} sets the depth by the diameter or the shank of the drill, "
                        "which is not supported yet: give the depth of the tip",
                        first + 1),
            ErrorCode::unsupported);
    const int plane = values.digit(first + 1, 0);
    const Plane planes[] = {Plane::xy, Plane::zx, Plane::yz};
    if (plane >= 1 && plane <= 3 && planes[plane - 1] != execution.modal().plane)
        return refuse_use(
            use, fmt::format("the cycle is for the G{} plane, which is not the active plane",
                             16 + plane));
    return {};
}

/// Index of the parameter _AXN, the axis along which the cycle drills; 100: the cycle has none.
size_t axis_parameter_of(int number) {
    return number == 840 ? 11 : number == 83 || number == 84 ? 12 : 100;
}

core::Result<void> check_axis(const Execution& execution, const SiemensKeywordUse& use,
                              const Values& values, int number) {
    const size_t index = axis_parameter_of(number);
    const int axis = values.whole(index, 0.0);
    if (axis == 0 || static_cast<size_t>(axis) == axes_of(execution.modal().plane).normal + 1)
        return {};
    return refuse_use(use,
                      fmt::format("parameter {} (_AXN) is {}: drilling along another axis than the "
                                  "normal of the plane is not supported yet",
                                  index + 1, axis),
                      ErrorCode::unsupported);
}

void read_deep_hole(SiemensDrilling& cycle, const Values& values) {
    // FDEP FDPR DAM DTB DTS FRF VARI AXN MDEP VRT DTD DIS1
    cycle.first_depth = values.has(6) && values.plain(6) != 0.0
                            ? cycle.reference - std::abs(values.length(6))
                        : values.has(5) ? values.length(5)
                                        : cycle.bottom;
    cycle.degression = values.plain(7) < 0.0 ? values.plain(7) : values.length(7);
    if (values.digit(19, 5) == 2) cycle.degression = -values.plain(7) / 100.0;
    cycle.dwell_below = values.plain(8);
    cycle.dwell_above = values.plain(9);
    const double factor = values.plain(10, 1.0);
    cycle.feed_factor = factor <= 0.0 ? 1.0 : factor > 1.0 ? factor / 100.0 : factor;
    cycle.clears_chips = values.plain(11) != 0.0;
    cycle.least_peck = values.length(13);
    cycle.break_back = values.length(14) > 0.0 ? values.length(14) : 1.0;
    cycle.dwell_final =
        values.has(15) && values.plain(15) != 0.0 ? values.plain(15) : cycle.dwell_below;
    cycle.near = values.length(16);
}

core::Result<void> read_tapping(SiemensDrilling& cycle, const SiemensKeywordUse& use,
                                const Values& values) {
    cycle.dwell_below = values.plain(5);
    const bool rigid = cycle.number == 84;
    cycle.direction_after = values.whole(rigid ? 6 : 7, 5.0);
    FEELER_TRY(cycle.pitch,
               rigid ? pitch_of(use, values, 7, 8, 13) : pitch_of(use, values, 9, 10, 12));
    if (!rigid) return {};
    if (cycle.pitch == 0.0) return refuse_use(use, "the pitch is missing: give MPIT or PIT");
    cycle.speed_in = values.plain(10);
    cycle.speed_out = values.plain(11) > 0.0 ? values.plain(11) : cycle.speed_in;
    if (values.plain(15) != 0.0)
        return refuse_use(use, "tapping in several steps (VARI) is not supported yet",
                          ErrorCode::unsupported);
    return {};
}

core::Result<void> read_special(SiemensDrilling& cycle, const SiemensKeywordUse& use,
                                const Values& values) {
    switch (cycle.number) {
    case 82:
    case 89:
        cycle.dwell_below = values.plain(5);
        return {};
    case 83:
        read_deep_hole(cycle, values);
        return {};
    case 84:
    case 840:
        return read_tapping(cycle, use, values);
    case 85:
        cycle.dwell_below = values.plain(5);
        cycle.feed_in = values.length(6);
        cycle.feed_out = values.length(7);
        return {};
    case 86:
        cycle.dwell_below = values.plain(5);
        cycle.direction = values.whole(6, 3.0);
        cycle.aside = {values.length(7), values.length(8), values.length(9)};
        return {};
    case 87:
        cycle.direction = values.whole(5, 3.0);
        return {};
    case 88:
        cycle.dwell_below = values.plain(5);
        cycle.direction = values.whole(6, 3.0);
        return {};
    default:
        return {};
    }
}

core::Result<void> check_levels(const SiemensDrilling& cycle, const SiemensKeywordUse& use) {
    if (!(cycle.retract >= cycle.reference))
        return refuse_use(use, fmt::format("the retract plane RTP at {:.4f} mm is below the "
                                           "reference plane RFP at {:.4f} mm (alarm 61101)",
                                           cycle.retract, cycle.reference));
    if (cycle.bottom > cycle.reference)
        return refuse_use(use, fmt::format("the bottom of the hole at {:.4f} mm is above the "
                                           "reference plane RFP at {:.4f} mm (alarm 61101)",
                                           cycle.bottom, cycle.reference));
    if (cycle.number == 83
        && (cycle.first_depth >= cycle.reference || cycle.first_depth < cycle.bottom - 1e-9))
        return refuse_use(use, fmt::format("the first drilling depth at {:.4f} mm is not between "
                                           "the reference plane and the bottom (alarm 61107)",
                                           cycle.first_depth));
    return {};
}

core::Result<SiemensDrilling> drilling_of(Execution& execution, const SiemensKeywordUse& use) {
    FEELER_TRY(auto given, cycle_values(execution, use));
    const Values values(std::move(given), execution.modal().unit);
    SiemensDrilling cycle{.number = std::stoi(std::string(use.keyword->name.substr(5)))};
    constexpr std::string_view names[] = {"RTP", "RFP"};
    for (size_t i = 0; i < 2; ++i)
        if (!values.has(i))
            return refuse_use(use, fmt::format("parameter {} ({}) is missing", i + 1, names[i]),
                              ErrorCode::missing_value);
    if (!values.has(3) && !values.has(4))
        return refuse_use(use, "the depth is missing: give DP or DPR", ErrorCode::missing_value);
    cycle.retract = values.length(0);
    cycle.reference = values.length(1);
    cycle.safety = std::abs(values.length(2));
    // The relative depth is used if both are given.
    const bool relative = values.plain(4) != 0.0 || !values.has(3);
    cycle.bottom = relative ? cycle.reference - std::abs(values.length(4)) : values.length(3);
    if (auto checked = check_modes(execution, use, values, cycle.number); !checked)
        return tl::unexpected(std::move(checked).error());
    if (auto checked = check_axis(execution, use, values, cycle.number); !checked)
        return tl::unexpected(std::move(checked).error());
    if (auto read = read_special(cycle, use, values); !read)
        return tl::unexpected(std::move(read).error());
    if (auto checked = check_levels(cycle, use); !checked)
        return tl::unexpected(std::move(checked).error());
    return cycle;
}

} // namespace

core::Result<std::vector<std::optional<double>>> cycle_values(Execution& execution,
                                                              const SiemensKeywordUse& use) {
    (void)use;
    std::vector<std::optional<double>> values;
    for (const SiemensArgument& argument : siemens_of(execution.block).arguments) {
        values.emplace_back();
        if (argument.kind != SiemensArgument::Kind::value) continue;
        FEELER_TRY(values.back(), value_of_argument(flow_step_of(execution), argument));
    }
    return values;
}

core::Result<void> run_hole_cycle(Execution& execution, const SiemensKeywordUse& use) {
    execution.column = use.span.column;
    if (use.keyword->action != SiemensAction::drill) return run_siemens_holes(execution, use);
    FEELER_TRY(const SiemensDrilling cycle, drilling_of(execution, use));
    if (siemens_of(execution.block).is_modal_call) {
        writable_siemens(execution.state).modal_cycle = cycle;
        return {};
    }
    return drill_here(execution, cycle);
}

} // namespace gcode
