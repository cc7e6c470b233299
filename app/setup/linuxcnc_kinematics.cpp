#include "app/setup/linuxcnc_kinematics.h"

#include <cmath>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/setup/hal_settings.h"
#include "core/base/math.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "core/motion/machine.h"

namespace app {
namespace {

using core::Side;
using core::Vec3;
using Type = gcode::SwitchableKinematics::Type;

/// Values of the pins of a module.
class Pins {
public:
    /// `unit`: mm per unit of the machine's lengths.
    Pins(std::string prefix, const HalSettings& hal,
         const std::map<std::string, std::optional<double>, std::less<>>& stated, double unit,
         std::string without = {})
        : prefix_(std::move(prefix)),
          hal_(hal),
          stated_(stated),
          unit_(unit),
          without_(std::move(without)) {}

    /// A length, mm.
    double operator()(const char* name) { return unit_ * plain(name); }
    /// An angle or a switch.
    double plain(const char* name) {
        const std::string pin = prefix_ + "." + name;
        const auto known = stated_.find("_hal[" + pin + "]");
        if (known != stated_.end() && known->second) return *known->second;
        const auto value = hal_.value(pin, without_);
        if (!value) unknown_.push_back(pin);
        return value.value_or(0.0);
    }

    const std::vector<std::string>& unknown() const { return unknown_; }

private:
    std::string prefix_;
    const HalSettings& hal_;
    const std::map<std::string, std::optional<double>, std::less<>>& stated_;
    double unit_ = 1.0;
    std::string without_;
    std::vector<std::string> unknown_;
};

/// Adds rotary axes, each side from the base on.
class Chain {
public:
    void add(char letter, Side side, const Vec3& direction, const Vec3& point) {
        const size_t axis = core::axis_letters.find(letter);
        core::LinkId& last = side == Side::table ? machine.table : machine.spindle;
        machine.axes[axis] = {
            .direction = direction, .present = true, .side = side, .point = point, .carrier = last};
        last = core::link_of(axis);
    }

    core::Machine machine;
};

/// A module: its pins and the machine they describe.
struct Module {
    std::string_view name, pins, tool_length; // prefix of its pins; the pin for the tool length
    std::string_view coordinates;             // unless the ini file says otherwise
    std::vector<Type> types;
    bool may_begin_with_identity; // sparm=identityfirst exchanges the first two types
    core::Machine (*machine)(Pins& pin);
};

core::Machine table_tilting_about_x(Pins& pin) {
    const Vec3 at(pin("x-rot-point"), pin("y-rot-point"), pin("z-rot-point"));
    const double sense = pin.plain("conventional-directions") != 0.0 ? 1.0 : -1.0;
    Chain chain;
    chain.add('A', Side::table, {sense, 0.0, 0.0},
              at + Vec3(0.0, pin("y-offset"), pin("z-offset")));
    chain.add('C', Side::table, {0.0, 0.0, sense}, at);
    return chain.machine;
}

core::Machine table_tilting_about_y(Pins& pin) {
    const Vec3 at(pin("x-rot-point"), pin("y-rot-point"), pin("z-rot-point"));
    const double sense = pin.plain("conventional-directions") != 0.0 ? 1.0 : -1.0;
    Chain chain;
    chain.add('B', Side::table, {0.0, sense, 0.0},
              at + Vec3(pin("x-offset"), 0.0, pin("z-offset")));
    chain.add('C', Side::table, {0.0, 0.0, sense}, at);
    return chain.machine;
}

core::Machine two_rotary_tables(Pins& pin) {
    const Vec3 at(pin("x-rot-point"), pin("y-rot-point"), pin("z-rot-point"));
    Chain chain;
    chain.add('B', Side::table, {0.0, 1.0, 0.0}, at);
    chain.add('A', Side::table, {1.0, 0.0, 0.0}, at + Vec3(0.0, 0.0, pin("z-offset")));
    return chain.machine;
}

core::Machine head_on_head(Pins& pin) {
    const double sense = pin.plain("conventional-directions") != 0.0 ? 1.0 : -1.0;
    Chain chain;
    chain.add('C', Side::tool, {0.0, 0.0, 1.0}, Vec3(0.0));
    chain.add('B', Side::tool, {0.0, sense, 0.0}, {0.0, 0.0, pin("pivot-length")});
    // Only if the set-up says that W has no motor, so that the other axes move the tip along the
    // tool instead (control_table.cpp).
    const size_t w = core::axis_letters.find('W');
    chain.machine.axes[w] = {.direction = {0.0, 0.0, 1.0}, .present = true, .side = Side::tool};
    chain.machine.length_axis = w;
    return chain.machine;
}

core::Machine nutating_head_and_table_about_x(Pins& pin) {
    const double angle = core::radians_of(pin.plain("nut-angle"));
    const Vec3 pivot(0.0, pin("y-pivot"), pin("z-pivot"));
    Chain chain;
    chain.add('A', Side::table, {1.0, 0.0, 0.0}, {0.0, pin("y-rot-axis"), pin("z-rot-axis")});
    chain.add('C', Side::tool, {0.0, 0.0, 1.0},
              pivot + Vec3(pin("x-offset"), pin("y-offset"), 0.0));
    chain.add('B', Side::tool, {0.0, core::sin(angle), core::cos(angle)}, pivot);
    return chain.machine;
}

core::Machine nutating_head_and_table_about_y(Pins& pin) {
    const double angle = core::radians_of(pin.plain("nut-angle"));
    const Vec3 pivot(pin("x-pivot"), 0.0, pin("z-pivot"));
    Chain chain;
    chain.add('B', Side::table, {0.0, 1.0, 0.0}, {pin("x-rot-axis"), 0.0, pin("z-rot-axis")});
    chain.add('C', Side::tool, {0.0, 0.0, 1.0},
              pivot + Vec3(pin("x-offset"), pin("y-offset"), 0.0));
    chain.add('A', Side::tool, {core::sin(angle), 0.0, core::cos(angle)}, pivot);
    return chain.machine;
}

const std::vector<Module>& modules() {
    static const std::vector<Module> all = {
        {"xyzac-trt-kins",
         "xyzac-trt-kins",
         "tool-offset",
         "XYZAC",
         {Type::tip, Type::axes, Type::other},
         true,
         table_tilting_about_x},
        {"xyzbc-trt-kins",
         "xyzbc-trt-kins",
         "tool-offset",
         "XYZBC",
         {Type::tip, Type::axes, Type::other},
         true,
         table_tilting_about_y},
        {"xyzab_tdr_kins",
         "xyzab_tdr_kins",
         "tool-offset-z",
         "XYZAB",
         {Type::axes, Type::tip},
         false,
         two_rotary_tables},
        {"5axiskins",
         "5axiskins",
         "pivot-length",
         "XYZBCW",
         {Type::tip, Type::axes, Type::other},
         true,
         head_on_head},
        {"xyzacb_trsrn",
         "xyzacb_trsrn_kins",
         "tool-offset-z",
         "XYZABC",
         {Type::axes, Type::tip, Type::other},
         false,
         nutating_head_and_table_about_x},
        {"xyzbca_trsrn",
         "xyzbca_trsrn_kins",
         "tool-offset-z",
         "XYZABC",
         {Type::axes, Type::tip, Type::other},
         false,
         nutating_head_and_table_about_y},
    };
    return all;
}

const Module* module_named(const std::string& name) {
    for (const Module& each : modules())
        if (each.name == name) return &each;
    return nullptr;
}

/// The value of `name=value` in the settings of a module.
std::string setting(const std::string& settings, const std::string& name) {
    for (const std::string& word : words_of_line(settings))
        if (core::lower_case(word).starts_with(name + "=")) return word.substr(name.size() + 1);
    return {};
}

/// "A turns the table, direction [-1 0 0], point [0 20 10]; C ...", as in [[machine.axis]].
std::string text_of_axes(const core::Machine& machine) {
    const auto text_of = [](const Vec3& v) {
        return fmt::format("[{} {} {}]", core::number_text(v.x, 4), core::number_text(v.y, 4),
                           core::number_text(v.z, 4));
    };
    std::string text;
    for (size_t axis = 3; axis < 6; ++axis)
        if (const core::MachineAxis& entry = machine.axes[axis]; entry.present)
            text += fmt::format("{}{} turns the {}, direction {}, point {}",
                                text.empty() ? "" : "; ", core::axis_letters[axis],
                                entry.side == core::Side::table ? "table" : "head",
                                text_of(entry.direction), text_of(entry.point));
    return text;
}

/// The number of the analogue output that is connected to the selection of the kinematics.
std::optional<int> selecting_output(const HalSettings& hal) {
    const std::string beginning = "motion.analog-out-";
    const std::string pin = hal.joined("motion.switchkins-type", beginning);
    const auto number = pin.empty() ? std::nullopt : number_in(pin.substr(beginning.size()));
    return number ? std::optional(static_cast<int>(*number)) : std::nullopt;
}

} // namespace

bool is_known_kinematics(const std::string& module) { return module_named(module) != nullptr; }

std::optional<LinuxcncKinematics>
linuxcnc_kinematics(const std::string& module, const std::string& settings, const HalSettings& hal,
                    const std::map<std::string, std::optional<double>, std::less<>>& stated,
                    double unit) {
    const Module* const found = module_named(module);
    if (!found) return std::nullopt;

    LinuxcncKinematics result;
    gcode::SwitchableKinematics& switches = result.switches;
    switches.module = module;
    switches.types = found->types;
    if (found->may_begin_with_identity && setting(settings, "sparm") == "identityfirst")
        std::swap(switches.types[0], switches.types[1]);
    switches.output = selecting_output(hal);
    switches.coordinates = core::upper_case(setting(settings, "coordinates"));
    if (switches.coordinates.empty()) switches.coordinates = found->coordinates;

    const std::string length_pin = fmt::format("{}.{}", found->pins, found->tool_length);
    Pins pins(std::string(found->pins), hal, stated, unit, "motion.tooloffset.z");
    core::Machine machine = found->machine(pins);
    if (!hal.is_fed_by(length_pin, "motion.tooloffset.z"))
        result.notes.push_back(fmt::format(
            "no HAL command connects motion.tooloffset.z with {}: it is assumed that the control "
            "takes the tool length into account while it follows the tip",
            length_pin));
    if (pins.unknown().empty()) {
        result.notes.push_back(fmt::format("{}: {}", module, text_of_axes(machine)));
        switches.machine = std::make_shared<const core::Machine>(std::move(machine));
        return result;
    }
    std::string names;
    for (const std::string& pin : pins.unknown())
        names += fmt::format("{}\"#<_hal[{}]>\"", names.empty() ? "" : ", ", pin);
    result.notes.push_back(fmt::format(
        "where the rotary axes of {} are is not known, because the HAL commands do not set all of "
        "its pins: state {} under [program.values] in the set-up",
        module, names));
    return result;
}

} // namespace app
