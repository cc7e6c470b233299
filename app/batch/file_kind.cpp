#include "app/batch/file_kind.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "app/tools/line_comments.h"
#include "gcode/program_text.h"

namespace app {
namespace {

constexpr size_t looked_at = 65536; // bytes

/// Endings of names, without the dot, that no NC program has.
struct Kind {
    const char* what;
    std::initializer_list<std::string_view> endings;
};

const Kind foreign_kinds[] = {
    {"is a mesh or a drawing",
     {"stl", "obj", "ply", "off", "step", "stp", "iges", "igs", "dxf", "dwg", "3mf", "f3d", "fcstd",
      "sldprt", "sldasm", "ipt", "prt", "svg"}},
    {"is a picture or a film", {"png", "jpg", "jpeg", "gif", "bmp", "tif", "tiff", "webp", "mp4"}},
    {"is an archive", {"zip", "gz", "bz2", "xz", "7z", "tar", "rar", "zst"}},
    {"is a document", {"pdf", "doc", "docx", "xls", "xlsx", "odt", "ods", "md", "html", "htm"}},
    {"is a set-up, a table or a report",
     {"toml", "json", "jsonl", "yaml", "yml", "xml", "csv", "tsv", "ini", "tbl", "var", "fctl",
      "fctb", "sarif", "sqlite", "db", "log"}},
    {"is a program of another kind", {"py", "sh", "bat", "exe", "dll", "so", "cpp", "c", "js"}},
};

/// Endings that NC programs have and hardly anything else.
constexpr std::string_view program_endings[] = {"nc",  "ngc", "tap", "cnc", "gcode", "mpf",
                                                "spf", "eia", "nct", "hnc", "gc"};

std::string ending_of(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return ending.empty() ? ending : ending.substr(1);
}

/// Whether code without blanks begins as a block does: N10, a letter and a value, a tape mark.
bool is_like_a_block(std::string_view code) {
    if (code.empty()) return false;
    if (code[0] == '/') code.remove_prefix(1);
    if (code.size() == 1) return code[0] == '%';
    const char first = code.empty() ? ' ' : code[0];
    if (first == '%' || first == '#') return true;
    return first >= 'A' && first <= 'Z'
           && std::string_view("0123456789+-.#[=<").find(code[1]) != std::string_view::npos;
}

bool is_klartext(std::string_view text) {
    return text.substr(0, 4096).find("BEGIN PGM") != std::string_view::npos;
}

/// Whether most lines are blocks, and one of them has a G or M code.
bool has_mostly_blocks(std::string_view text) {
    size_t lines = 0, blocks = 0;
    bool has_code = false;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find_first_of("\r\n", at), text.size());
        const std::string code = parts_of_line(text.substr(at, end - at)).code;
        at = end + 1;
        if (code.empty()) continue;
        const bool is_block = is_like_a_block(code);
        ++lines;
        blocks += is_block;
        for (size_t i = 0; is_block && !has_code && i + 1 < code.size(); ++i)
            has_code =
                (code[i] == 'G' || code[i] == 'M') && code[i + 1] >= '0' && code[i + 1] <= '9';
    }
    return has_code && 2 * blocks >= lines;
}

/// What keeps any text from being a program.
std::optional<std::string> why_unreadable(std::string_view text) {
    if (text.find('\0') != std::string_view::npos) return std::string(gcode::what_has_nuls(text));
    if (gcode::looks_binary(gcode::count_stray_controls(text), text.size()))
        return "is a binary file";
    return text.empty() ? std::optional<std::string>("is empty") : std::nullopt;
}

} // namespace

std::optional<std::string> why_no_program_text(std::string_view text) {
    if (auto why = why_unreadable(text)) return why;
    if (is_klartext(text) || has_mostly_blocks(text)) return std::nullopt;
    return "most of its lines are no blocks of an NC program";
}

core::Result<std::optional<std::string>> why_no_program(const std::string& path) {
    const std::string ending = ending_of(path);
    for (const Kind& kind : foreign_kinds)
        if (std::find(kind.endings.begin(), kind.endings.end(), ending) != kind.endings.end())
            return std::optional<std::string>(kind.what);
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file)
        return tl::unexpected<core::Error>(
            {core::ErrorCode::io,
             {},
             "cannot be read: " + std::generic_category().message(errno),
             path});
    std::string text(looked_at, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<size_t>(file.gcount()));
    const bool is_named_so =
        std::find(std::begin(program_endings), std::end(program_endings), ending)
        != std::end(program_endings);
    return is_named_so ? why_unreadable(text) : why_no_program_text(text);
}

} // namespace app
