#include "app/library/store/relative_paths.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <string_view>
#include <utility>

#include "app/base/file_stamp.h"
#include "app/base/text.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/setup/program_settings.h"
#include "core/base/file_reads.h"

namespace app {
namespace {

namespace fs = std::filesystem;

/// The rest of a path below a folder, beginning with a slash; empty optional if the path is not in
/// the folder. Both must be plain paths; the root is an empty text.
std::optional<std::string_view> below(std::string_view path, std::string_view folder) {
    if (!path.starts_with(folder)) return std::nullopt;
    path.remove_prefix(folder.size());
    if (!path.empty() && path[0] != '/') return std::nullopt;
    return path;
}

std::string_view parent_of(std::string_view folder) {
    return folder.substr(0, std::min(folder.rfind('/'), folder.size()));
}

/// The absolute path without redundant parts; the root is an empty text.
std::string absolute_path(const std::string& path, const std::string& working_folder) {
    std::error_code ignored;
    const fs::path stated(path); // on Windows, D:jobs and \jobs have a root, but are not absolute
    std::string plain =
        plain_path(stated.has_root_path() ? fs::absolute(stated, ignored).generic_string()
                                          : working_folder + "/" + path);
    return plain == "/" ? std::string() : plain;
}

/// The stamps of folders; the root is an empty text.
std::array<FileStamp, 3> stamps_of(const std::array<std::string, 3>& folders) {
    std::array<FileStamp, 3> stamps;
    for (size_t i = 0; i < folders.size(); ++i) stamps[i] = stamp_of(folders[i] + "/");
    return stamps;
}

std::string folder_of(const std::string& database) {
    const fs::path folder = fs::path(plain_path(database)).parent_path();
    return (folder.filename() == ".feeler" ? folder.parent_path() : folder).generic_string();
}

} // namespace

RelativePaths::RelativePaths(const std::string& database) {
    std::error_code failure;
    working_folder_ = fs::current_path(failure).generic_string();
    named_folder_ = absolute_path(folder_of(database), working_folder_);
    folder_ =
        absolute_path(whole_path(named_folder_ + "/", failure).generic_string(), working_folder_);
    stamps_ = stamps_of({working_folder_, named_folder_, folder_});
}

bool RelativePaths::are_still_valid() const {
    const auto is_same = [](const FileStamp& a, const FileStamp& b) {
        return a.is_there && a.device == b.device && a.number == b.number;
    };
    const auto now = stamps_of({working_folder_, named_folder_, folder_});
    const FileStamp here = stamp_of(".");
    return std::equal(stamps_.begin(), stamps_.end(), now.begin(), is_same)
           && is_same(stamps_[0], here);
}

std::string RelativePaths::relative(const std::string& path) const {
    if (path.empty()) return {};
    const std::string file = absolute_path(path, working_folder_);
    for (const std::string& folder : {named_folder_, folder_})
        if (const auto rest = below(file, folder))
            return rest->empty() ? "." : std::string(rest->substr(1));
    std::string up = "..";
    for (std::string_view folder = parent_of(folder_); !folder.empty();
         folder = parent_of(folder), up += "/..")
        if (const auto rest = below(file, folder)) return up + std::string(*rest);
    return file.empty() ? "/" : file;
}

std::string RelativePaths::absolute(const std::string& relative_path) const {
    if (relative_path.empty() || fs::path(relative_path).has_root_path()) return relative_path;
    std::string_view folder = folder_, rest = relative_path;
    while (rest == ".." || rest.starts_with("../")) {
        folder = parent_of(folder);
        rest.remove_prefix(std::min<size_t>(3, rest.size()));
    }
    std::string path(folder);
    if (!rest.empty() && rest != ".") path += "/" + std::string(rest);
    return path.empty() ? "/" : path;
}

CheckJob with_relative_paths(const CheckJob& job, const RelativePaths& paths) {
    CheckJob made = job;
    ProgramSettings& settings = made.settings;
    for (std::string* path :
         {&made.program, &made.setup, &settings.ini, &settings.parameters, &settings.tool_table})
        *path = paths.relative(*path);
    for (std::string& folder : settings.search_path) folder = paths.relative(folder);
    return made;
}

InputFile with_relative_paths(InputFile input, const RelativePaths& paths) {
    input.path = paths.relative(input.path);
    if (input.question == core::FileAccessKind::in_folder && input.answer)
        input.answer = paths.relative(*input.answer);
    return input;
}

InputFile with_absolute_paths(InputFile input, const RelativePaths& paths) {
    input.path = paths.absolute(input.path);
    if (input.question == core::FileAccessKind::in_folder && input.answer)
        input.answer = paths.absolute(*input.answer);
    return input;
}

namespace {

bool goes_on(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Whether text[begin, end) is not part of a longer word, and not just the dots ending a sentence.
bool is_whole_word(const std::string& text, size_t begin, size_t end) {
    const bool begins = begin == 0 || !goes_on(text[begin - 1]) || !goes_on(text[begin]);
    const bool ends = end == text.size() || !goes_on(text[end]) || !goes_on(text[end - 1]);
    const bool is_dots = text.find_first_not_of('.', begin) >= end;
    const bool may_be_folder =
        begin == 0 || std::string_view(" \"'(:=,").find(text[begin - 1]) != std::string_view::npos;
    return begins && ends && (!is_dots || may_be_folder);
}

bool quotes(const std::string& text, const std::string& path) {
    for (size_t at = text.find(path); at != std::string::npos; at = text.find(path, at + 1))
        if (is_whole_word(text, at, at + path.size())) return true;
    return false;
}

std::vector<std::string> texts_of(const ProgramResult& result) {
    std::vector<std::string> texts = result.assumptions;
    for (const StoredFinding& finding : result.findings)
        texts.insert(texts.end(), {finding.file, finding.message, finding.cure, finding.pair[0],
                                   finding.pair[1]});
    if (result.tightest)
        texts.insert(texts.end(), {result.tightest->pair[0], result.tightest->pair[1]});
    if (!result.error) return texts;
    texts.push_back(result.error->message);
    if (result.error->file != result.program) texts.push_back(result.error->file);
    return texts;
}

/// All paths that a check may have used, and their folders.
std::set<std::string> paths_of(const CheckJob& job, const std::vector<InputFile>& inputs) {
    const ProgramSettings& settings = job.settings;
    std::vector<std::string> paths = {job.program, job.setup, settings.ini, settings.parameters,
                                      settings.tool_table};
    paths.insert(paths.end(), settings.search_path.begin(), settings.search_path.end());
    for (const InputFile& input : inputs) {
        paths.push_back(input.path);
        if (input.question == core::FileAccessKind::in_folder && input.answer)
            paths.push_back(*input.answer);
    }
    std::set<std::string> all;
    for (const std::string& path : paths) {
        all.insert(utf8_text(path));
        all.insert(utf8_text(std::filesystem::path(path).parent_path().generic_string()));
    }
    all.erase("");
    all.erase("/");
    return all;
}

} // namespace

bool quotes_paths(const ProgramResult& result, const CheckJob& job,
                  const std::vector<InputFile>& inputs, const std::string& folder) {
    std::set<std::string> paths = paths_of(job, inputs);
    if (folder.size() > 1) paths.insert(utf8_text(folder));
    const std::vector<std::string> texts = texts_of(result);
    return std::any_of(paths.begin(), paths.end(), [&](const std::string& path) {
        return std::any_of(texts.begin(), texts.end(),
                           [&](const std::string& text) { return quotes(text, path); });
    });
}

ProgramResult renamed(ProgramResult result, const CheckJob& job) {
    const std::string before = std::exchange(result.program, std::string());
    for (const std::string& old : {before, result.setup}) result.file_bytes.erase(old);
    result.program = shown_name(job.program, result.file_bytes);
    if (result.error && result.error->file == before) result.error->file = result.program;
    result.setup = shown_name(job.setup, result.file_bytes);
    return result;
}

} // namespace app
