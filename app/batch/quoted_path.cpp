#include "app/batch/quoted_path.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <string_view>
#include <utility>

#include "app/setup/utf8_text.h"

namespace app {
namespace {

bool goes_on(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Whether what stands there is no part of a longer word, nor the end of a sentence.
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
    for (const KeptFinding& finding : result.findings)
        texts.insert(texts.end(), {finding.file, finding.message, finding.cure, finding.pair[0],
                                   finding.pair[1]});
    if (result.tightest)
        texts.insert(texts.end(), {result.tightest->pair[0], result.tightest->pair[1]});
    if (!result.error) return texts;
    texts.push_back(result.error->message);
    if (result.error->file != result.program) texts.push_back(result.error->file);
    return texts;
}

/// All paths that a check may have had in hand, and the folders that they are in.
std::set<std::string> paths_of(const CheckJob& job, const std::vector<InputFile>& inputs) {
    const ProgramSettings& settings = job.settings;
    std::vector<std::string> paths = {job.program, job.setup, settings.ini, settings.parameters,
                                      settings.tool_table};
    paths.insert(paths.end(), settings.search_path.begin(), settings.search_path.end());
    for (const InputFile& input : inputs) {
        paths.push_back(input.path);
        if (input.question == core::FileQuestion::in_folder && input.answer)
            paths.push_back(*input.answer);
    }
    std::set<std::string> all;
    for (const std::string& path : paths) {
        all.insert(utf8_text(path));
        all.insert(utf8_text(std::filesystem::path(path).parent_path().string()));
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
