#include "app/view/model/recent_files.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/setup/setup_text.h"
#include "app/setup/toml_file.h"
#include "core/base/file_reads.h"

namespace app::viewer {
namespace {

/// The most bytes of a list that are read: paths are shorter than 4 KB.
constexpr size_t most_bytes = most_recent * 4 * 4096;

} // namespace

std::vector<RecentProgram> recent_in(const std::string& text) {
    const auto table = parsed_toml(text);
    const toml::array* list = table ? (*table)["recent"].as_array() : nullptr;
    if (!list) return {};
    std::vector<RecentProgram> found;
    for (const toml::node& node : *list) {
        const toml::table* entry = node.as_table();
        if (!entry) continue;
        RecentProgram recent{(*entry)["program"].value_or(std::string()),
                             (*entry)["setup"].value_or(std::string())};
        const bool is_known = std::any_of(found.begin(), found.end(), [&](const RecentProgram& r) {
            return r.program == recent.program;
        });
        if (!recent.program.empty() && !is_known && found.size() < most_recent)
            found.push_back(std::move(recent));
    }
    return found;
}

std::string text_of(const std::vector<RecentProgram>& recent) {
    std::string text = "# Programs that feeler view has opened, the last one first.\n";
    for (const RecentProgram& each : recent)
        text += fmt::format("\n[[recent]]\nprogram = {}\nsetup = {}\n", toml_text(each.program),
                            toml_text(each.setup));
    return text;
}

std::vector<RecentProgram> with_recent(std::vector<RecentProgram> recent, RecentProgram opened) {
    std::erase_if(recent, [&](const RecentProgram& r) { return r.program == opened.program; });
    recent.insert(recent.begin(), std::move(opened));
    if (recent.size() > most_recent) recent.resize(most_recent);
    return recent;
}

RecentFiles::RecentFiles(std::filesystem::path file, FileWriter write)
    : file_(std::move(file)), write_(std::move(write)) {
    read();
}

void RecentFiles::read() {
    if (!file_.empty()) programs_ = recent_in(core::file_bytes(file_, most_bytes).value_or(""));
}

void RecentFiles::add(const std::string& program, const std::string& setup) {
    RecentProgram opened{absolute_path(program), absolute_path(setup)};
    // The list is UTF-8: it cannot name other files.
    if (utf8_text(opened.program + opened.setup) != opened.program + opened.setup) return;
    read();
    programs_ = with_recent(std::move(programs_), std::move(opened));
    keep();
}

void RecentFiles::remove(const std::string& program) {
    read();
    std::erase_if(programs_, [&](const RecentProgram& r) { return r.program == program; });
    keep();
}

void RecentFiles::keep() const {
    if (file_.empty() || !write_) return;
    std::error_code ignored; // writing the file fails then
    std::filesystem::create_directories(file_.parent_path(), ignored);
    static_cast<void>(write_(file_.generic_string(), text_of(programs_)));
}

} // namespace app::viewer
