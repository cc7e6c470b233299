#include "app/setup/inference/inferred_stock.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/setup/inference/program_survey.h"
#include "app/setup/tools/program_tools.h"
#include "core/base/math.h"
#include "core/base/text.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/language/lexer.h"
#include "gcode/language/modal_state.h"
#include "gcode/text/source.h"

namespace app {
namespace {

using core::Aabb;
using core::Vec3;

constexpr double below_the_cuts = 2.0; // mm of stock under the deepest cut
constexpr double smallest_height = 1.0;

/// Lengths in a sentence: mm with three decimals, inches with four.
struct StockWords {
    gcode::LengthUnit unit;

    bool is_inch() const { return unit == gcode::LengthUnit::inch; }
    std::string at(double mm) const {
        return fmt::format("{:.{}f}", gcode::from_mm(mm, unit), is_inch() ? 4 : 3);
    }
    std::string size(double mm) const {
        return is_inch() ? core::number_text(gcode::from_mm(mm, unit), 4) + " in"
                         : fmt::format("{:g} mm", mm);
    }
};

/// The top of the material relative to a zero, and why.
struct Top {
    double z = 0.0;
    std::string why;
};

Top top_of(const ProgramSurvey& seen, double zero) {
    constexpr double near = 2.0,
                     fraction = 0.25; // ramps and leads begin up to this height above zero
    const double lowest = seen.lowest - zero;
    if (seen.retract && *seen.retract - zero < 0.0 && *seen.retract > seen.lowest)
        return {*seen.retract - zero, "where rapids travel"};
    if (!seen.cuts_sideways)
        return lowest < 0.0 ? Top{0.0, "at Z0, where cuts go below it"}
                            : Top{lowest + smallest_height, "just above the deepest feed"};
    const double highest = seen.highest_cut - zero;
    const bool at_zero = lowest < 0.0 && highest <= std::max(near, -fraction * lowest);
    if (at_zero) return {0.0, "at Z0, where cuts go below it"};
    return {highest, "at the highest cut"};
}

/// Lowers a top above zero to the end of the lowest rapid plunge, such as those before drilling.
void lower_top(const std::vector<UncutPlunge>& plunges, double zero, Aabb& box, Top& top) {
    for (const UncutPlunge& plunge : plunges) {
        const double z = plunge.tip.z;
        if (z < zero || z >= box.max.z || z < box.min.z + smallest_height) continue;
        box.max.z = z;
        top.why = fmt::format("where the rapid in line {} ends", plunge.line);
    }
}

/// The sides of a box that move inwards, and the plunge that stops each.
struct Sides {
    Aabb whole, box;
    std::array<const UncutPlunge*, 4> ends{}; // X from, X to, Y from, Y to

    double& coordinate(size_t side) {
        return side % 2 == 0 ? box.min[static_cast<int>(side / 2)]
                             : box.max[static_cast<int>(side / 2)];
    }

    /// The position of a side that makes a plunge pass just outside.
    static double side_of(const UncutPlunge& plunge, size_t side) {
        const double at = plunge.tip[static_cast<int>(side / 2)];
        return side % 2 == 0 ? at + plunge.radius : at - plunge.radius;
    }

    bool holds(const UncutPlunge& plunge) {
        for (size_t side = 0; side < 4; ++side)
            if ((side % 2 == 0) == (side_of(plunge, side) <= coordinate(side))) return false;
        return true;
    }

    void go_back(const UncutPlunge& plunge) {
        constexpr double most = 0.2; // of the whole size, both sides together
        double least = most;
        std::optional<size_t> chosen;
        for (size_t side = 0; side < 4; ++side) {
            const int axis = static_cast<int>(side / 2);
            const double gone = std::abs(side_of(plunge, side) - coordinate(side))
                                + whole.size()[axis] - box.size()[axis];
            const double fraction = gone / whole.size()[axis];
            if (fraction >= least) continue;
            least = fraction;
            chosen = side;
        }
        if (!chosen) return;
        coordinate(*chosen) = side_of(plunge, *chosen);
        ends[*chosen] = &plunge;
    }

    std::string why(const Vec3& frame, const StockWords& words) {
        constexpr const char* names[] = {"X", "X", "Y", "Y"};
        std::string text;
        for (size_t side = 0; side < 4; ++side)
            if (ends[side])
                text += fmt::format("{} {} {}, because line {} plunges next to it by rapid",
                                    text.empty() ? "; it ends at" : " and at", names[side],
                                    words.at(coordinate(side) - frame[static_cast<int>(side / 2)]),
                                    ends[side]->line);
        return text;
    }
};

} // namespace

InferredStock guessed_stock(const ProgramSurvey& seen, const Vec3& frame, double margin) {
    return guessed_stock(seen, frame, margin, {});
}

InferredStock guessed_stock(const ProgramSurvey& seen, const Vec3& frame, double margin,
                            const std::vector<UncutPlunge>& plunges) {
    if (!seen.feeds) {
        const auto sentence = [](const StockWords& words) {
            return fmt::format("the program cuts nothing, so the stock is a cube of {} at its zero",
                               words.size(10.0));
        };
        return {{frame + Vec3(-5, -5, -5), frame + Vec3(5, 5, 0)},
                sentence({gcode::LengthUnit::mm}),
                sentence({gcode::LengthUnit::inch})};
    }
    Top top = top_of(seen, seen.zero.z);
    const double below = std::max(margin, below_the_cuts);
    Aabb box{seen.cutting.min - Vec3(margin, margin, 0.0),
             seen.cutting.max + Vec3(margin, margin, 0.0)};
    box.min.z = seen.lowest - below;
    box.max.z = std::max(top.z + seen.zero.z, box.min.z + smallest_height);
    lower_top(plunges, seen.zero.z, box, top);
    Sides sides{box, box};
    for (const UncutPlunge& plunge : plunges)
        if (plunge.tip.z < box.max.z && sides.holds(plunge)) sides.go_back(plunge);
    const Vec3 low = sides.box.min - frame, high = sides.box.max - frame;
    const auto sentence = [&](const StockWords& words) {
        return fmt::format("the stock is the box that cutting moves reach{}: X {} to {}, "
                           "Y {} to {}, Z {} ({} below the deepest cut) to {} ({}){}",
                           margin > 0.0 ? fmt::format(" plus {} per side", words.size(margin)) : "",
                           words.at(low.x), words.at(high.x), words.at(low.y), words.at(high.y),
                           words.at(low.z), words.size(below), words.at(high.z), top.why,
                           sides.why(frame, words));
    };
    return {sides.box, sentence({gcode::LengthUnit::mm}), sentence({gcode::LengthUnit::inch})};
}

std::string box_text(const Aabb& box, gcode::LengthUnit unit) {
    const StockWords words{unit};
    return fmt::format("X {} to {}, Y {} to {}, Z {} to {}", words.at(box.min.x),
                       words.at(box.max.x), words.at(box.min.y), words.at(box.max.y),
                       words.at(box.min.z), words.at(box.max.z));
}

core::Aabb unreachable_box() { return {{-5, -5, -100'010}, {5, 5, -100'000}}; }

namespace {

constexpr double same_height = 0.05; // mm

/// The lowest Z of feeds, in square cells over a box.
class CutHeights {
public:
    CutHeights(const Aabb& box, double widest)
        : box_(box),
          cell_(std::max({0.5, std::max(box.size().x, box.size().y) / 400.0, widest / 8.0})),
          columns_(1 + static_cast<long>(box.size().x / cell_)),
          rows_(1 + static_cast<long>(box.size().y / cell_)),
          heights_(static_cast<size_t>(columns_ * rows_), box.max.z) {}

    void cut(const TipTrack& track, double radius) {
        for (size_t i = 1; i < track.positions.size(); ++i) {
            const Vec3 from = track.positions[i - 1], way = track.positions[i] - from;
            const long steps = 1 + static_cast<long>(core::hypot(way.x, way.y) / cell_);
            for (long step = 0; step <= steps; ++step)
                cut(from + way * (static_cast<double>(step) / static_cast<double>(steps)), radius);
        }
    }

    /// Whether a tool at this point is in uncut material. Cells count by their centres. Because a
    /// cut is recorded at discrete points, its side may be missing by up to `missed` between two of
    /// them; the radius is reduced by that.
    bool is_uncut(const Vec3& tip, double radius) const {
        const double missed = 0.01 + cell_ * cell_ / (8.0 * std::max(radius, cell_));
        bool uncut = false;
        visit(tip, radius - missed,
              [&](size_t at) { uncut |= heights_[at] > tip.z + same_height; });
        return uncut;
    }

private:
    void cut(const Vec3& tip, double radius) {
        visit(tip, radius, [&](size_t at) { heights_[at] = std::min(heights_[at], tip.z); });
    }

    /// Calls for every cell whose centre lies within the radius, and at least for the cell below.
    template <typename Visit>
    void visit(const Vec3& position, double radius, Visit&& call) const {
        const double x = (position.x - box_.min.x) / cell_, y = (position.y - box_.min.y) / cell_;
        const double reach = std::max(0.75, radius / cell_);
        const auto first = [](double v, long count) {
            return static_cast<long>(std::clamp(std::floor(v), 0.0, double(count)));
        };
        const auto last = [](double v, long count) {
            return static_cast<long>(std::clamp(std::floor(v), -1.0, double(count - 1)));
        };
        const long first_column = first(x - reach, columns_);
        const long last_column = last(x + reach, columns_), last_row = last(y + reach, rows_);
        for (long row = first(y - reach, rows_); row <= last_row; ++row) {
            const double up = static_cast<double>(row) + 0.5 - y;
            for (long column = first_column; column <= last_column; ++column) {
                const double aside = static_cast<double>(column) + 0.5 - x;
                if (aside * aside + up * up <= reach * reach)
                    call(static_cast<size_t>(row * columns_ + column));
            }
        }
    }

    Aabb box_;
    double cell_;
    long columns_, rows_;
    std::vector<double> heights_;
};

bool goes_straight_down(const TipTrack& track) {
    return !track.sideways && track.positions.back().z < track.positions[0].z;
}

bool ends_inside(const TipTrack& track, const Aabb& box) {
    const Vec3& tip = track.positions.back();
    return tip.z < box.max.z - same_height && tip.x > box.min.x && tip.x < box.max.x
           && tip.y > box.min.y && tip.y < box.max.y;
}

} // namespace

std::vector<UncutPlunge> uncut_plunges(const gcode::Program& program,
                                       const gcode::Environment& environment,
                                       const SurveyTools& tools, const Aabb& box) {
    double widest = 0.0;
    for (const auto& [number, radius] : tools.radii) widest = std::max(widest, radius);
    CutHeights heights(box, widest);
    std::vector<UncutPlunge> plunges;
    visit_events(program, environment, [&](const ProgramEvent& event) {
        const auto* motion = std::get_if<core::Motion>(&event.event);
        if (!motion) return;
        const auto track =
            tip_track(*motion, size_of(tools.lengths, event.tool), event.offsets.machine);
        if (!track) return;
        const double radius = size_of(tools.radii, event.tool);
        if (motion->kind != core::MotionKind::rapid)
            heights.cut(*track, radius);
        else if (goes_straight_down(*track) && ends_inside(*track, box)
                 && heights.is_uncut(track->positions.back(), radius))
            plunges.push_back({track->positions.back(), radius, event.line});
    });
    return plunges;
}

namespace {

using core::Vec3;

std::optional<double> number_in(std::string text) {
    if (text.starts_with('+')) text.erase(0, 1);
    for (char& c : text)
        if (c == ',') c = '.'; // decimal comma of German settings
    double value = 0.0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc() || end == text.data()) return std::nullopt;
    return value;
}

/// The corner after BLK FORM 0.1 or 0.2, in a code without blanks: X-5Y+0Z-20. A coordinate with an
/// I in front is relative to the other corner.
std::optional<Vec3> corner_in(const std::string& words, const Vec3& other) {
    Vec3 corner(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const size_t at = words.find("XYZ"[axis], words.starts_with("Z") && axis == 2 ? 1 : 0);
        if (at == std::string::npos) return std::nullopt;
        const auto value = number_in(words.substr(at + 1));
        if (!value) return std::nullopt;
        const bool counts_on = at > 0 && words[at - 1] == 'I';
        corner[axis] = *value + (counts_on ? other[axis] : 0.0);
    }
    return corner;
}

std::vector<std::string> arguments_of(const std::string& code, size_t opening) {
    std::vector<std::string> arguments(1);
    for (size_t at = opening + 1; at < code.size() && code[at] != ')'; ++at) {
        if (code[at] == ',')
            arguments.emplace_back();
        else if (code[at] != '"')
            arguments.back() += code[at];
    }
    return arguments;
}

/// WORKPIECE(,,,"BOX",112,top,bottom,machining depth,x,y,x,y)
std::optional<std::array<Vec3, 2>> workpiece_box(const std::vector<std::string>& arguments) {
    constexpr size_t form = 3, first = 5, count = 12;
    if (arguments.size() < count || arguments[form] != "BOX") return std::nullopt;
    std::array<double, count - first> n{};
    for (size_t i = 0; i < n.size(); ++i) {
        const auto value = number_in(arguments[first + i]);
        if (!value && i != 2) return std::nullopt;
        n[i] = value.value_or(0.0);
    }
    return std::array{Vec3(n[3], n[4], n[1]), Vec3(n[5], n[6], n[0])};
}

std::string capitals(std::string_view text) {
    std::string result;
    for (const char c : text)
        if (c != ' ' && c != '\t' && c != '\r') result += core::upper(c);
    return result;
}

/// The header of Vectric's programs, comment by comment.
struct MaterialHeader {
    bool announced = false; // (Material Size)
    std::optional<Vec3> size{};
    bool zero_on_table = false;
    std::string corner; // position of zero: BOTTOMLEFT, CENTER; empty if not stated
    size_t line = 0;

    void comment(const std::string& words, size_t number) {
        const auto says = [&](const char* text) { return words.find(text) != std::string::npos; };
        if (says("MATERIALSIZE")) announced = true;
        if (says("ZORIGIN") || says("ZZERO")) zero_on_table = says("TABLE") || says("BOTTOM");
        for (const char* name : {"BOTTOMLEFT", "BOTTOMRIGHT", "TOPLEFT", "TOPRIGHT", "CENT"})
            if (says("XYORIGIN") && says(name)) corner = name;
        if (!announced || size) return;
        Vec3 read(0.0);
        for (int axis = 0; axis < 3; ++axis) {
            const size_t at = words.find(std::string(1, "XYZ"[axis]) + "=");
            if (at == std::string::npos) return;
            read[axis] = number_in(words.substr(at + 2)).value_or(0.0);
        }
        size = read;
        line = number;
    }

    /// The low corner relative to program zero, in program units.
    std::optional<Vec3> low(const std::optional<core::Aabb>& reach, double scale) const {
        Vec3 result(0.0, 0.0, zero_on_table ? 0.0 : -size->z);
        if (corner == "CENT") {
            result.x = -0.5 * size->x;
            result.y = -0.5 * size->y;
        } else if (!corner.empty()) {
            if (corner.ends_with("RIGHT")) result.x = -size->x;
            if (corner.starts_with("TOP")) result.y = -size->y;
        } else {
            if (!reach) return std::nullopt;
            const auto holds = [&](const Vec3& low) {
                constexpr double beyond = 0.1; // of the size, because outlines are cut outside
                const Vec3 room = (1.0 + beyond) * *size, from = low - beyond * *size;
                return reach->min.x >= scale * from.x && reach->min.y >= scale * from.y
                       && reach->max.x <= scale * (low + room).x
                       && reach->max.y <= scale * (low + room).y;
            };
            const Vec3 middle(-0.5 * size->x, -0.5 * size->y, result.z);
            if (holds(result)) return result;
            if (!holds(middle)) return std::nullopt;
            return middle;
        }
        return result;
    }
};

struct Scan {
    gcode::LengthUnit unit;
    std::optional<Vec3> first{};
    std::optional<DeclaredStock> found{};
    MaterialHeader header{};

    void take(const Vec3& a, const Vec3& b, std::string source) {
        const core::Aabb box{glm::min(a, b), glm::max(a, b)};
        const Vec3 size = box.size();
        if (size.x <= 0.0 || size.y <= 0.0 || size.z <= 0.0) return;
        const double scale = gcode::to_mm(1.0, unit);
        found = {{box.min * scale, box.max * scale}, std::move(source)};
    }

    void blank_form(const std::string& code, size_t number) {
        const size_t blank = code.find("BLKFORM0.");
        if (blank == std::string::npos || blank + 10 > code.size()) return;
        const auto corner = corner_in(code.substr(blank + 10), first.value_or(Vec3(0.0)));
        if (code[blank + 9] == '1')
            first = corner;
        else if (first && corner)
            take(*first, *corner, fmt::format("BLK FORM in line {}", number));
    }

    void line(std::string_view text, size_t number) {
        const std::string code = capitals(text.substr(0, text.find(';')));
        blank_form(code, number);
        if (const size_t piece = code.find("WORKPIECE("); piece != std::string::npos)
            if (const auto box = workpiece_box(arguments_of(code, piece + 9)))
                take((*box)[0], (*box)[1], fmt::format("WORKPIECE in line {}", number));
        if (code.starts_with('(') || text.starts_with(';'))
            header.comment(capitals(text.substr(1)), number);
    }

    void end(const std::optional<core::Aabb>& reach) {
        if (found || !header.size) return;
        if (const auto low = header.low(reach, gcode::to_mm(1.0, unit)))
            take(*low, *low + *header.size,
                 fmt::format("the material's size in line {}", header.line));
    }
};

} // namespace

std::optional<DeclaredStock> declared_stock(const gcode::Program& program, gcode::LengthUnit unit,
                                            const std::optional<core::Aabb>& reach) {
    Scan scan{unit};
    for (size_t line = 1; line <= program.line_count(); ++line) scan.line(program.line(line), line);
    scan.end(reach);
    return scan.found;
}

} // namespace app
