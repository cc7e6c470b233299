#include "app/view/model/file_watch.h"

#include <algorithm>

#include "app/setup/toml_file.h"
#include "core/base/text.h"
#include "core/cad/cad_file.h"

namespace app::viewer {
namespace {

bool has_ending(const std::string& path, std::initializer_list<const char*> endings) {
    const std::string ending =
        core::lower_case(std::filesystem::path(path).extension().generic_string());
    return std::any_of(endings.begin(), endings.end(), [&](const char* e) { return ending == e; });
}

} // namespace

bool is_mesh_file(const std::string& path) {
    return has_ending(path, {".stl", ".obj", ".ply", ".off"})
           || (core::is_cad_file(path) && !is_cam_job(path));
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

bool is_cam_job(const std::string& path) { return has_ending(path, {".fcstd"}); }
bool is_ini_file(const std::string& path) { return has_ending(path, {".ini"}); }
bool is_offset_file(const std::string& path) { return has_ending(path, {".var", ".ofs"}); }

FileWatch::Seen FileWatch::observe(const std::string& path) {
    Seen seen{path};
    std::error_code gone;
    const auto time = std::filesystem::last_write_time(path, gone);
    if (!gone) seen.time = time;
    const auto size = std::filesystem::file_size(path, gone);
    if (!gone) seen.size = size;
    return seen;
}

void FileWatch::set(const std::vector<std::string>& paths) {
    std::vector<Seen> known, last;
    for (const std::string& path : paths) {
        const auto is_same = [&](const Seen& seen) { return seen.path == path; };
        if (path.empty() || std::any_of(known.begin(), known.end(), is_same)) continue;
        const auto before = std::find_if(known_.begin(), known_.end(), is_same);
        const auto index = static_cast<size_t>(before - known_.begin());
        known.push_back(index == known_.size() ? observe(path) : known_[index]);
        last.push_back(index == known_.size() ? known.back() : last_[index]);
    }
    known_ = std::move(known);
    last_ = std::move(last);
    missing_.clear();
}

void FileWatch::take_as_known(const std::string& path) {
    for (size_t i = 0; i < known_.size(); ++i)
        if (known_[i].path == path) known_[i] = last_[i] = observe(path);
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
