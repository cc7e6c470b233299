#include "app/guard/motion_log.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/setup/setup_file.h"
#include "core/motion/event.h"
#include "gcode/language/canonical.h"

namespace app {
namespace {

/// Text that stays within a comment of a program: one line without parentheses.
std::string comment_of(std::string text) {
    std::replace_if(
        text.begin(), text.end(),
        [](char c) { return c == '(' || c == ')' || static_cast<unsigned char>(c) < ' '; }, ' ');
    return "(" + text + ")";
}

/// Without the sign of a zero.
double plain(double value) { return std::abs(value) < 5e-7 ? 0.0 : value; }

} // namespace

struct MotionLog::State {
    std::ofstream file;
    core::AxisValues origin{}; // of the program's coordinates, in machine coordinates
    std::optional<gcode::SwitchableKinematics> kinematics;
    double length = 0.0;                            // that is in use, mm
    std::array<bool, core::axis_count> is_placed{}; // in the first motion: X, Y, Z, rotary axes
    std::optional<LiveMotion> last, refused;
    std::string reason; // of `refused`

    std::string axis_words(const double (&values)[core::axis_count],
                           const double (&from)[core::axis_count], bool all) const;
    void write(const LiveMotion& motion);
    void write_refusal();
    void write_kinematics(const LiveMotion& motion);
    void write_modes(const LiveMotion& motion);
    void write_motion(const LiveMotion& motion);
};

/// The words of axes that move, or of X, Y and Z in any case; at first, of rotary axes as well.
std::string MotionLog::State::axis_words(const double (&values)[core::axis_count],
                                         const double (&from)[core::axis_count], bool all) const {
    std::string words;
    for (size_t i = 0; i < core::axis_count; ++i)
        if (values[i] != from[i] || (all && (last ? i < 3 : is_placed[i])))
            words += fmt::format(" {}{:.6f}", core::axis_letters[i],
                                 plain(values[i] - origin[i] - (i == 2 ? length : 0.0)));
    return words;
}

/// The kinematics of LinuxCNC and the length offset that they use, where they have changed.
void MotionLog::State::write_kinematics(const LiveMotion& motion) {
    if (!kinematics) return;
    using Type = gcode::SwitchableKinematics::Type;
    const auto& types = kinematics->types;
    const auto is_tip = [](Type type) { return type == Type::tip; };
    const bool was_tip = last ? last->follows_tip : !types.empty() && is_tip(types.front());
    const double needed = motion.follows_tip ? motion.tool_length : 0.0;
    if (last && was_tip == motion.follows_tip && needed == length) return;
    const auto select = [&](Type type) {
        const auto number = std::find(types.begin(), types.end(), type) - types.begin();
        if (kinematics->output)
            file << fmt::format("M68 E{} Q{}\nM66 E0 L0\n", *kinematics->output, number);
        else if (is_tip(type) != is_tip(types.front()))
            file << comment_of("LinuxCNC uses other kinematics here: the ini file does not say how "
                               "they are selected")
                 << "\n";
    };
    // The length only changes where that moves nothing.
    if (needed != length) {
        if (was_tip) select(Type::axes);
        file << (needed == 0.0 ? "G49\n" : fmt::format("G43.1 Z{:.6f}\n", needed));
        if (motion.follows_tip) select(Type::tip);
    } else if (was_tip != motion.follows_tip) {
        select(motion.follows_tip ? Type::tip : Type::axes);
    }
    length = needed;
    constexpr double same_place = 1e-6; // mm or degrees
    const auto is_same = [](double a, double b) { return std::abs(a - b) <= same_place; };
    if (!last
        || !std::equal(last->axes_to.begin(), last->axes_to.end(), motion.axes_from.begin(),
                       is_same))
        return;
    // As the new kinematics count it.
    std::copy(std::begin(motion.from), std::end(motion.from), std::begin(last->to));
}

/// Tool, spindle and path mode, where they have changed.
void MotionLog::State::write_modes(const LiveMotion& motion) {
    if (!last || last->tool != motion.tool)
        if (motion.tool >= 0) file << fmt::format("M61 Q{}\n", motion.tool);
    if (!last || last->turns_on != motion.turns_on || last->speed != motion.speed) {
        if (motion.turns_on == 0)
            file << "M5\n";
        else
            file << fmt::format("M{} S{:.3f}\n", motion.turns_on == 1 ? 3 : 4,
                                std::abs(motion.speed));
    }
    if (last && last->blending == motion.blending && last->tolerance == motion.tolerance) return;
    if (motion.blending == FEELER_EXACT_STOP)
        file << "G61.1\n";
    else if (motion.blending == FEELER_EXACT_PATH)
        file << "G61\n";
    else if (motion.tolerance > 0.0)
        file << fmt::format("G64 P{:.6f} Q0\n", motion.tolerance);
    else
        file << "G64\n";
}

void MotionLog::State::write_motion(const LiveMotion& motion) {
    const bool is_placed =
        last && std::equal(std::begin(last->to), std::end(last->to), std::begin(motion.from));
    if (!is_placed) {
        if (last) file << comment_of("moved in another way, such as by hand") << "\n";
        file << "G0" << axis_words(motion.from, last ? last->to : motion.from, true) << "\n";
    }
    const bool is_rapid =
        motion.purpose != FEELER_FEED && motion.purpose != FEELER_CURVE && !is_probing(motion);
    if (motion.shape == FEELER_LINE) {
        file << (is_rapid ? "G0" : "G1") << axis_words(motion.to, motion.from, is_rapid);
        if (!is_rapid) file << fmt::format(" F{:.3f}", 60.0 * motion.feed);
    } else if (motion.shape == FEELER_TAP) {
        file << fmt::format("G1{} F{:.3f}\nG1{}", axis_words(motion.to, motion.from, true),
                            60.0 * motion.feed, axis_words(motion.from, motion.to, true));
    } else {
        const char* const planes[] = {"G19", "G18", "G17"};
        const size_t normal = motion.normal[2] != 0.0 ? 2 : motion.normal[1] != 0.0 ? 1 : 0;
        const bool is_clockwise = (motion.turns < 0) != (motion.normal[normal] < 0.0);
        file << planes[normal] << (is_clockwise ? " G2" : " G3")
             << axis_words(motion.to, motion.from, true);
        for (size_t i = 0; i < 3; ++i)
            if (i != normal)
                file << fmt::format(" {}{:.6f}", "IJK"[i],
                                    plain(motion.centre[i] - motion.from[i]));
        const int turns = 1 + (motion.turns < 0 ? -1 - motion.turns : motion.turns);
        if (turns > 1) file << fmt::format(" P{}", turns);
        file << fmt::format(" F{:.3f}", 60.0 * motion.feed);
    }
    file << fmt::format(" (line {})\n", motion.line);
    last = motion;
    if (motion.shape != FEELER_TAP) return;
    std::copy(std::begin(motion.from), std::end(motion.from), std::begin(last->to));
    last->axes_to = last->axes_from;
}

MotionLog::MotionLog(std::unique_ptr<State> state) : state_(std::move(state)) {}
MotionLog::MotionLog(MotionLog&&) noexcept = default;
MotionLog& MotionLog::operator=(MotionLog&&) noexcept = default;
MotionLog::~MotionLog() {
    if (!state_) return;
    if (state_->refused) {
        state_->write_refusal();
        state_->write_kinematics(*state_->refused);
        state_->write_modes(*state_->refused);
        state_->write_motion(*state_->refused);
    }
    state_->file << "M2\n";
}

core::Result<MotionLog> MotionLog::begin(const std::string& path, const SetupFile& setup) {
    const size_t offset =
        setup.offsets_set.empty() ? 0 : static_cast<size_t>(*setup.offsets_set.begin());
    auto state = std::make_unique<State>();
    state->origin = setup.environment.work_offset(offset);
    state->kinematics = setup.environment.kinematics;
    for (size_t i = 0; i < core::axis_count; ++i)
        state->is_placed[i] = i < 3 || setup.setup.machine.axes[i].present;
    state->file.open(path, std::ios::binary | std::ios::trunc);
    state->file << comment_of("motions of the machine, recorded by feeler guard") << "\n"
                << comment_of("set-up: " + setup.path) << "\n"
                << "G21 G90 G40 G49 G80 G94 " << gcode::name_of_offset(offset) << "\n";
    state->file.flush();
    if (!state->file)
        return tl::unexpected(core::Error{core::ErrorCode::io, {}, "cannot be written", path});
    return MotionLog(std::move(state));
}

void MotionLog::State::write_refusal() {
    if (refused) file << comment_of("refused, not made: " + reason) << "\n";
}

void MotionLog::State::write(const LiveMotion& motion) {
    if (refused && motion.number > refused->number) {
        write_refusal();
        refused.reset();
    }
    write_kinematics(motion);
    write_modes(motion);
    write_motion(motion);
}

void MotionLog::add(const LiveMotion& motion) { state_->write(motion); }

void MotionLog::add_refused(const LiveMotion& motion, const std::string& reason) {
    state_->write_refusal();
    state_->refused = motion;
    state_->reason = reason;
    state_->file.flush();
}

void MotionLog::flush() { state_->file.flush(); }

bool MotionLog::is_whole() const { return state_->file.good(); }

} // namespace app
