#include "app/gate/grbl_protocol.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <iterator>
#include <sstream>
#include <vector>

#include "core/base/text.h"
#include "core/base/units.h"

namespace app {
namespace {

std::vector<std::string_view> parts_of(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    while (true) {
        const size_t end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

std::optional<double> number_of(std::string_view text) {
    double value = 0.0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ec != std::errc() || read.ptr != text.data() + text.size()) return {};
    return value;
}

/// The first three numbers; a controller may have more axes.
std::optional<core::Vec3> vector_of(std::string_view text) {
    const auto parts = parts_of(text, ',');
    if (parts.size() < 3) return {};
    core::Vec3 value(0.0);
    for (int i = 0; i < 3; ++i) {
        const auto number = number_of(parts[static_cast<size_t>(i)]);
        if (!number) return {};
        value[i] = *number;
    }
    return value;
}

/// Whether a start-up line may move the machine: G28 and G30 do so without an axis, too.
bool may_move(std::string_view line) {
    return line.find_first_of("XYZABCUVW") != std::string_view::npos
           || line.find("G28") != std::string_view::npos
           || line.find("G30") != std::string_view::npos;
}

} // namespace

std::string as_grbl_reads(std::string_view line) {
    std::string text;
    bool in_comment = false;
    for (const char c : line) {
        if (in_comment) {
            in_comment = c != ')';
        } else if (c == ';') {
            break;
        } else if (c == '(') {
            in_comment = true;
        } else if (static_cast<unsigned char>(c) > ' ' && c != '/') {
            text += core::upper(c);
        }
    }
    return text;
}

GrblLine kind_of(std::string_view text) {
    if (text.empty()) return GrblLine::empty;
    if (text.starts_with("$J=")) return GrblLine::jog;
    if (text == "$X") return GrblLine::unlock;
    if (text == "$H") return GrblLine::home;
    for (const std::string_view request : {"$", "$$", "$#", "$G", "$I", "$N", "$C", "$SLP"})
        if (text == request) return GrblLine::request;
    if (std::isalpha(static_cast<unsigned char>(text[0])) || text[0] == '%') return GrblLine::code;
    return GrblLine::other;
}

bool acts_at_once(char byte) {
    const auto code = static_cast<unsigned char>(byte);
    return byte == status_request || byte == feed_hold || byte == '~' || byte == soft_reset
           || code == 0x84 || code == 0x85 || (code >= 0x90 && code <= 0x9e) || code == 0xa0
           || code == 0xa1 || byte == other_hold || byte == stop;
}

bool is_dropped(char byte) {
    return static_cast<unsigned char>(byte) >= 0x80 && !acts_at_once(byte);
}

std::optional<GrblStatus> read_status(std::string_view line) {
    if (line.size() < 3 || line.front() != '<' || line.back() != '>') return {};
    const auto fields = parts_of(line.substr(1, line.size() - 2), '|');
    GrblStatus status;
    status.state = fields[0].substr(0, fields[0].find(':'));
    for (const std::string_view field : fields) {
        if (field.starts_with("MPos:")) status.mpos = vector_of(field.substr(5));
        if (field.starts_with("WPos:")) status.wpos = vector_of(field.substr(5));
    }
    return status;
}

core::Vec3 GrblFacts::scaled(core::Vec3 reported) const {
    return reports_inches ? reported * core::mm_per_inch : reported;
}

std::optional<size_t> GrblFacts::active() const {
    const size_t at = modes.find("G5");
    for (size_t i = at; i != std::string::npos; i = modes.find("G5", i + 1))
        if (i + 2 < modes.size() && modes[i + 2] >= '4' && modes[i + 2] <= '9')
            return static_cast<size_t>(modes[i + 2] - '4');
    return {};
}

std::string GrblFacts::unknown_mode() const {
    // G49 and the codes after it: the only ones of these groups that leave things as Grbl has them.
    constexpr std::string_view known[] = {
        "G0",  "G1",  "G2",  "G3",  "G38.2", "G38.3", "G38.4", "G38.5", "G80", "G54", "G55",
        "G56", "G57", "G58", "G59", "G17",   "G18",   "G19",   "G20",   "G21", "G90", "G91",
        "G93", "G94", "G40", "G61", "G91.1", "G43.1", "G49",   "G50",   "G97", "G98", "G99"};
    std::istringstream words(modes);
    for (std::string word; words >> word;)
        if (word[0] == 'G'
            && std::find(std::begin(known), std::end(known), word) == std::end(known))
            return word;
    return {};
}

void GrblFacts::take(std::string_view line) {
    const auto offset = [&](std::string_view name, core::Vec3& value, unsigned bit) {
        if (!line.starts_with(name) || line.back() != ']') return;
        const auto read = vector_of(line.substr(name.size(), line.size() - name.size() - 1));
        if (!read) return;
        value = scaled(*read);
        seen |= 1u << bit;
    };
    for (unsigned i = 0; i < 6; ++i)
        offset("[G5" + std::string(1, static_cast<char>('4' + i)) + ":", offsets[i], i);
    offset("[G92:", axis_offset, 6);
    offset("[G28:", home, 7);
    offset("[G30:", second_home, 8);
    if (line.starts_with("[TLO:") && line.back() == ']') {
        // One number for Z, or one for each axis (grblHAL).
        const auto parts = parts_of(line.substr(5, line.size() - 6), ',');
        if (const auto length = number_of(parts[parts.size() >= 3 ? 2 : 0])) {
            length_offset = scaled({0.0, 0.0, *length}).z;
            seen |= 1u << 9;
        }
    }
    if (line.starts_with("[GC:")) modes = line.substr(4, line.size() - 5);
    if (line.starts_with("[OPT:")) {
        const auto parts = parts_of(line.substr(5, line.size() - 6), ',');
        const auto count = [&](size_t i) -> std::optional<size_t> {
            const auto value = i < parts.size() ? number_of(parts[i]) : std::nullopt;
            if (!value || !(*value >= 1.0 && *value < 1e6)) return {};
            return static_cast<size_t>(*value);
        };
        planner = count(1);
        buffer = count(2);
    }
    if (line.starts_with("$N") && may_move(line.substr(2))) stored_line = line;
    if (line.starts_with("$") && line.find('=') != std::string_view::npos) {
        const size_t equals = line.find('=');
        const auto value = number_of(line.substr(equals + 1));
        if (!value) return;
        const std::string_view name = line.substr(0, equals);
        if (name == "$12") arc_tolerance = *value;
        if (name == "$13") reports_inches = *value != 0.0;
        for (int i = 0; i < 3; ++i)
            if (name == "$10" + std::to_string(i) && *value > 0.0) step[i] = 1.0 / *value;
    }
}

int grbl_error_in(std::string_view message) {
    constexpr int unsupported = 20;
    const size_t at = message.find("(error ");
    if (at == std::string_view::npos) return unsupported;
    int number = unsupported;
    std::from_chars(message.data() + at + 7, message.data() + message.size(), number);
    return number;
}

std::string grbl_message(std::string text) {
    for (char& c : text) {
        if (c == '[') c = '(';
        if (c == ']') c = ')';
        if (static_cast<unsigned char>(c) < ' ') c = ' ';
    }
    return "[MSG:" + text + "]";
}

} // namespace app
