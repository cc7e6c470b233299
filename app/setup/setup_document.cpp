#include "app/setup/setup_document.h"

#include <filesystem>
#include <set>
#include <utility>

#include <fmt/format.h>

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
    redo_.push_back({std::move(version.title), text_});
    mark_.clear();
    put(std::move(version.text));
}

void SetupDocument::redo() {
    if (redo_.empty()) return;
    Version version = std::move(redo_.back());
    redo_.pop_back();
    undo_.push_back({std::move(version.title), text_});
    mark_.clear();
    put(std::move(version.text));
}

void SetupDocument::saved_as(std::string path) {
    path_ = std::move(path);
    saved_ = text_;
    mark_.clear();
}

void SetupDocument::file_changed(std::string text) {
    saved_ = text;
    static_cast<void>(edit("Read the changed file", [&](const std::string&) { return text; }));
}

namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Visits all values with the key nearest above them.
void visit(const toml::node& node, const std::string& key,
           const std::function<void(const std::string&, const toml::node&)>& see) {
    see(key, node);
    if (const toml::table* table = node.as_table())
        for (const auto& [name, value] : *table)
            visit(value, std::string(std::string_view(name)), see);
    if (const toml::array* list = node.as_array())
        for (const toml::node& value : *list) visit(value, key, see);
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
    }
    const bool is_elsewhere =
        !document.path().empty()
        && !core::platform::is_same_file(folder_of(path), folder_of(document.path()));
    if (is_elsewhere && names_relative_files(document.text()))
        return core::fail_file(
            path, fmt::format("the set-up names files by relative paths: save it in {}",
                              folder_of(document.path()).generic_string()));
    return {};
}

} // namespace

bool names_relative_files(const std::string& text) {
    const auto root = parsed_toml(text);
    if (!root) return false;
    static const std::set<std::string> keys = {
        "mesh",       "model",       "file",         "ini",         "parameters",
        "tool_table", "search_path", "tool_library", "holder_file", "holder_mesh"};
    bool any = false;
    visit(*root, "", [&](const std::string& key, const toml::node& node) {
        const auto path = node.value<std::string>();
        any = any || (keys.contains(key) && path && fs::path(*path).is_relative());
    });
    return any;
}

core::Result<void> save_setup(SetupDocument& document, const std::string& path, Replacing replacing,
                              const std::string& program, const FileWriter& write) {
    if (const auto may = check_target(document, path, replacing, program); !may) return may;
    if (const auto written = write(path, document.text()); !written) return written;
    document.saved_as(path);
    return {};
}

} // namespace app
