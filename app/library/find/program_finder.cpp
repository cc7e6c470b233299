#include "app/library/find/program_finder.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <system_error>

#include "app/base/file_stamp.h"
#include "app/library/find/folder_walk.h"
#include "app/library/find/project_file.h"
#include "app/setup/tools/program_tools.h"
#include "core/base/file_reads.h"
#include "core/base/platform.h"
#include "gcode/text/program_text.h"

namespace app {
namespace {

namespace fs = std::filesystem;

class Finder {
public:
    explicit Finder(fs::path folder) : folder_(std::move(folder)) {}

    FoundPrograms found;

    void take(const std::string& word) {
        const std::string path = folder_.empty() ? word : plain_path(folder_ / word);
        const auto what = core::presence_of(path);
        if (what == "folder") return search(plain_path(path));
        if ((!what || *what == "unknown") && is_glob(word)) return expand(word);
        if (what == "other") return fail(path, "is a pipe or a device; name it alone to check it");
        add(path); // its check reports if it is missing or unreadable
    }

private:
    void search(const std::string& folder) {
        const FolderWalk walk = walk_folder(folder);
        const bool has_programs = take_all(walk, folder);
        std::set<std::string> projects, unreadable;
        for (const core::Error& error : walk.unreadable) unreadable.insert(error.file);
        for (const fs::path& each : walk.folders)
            if (!unreadable.contains(each.generic_string()) && !owners_.of(each, each).empty())
                projects.insert(plain_path(owners_.of(each, each)));
        found.projects.insert(found.projects.end(), projects.begin(), projects.end());
        if (!has_programs && projects.empty() && walk.unreadable.empty())
            fail(folder, "contains no NC program");
    }

    void expand(const std::string& pattern) {
        const FolderWalk matched = files_of_glob(folder_, pattern);
        const bool has_programs = take_all(matched, folder_of_glob(folder_, pattern));
        if (has_programs || !matched.unreadable.empty()) return;
        const bool is_any = !matched.files.empty() || !matched.skipped.empty();
        fail(plain_path(folder_ / pattern), is_any ? "matches no NC program" : "matches no file");
    }

    /// Adds the programs among files. True if there are programs, or files that may be programs.
    bool take_all(const FolderWalk& walk, const fs::path& top) {
        for (const SkippedFile& file : walk.skipped) skip(plain_path(file.path), file.why);
        for (core::Error error : walk.unreadable) {
            error.file = plain_path(error.file);
            found.failures.push_back(std::move(error));
        }
        bool has_programs = false;
        for (const std::string& file : walk.files) {
            const std::string owner = owners_.of(fs::path(file).parent_path(), top);
            const std::string project = owner.empty() ? owner : plain_path(owner);
            has_programs = take_file(plain_path(file), project) || has_programs;
        }
        return has_programs;
    }

    /// Adds a file if it is a program. True if it is one, or may be one. Reads each file only once.
    bool take_file(const std::string& file, const std::string& project) {
        const auto [known, is_new] = examined_.try_emplace(identities_.of(file));
        Examined& examined = known->second;
        if (examined.index) {
            FoundProgram& program = found.programs[*examined.index];
            // A program found by a search that began below its project is always checked.
            if (program.project.empty() != project.empty()) program.is_named = true;
            if (!project.empty()) program.project = project;
        }
        if (!is_new) return examined.may_be_program;
        core::notify_file_access({core::FileAccessKind::kind, file, {}, {}});
        auto why = why_no_program(file);
        examined.may_be_program = !why || !*why;
        if (!why)
            found.failures.push_back(why.error());
        else if (*why)
            found.skipped.push_back({file, **why});
        else
            examined.index = put(file, project);
        return examined.may_be_program;
    }

    void add(const std::string& file) {
        Examined& examined = examined_[identities_.of(file)];
        if (!examined.index) examined = {true, put(file, {})};
        found.programs[*examined.index].is_named = true;
    }

    size_t put(const std::string& file, const std::string& project) {
        found.programs.push_back({file, project, false});
        return found.programs.size() - 1;
    }

    void skip(const std::string& file, const std::string& why) {
        if (skipped_.insert(identities_.of(file)).second) found.skipped.push_back({file, why});
    }

    void fail(const std::string& word, const std::string& why) {
        found.failures.push_back({core::ErrorCode::io, {}, why, word});
    }

    /// The result of examining a file.
    struct Examined {
        bool may_be_program = false;
        std::optional<size_t> index = {}; // index in found.programs
    };

    fs::path folder_;
    FileIdentities identities_;
    ProjectOwners owners_;
    std::map<std::string, Examined> examined_;
    std::set<std::string> skipped_;
};

} // namespace

FoundPrograms find_programs(const std::vector<std::string>& words, const fs::path& folder) {
    Finder finder(folder);
    for (const std::string& word : words) finder.take(word);
    return std::move(finder.found);
}

namespace {

constexpr size_t sample_size = 65536; // bytes at the beginning of a file that are read

/// File extensions, without the dot, that NC programs never have.
struct Kind {
    const char* what;
    std::initializer_list<std::string_view> endings;
};

const Kind foreign_kinds[] = {
    {"is a mesh or a drawing",
     {"stl", "obj", "ply", "off", "step",  "stp",    "iges",   "igs", "brep", "brp",
      "dxf", "dwg", "3mf", "f3d", "fcstd", "sldprt", "sldasm", "ipt", "prt",  "svg"}},
    {"is a picture or a video", {"png", "jpg", "jpeg", "gif", "bmp", "tif", "tiff", "webp", "mp4"}},
    {"is an archive", {"zip", "gz", "bz2", "xz", "7z", "tar", "rar", "zst"}},
    {"is a document", {"pdf", "doc", "docx", "xls", "xlsx", "odt", "ods", "md", "html", "htm"}},
    {"is a set-up, a table or a report",
     {"toml", "json", "jsonl", "yaml", "yml", "xml", "csv", "tsv", "ini", "tbl", "var", "fctl",
      "fctb", "sarif", "sqlite", "db", "log"}},
    {"is a program of another kind", {"py", "sh", "bat", "exe", "dll", "so", "cpp", "c", "js"}},
};

/// File extensions that are hardly used for anything but NC programs.
constexpr std::string_view program_endings[] = {"nc",  "ngc", "tap", "cnc", "gcode", "mpf",
                                                "spf", "eia", "nct", "hnc", "gc"};

std::string ending_of(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().generic_string();
    for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return ending.empty() ? ending : ending.substr(1);
}

/// Whether code without blanks begins like a block: N10, a letter and a value, or a tape mark.
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

/// Why a text cannot be a program of any kind; empty if it can.
std::optional<std::string> why_unreadable(std::string_view text) {
    if (text.find('\0') != std::string_view::npos) return std::string(gcode::nul_bytes_error(text));
    if (gcode::looks_binary(gcode::count_stray_controls(text), text.size()))
        return "is a binary file";
    return text.empty() ? std::optional<std::string>("is empty") : std::nullopt;
}

} // namespace

std::optional<std::string> why_no_program_text(std::string_view text) {
    if (auto why = why_unreadable(text)) return why;
    if (is_klartext(text) || has_mostly_blocks(text)) return std::nullopt;
    return "most of its lines are not NC blocks";
}

std::string foreign_kind(const std::string& path) {
    const std::string ending = ending_of(path);
    for (const Kind& kind : foreign_kinds)
        if (std::find(kind.endings.begin(), kind.endings.end(), ending) != kind.endings.end())
            return kind.what;
    return {};
}

core::Result<std::optional<std::string>> why_no_program(const std::string& path) {
    const std::string ending = ending_of(path);
    if (const std::string kind = foreign_kind(path); !kind.empty()) return std::optional(kind);
    if (core::platform::is_device(path)) return std::optional<std::string>("is a device");
    errno = 0;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
        core::platform::open_file(path, "rb"), std::fclose);
    if (!file)
        return tl::unexpected<core::Error>(
            {core::ErrorCode::io,
             {},
             "cannot be read: " + std::generic_category().message(errno),
             path});
    std::string text(sample_size, '\0');
    text.resize(std::fread(text.data(), 1, text.size(), file.get()));
    const bool is_named_so =
        std::find(std::begin(program_endings), std::end(program_endings), ending)
        != std::end(program_endings);
    return is_named_so ? why_unreadable(text) : why_no_program_text(text);
}

} // namespace app
