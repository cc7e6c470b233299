#include "app/view/model/file_watch.h"

#include <algorithm>
#include <fstream>

#include "app/setup/toml_file.h"
#include "core/base/text.h"

namespace app::viewer {
namespace {

bool has_ending(const std::string& path, std::initializer_list<const char*> endings) {
    const std::string ending =
        core::lower_case(std::filesystem::path(path).extension().generic_string());
    return std::any_of(endings.begin(), endings.end(), [&](const char* e) { return ending == e; });
}

/// All texts between quotes, line by line.
std::vector<std::string> quoted_in(const std::string& path) {
    std::ifstream file{std::filesystem::path(path)};
    std::vector<std::string> found;
    for (std::string line; std::getline(file, line);)
        for (const char quote : {'"', '\''})
            for (size_t first = line.find(quote); first != std::string::npos;) {
                const size_t last = line.find(quote, first + 1);
                if (last == std::string::npos) break;
                found.push_back(line.substr(first + 1, last - first - 1));
                first = line.find(quote, last + 1);
            }
    return found;
}

} // namespace

bool is_mesh_file(const std::string& path) {
    return has_ending(path, {".stl", ".obj", ".ply", ".off"});
}

bool is_setup_file(const std::string& path) { return has_ending(path, {".toml"}); }

bool is_tool_library(const std::string& path) {
    return has_ending(path, {".tools", ".json", ".hsmlib", ".fctl", ".fctb", ".tbl"});
}

bool is_machine_file(const std::string& path) {
    if (has_ending(path, {".machine", ".mch"})) return true;
    if (!is_setup_file(path)) return false;
    const auto root = read_toml(path);
    return root && root->contains("axis");
}

std::vector<std::string> files_of_setup(const std::string& setup) {
    std::vector<std::string> files{setup};
    // A machine file names meshes, too; a set-up never names another set-up.
    for (size_t i = 0; i < files.size(); ++i) {
        if (!is_setup_file(files[i])) continue;
        const std::filesystem::path folder = std::filesystem::path(files[i]).parent_path();
        for (const std::string& name : quoted_in(files[i])) {
            if (!is_mesh_file(name) && !is_setup_file(name) && !is_tool_library(name)) continue;
            const std::string path = (folder / name).generic_string();
            if (std::find(files.begin(), files.end(), path) == files.end()) files.push_back(path);
        }
    }
    return files;
}

FileWatch::Seen FileWatch::observe(const std::string& path) {
    Seen seen{path};
    std::error_code gone;
    const auto time = std::filesystem::last_write_time(path, gone);
    if (!gone) seen.time = time;
    const auto size = std::filesystem::file_size(path, gone);
    if (!gone) seen.size = size;
    return seen;
}

void FileWatch::set(std::vector<std::string> paths) {
    known_.clear();
    for (const std::string& path : paths)
        if (!path.empty()) known_.push_back(observe(path));
    last_ = known_;
    missing_.clear();
}

void FileWatch::add(const std::vector<std::string>& paths) {
    for (const std::string& path : paths) {
        const auto is_same = [&](const Seen& seen) { return seen.path == path; };
        if (path.empty() || std::any_of(known_.begin(), known_.end(), is_same)) continue;
        known_.push_back(observe(path));
        last_.push_back(known_.back());
    }
}

void FileWatch::check_for_missing(const std::vector<Seen>& now) {
    missing_.clear();
    for (size_t i = now.size(); i-- > 0;)
        if (now[i].size == 0 && now[i] != known_[i]) missing_ = now[i].path;
}

bool FileWatch::has_changed() {
    std::vector<Seen> now;
    for (const Seen& seen : known_) now.push_back(observe(seen.path));
    const bool rests = now == last_;
    last_ = now;
    if (!rests) return false;
    // Editors that replace a file delete it for a moment.
    check_for_missing(now);
    if (now == known_ || !missing_.empty()) return false;
    known_ = std::move(now);
    return true;
}

} // namespace app::viewer
