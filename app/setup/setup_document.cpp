#include "app/setup/setup_document.h"

#include <filesystem>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/setup/setup_text.h"
#include "app/setup/toml_edit.h"
#include "app/setup/toml_file.h"
#include "core/base/file_reads.h"
#include "core/base/platform.h"

namespace app {

namespace {

constexpr size_t most_versions = 1000;

} // namespace

SetupDocument::SetupDocument(std::string path, std::string text)
    : path_(std::move(path)), text_(std::move(text)), saved_(text_) {}

void SetupDocument::put(std::string text) {
    text_ = std::move(text);
    ++version_;
}

core::Result<void> SetupDocument::edit(const std::string& title, const Edit& edit,
                                       const std::string& mark) {
    FEELER_TRY(std::string text, edit(text_));
    if (text == text_) return {};
    const bool continues = !mark.empty() && mark == mark_ && !undo_.empty();
    if (!continues) undo_.push_back({title, text_});
    if (undo_.size() > most_versions) undo_.erase(undo_.begin());
    mark_ = mark;
    redo_.clear();
    put(std::move(text));
    return {};
}

void SetupDocument::undo() {
    if (undo_.empty()) return;
    Version version = std::move(undo_.back());
    undo_.pop_back();
    changes_taken_back_ += version.is_of_file;
    redo_.push_back({std::move(version.title), text_, version.is_of_file});
    mark_.clear();
    put(std::move(version.text));
}

void SetupDocument::redo() {
    if (redo_.empty()) return;
    Version version = std::move(redo_.back());
    redo_.pop_back();
    changes_taken_back_ -= version.is_of_file;
    undo_.push_back({std::move(version.title), text_, version.is_of_file});
    mark_.clear();
    put(std::move(version.text));
}

void SetupDocument::saved_as(std::string path) {
    path_ = std::move(path);
    saved_ = text_;
    changes_taken_back_ = 0;
    mark_.clear();
}

void SetupDocument::file_changed(std::string text) {
    saved_ = text;
    changes_taken_back_ = 0;
    const bool is_change = text != text_;
    static_cast<void>(edit("Read the changed file", [&](const std::string&) { return text; }));
    if (is_change) undo_.back().is_of_file = true;
}

namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// A path of a file in a set-up that is relative to the folder of the set-up.
struct RelativeFile {
    TomlPath place;
    std::string path;
};

/// Collects the relative files below a node. `key`: the one nearest above it.
void collect_files(const toml::node& node, const TomlPath& place, const std::string& key,
                   std::vector<RelativeFile>& found) {
    static const std::set<std::string> keys = {
        "mesh",       "model",       "file",         "ini",         "parameters",
        "tool_table", "search_path", "tool_library", "holder_file", "holder_mesh"};
    const auto path = node.value<std::string>();
    if (path && keys.contains(key) && fs::path(*path).is_relative())
        found.push_back({place, *path});
    if (const toml::table* table = node.as_table())
        for (const auto& [name, value] : *table) {
            const std::string below(std::string_view{name});
            collect_files(value, place / below, below, found);
        }
    if (const toml::array* list = node.as_array())
        for (size_t i = 0; i < list->size(); ++i)
            collect_files(*list->get(i), place / i, key, found);
}

std::vector<RelativeFile> relative_files(const std::string& text) {
    std::vector<RelativeFile> found;
    if (const auto root = parsed_toml(text)) collect_files(*root, {}, "", found);
    return found;
}

core::Result<void> check_target(const SetupDocument& document, const std::string& path,
                                Replacing replacing, const std::string& program) {
    if (path.empty()) return core::fail_file(path, "the file name is empty");
    if (!program.empty() && core::platform::is_same_file(path, program))
        return core::fail_file(path, "is the program itself");
    const bool is_own =
        !document.path().empty()
        && (path == document.path() || core::platform::is_same_file(path, document.path()));
    if (replacing == Replacing::refused && core::is_there(path)) {
        if (!is_own) return core::fail_file(path, "already exists");
        if (core::file_bytes(path) != document.saved_text())
            return core::fail_file(path, "has been changed by another program since it was read");
        if (document.takes_back_file())
            return core::fail_file(path, "has a change of another program, which you have undone: "
                                         "saving writes over that change");
    }
    // A set-up without a file is read as if it were next to the program.
    const std::string& place = document.path().empty() ? program : document.path();
    const bool is_elsewhere =
        !place.empty() && !core::platform::is_same_file(folder_of(path), folder_of(place));
    if (is_elsewhere && names_relative_files(document.text()))
        return core::fail_file(
            path, fmt::format("the set-up names files by relative paths: save it in {}",
                              folder_of(place).generic_string()));
    return {};
}

} // namespace

bool names_relative_files(const std::string& text) { return !relative_files(text).empty(); }

core::Result<std::string> with_whole_paths(const std::string& text, const std::string& folder) {
    std::string whole = text;
    for (const RelativeFile& file : relative_files(text)) {
        const fs::path path = (fs::path(folder) / file.path).lexically_normal();
        FEELER_TRY(whole, toml_with_value(whole, file.place, toml_text(path.generic_string())));
    }
    return whole;
}

core::Result<void> save_setup(SetupDocument& document, const std::string& path, Replacing replacing,
                              const std::string& program, const FileWriter& write) {
    if (const auto may = check_target(document, path, replacing, program); !may) return may;
    if (const auto written = write(path, document.text()); !written) return written;
    document.saved_as(path);
    return {};
}

} // namespace app
