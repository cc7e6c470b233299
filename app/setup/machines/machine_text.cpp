#include <algorithm>
#include <initializer_list>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/setup/machines/machine_preset.h"
#include "app/setup/presets/preset_lists.h"
#include "core/base/text.h"

namespace app {
namespace {

using Keys = std::initializer_list<std::string_view>;

std::string number(double value) { return core::number_text(value, 6); }

std::string point(double x, double y, double z) {
    return fmt::format("[{}, {}, {}]", number(x), number(y), number(z));
}

/// "a, b and c".
std::string list_text(const std::vector<std::string>& words) {
    if (words.size() < 2) return words.empty() ? std::string() : words[0];
    const std::vector<std::string> first(words.begin(), words.end() - 1);
    return fmt::format("{} and {}", fmt::join(first, ", "), words.back());
}

/// How the axes carry each other, and which keys their values have.
struct AxisPlace {
    char letter;
    bool is_on_table;
    char parent;      // 0: the base
    const char* keys; // as in `x_min`, `rapid_x`
};

/// Writes the file of one machine.
class MachineWriter {
public:
    MachineWriter(const MachinePreset& preset, const PresetValues& stated)
        : preset_(preset), stated_(stated) {}

    core::Result<MachineText> text();

private:
    std::optional<double> value(std::string_view key) const;
    double known(std::string_view key) const { return value(key).value_or(0.0); }
    bool has(Keys keys) const {
        return std::all_of(keys.begin(), keys.end(), [&](auto key) { return value(key); });
    }
    std::vector<std::string> missing(Keys keys) const;
    double middle(const char* low, const char* high) const {
        return 0.5 * (known(low) + known(high));
    }

    core::Result<void> check_range(const char* axis) const;
    core::Result<bool> is_described(Keys keys) const;
    core::Result<void> check() const;

    void write_comments();
    void write_axis(const AxisPlace& axis, const std::string& direction, const std::string& extra);
    void write_linear_axes();
    void write_rotary(const AxisPlace& axis, const std::string& at);
    void leave_out(const std::string& letters, Keys keys);
    core::Result<void> write_turning_table(Keys keys);
    core::Result<void> write_trunnion();
    void write_head();
    core::Result<void> write_rotary_axes();
    void write_body(const char* name, char axis, const std::string& shape);
    void write_spindle();
    void write_flat_table();
    void write_pallet();
    void write_round_table();
    void write_table();

    void note_origins();
    void note_missing(Keys keys, const std::string& consequence);

    const MachinePreset& preset_;
    const PresetValues& stated_;
    MachineText made_{};
    char last_tool_ = 'Z', last_table_ = 'Y';
};

std::optional<double> MachineWriter::value(std::string_view key) const {
    if (const auto found = stated_.find(key); found != stated_.end()) return found->second;
    const MachineSize* const size = preset_.size(key);
    return size ? size->standard : std::nullopt;
}

std::vector<std::string> MachineWriter::missing(Keys keys) const {
    std::vector<std::string> found;
    for (const std::string_view key : keys)
        if (!value(key)) found.emplace_back(key);
    return found;
}

// --- checks ---

core::Result<void> MachineWriter::check_range(const char* axis) const {
    const auto low = value(fmt::format("{}_min", axis)), high = value(fmt::format("{}_max", axis));
    if (low && high && !(*low < *high))
        return unfit_sizes(fmt::format("{0}_min must be below {0}_max", axis));
    return {};
}

/// Whether all of these sizes are known.
///
/// Errors: invalid_value if only some of them are.
core::Result<bool> MachineWriter::is_described(Keys keys) const {
    const std::vector<std::string> open = missing(keys);
    if (open.empty()) return true;
    if (open.size() == keys.size()) return false;
    return unfit_sizes(fmt::format("{} belong together: {} {} missing",
                                   list_text({keys.begin(), keys.end()}), list_text(open),
                                   open.size() == 1 ? "is" : "are"));
}

core::Result<void> MachineWriter::check() const {
    for (const auto& [key, stated] : stated_)
        if (const auto checked = check_machine_value(preset_, key, stated); !checked)
            return checked;
    for (const char* axis : {"x", "y", "z", "tilt", "rotary"})
        if (const auto checked = check_range(axis); !checked) return checked;
    return {};
}

// --- axes ---

void MachineWriter::write_comments() {
    const auto comment = [&](std::string_view line) { made_.toml += fmt::format("# {}\n", line); };
    comment(fmt::format("{}: {}", preset_.name, preset_.title));
    comment(preset_.source);
    comment(fmt::format("Machine zero: {}", preset_.zero));
    comment("Lengths in mm. Compare all values with the machine.");
}

void MachineWriter::write_axis(const AxisPlace& axis, const std::string& direction,
                               const std::string& extra) {
    std::string& text = made_.toml;
    text += fmt::format("\n[[axis]]\nname = \"{}\"\nside = \"{}\"\nparent = \"{}\"\n"
                        "direction = {}\n{}",
                        axis.letter, axis.is_on_table ? "table" : "tool",
                        axis.parent == 0 ? std::string("base") : std::string(1, axis.parent),
                        direction, extra);
    const auto add = [&](const char* key, const std::string& size) {
        if (const auto known = value(size)) text += fmt::format("{} = {}\n", key, number(*known));
    };
    add("min", fmt::format("{}_min", axis.keys));
    add("max", fmt::format("{}_max", axis.keys));
    if (value(fmt::format("{}_min", axis.keys)).value_or(0.0) <= 0.0
        && value(fmt::format("{}_max", axis.keys)).value_or(0.0) >= 0.0)
        text += "home = 0\n";
    add("rapid", fmt::format("rapid_{}", axis.keys));
    add("acceleration", fmt::format("acceleration_{}", axis.keys));
}

void MachineWriter::write_linear_axes() {
    const bool moves_table =
        preset_.kind == MachineKind::bench_mill || preset_.kind == MachineKind::knee_mill
        || preset_.kind == MachineKind::vertical || preset_.kind == MachineKind::head_table;
    write_axis({'X', moves_table, 0, "x"}, point(1, 0, 0), "");
    write_axis({'Y', moves_table, 'X', "y"}, point(0, 1, 0), "");
    write_axis({'Z', false, moves_table ? '\0' : 'Y', "z"}, point(0, 0, 1), "");
    last_table_ = moves_table ? 'Y' : '\0';
}

void MachineWriter::write_rotary(const AxisPlace& axis, const std::string& at) {
    const char letter = axis.letter;
    const double x = letter == 'A' ? 1 : 0, y = letter == 'B' ? 1 : 0, z = letter == 'C' ? 1 : 0;
    write_axis(axis, point(x, y, z), fmt::format("point = {}\n", at));
    (axis.is_on_table ? last_table_ : last_tool_) = letter;
}

void MachineWriter::leave_out(const std::string& letters, Keys keys) {
    std::vector<std::string> names;
    for (const char letter : letters) names.emplace_back(1, letter);
    const bool is_one = names.size() == 1;
    made_.others += letters;
    note_missing(keys, fmt::format("where {} turn{} is not known, and blocks that move {} are "
                                   "undecided",
                                   list_text(names), is_one ? "s" : "", is_one ? "it" : "them"));
}

core::Result<void> MachineWriter::write_turning_table(Keys keys) {
    FEELER_TRY(const bool is_known, is_described(keys));
    const char rotary = preset_.rotary;
    if (is_known)
        write_rotary({rotary, true, last_table_, "rotary"},
                     point(known("centre_x"), known("centre_y"), known("centre_z")));
    else
        leave_out(std::string(1, rotary), keys);
    return {};
}

core::Result<void> MachineWriter::write_trunnion() {
    const Keys keys = {"centre_x", "centre_y", "centre_z"};
    FEELER_TRY(const bool is_known, is_described(keys));
    if (!is_known) {
        leave_out({preset_.tilt, preset_.rotary}, keys);
        return {};
    }
    write_rotary({preset_.tilt, true, last_table_, "tilt"},
                 point(known("centre_x"), known("centre_y"), known("centre_z")));
    return write_turning_table(keys);
}

void MachineWriter::write_head() {
    const bool turns = preset_.kind == MachineKind::head_head;
    const std::string letters =
        turns ? std::string{preset_.tilt, preset_.rotary} : std::string(1, preset_.tilt);
    if (!value("pivot_length")) return leave_out(letters, {"pivot_length"});
    const std::string at = point(0, 0, known("pivot_length"));
    if (turns) write_rotary({preset_.rotary, false, last_tool_, "rotary"}, at);
    write_rotary({preset_.tilt, false, last_tool_, "tilt"}, at);
}

core::Result<void> MachineWriter::write_rotary_axes() {
    switch (preset_.kind) {
    case MachineKind::horizontal:
        return write_turning_table({"centre_x", "centre_z"});
    case MachineKind::trunnion:
        return write_trunnion();
    case MachineKind::head_table:
        write_head();
        return write_turning_table({"centre_x", "centre_y"});
    case MachineKind::head_head:
        write_head();
        return {};
    default:
        return {};
    }
}

// --- bodies ---

void MachineWriter::write_body(const char* name, char axis, const std::string& shape) {
    made_.toml += fmt::format("\n[[body]]\nname = \"{}\"\naxis = \"{}\"\n{}", name,
                              axis == 0 ? std::string("base") : std::string(1, axis), shape);
}

std::string box_text(double x0, double y0, double z0, double x1, double y1, double z1) {
    return fmt::format("box = [{}, {}]\n", point(x0, y0, z0), point(x1, y1, z1));
}

std::string cylinder_text(double radius, double height, const std::string& at) {
    return fmt::format("cylinder = {{ radius = {}, height = {} }}\nat = {}\n", number(radius),
                       number(height), at);
}

void MachineWriter::write_spindle() {
    const double length = known("nose_length"), half = known("head_width") / 2;
    const double height = known("head_height");
    if (length > 0.0 && known("nose_diameter") > 0.0)
        write_body("nose", last_tool_,
                   cylinder_text(known("nose_diameter") / 2, length, point(0, 0, 0)));
    if (!(half > 0.0 && height > 0.0)) return;
    const double back = preset_.size("head_depth") ? known("head_depth") : half;
    write_body("head", 'Z', box_text(-half, -half, length, half, back, length + height));
}

void MachineWriter::write_flat_table() {
    const Keys keys = {"nose_to_table", "table_length", "table_width"};
    if (!has(keys)) return note_missing(keys, "its table is not checked");
    const double x = middle("x_min", "x_max"), y = middle("y_min", "y_max");
    const double length = known("table_length") / 2, width = known("table_width") / 2;
    const double top = known("z_max") - known("nose_to_table");
    write_body("table", last_table_,
               box_text(x - length, y - width, top - known("table_thickness"), x + length,
                        y + width, top));
}

void MachineWriter::write_pallet() {
    const Keys keys = {"spindle_to_table", "table_length", "table_width", "centre_x", "centre_z"};
    if (!has(keys)) return note_missing(keys, "its table is not checked");
    const double x = known("centre_x"), z = known("centre_z");
    const double length = known("table_length") / 2, width = known("table_width") / 2;
    const double top = known("y_min") - known("spindle_to_table");
    write_body("table", last_table_,
               box_text(x - length, top - known("table_thickness"), z - width, x + length, top,
                        z + width));
}

void MachineWriter::write_round_table() {
    const bool tilts = preset_.kind == MachineKind::trunnion;
    const Keys on_cradle = {"table_diameter", "centre_to_table", "centre_x", "centre_y",
                            "centre_z"};
    const Keys upright = {"table_diameter", "nose_to_table", "centre_x", "centre_y"};
    const Keys keys = tilts ? on_cradle : upright;
    if (!has(keys)) return note_missing(keys, "its table is not checked");
    const double thickness = known("table_thickness");
    const double top = tilts ? known("centre_z") - known("centre_to_table")
                             : known("z_max") - known("nose_to_table");
    write_body("table", last_table_,
               cylinder_text(known("table_diameter") / 2, thickness,
                             point(known("centre_x"), known("centre_y"), top - thickness)));
}

void MachineWriter::write_table() {
    if (!(known("table_thickness") > 0.0)) return;
    if (preset_.size("table_diameter")) return write_round_table();
    if (preset_.kind == MachineKind::horizontal) return write_pallet();
    write_flat_table();
}

// --- notes ---

void MachineWriter::note_missing(Keys keys, const std::string& consequence) {
    made_.notes.push_back(fmt::format("nothing states {} of {}, so {}", list_text(missing(keys)),
                                      preset_.name, consequence));
}

void MachineWriter::note_origins() {
    std::vector<std::string> usual, of_source;
    for (const MachineSize& size : preset_.sizes) {
        if (!size.standard || stated_.contains(size.key)) continue;
        (size.is_typical ? usual : of_source).emplace_back(size.key);
    }
    if (!of_source.empty())
        made_.notes.push_back(fmt::format("{} are those of the preset {}, not measured",
                                          list_text(of_source), preset_.name));
    if (!usual.empty())
        made_.notes.push_back(
            fmt::format("{} {} typical of such machines, not stated by the {} of {}",
                        list_text(usual), usual.size() == 1 ? "is" : "are",
                        preset_.is_generic ? "maker" : "source", preset_.name));
    std::string zero(preset_.zero);
    zero[0] = static_cast<char>(zero[0] - 'A' + 'a');
    zero.pop_back();
    made_.notes.push_back(fmt::format("the zero of {} is {}", preset_.name, zero));
    if (preset_.rotary != 0 && made_.others.empty())
        made_.notes.push_back(fmt::format("the rotary axes of {} turn as ISO 841 has it: positive "
                                          "is right-handed for the tool against the work",
                                          preset_.name));
}

core::Result<MachineText> MachineWriter::text() {
    if (const auto checked = check(); !checked) return tl::unexpected(checked.error());
    write_comments();
    write_linear_axes();
    if (const auto written = write_rotary_axes(); !written) return tl::unexpected(written.error());
    write_spindle();
    write_table();
    note_origins();
    return std::move(made_);
}

} // namespace

core::Result<MachineText> machine_text(const MachinePreset& preset, const PresetValues& stated) {
    return MachineWriter(preset, stated).text();
}

} // namespace app
